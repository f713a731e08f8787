"""Looks a robot file over: everything that would keep its plans from being good ones."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from runtime.robot.approach import Family
from runtime.robot.controllers import unmoved
from runtime.robot.file import RobotFile, read_robot_file
from runtime.robot.findings import Finding
from runtime.robot.load import build_robot
from runtime.robot.model import RobotModel
from runtime.robot.outline import outline
from runtime.robot.propose.pairs import ALWAYS, touching
from runtime.robot.structure import contradictions
from runtime.world.poses import apply, compose, invert
from runtime.world.solids import Floats

WIDE_OPEN = 0.015
"""Metres that fingers may be apart when they are closed."""

LITTLE = 0.01
"""Metres that fingers have to open by."""

OFF_AXIS = 0.02
"""Metres that the grasp centre may be beside the middle of the pads."""

ALONG = 0.8
"""Cosine of the angle between x of the tool and the direction from wrist to fingers, at least."""

AHEAD = 0.12
"""Metres that the tips of the fingers may be before the grasp centre."""

SPEEDY = {True: 1.0, False: 7.0}
"""m/s and rad/s (sliding or not) beyond which no arm moves."""

SAMPLES = 120
COLLISIONS_NAMED = 12
LINKS_NAMED = 6


def check_robot(path: Path) -> tuple[list[Finding], RobotModel | None]:
    """All findings for a robot file, and the robot where one could be built.

    Raises:
        InputError: the file or one that it names cannot be read.
    """
    file = read_robot_file(path)
    found = list(contradictions(file))
    if found:
        return found, None
    robot = build_robot(file)
    for look in (_joints, _shapes, _controllers, _fingers, _tool, _collisions, _workspace):
        found += look(file, robot)
    return found, robot


def _joints(file: RobotFile, robot: RobotModel) -> Iterator[Finding]:
    count = len(robot.joints)
    if not 5 <= count <= 8:
        yield Finding(
            "too-many-joints" if count > 8 else "too-few-joints",
            f"joints: {count} are planned for; 5 to 8 are understood",
            file.place,
            "hold some of them by [fixed_joints]" if count > 8 else None,
        )
    for name, velocity, slides in zip(
        robot.joints, robot.velocity, robot.chain.prismatic, strict=True
    ):
        if velocity > SPEEDY[bool(slides)]:
            yield Finding(
                "velocity-implausible",
                f"joint {name!r}: no arm has {velocity:g} {'m/s' if slides else 'rad/s'}",
                file.place,
                f"state it in [limits.{name}]: velocity",
            )


def _shapes(file: RobotFile, robot: RobotModel) -> Iterator[Finding]:
    bare = [
        link for link, seen in robot.urdf.visuals.items() if seen and not robot.urdf.shapes[link]
    ]
    if bare:
        yield Finding(
            "shape-missing",
            f"{_named(bare)} can be seen, but {'has' if len(bare) == 1 else 'have'} no collision "
            "shape",
            file.place,
            "plans would go through it: give it a <collision> in the URDF, unless another link's "
            "shape covers it",
        )


def _named(links: list[str]) -> str:
    """Some links by name, and how many more there are."""
    named = ", ".join(map(repr, links[:LINKS_NAMED]))
    more = f" and {len(links) - LINKS_NAMED} more" if len(links) > LINKS_NAMED else ""
    return f"{'link' if len(links) == 1 else 'links'} {named}{more}"


def _controllers(file: RobotFile, robot: RobotModel) -> Iterator[Finding]:
    assert file.gripper is not None
    fingers = [j for j in map(robot.urdf.joint, file.gripper.fingers) if j is not None]
    driven = [joint.name for joint in fingers if joint.mimic is None]
    mobile = robot.base.type != "fixed"
    for message, hint in unmoved(robot.controllers, [*robot.joints, *driven], mobile):
        place = f"{file.place}: [controllers]"
        yield Finding("controller-joints", message, place, hint)


def _fingers(file: RobotFile, robot: RobotModel) -> Iterator[Finding]:
    place = f"{file.place}: [gripper]"
    gripper = robot.gripper
    if gripper.min_opening > WIDE_OPEN:
        yield Finding(
            "fingers-do-not-close",
            f"finger_joints: closed, the pads are still {1000 * gripper.min_opening:.0f} mm apart",
            place,
            "look at the limits of the finger joints, and at the pads' collision shapes",
        )
    if gripper.max_opening - gripper.min_opening < LITTLE:
        yield Finding(
            "fingers-do-not-open",
            f"finger_joints: the pads are {1000 * gripper.max_opening:.0f} mm apart at most",
            place,
        )


def _tips(robot: RobotModel) -> list[Floats]:
    """The points of the fingers on either side, half open, in the tool frame."""
    opening = (robot.gripper.min_opening + robot.gripper.max_opening) / 2
    values = np.array([*robot.gripper.joint_values(opening).values()])
    back = invert(robot.tool)
    sides = dict(robot.gripper.fingers)
    clouds: dict[float, list[Floats]] = {1.0: [], -1.0: []}
    for finger in robot.finger_parts:
        pose = compose(back, finger.pose(values))
        cloud = apply(pose, outline(robot.parts[finger.part].shape.solid))
        clouds[sides[finger.part]].append(cloud)
    return [np.vstack(side) for side in clouds.values()]


def _tool(file: RobotFile, robot: RobotModel) -> Iterator[Finding]:
    code, hint = (
        "tool-axis",
        "x of the tool frame is the direction of approach, y that in which the fingers close, "
        "the origin is between their tips: see [tool] xyz, rpy",
    )
    tips = _tips(robot)
    reach = min(float(cloud[:, 0].max()) for cloud in tips)
    ahead = [cloud[cloud[:, 0] > cloud[:, 0].max() - 0.01] for cloud in tips]
    middle = np.mean([(c.min(axis=0) + c.max(axis=0)) / 2 for c in ahead], axis=0)
    fingers = np.mean([(c.min(axis=0) + c.max(axis=0)) / 2 for c in tips], axis=0)
    forward = fingers - invert(robot.tool)[:, 3]  # from the last joint, in the tool frame
    length = float(np.linalg.norm(forward))
    if length > LITTLE and forward[0] < ALONG * length:
        angle = math.degrees(math.acos(forward[0] / length))
        yield Finding(
            code,
            f"tool: x is {angle:.0f} degrees off the direction from the wrist to the fingers",
            file.place,
            hint,
        )
    if not 0.0 <= reach <= AHEAD:
        where = "behind" if reach < 0 else "ahead of"
        yield Finding(
            code,
            f"tool: the tips of the fingers end {abs(reach):.3f} m {where} the grasp centre",
            file.place,
            hint,
        )
    off = float(np.hypot(middle[1], middle[2]))
    if off > OFF_AXIS:
        yield Finding(
            code,
            f"tool: the grasp centre is {off:.3f} m beside the middle of the fingers",
            file.place,
            hint,
        )


def _collisions(file: RobotFile, robot: RobotModel) -> Iterator[Finding]:
    rng = np.random.default_rng(0)
    postures = rng.uniform(robot.lower, robot.upper, (SAMPLES, len(robot.joints)))
    always = {pair for pair, share in touching(robot, postures).items() if share >= ALWAYS}
    for pair in sorted(map(sorted, always))[:COLLISIONS_NAMED]:
        yield Finding(
            "always-in-collision",
            f"ignored_collisions: {pair[0]!r} and {pair[1]!r} touch in nearly all postures",
            file.place,
            "list the pair if it may touch",
        )
    at_home = touching(robot, robot.home[None]).keys() - always
    for pair in sorted(map(sorted, at_home))[:COLLISIONS_NAMED]:
        yield Finding(
            "home-in-collision",
            f"home: {pair[0]!r} and {pair[1]!r} touch",
            file.place,
            "choose another posture, or list the pair in ignored_collisions if it may touch",
        )
    frames = robot.frames(robot.home)
    for part in robot.parts:
        pose = compose(frames[part.frame], part.shape.pose)
        lowest = float(apply(pose, outline(part.shape.solid))[:, 2].min())
        if part.frame > 0 and lowest < 0.0:
            yield Finding(
                "home-in-collision",
                f"home: {part.link!r} reaches {-lowest:.3f} m below the floor",
                file.place,
            )


def _workspace(file: RobotFile, robot: RobotModel) -> Iterator[Finding]:
    spaces = robot.derived.workspaces
    if all(spaces[family].reaches is None for family in (Family.SIDE, Family.TOP)):
        yield Finding(
            "workspace-unreachable",
            "no grasp from the side or from above is reached at any height over the floor",
            file.place,
            "look at the joints' limits, the tool frame, the height of the base, and at pairs "
            "that touch in many postures",
        )
