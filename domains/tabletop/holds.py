"""How objects are taken: the grasps that fit, for each heading of the hand."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from domains.tabletop.features import swept
from domains.tabletop.features.swept import HEADINGS, STEP
from domains.tabletop.items import Item
from domains.tabletop.state import UNIT, Grasp, quantise_angle
from runtime.world.poses import Floats

if TYPE_CHECKING:
    from domains.tabletop.world import TabletopWorld

MIDDLES: Floats = np.arange(HEADINGS, dtype=np.float64) * STEP
"""The K headings, radians."""

SAME_HEADING = 4
"""Decimals, in radians, to which headings are told apart when it comes to how a thing is held."""


@dataclass(frozen=True, eq=False)
class SiteHold:
    """How objects of one kind are taken at a site, for the K headings: rows (K, 3) of half the
    width and the centre of the grasp, its height, and bits of the headings that fit. `angles`
    (K,) are the exact headings, within half a step of the K."""

    rows: Floats
    height: float
    fits: int
    angles: Floats = field(default_factory=lambda: MIDDLES)

    @cached_property
    def reach(self) -> float:
        """Metres in the plane that the grip and its centre are from the site, at most."""
        return float(np.abs(self.rows).sum(axis=1).max())

    @cached_property
    def key(self) -> Hashable:
        """Equal for holds that come to the same."""
        return self.rows.tobytes(), self.height, self.fits


def hold(world: TabletopWorld, index: int, family: int, yaw: float, face: int = 0) -> SiteHold:
    """How an object that stands with a heading on a face is taken along each heading of the
    hand."""
    kind = world.kinds[index]
    return world.memory.answer(
        "holds",
        (kind, family, yaw, face),
        lambda: _turned_hold(world, kind, face, family, yaw),
    )


def _turned_hold(world: TabletopWorld, kind: int, face: int, family: int, yaw: float) -> SiteHold:
    """A hold for an object that is turned by whole steps from another heading is that one
    with its headings moved on."""
    steps, rest = divmod(yaw, STEP)
    rest = round(rest, SAME_HEADING)
    hold = world.memory.answer(
        "holds within a step",
        (kind, face, family, rest),
        lambda: _holds(world, world.faces[kind][face], family, [rest])[0],
    )
    by = int(steps) % HEADINGS
    return SiteHold(
        np.roll(hold.rows, by, axis=0),
        hold.height,
        ((hold.fits << by) | (hold.fits >> (HEADINGS - by))) & swept.ALL,
        np.roll(hold.angles, by) + by * STEP,
    )


def learn_holds(
    world: TabletopWorld, family: int, standing: Iterable[tuple[int, int, float]]
) -> None:
    """Look at once at how objects, by index, face and heading, are taken, where that is not
    known yet."""
    table = world.memory.table("holds within a step")
    unknown: dict[tuple[int, int], set[float]] = {}
    for index, face, yaw in standing:
        kind, rest = world.kinds[index], round(yaw % STEP, SAME_HEADING)
        if (kind, face, family, rest) not in table:
            unknown.setdefault((kind, face), set()).add(rest)
    for (kind, face), found in unknown.items():
        rests = sorted(found)
        holds = _holds(world, world.faces[kind][face], family, rests)
        for rest, hold in zip(rests, holds, strict=True):
            world.memory.keep("holds within a step", (kind, face, family, rest), hold)


def _holds(world: TabletopWorld, item: Item, family: int, yaws: Sequence[float]) -> list[SiteHold]:
    """How an object that stands with some headings is taken along each heading of the hand."""
    # Squarely on a side where there is one within the step, else as it comes.
    tried: list[tuple[list[float], list[int]]] = []
    for yaw in yaws:
        angles: list[float] = []
        owner: list[int] = []
        for k, middle in enumerate(MIDDLES.tolist()):
            near = [middle + t for t in _turns(item.sides + yaw - middle) if abs(t) <= STEP / 2]
            angles += [*near, middle]
            owner += [k] * (len(near) + 1)
        tried.append((angles, owner))
    seen = [np.array(angles) - yaw for (angles, _), yaw in zip(tried, yaws, strict=True)]
    found = item.holds(world.hand, family, np.concatenate(seen))
    if found is None:
        return [SiteHold(np.zeros((HEADINGS, 3)), 0.0, 0, MIDDLES.copy()) for _ in yaws]
    holds, first = [], 0
    for angles, owner in tried:
        rows, chosen, fits = np.zeros((HEADINGS, 3)), MIDDLES.copy(), 0
        for i in range(len(angles) - 1, -1, -1):
            k, at = owner[i], first + i
            if found.fits[at] or not (fits >> k) & 1:
                rows[k] = found.width[at] / 2, found.along[at], found.aside[at]
                chosen[k] = angles[i]
                fits |= int(found.fits[at]) << k
        holds.append(SiteHold(rows, found.height, fits, chosen))
        first += len(angles)
    return holds


def grasp(world: TabletopWorld, index: int, face: int, family: int, angle: float) -> Grasp | None:
    """The grasp of an object by a family at a heading in the standing frame of a face; None
    where no hand takes it so."""
    kind, steps = world.kinds[index], quantise_angle(angle)

    def compute() -> Grasp | None:
        item, at = world.faces[kind][face], steps * UNIT
        found = item.holds(world.hand, family, np.array([at]))
        return item.grasp(found, 0, at) if found is not None and found.fits[0] else None

    return world.memory.answer("grasps", (kind, face, family, steps), compute)


def place_hold(
    world: TabletopWorld, index: int, family: int, yaw: float | None, grasp: Grasp | None
) -> SiteHold:
    """How an object is held while it is put down, for each heading of the hand there: given
    by its heading there where that is prescribed, else by the grasp that holds it, else
    that of its narrowest grasp."""
    if yaw is not None:
        return world.hold(index, family, yaw)
    key = (world.kinds[index], family, grasp)
    return world.memory.answer("place holds", key, lambda: _place_hold(world, index, family, grasp))


def _place_hold(world: TabletopWorld, index: int, family: int, grasp: Grasp | None) -> SiteHold:
    if grasp is not None:
        width = round(world.item(index, grasp.face).width(world.hand, grasp) / 2, 4)
        row = [width, grasp.along * UNIT, grasp.aside * UNIT]
        height = grasp.height * UNIT
        fits = swept.ALL if grasp.family == family else 0
        return SiteHold(np.tile(row, (HEADINGS, 1)), height, fits)
    hold = world.hold(index, family, 0.0)
    if not hold.fits:
        return hold
    fitting = [k for k in range(HEADINGS) if (hold.fits >> k) & 1]
    best = min(fitting, key=lambda k: (hold.rows[k, 0], k))
    return SiteHold(np.tile(hold.rows[best], (HEADINGS, 1)), hold.height, swept.ALL)


def _turns(angles: Floats) -> list[float]:
    """Angles in (-pi, pi], the smallest turns first."""
    wrapped = (angles + math.pi) % (2 * math.pi) - math.pi
    return sorted(wrapped.tolist(), key=abs)
