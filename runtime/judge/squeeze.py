"""Whether two fingers that push on a body keep it where it is, by the planes between them.

Where two convex solids touch, a plane can be put between them, and its normal is a direction in
which they push on each other. Friction holds if some such normal is within its cone about the line
along which the fingers close, and about the line from one contact to the other (two contacts with
friction, Nguyen 1988). A finger whose edge lies on a face that leans has that face as its only
plane; one that lies on an edge or on something round has its own face, which does not lean.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runtime.judge.extents import along_y
from runtime.world.poses import Floats
from runtime.world.solids import Solid

FRICTION = 0.7
"""Coefficient of friction between fingers and bodies, the one that is simulated with."""

CONTACT = 0.0003
"""Metres within which what is nearest to a finger touches it: pads give a little."""

LEEWAY = 0.00005
"""Metres by which a plane between two solids may cut deeper if its normal has to be in a cone."""

SIDES = 32
"""Sides of the pyramid that stands for a cone of friction and lies within it."""

Placed = tuple[Solid, Floats]
"""A solid and its pose (4, 4) in the tool frame."""


@dataclass(frozen=True, eq=False)
class Lines:
    """Lines along y through points x, z (k,), `step` metres apart."""

    x: Floats
    z: Floats
    step: float

    def surfaces(self, placed: Placed, side: float) -> tuple[Floats, Floats]:
        """Where the lines enter and leave a solid (k,), seen so that the finger of a side, 1 left
        and -1 right, is above; inf and -inf where they miss it."""
        enter, leave = along_y(*placed, self.x, self.z)
        return (enter, leave) if side > 0 else (-leave, -enter)


@dataclass(frozen=True, eq=False)
class Touch:
    """A finger above a part of a body: where the lines meet the face of one and the other (k,),
    and which of them meet both where they touch."""

    lines: Lines
    finger: Floats
    part: Floats
    touching: NDArray[np.bool_]

    @property
    def points(self) -> Floats:
        """Points (m, 2) where they touch."""
        return np.column_stack([self.lines.x[self.touching], self.lines.z[self.touching]])

    @property
    def reach(self) -> float:
        """How far along y, to its side, the part reaches where they touch."""
        return float(self.part[self.touching].max())

    def holds(self, *ways: Floats) -> bool:
        """Whether a plane fits between the two whose normal is in the cones of friction about
        some directions (3,), the first of which is y."""
        under = np.isfinite(self.part)
        over = np.isfinite(self.finger)
        if len(ways) == 1 and self.part[under].max() <= self.finger[over].min() + LEEWAY:
            return True
        solids = self._rows(under, self.part), self._rows(over, self.finger)
        return _room(*solids, ways) <= _room(*solids, ()) + LEEWAY

    def _rows(self, there: NDArray[np.bool_], y: Floats) -> Floats:
        return np.column_stack([self.lines.x[there], y[there], self.lines.z[there]])


def _room(under: Floats, over: Floats, ways: Sequence[Floats]) -> float:
    """Metres by which points (m, 3) must rise above a plane that points (n, 3) are not below, at
    least, with its normal in the cones about some directions."""
    from scipy.optimize import linprog

    # Unknown: x and z of a normal whose y is 1, how high the plane is, and what rises above it.
    rows = [
        np.column_stack([under[:, [0, 2]], np.full(len(under), -1.0), np.full(len(under), -1.0)]),
        np.column_stack([-over[:, [0, 2]], np.full(len(over), 1.0), np.zeros(len(over))]),
    ]
    bounds = [-under[:, 1], over[:, 1]]
    for way in ways:
        across = _around(way) - FRICTION * math.cos(math.pi / SIDES) * way
        rows.append(np.column_stack([across[:, [0, 2]], np.zeros((SIDES, 2))]))
        bounds.append(-across[:, 1])
    free = (None, None)
    found = linprog(
        [0.0, 0.0, 0.0, 1.0],
        np.vstack(rows),
        np.concatenate(bounds),
        bounds=[*[free] * 3, (0, None)],
    )
    return float(found.fun) if found.success else math.inf


def _around(way: Floats) -> Floats:
    """Directions (SIDES, 3) at right angles to a direction of length 1, all round."""
    first = np.cross(way, [0.0, 0.0, 1.0])
    first /= np.linalg.norm(first)
    angles = 2 * math.pi * np.arange(SIDES) / SIDES
    second = np.cross(way, first)
    found: Floats = np.outer(np.cos(angles), first) + np.outer(np.sin(angles), second)
    return found


def slip_fault(
    lines: Lines,
    left: Sequence[Placed],
    right: Sequence[Placed],
    parts: Sequence[Placed],
    name: str,
) -> str | None:
    """Why a body of some parts slips from between closed fingers, None where it does not. The
    lines go beyond the edges of the fingers."""
    counts = _between(lines, left, right, parts)
    touches = [
        _touches(lines, fingers, parts, counts, side) for fingers, side in ((left, 1), (right, -1))
    ]
    across = np.array([0.0, 1.0, 0.0])
    firm = [[touch for touch in found if touch.holds(across)] for found in touches]
    if not all(firm):
        lean = math.degrees(math.atan(FRICTION))
        return f"{name} slips: where a finger touches it, it leans more than {lean:.0f} degrees"
    beside = _beside(*(np.vstack([touch.points for touch in found]) for found in firm))
    apart = float(np.hypot(*beside))
    if apart <= lines.step:
        return None
    off = beside * (1 - lines.step / apart)
    depth = sum(max(touch.reach for touch in found) for found in firm)
    way = np.array([off[0], depth, off[1]]) / math.hypot(*off, depth)
    ways = (way, way * [-1.0, 1.0, -1.0])  # the second one as the right finger sees it
    borne = [
        [touch.points for touch in found if touch.holds(across, each)]
        for found, each in zip(firm, ways, strict=True)
    ]
    if all(borne) and np.hypot(*_beside(*map(np.vstack, borne))) <= apart + LEEWAY:
        return None
    return f"{name} slips: the fingers touch it {1000 * apart:.0f} mm beside each other"


def _beside(a: Floats, b: Floats) -> Floats:
    """From what is between points (m, 2) to what is between points (n, 2), backwards (2,): each
    finger pushes anywhere between its contacts."""
    ways = _around(np.array([0.0, 1.0, 0.0]))[:, [0, 2]]
    gaps = (a @ ways.T).min(axis=0) - (b @ ways.T).max(axis=0)
    widest = int(gaps.argmax())
    found: Floats = max(0.0, float(gaps[widest])) * ways[widest]
    return found


def _between(
    lines: Lines, left: Sequence[Placed], right: Sequence[Placed], parts: Sequence[Placed]
) -> list[tuple[Floats, Floats, NDArray[np.bool_]]]:
    """Where lines enter and leave each part, and whether it is between the fingers there: the
    other wall of a tray whose rim is held is not."""
    beyond_left = np.max([along_y(*each, lines.x, lines.z)[1] for each in left], axis=0)
    beyond_right = np.min([along_y(*each, lines.x, lines.z)[0] for each in right], axis=0)
    found = []
    for part in parts:
        enter, leave = along_y(*part, lines.x, lines.z)
        counts = (enter <= beyond_left) & (leave >= beyond_right) & np.isfinite(enter)
        found.append((enter, leave, counts))
    return found


def _touches(
    lines: Lines,
    fingers: Sequence[Placed],
    parts: Sequence[Placed],
    counts: Sequence[tuple[Floats, Floats, NDArray[np.bool_]]],
    side: float,
) -> list[Touch]:
    """What touches on one side. Fingers are let in, or out, until the first one touches."""
    above = [lines.surfaces(finger, side)[0] for finger in fingers]
    pairs = []
    for part, (_, _, on) in zip(parts, counts, strict=True):
        below = lines.surfaces(part, side)[1]
        for face in above:
            gap = np.where(on & np.isfinite(face), face - np.where(on, below, 0.0), np.inf)
            pairs.append((face, below, gap))
    least = min((float(gap.min()) for *_, gap in pairs), default=math.inf)
    return [
        Touch(lines, face - least, below, gap <= least + CONTACT)
        for face, below, gap in pairs
        if gap.min() <= least + CONTACT
    ]
