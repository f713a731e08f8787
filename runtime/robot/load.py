"""Make a `RobotModel` of a robot file (TOML) and the URDFs that it names."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from runtime.robot.approach import Derived, Family
from runtime.robot.controllers import proposed_controllers
from runtime.robot.file import BUILT_IN, GripperFile, RobotFile, read_robot_file
from runtime.robot.gripper import FingerPart, Gripper, Hand
from runtime.robot.model import Chain, PlacedShape, RobotModel
from runtime.robot.shapes import Shape
from runtime.robot.structure import contradictions, planning_joints
from runtime.robot.tree import Folded, fold
from runtime.robot.urdf import Joint, Urdf
from runtime.world.poses import Pose, compose, identity
from sketchlang.errors import InputError

DEFAULT_ROBOT = "tiago"


def built_in_robots() -> list[str]:
    """Names of the robots that come with the package."""
    return sorted(path.parent.name for path in BUILT_IN.glob("*/*.toml"))


def robot_path(name: str | Path) -> Path:
    """The robot file of a name, or the path that is given.

    Raises:
        InputError: no such robot.
    """
    path = Path(name)
    if path.suffix == ".toml":
        return path
    known = built_in_robots()
    if str(name) not in known:
        raise InputError(
            f"unknown robot {str(name)!r}",
            hint=f"built in: {', '.join(known)}; or give the path of a robot file ending in .toml",
        )
    return BUILT_IN / str(name) / f"{name}.toml"


def load_robot(name: str | Path) -> RobotModel:
    """Load a robot by its name or by the path of its TOML file.

    Raises:
        InputError: no such robot, or a file that does not describe one.
    """
    file = read_robot_file(robot_path(name))
    for finding in contradictions(file):
        raise finding.error()
    return replace(build_robot(file), source=str(name))


def build_robot(file: RobotFile) -> RobotModel:
    """The robot of a file without contradictions (`runtime.robot.structure`)."""
    assert file.gripper is not None
    assert file.base is not None
    urdf, joints = file.urdf, planning_joints(file)
    hand = Hand(urdf, file.tool_link, file.gripper.fingers)
    openings, values = hand.table()
    fingers = [joint.name for joint in hand.joints]
    held = {**file.fixed, **dict(zip(fingers, values[0].tolist(), strict=True))}
    folded = fold(urdf, urdf.chain(file.tool_link), [joint.name for joint in joints], held)
    tool = folded.frames[file.tool_link][1]
    parts = tuple(
        PlacedShape(link, frame, Shape(shape.name, compose(pose, shape.pose), shape.solid))
        for link, (frame, pose) in folded.frames.items()
        for shape in urdf.shapes[link]
    )
    ignored = frozenset(frozenset(pair) for pair in file.ignored)
    controllers = file.controllers
    if controllers is None:
        driven = [joint.name for joint in hand.driven]
        controllers = proposed_controllers(joints, driven, file.base.type != "fixed")
    return RobotModel(
        name=file.name,
        joints=tuple(joint.name for joint in joints),
        lower=np.array([joint.lower for joint in joints]),
        upper=np.array([joint.upper for joint in joints]),
        velocity=np.array([joint.velocity for joint in joints]),
        acceleration=np.array(file.acceleration),
        jerk=np.array(file.jerk),
        chain=Chain(folded.origins, np.array([j.type == "prismatic" for j in joints])),
        tool=tool,
        parts=parts,
        pairs=_pairs(parts, ignored, set(hand.links)),
        gripper=_gripper(file.gripper, parts, hand, openings, values),
        finger_parts=_finger_parts(urdf, folded, hand, parts),
        base=file.base,
        home=np.array(file.home),
        ignored=ignored,
        fixed=file.fixed,
        urdf=urdf,
        urdf_tool=file.tool_link,
        digest=file.digest,
        derive=_derived,
        controllers=controllers,
    )


def _derived(robot: RobotModel, families: tuple[Family, ...]) -> Derived:
    """From a cache on disk, where it is known."""
    from runtime.robot.derived import derived_of  # when it is asked for: it needs the kernels

    return derived_of(robot, families)


def _pairs(
    parts: tuple[PlacedShape, ...], ignored: frozenset[frozenset[str]], fingers: set[str]
) -> tuple[tuple[int, int], ...]:
    """Pairs of parts tested for self-collision: that move against each other, and are not
    listed as ignored. Fingers move against each other and against the frame they are on."""
    return tuple(
        (i, j)
        for j, b in enumerate(parts)
        for i, a in enumerate(parts[:j])
        if a.frame != b.frame and frozenset((a.link, b.link)) not in ignored
    )


def _gripper(
    file: GripperFile,
    parts: tuple[PlacedShape, ...],
    hand: Hand,
    openings: np.ndarray,
    values: np.ndarray,
) -> Gripper:
    sides = hand.sides()
    return Gripper(
        fingers=tuple((i, sides[part.link]) for i, part in enumerate(parts) if part.link in sides),
        clearance=file.clearance,
        time=file.time,
        links=frozenset(file.links) | frozenset(hand.links),
        joints=tuple(joint.name for joint in hand.joints),
        openings=openings,
        values=values,
        max_force=file.max_force,
        max_torque=file.max_torque,
        payload=file.payload,
        opens_fully=file.opens_fully,
    )


def _finger_parts(
    urdf: Urdf, folded: Folded, hand: Hand, parts: tuple[PlacedShape, ...]
) -> tuple[FingerPart, ...]:
    """How the parts of the fingers move, from the last frame of the chain outwards."""
    columns = {joint.name: i for i, joint in enumerate(hand.joints)}
    by_name = {(link, shape.name): shape for link in hand.links for shape in urdf.shapes[link]}
    found = []
    for index, part in enumerate(parts):
        if part.link not in hand.links:
            continue
        above = urdf.chain(part.link)
        first = next(i for i, joint in enumerate(above) if joint.name in columns)
        steps: list[tuple[Pose, Joint, int]] = []
        before = folded.frames[above[first].parent][1]
        for joint in above[first:]:
            before = compose(before, joint.origin)
            if joint.name in columns:
                steps.append((before, joint, columns[joint.name]))
                before = identity()
        tip = compose(before, by_name[part.link, part.shape.name].pose)
        found.append(FingerPart(index, tuple(steps), tip))
    return tuple(found)
