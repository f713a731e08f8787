"""What in a robot file contradicts its URDF, before any geometry is looked at."""

from __future__ import annotations

from collections.abc import Iterator

from runtime.robot.controllers import misfits
from runtime.robot.file import RobotFile
from runtime.robot.findings import Finding
from runtime.robot.gripper import Hand
from runtime.robot.urdf import MOVING, Joint


def planning_joints(file: RobotFile) -> list[Joint]:
    """The joints that are planned for, from the base to the tool: all that move there, but
    those that the file holds at a value."""
    return [
        joint
        for joint in file.urdf.chain(file.tool_link)
        if joint.type in MOVING and joint.name not in file.fixed
    ]


def contradictions(file: RobotFile) -> Iterator[Finding]:
    """Everything that keeps a robot from being built, in an order that makes sense to mend."""
    chain = list(_chain(file))
    yield from chain
    if not chain:
        yield from _joints(file)
    yield from _names(file)
    if file.base is None:
        yield Finding(
            "base-missing",
            "base: how the robot gets about is not said",
            file.place,
            'add [base] with type = "fixed", "holonomic" or "differential"',
        )
    yield from _gripper(file, not chain)
    known = [joint.name for joint in file.urdf.joints.values() if joint.type in MOVING]
    for name, message, hint in misfits(file.controllers or (), known):
        yield Finding("controller-joints", message, f"{file.place}: [controllers.{name}]", hint)


def _chain(file: RobotFile) -> Iterator[Finding]:
    urdf, base, tool = file.urdf, file.base_link, file.tool_link
    code = "chain-does-not-reach-tool"
    if tool not in urdf.shapes:
        yield Finding(
            code,
            f"tool_link: there is no link {tool!r} on {base!r}",
            file.place,
            "the links of the URDF: " + ", ".join(list(urdf.shapes)[:40]),
        )
        return
    moving = planning_joints(file)
    if not moving:
        yield Finding(code, f"tool_link: no joint moves between {base!r} and {tool!r}", file.place)
    names = [joint.name for joint in moving]
    if moving and file.joints is not None and names != list(file.joints):
        yield Finding(
            code,
            f"joints: the moving joints from {base!r} to {tool!r} are {names}",
            file.place,
            "list just these, in this order; others are held by [fixed_joints]",
        )


def _joints(file: RobotFile) -> Iterator[Finding]:
    joints = planning_joints(file)
    for joint in joints:
        if joint.mimic is not None:
            yield Finding(
                "joint-mimics",
                f"joints: {joint.name!r} mimics {joint.mimic.joint!r} and cannot be planned for",
                file.place,
                "hold it by [fixed_joints]",
            )
        if joint.absent:
            what = " and ".join(joint.absent)
            yield Finding(
                "limits-absent",
                f"joint {joint.name!r}: the URDF gives no {what} in its <limit>",
                file.place,
                f"state them in [limits.{joint.name}]: lower, upper, velocity",
            )
        elif joint.lower == joint.upper:
            yield Finding(
                "limits-absent",
                f"joint {joint.name!r}: its limits leave it no way to move",
                file.place,
                f"state them in [limits.{joint.name}]: lower, upper, velocity",
            )
    rows = {"acceleration": file.acceleration, "jerk": file.jerk, "home": file.home}
    if len(file.jerk) == len(file.acceleration):  # the same is wrong with both
        del rows["jerk"]
    for key, values in rows.items():
        if len(values) != len(joints):
            yield Finding(
                f"{key}-missing",
                f"{key}: {len(values)} values for {len(joints)} joints",
                file.place,
            )
            continue
        for joint, value in zip(joints, values, strict=True):
            if key == "acceleration" and value <= 0:
                yield Finding(
                    "acceleration-missing",
                    f"acceleration: that of {joint.name} must be positive, found {value:g}",
                    file.place,
                )
            if key == "home" and not joint.lower <= value <= joint.upper:
                yield Finding(
                    "home-outside-limits",
                    f"home: {joint.name} = {value:g} is outside its limits, "
                    f"{joint.lower:g} to {joint.upper:g}",
                    file.place,
                )


def _names(file: RobotFile) -> Iterator[Finding]:
    for name in file.fixed:
        if file.urdf.joint(name) is None:
            yield Finding(
                "unknown-name", f"fixed_joints: the URDF has no joint {name!r}", file.place
            )
    for name in dict.fromkeys(name for pair in file.ignored for name in pair):
        if not file.urdf.shapes.get(name):
            yield Finding(
                "unknown-name",
                f"ignored_collisions: no collision shape on a link {name!r}",
                file.place,
            )


def _gripper(file: RobotFile, with_tool: bool) -> Iterator[Finding]:
    place = f"{file.place}: [gripper]"
    if file.gripper is None or not file.gripper.fingers:
        yield Finding(
            "gripper-missing",
            "gripper: the robot has none",
            file.place,
            "name its finger_joints in [gripper]; `robot import --gripper two_finger` fits one",
        )
        return
    unknown = still = False
    for name in file.gripper.fingers:
        joint = file.urdf.joint(name)
        if joint is None:
            yield Finding("unknown-name", f"finger_joints: the URDF has no joint {name!r}", place)
        elif joint.type not in MOVING:
            yield Finding("fingers-do-not-close", f"finger_joints: {name!r} does not move", place)
        elif joint.mimic is None and joint.lower == joint.upper:
            still = True
            yield Finding(
                "limits-absent",
                f"finger_joints: {name!r} has no range: {joint.lower:g} is its only value",
                place,
                f"state lower and upper under [limits.{name}], as they are on the robot",
            )
        unknown |= joint is None or joint.type not in MOVING
    for name in file.gripper.links:
        if name not in file.urdf.shapes:
            yield Finding("unknown-name", f"links: the URDF has no link {name!r}", place)
            unknown = True
    if unknown or still or not with_tool:
        return
    try:
        Hand(file.urdf, file.tool_link, file.gripper.fingers).table()
    except ValueError as error:
        yield Finding(
            "fingers-do-not-close",
            f"finger_joints: {error}",
            place,
            "y of the tool frame is the direction in which the fingers close",
        )
