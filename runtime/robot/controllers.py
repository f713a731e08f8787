"""Which controller of the real robot moves which joints: the table `[controllers]`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from runtime.robot.urdf import Joint
from runtime.tables import Table

ACTIONS = {
    "FollowJointTrajectory": "/{name}/follow_joint_trajectory",
    "GripperCommand": "/{name}/gripper_cmd",
    "FollowPath": "/follow_path",
    "NavigateToPose": "/navigate_to_pose",
}
"""What a controller can be asked, and the action under which it listens by default."""

FOR_BASES = ("FollowPath", "NavigateToPose")
"""Those that move the base, and no joints."""


@dataclass(frozen=True)
class Controller:
    """A controller: its name, its type (a key of `ACTIONS`), the joints that it moves, in its
    own order, and the name of its action.

    One of a base (`moves_base`) has no joints, or three that the URDF need not have: x, y, heading.
    """

    name: str
    type: str
    joints: tuple[str, ...]
    action: str
    moves_base: bool = False

    @property
    def keeps_times(self) -> bool:
        """Whether it is where it should be when it should be."""
        return self.type == "FollowJointTrajectory"


def controller(
    name: str, kind: str, joints: Sequence[str] = (), action: str = "", base: bool = False
) -> Controller:
    """A controller that listens where such controllers do unless an action is named."""
    listens = action or ACTIONS[kind].format(name=name)
    return Controller(name, kind, tuple(joints), listens, base or kind in FOR_BASES)


def read_controllers(table: Table) -> tuple[Controller, ...]:
    """The table `[controllers]` of a robot file.

    Raises:
        InputError: a type that is none, or keys or values that do not fit it.
    """
    found = []
    for name in table.keys():  # noqa: SIM118
        entry = table.table(name)
        kind = entry.text("type", "FollowJointTrajectory")
        if kind not in ACTIONS:
            known = ", ".join(ACTIONS)
            raise entry.error("type", f"there is no type {kind!r}", hint=f"known: {known}")
        joints = entry.texts("joints", optional=kind in FOR_BASES)
        base = entry.has("base") and entry.flag("base")
        if kind in FOR_BASES and joints:
            raise entry.error("joints", f"{kind} moves the base and no joints")
        if base and kind == "FollowJointTrajectory" and len(joints) != 3:
            raise entry.error("joints", "a base has three: x, y and heading")
        if base and kind == "GripperCommand":
            raise entry.error("base", "GripperCommand moves no base")
        if kind not in FOR_BASES and not joints:
            raise entry.error("joints", "the controller has to move one joint at least")
        if kind == "GripperCommand" and len(joints) > 1:
            raise entry.error("joints", "GripperCommand moves one joint, others mimic it")
        found.append(controller(name, kind, joints, entry.text("action", ""), base))
    return tuple(found)


def proposed_controllers(
    joints: Sequence[Joint], fingers: Sequence[str], mobile: bool
) -> tuple[Controller, ...]:
    """The usual grouping: what slides below the arm's first turning joint is the torso, the rest
    is the arm; the driven finger joints; and the base, where there is one."""
    turning = [i for i, joint in enumerate(joints) if joint.type != "prismatic"]
    first = turning[0] if turning else 0
    groups = {
        "torso_controller": [joint.name for joint in joints[:first]],
        "arm_controller": [joint.name for joint in joints[first:]],
        "gripper_controller": list(fingers),
    }
    found = [
        controller(name, "FollowJointTrajectory", names) for name, names in groups.items() if names
    ]
    return (*found, *([controller("base", "FollowPath")] if mobile else []))


def misfits(
    controllers: Sequence[Controller], known: Sequence[str]
) -> Iterator[tuple[str, str, str]]:
    """What is wrong with controllers of a robot with some joints: a controller, a message and
    a hint."""
    owners: dict[str, str] = {}
    for each in controllers:
        for name in each.joints:
            if name not in known and not each.moves_base:
                yield each.name, f"joints: the URDF has no joint {name!r}", "see its <joint>s"
            elif name in owners:
                yield (
                    each.name,
                    f"joints: {name!r} belongs to {owners[name]!r} already",
                    "a joint is moved by one controller",
                )
            owners.setdefault(name, each.name)
    bases = [each.name for each in controllers if each.moves_base]
    for name in bases[1:]:
        yield name, f"type: the base is moved by {bases[0]!r} already", "leave one of them out"


def unmoved(
    controllers: Sequence[Controller], joints: Sequence[str], mobile: bool
) -> Iterator[tuple[str, str]]:
    """What plans move and no controller does: a message and a hint each."""
    owned = {name for each in controllers for name in each.joints}
    for name in joints:
        if name not in owned:
            yield f"no controller moves the joint {name!r}", "add it to one in [controllers]"
    if mobile and not any(each.moves_base for each in controllers):
        yield "no controller moves the base", 'add one of type = "FollowPath" to [controllers]'
