"""Things that nearly touch, told a little smaller.

KinDER asks for a gap of a thousandth of a millimetre, our planner keeps 2 mm between what stands
side by side. What starts nearer than that is described so much smaller that the gap is kept, and
as it is lifted, it is first taken aside.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from domains.tabletop.kinder.observed import Thing

NEAR = 0.0025
"""Metres between things that are told as they are."""

WITHIN = 0.001
"""Metres by which things may start in one another: KinDER's own test lets a little pass."""

SQUARE = 1e-3
"""Part of a quaternion, at most, of what stands along the axes."""

SIDES = "half_extent_x", "half_extent_y"


def slimmed(things: Sequence[Thing], fixed: Sequence[Thing] = ()) -> list[Thing]:
    """Upright cuboids, those that nearly touch another one or something fixed made thinner."""
    found = []
    for thing in things:
        cut = 0.0
        for other in [*things, *fixed]:
            gap = gap_between(thing, other)
            if other is thing or gap is None or gap >= NEAR:
                continue
            lack = NEAR - gap
            cut = max(cut, lack if other in fixed else lack / 2)
        sides = {side: max(thing[side] - cut, thing[side] / 2) for side in SIDES}
        found.append(replace(thing, features={**thing.features, **sides}) if cut else thing)
    return found


def away_from(thing: Thing, others: Iterable[Thing]) -> tuple[float, float]:
    """How far to go aside (x, y) so that an upright cuboid keeps its distance from others that
    nearly touch it; those on both sides of it leave it where it is. Things that are turned are
    not looked at."""
    aside = [0.0, 0.0]
    for other in others:
        if other is thing or not (_is_square(thing) and _is_square(other)):
            continue
        gap = gap_between(thing, other)
        if gap is None or gap >= NEAR:
            continue
        axis = int(np.argmax(_apart(thing, other)[:2]))
        way = math.copysign(NEAR - gap, thing.position[axis] - other.position[axis])
        aside[axis] = 0.0 if aside[axis] * way < 0 else max(aside[axis], way, key=abs)
    return aside[0], aside[1]


def gap_between(a: Thing, b: Thing) -> float | None:
    """Metres between two upright cuboids along an axis of the world that parts them, or nearly
    so; None where one of them is above the other, or where no such axis does."""
    gaps = _apart(a, b)
    beside = max(gaps[:2])
    return beside if beside >= -WITHIN and gaps[2] < -1e-4 else None


def _apart(a: Thing, b: Thing) -> list[float]:
    """Metres between two upright cuboids along x, y and z; below 0 where they overlap."""
    return [
        abs(p - q) - h - k
        for p, q, h, k in zip(a.position, b.position, a.half, b.half, strict=True)
    ]


def _is_square(thing: Thing) -> bool:
    """Whether a thing is a cuboid, upright and along the axes of the world."""
    turned = (thing[f"pose_q{axis}"] for axis in "xyz")
    return "half_extent_z" in thing.features and all(abs(part) < SQUARE for part in turned)
