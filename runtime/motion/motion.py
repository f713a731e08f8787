"""Motions: what the robot does between two states, as pieces that are executed in turn.

A piece says by itself what it does to bodies of the world, by their names, so that whoever
judges, records or executes it needs not know the action that it is of.
"""

from __future__ import annotations

from dataclasses import dataclass

from runtime.robot.model import Floats


@dataclass(frozen=True)
class Attach:
    """From the end of the piece on, a body is fixed to a link, and what stands on it goes with
    it. `to` is None for the tool link (files of version 1 do not name it)."""

    body: str
    to: str | None


@dataclass(frozen=True, eq=False)
class Release:
    """A held body is let go: `pose` (7,) is that of its frame in the world then (x, y, z,
    quaternion x, y, z, w), `on` the support that it rests on (None: not said)."""

    body: str
    on: str | None
    pose: Floats


@dataclass(frozen=True, eq=False)
class Carried:
    """A body that a constraint of its own moves along with the tool (a door, a drawer, a thing
    that is pushed): world poses (k, 7), one for each way point of the piece."""

    body: str
    poses: Floats


@dataclass(frozen=True, eq=False)
class BaseMove:
    """Base poses (k, 3): x, y in metres, heading in radians, straight lines in between."""

    poses: Floats
    along: tuple[Carried, ...] = ()


@dataclass(frozen=True, eq=False)
class ArmMove:
    """Configurations (p, n) of the planning joints, straight lines in between.

    `kind` is free, approach, lift, lower or retreat, or a domain's own word. `pace` is the share
    of the joints' speed limits that is used, and its square that of their accelerations: less
    than 1 where something could slide.
    """

    path: Floats
    kind: str
    along: tuple[Carried, ...] = ()
    pace: float = 1.0


@dataclass(frozen=True, eq=False)
class GripperMove:
    """Fingers go to `opening` metres apart; a body may be fixed to a link or let go then."""

    opening: float
    attach: Attach | None = None
    release: Release | None = None


@dataclass(frozen=True, eq=False)
class Together:
    """Base, arm and fingers at once: base poses (k, 3), configurations (k, n) and openings (k,)
    of the gripper, way points close in time with straight lines in between. The robot need not
    rest where one of these ends and the next begins."""

    poses: Floats
    path: Floats
    openings: Floats


Piece = BaseMove | ArmMove | GripperMove
Motion = tuple[Piece, ...]
