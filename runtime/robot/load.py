"""Make a `RobotModel` of a robot file (TOML) and the URDF that it names."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from runtime.robot.model import (
    ArmWorkspace,
    Chain,
    Gripper,
    MobileBase,
    PlacedBox,
    RobotModel,
    Strip,
)
from runtime.robot.urdf import Box, Joint, Urdf, read_urdf
from runtime.tables import Table, read_toml
from runtime.world.poses import Pose, compose, identity, invert
from sketchlang.errors import InputError
from sketchlang.reading import read_bytes

BUILT_IN = Path(__file__).parent
DEFAULT_ROBOT = "tiago"


def built_in_robots() -> list[str]:
    """Names of the robots that come with the package."""
    return sorted(path.parent.name for path in BUILT_IN.glob("*/*.toml"))


def load_robot(name: str | Path) -> RobotModel:
    """Load a robot by its name or by the path of its TOML file.

    Raises:
        InputError: no such robot, or a file that does not describe one.
    """
    path = Path(name)
    if path.suffix != ".toml":
        known = built_in_robots()
        if str(name) not in known:
            raise InputError(
                f"unknown robot {str(name)!r}",
                hint=f"built in: {', '.join(known)}; or give the path of a robot file "
                "ending in .toml",
            )
        path = BUILT_IN / str(name) / f"{name}.toml"
    table = read_toml(path)
    urdf_path = path.parent / table.text("urdf")
    urdf = read_urdf(urdf_path)
    digest = hashlib.sha256(read_bytes(path) + read_bytes(urdf_path)).hexdigest()
    robot = _build(table, urdf, digest)
    table.finish()
    return robot


def _build(table: Table, urdf: Urdf, digest: str) -> RobotModel:
    root, tip = table.text("base_link"), table.text("tool_link")
    names = tuple(table.texts("joints"))
    fixed = table.table("fixed_joints", optional=True).all_numbers()
    gripper = table.table("gripper")
    finger_names = gripper.texts("finger_joints")
    if root != urdf.root:
        raise table.error("base_link", f"{root!r} is not what all links hang on: {urdf.root!r}")
    if tip not in urdf.boxes:
        raise table.error("tool_link", f"the URDF has no link {tip!r}")
    for name in fixed:
        if all(name != joint.name for joint in urdf.joints.values()):
            raise table.error("fixed_joints", f"the URDF has no joint {name!r}")
    chain = urdf.chain(tip)
    moving = [joint for joint in chain if joint.type != "fixed"]
    movable = [joint.name for joint in moving]
    if not movable:
        raise table.error("tool_link", f"no joint moves between {root!r} and {tip!r}")
    if movable != list(names):
        raise table.error("joints", f"the moving joints from {root!r} to {tip!r} are {movable}")
    origins, tool, frames = _fold(urdf, chain, {**fixed, **dict.fromkeys(finger_names, 0.0)})
    boxes = tuple(
        PlacedBox(link, frame, Box(box.name, compose(pose, box.pose), box.half))
        for link, (frame, pose) in frames.items()
        for box in urdf.boxes[link]
    )
    home = np.array(table.numbers("home"))
    if len(home) != len(names):
        raise table.error("home", f"{len(home)} values for {len(names)} joints")
    lower = np.array([joint.lower for joint in moving])
    upper = np.array([joint.upper for joint in moving])
    for joint, value in zip(moving, home, strict=True):
        if not joint.lower <= value <= joint.upper:
            raise table.error(
                "home",
                f"{joint.name} = {value:g} is outside its limits, "
                f"{joint.lower:g} to {joint.upper:g}",
            )
    base, workspace, strip = table.table("base"), table.table("workspace"), table.table("strip")
    centre = workspace.numbers("centre", 2)
    inner, outer = workspace.number("inner"), workspace.positive("outer")
    if not 0 <= inner < outer:
        raise workspace.error("inner", "the annulus needs 0 <= inner < outer")
    return RobotModel(
        name=table.text("name"),
        joints=names,
        lower=lower,
        upper=upper,
        velocity=np.array([joint.velocity for joint in moving]),
        acceleration=np.array(table.positives("acceleration", len(names))),
        chain=Chain(np.array(origins), np.array([j.type == "prismatic" for j in moving])),
        tool=tool,
        boxes=boxes,
        pairs=_pairs(boxes, table),
        gripper=_gripper(gripper, urdf, boxes, tool, finger_names),
        base=MobileBase(
            base.positive("velocity"),
            base.positive("acceleration"),
            base.positive("angular_velocity"),
            base.positive("angular_acceleration"),
        ),
        workspace=ArmWorkspace(
            (centre[0], centre[1]),
            workspace.number("wrist_offset"),
            inner,
            outer,
        ),
        strip=Strip(
            strip.positive("finger_back"),
            strip.positive("finger_tip"),
            strip.positive("finger_width"),
            strip.positive("arm_length"),
            strip.positive("arm_half_width"),
        ),
        home=home,
        ignored=frozenset(frozenset(pair) for pair in table.pairs("ignored_collisions")),
        fixed=fixed,
        urdf=urdf,
        urdf_tool=tip,
        digest=digest,
    )


def _joint_pose(joint: Joint, value: float) -> Pose:
    """Pose of the child link in the parent link for a joint held at a value."""
    motion = identity()
    if joint.type == "prismatic":
        motion[:, 3] = joint.axis * value
    elif joint.type in {"revolute", "continuous"} and value:
        x, y, z = joint.axis
        k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        motion[:, :3] += math.sin(value) * k + (1 - math.cos(value)) * (k @ k)
    return compose(joint.origin, motion)


def _align_z(axis: np.ndarray) -> Pose:
    """A rotation that takes z to the given axis: kernels turn every joint about z."""
    pose = identity()
    z = axis / np.linalg.norm(axis)
    if abs(z[2]) < 1 - 1e-12:
        x = np.cross([0.0, 0.0, 1.0], z)
        x /= np.linalg.norm(x)
        pose[:, :3] = np.column_stack([x, np.cross(z, x), z])
    elif z[2] < 0:
        pose[:, :3] = np.diag([1.0, -1.0, -1.0])
    return pose


def _fold(
    urdf: Urdf, chain: Sequence[Joint], fixed: dict[str, float]
) -> tuple[list[Pose], Pose, dict[str, tuple[int, Pose]]]:
    """Fold fixed joints away: origins of the moving joints, tool pose in the last frame,
    and for every link the frame it moves with and its pose there."""
    origins: list[Pose] = []
    in_chain = {joint.child for joint in chain}
    frames: dict[str, tuple[int, Pose]] = {urdf.root: (0, identity())}
    for joint in chain:
        index, pose = frames[joint.parent]
        if joint.type == "fixed":
            frames[joint.child] = (index, compose(pose, joint.origin))
        else:
            align = _align_z(joint.axis)
            origins.append(compose(compose(pose, joint.origin), align))
            frames[joint.child] = (len(origins), invert(align))
    tool = frames[chain[-1].child][1]
    pending = [joint for joint in urdf.joints.values() if joint.child not in in_chain]
    while pending:
        ready = [joint for joint in pending if joint.parent in frames]
        for joint in ready:
            index, pose = frames[joint.parent]
            value = fixed.get(joint.name, 0.0)
            frames[joint.child] = (index, compose(pose, _joint_pose(joint, value)))
        pending = [joint for joint in pending if joint not in ready]
    return origins, tool, frames


def _pairs(boxes: Sequence[PlacedBox], table: Table) -> tuple[tuple[int, int], ...]:
    """Pairs of boxes tested for self-collision: on different frames, not listed as ignored."""
    ignored = {frozenset(pair) for pair in table.pairs("ignored_collisions")}
    links = {placed.link for placed in boxes}
    for name in {name for pair in ignored for name in pair}:
        if name not in links:
            raise table.error("ignored_collisions", f"no collision shape on a link {name!r}")
    return tuple(
        (i, j)
        for j, b in enumerate(boxes)
        for i, a in enumerate(boxes[:j])
        if a.frame != b.frame and frozenset((a.link, b.link)) not in ignored
    )


def _gripper(
    table: Table,
    urdf: Urdf,
    boxes: Sequence[PlacedBox],
    tool: Pose,
    finger_names: Iterable[str],
) -> Gripper:
    by_name = {joint.name: joint for joint in urdf.joints.values()}
    fingers: list[tuple[int, float]] = []
    opening = 0.0
    for name in finger_names:
        if name not in by_name:
            raise table.error("finger_joints", f"the URDF has no joint {name!r}")
        joint = by_name[name]
        opening += joint.upper
        for i, placed in enumerate(boxes):
            if placed.link == joint.child:
                side = float((placed.box.pose[:, 3] - tool[:, 3]) @ tool[:, 1])
                fingers.append((i, math.copysign(1.0, side)))
    links = table.texts("links")
    for link in links:
        if link not in urdf.boxes:
            raise table.error("links", f"the URDF has no link {link!r}")
    return Gripper(
        fingers=tuple(fingers),
        max_opening=opening,
        clearance=table.positive("clearance"),
        time=table.positive("time"),
        links=frozenset(links),
        joints=tuple(finger_names),
    )
