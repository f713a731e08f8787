"""Motions: what the robot does between two states, as pieces that are executed in turn."""

from __future__ import annotations

from dataclasses import dataclass

from runtime.robot.model import Floats


@dataclass(frozen=True, eq=False)
class BaseMove:
    """Base poses (k, 3): x, y in metres, heading in radians; turns on the spot and lines."""

    poses: Floats


@dataclass(frozen=True, eq=False)
class ArmMove:
    """Configurations (p, n) of the planning joints, straight lines in between.

    `kind` is free, approach, lift, lower or retreat.
    """

    path: Floats
    kind: str


@dataclass(frozen=True)
class GripperMove:
    """Fingers go to `opening` metres apart; `attach` or `release` names the object that
    becomes part of the robot or stops being one."""

    opening: float
    attach: int | None = None
    release: int | None = None


Piece = BaseMove | ArmMove | GripperMove
Motion = tuple[Piece, ...]
