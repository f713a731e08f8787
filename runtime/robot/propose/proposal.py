"""A robot file proposed for a URDF and a tool link."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from runtime.robot.controllers import proposed_controllers
from runtime.robot.file import FLOOR_LINK, TOOL_LINK, GripperFile, RobotFile
from runtime.robot.load import build_robot
from runtime.robot.model import JERK, MobileBase, RobotModel
from runtime.robot.propose.base import propose_base
from runtime.robot.propose.fitted import Mount, fitted
from runtime.robot.propose.hand import ProposedHand, propose_hand
from runtime.robot.propose.held import MOST, held, other_arms, planned
from runtime.robot.propose.home import propose_home
from runtime.robot.propose.pairs import always_touching, neighbours, within
from runtime.robot.propose.srdf import Srdf
from runtime.robot.structure import contradictions
from runtime.robot.urdf import MOVING, Joint, Urdf, read_urdf
from runtime.world.poses import Pose
from sketchlang.errors import InputError
from sketchlang.suggest import did_you_mean

FULL_SPEED = 0.5
"""Seconds from rest to full speed."""

FASTEST = {"prismatic": 0.5, "revolute": 3.2, "continuous": 3.2}
"""m/s, rad/s: limits beyond are placeholders in many URDFs, and no arm's."""

HARDEST = 8.0
"""rad/s^2, at most."""

DRIVING = MobileBase(0.5, 0.5, 1.0, 1.5, jerk=JERK * 0.5, angular_jerk=JERK * 1.5)
"""Speeds of a base of which nothing is known."""


@dataclass(frozen=True, eq=False)
class Proposal:
    """What is proposed: `urdf` as it is to be written (without a fitted gripper), and the file.
    `limits` are what the file states of joints; `notes` what a reader should know."""

    urdf: Urdf
    file: RobotFile
    tool_link: str
    tool: Pose | None
    base_link: str
    height: float
    mount: Mount | None
    limits: Mapping[str, Mapping[str, float]]
    notes: tuple[str, ...] = field(default=())


def propose(
    path: Path,
    tool_link: str,
    *,
    name: str | None = None,
    srdf: Srdf | None = None,
    base: str | None = None,
    height: float = 0.0,
    gripper: str | None = None,
    seed: int = 0,
) -> Proposal:
    """A robot file for a URDF.

    `base` overrides the kind of base that is found, `height` lifts a base above the floor
    (metres), `gripper` names or gives a URDF of a gripper to fit to the tool link.

    Raises:
        InputError: the URDF cannot be read, or has no such link.
    """
    urdf = read_urdf(path)
    _known_link(urdf, tool_link, path)
    found = propose_base(urdf, tool_link)
    notes = [f"base: {base or found.type} ({'as asked for' if base else found.reason})"]
    kind = base or found.type
    whole, mount = urdf, None
    if gripper is not None:
        mount, whole = fitted(urdf, tool_link, gripper)
        tool_link = mount.root
    whole = whole.part(found.link)
    limits = _limits(whole, tool_link, notes)
    limited = _with_limits(whole, limits)
    hand = propose_hand(limited, tool_link)
    file = _first_file(name or urdf.name, limited, tool_link, hand, kind, height)
    if any(contradictions(file)):
        notes.append("no home posture and no pairs were looked for: mend the findings first")
    else:
        rng = np.random.default_rng(seed)
        way = {joint.name for joint in limited.chain(tool_link)}
        if way & file.fixed.keys():
            names = ", ".join(sorted(way & file.fixed.keys()))
            notes.append(f"held, as {MOST} joints at most are planned for: {names}")
        for link in other_arms(limited, tool_link):
            parked = _parked(limited, link, kind, height, srdf, rng)
            if parked is not None:
                notes.append(f"the arm to {link!r} is held out of the way: see [fixed_joints]")
                beside = {name: q for name, q in parked.items() if name not in way}
                file = replace(file, fixed={**file.fixed, **beside})
        file = _probed(file, srdf, notes, rng)
    return Proposal(
        urdf=urdf,
        file=file,
        tool_link=tool_link,
        tool=None if hand is None else hand.tool,
        base_link=found.link,
        height=height,
        mount=mount,
        limits=limits,
        notes=tuple(notes),
    )


def _known_link(urdf: Urdf, link: str, path: Path) -> None:
    if link not in urdf.shapes:
        hint = did_you_mean(link, urdf.shapes) or "its links: " + ", ".join(list(urdf.shapes)[:40])
        raise InputError(f"there is no link {link!r}", place=str(path), hint=hint)


def _limits(urdf: Urdf, tool_link: str, notes: list[str]) -> dict[str, dict[str, float]]:
    """What the robot file has to say about joints: what the URDF leaves out, and speeds that
    no arm has."""
    found: dict[str, dict[str, float]] = {}
    for joint in urdf.chain(tool_link):
        if joint.type not in MOVING:
            continue
        entry: dict[str, float] = {}
        if "limits" in joint.absent or joint.lower == joint.upper:
            if joint.type == "prismatic":
                notes.append(f"joint {joint.name!r}: the URDF gives no limits; state them")
                continue
            entry |= {"lower": -3.1416, "upper": 3.1416}
            notes.append(f"joint {joint.name!r}: no limits in the URDF, half a turn is assumed")
        if "velocity" in joint.absent:
            entry["velocity"] = joint.velocity
            notes.append(f"joint {joint.name!r}: no velocity, {joint.velocity:g} is assumed")
        elif joint.velocity > FASTEST[joint.type]:
            entry["velocity"] = FASTEST[joint.type]
            notes.append(
                f"joint {joint.name!r}: {joint.velocity:g} "
                f"{'m/s' if joint.type == 'prismatic' else 'rad/s'} is more than most arms can; "
                f"{FASTEST[joint.type]:g} is written, for you to raise"
            )
        if entry:
            found[joint.name] = entry
    return found


def _with_limits(urdf: Urdf, limits: Mapping[str, Mapping[str, float]]) -> Urdf:
    joints = dict(urdf.joints)
    for joint in urdf.joints.values():
        entry = limits.get(joint.name)
        if entry:
            joints[joint.child] = replace(
                joint,
                lower=entry.get("lower", joint.lower),
                upper=entry.get("upper", joint.upper),
                velocity=entry.get("velocity", joint.velocity),
                absent=(),
            )
    return replace(urdf, joints=joints)


def _first_file(
    name: str, urdf: Urdf, tool_link: str, hand: ProposedHand | None, kind: str, height: float
) -> RobotFile:
    """A file with what needs no probing: joints at the middle of their range, neighbours may
    touch."""
    ignored = neighbours(urdf)
    gripper = None
    tool = tool_link
    moving = planned(urdf.chain(tool_link))
    fingers = () if hand is None else hand.fingers
    fixed = held(urdf, {joint.name for joint in moving} | set(fingers))
    if hand is not None:
        ignored |= within(hand.links, urdf)
        gripper = GripperFile(hand.fingers, hand.links, 0.004, 0.5, None, None, None)
        if hand.tool is not None:
            tool = urdf.free_name(TOOL_LINK)
            urdf = urdf.with_frame(tool, tool_link, hand.tool)
    base = MobileBase(0.0, 0.0, 0.0, 0.0, "fixed")
    if kind != "fixed":
        base = replace(DRIVING, type=kind)
    if height:
        urdf = urdf.raised(urdf.free_name(FLOOR_LINK), height)
    middle = [_middle(joint) for joint in moving]
    return RobotFile(
        place=name,
        name=name,
        urdf=urdf,
        base_link=urdf.root,
        tool_link=tool,
        joints=tuple(joint.name for joint in moving),
        acceleration=tuple(_acceleration(joint) for joint in moving),
        jerk=tuple(JERK * _acceleration(joint) for joint in moving),
        home=tuple(middle),
        ignored=_sorted(ignored),
        fixed=fixed,
        limited=(),
        gripper=gripper,
        base=base,
        digest="",
        controllers=proposed_controllers(moving, fingers, kind != "fixed"),
    )


def _middle(joint: Joint) -> float:
    return round(min(joint.upper, max(joint.lower, (joint.lower + joint.upper) / 2)), 4)


def _acceleration(joint: Joint) -> float:
    value = joint.velocity / FULL_SPEED
    return round(value if joint.type == "prismatic" else min(value, HARDEST), 3)


def _parked(
    urdf: Urdf,
    link: str,
    kind: str,
    height: float,
    srdf: Srdf | None,
    rng: np.random.Generator,
) -> dict[str, float] | None:
    """Where the joints of an arm that is not used are out of the way; None if that is unknown."""
    urdf = _with_limits(urdf, _limits(urdf, link, []))
    file = _first_file(urdf.name, urdf, link, propose_hand(urdf, link), kind, height)
    if any(contradictions(file)):
        return None
    notes: list[str] = []
    file = _probed(file, srdf, notes, rng, parked=True)
    return None if notes or file.joints is None else dict(zip(file.joints, file.home, strict=True))


def _sorted(pairs: set[frozenset[str]]) -> tuple[tuple[str, str], ...]:
    found = sorted(tuple(sorted(pair)) for pair in pairs)
    return tuple((a, b) for a, b in found)


def _probed(
    file: RobotFile,
    srdf: Srdf | None,
    notes: list[str],
    rng: np.random.Generator,
    parked: bool = False,
) -> RobotFile:
    """The file with pairs that always touch and a home posture."""
    ignored = {frozenset(pair) for pair in file.ignored}
    if srdf is not None:
        known = {link for link, shapes in file.urdf.shapes.items() if shapes}
        ignored |= {pair for pair in srdf.pairs if pair <= known}
    file = replace(file, ignored=_sorted(ignored))
    ignored |= always_touching(build_robot(file), rng)
    file = replace(file, ignored=_sorted(ignored))
    robot = build_robot(file)
    wanted = [] if srdf is None else list(filter(None, (_full(robot, s) for s in srdf.homes())))
    home = propose_home(robot, rng, [np.array(q) for q in wanted], parked)
    if home is None:
        notes.append("no posture was found that is free of collision: look at the shapes")
        return file
    return replace(file, home=tuple(home.tolist()))


def _full(robot: RobotModel, state: Mapping[str, float]) -> list[float] | None:
    """A posture of an SRDF for all joints and within their limits, or None."""
    if not set(robot.joints) <= state.keys():
        return None
    q = np.array([state[name] for name in robot.joints])
    inside = (q >= robot.lower).all() and (q <= robot.upper).all()
    return q.tolist() if inside else None
