"""What moves on a robot besides the arm that is planned for, and is held: heads, other arms, joints
of the torso that are too many."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from runtime.robot.urdf import MOVING, Joint, Urdf

MOST = 8
"""Joints of an arm that can be planned for."""

OF_AN_ARM = 7
"""Of a chain with more joints than that, the last ones are the arm and the others a torso's."""

LEAST = 5
"""Joints of an arm, at least: necks and tails have fewer."""


def planned(chain: Sequence[Joint]) -> list[Joint]:
    """The joints of a chain that are planned for: all that move, or of too many the arm's own and
    a lift."""
    moving = [joint for joint in chain if joint.type in MOVING]
    if len(moving) <= MOST:
        return moving
    torso, arm = moving[:-OF_AN_ARM], moving[-OF_AN_ARM:]
    lift = [joint for joint in torso if joint.type == "prismatic"]
    return [*lift[: MOST - OF_AN_ARM], *arm]


def held(urdf: Urdf, moved: Collection[str]) -> dict[str, float]:
    """Values for the joints that are not moved: 0, or as near as they get."""
    return {
        joint.name: round(min(joint.upper, max(joint.lower, 0.0)), 4)
        for joint in urdf.joints.values()
        if joint.type in MOVING
        and joint.mimic is None
        and joint.name not in moved
        and joint.type != "continuous"
    }


def other_arms(urdf: Urdf, tool_link: str) -> list[str]:
    """The links that the hands of other arms hang on: from each joint that leaves the way to the
    tool, as long as one joint follows another, to where fingers part."""
    way = [joint for joint in urdf.chain(tool_link) if joint.type in MOVING]
    names = {joint.name for joint in way}
    leaving = [j for before in (None, *way[:-1]) for j in _following(urdf, before)]
    arms = (_arm_from(urdf, joint) for joint in leaving if joint.name not in names)
    return [link for link in arms if link is not None]


def _arm_from(urdf: Urdf, joint: Joint) -> str | None:
    """The link of the hand at the end of a chain of single joints, if that is an arm's."""
    count = 1
    while len(following := _following(urdf, joint)) == 1:
        joint, count = following[0], count + 1
    return joint.child if len(following) > 1 and count >= LEAST else None


def _following(urdf: Urdf, before: Joint | None) -> list[Joint]:
    """The moving joints next after one, with only fixed ones between; the first ones of all."""
    links = [urdf.root if before is None else before.child]
    found = []
    for link in links:
        for joint in urdf.joints.values():
            if joint.parent == link:
                if joint.type in MOVING:
                    found.append(joint)
                else:
                    links.append(joint.child)
    return found
