"""How much room a support leaves for an object."""

from __future__ import annotations

import math

from domains.tabletop.ground import Ground
from domains.tabletop.items import Item
from runtime.world.pegs import hollow_of
from runtime.world.world import Peg

INSET = 0.005
"""Metres between the edge of a support and the outline of an object placed on it."""


def has_room(ground: Ground, item: Item) -> bool:
    """Whether an object fits on a support at all, and below what is above that."""
    spans, _ = room_on(ground, item)
    return spans is not None and item.size[2] <= ground.clearance - INSET


def goes_over(item: Item, peg: Peg) -> bool:
    """Whether an object can stand where a peg rises into its hollow, if it does rise."""
    hollow = hollow_of(item.parts) if peg.height else None
    return not peg.height or (hollow is not None and hollow.goes_over(peg))


def room_on(ground: Ground, item: Item) -> tuple[list[float] | None, list[float] | None]:
    """Half the room for the middle of an object on a support, along its x and y; and the
    headings that fit, where not all do: a long thing lies along the sides. Around a peg or a hole
    there is one place; over a peg, for what is hollow."""
    if ground.peg is not None:
        return ([0.0, 0.0] if goes_over(item, ground.peg) else None), None
    inset = item.outer_radius + INSET
    spans = [half - inset for half in ground.half]
    slim = max(item.size[:2]) > 2.5 * min(item.size[:2])
    if min(spans) > 0 and not slim:
        return spans, None
    yaw = ground.yaw
    for turn in (0, 1):
        half = [item.size[turn] / 2, item.size[1 - turn] / 2]
        tight = [h - e - INSET / 2 for h, e in zip(ground.half, half, strict=True)]
        if min(tight) >= 0:
            along = yaw + turn * math.pi / 2
            return tight, [along, along + math.pi]
    on_top = [min(item.size[k], item.size[1 - k]) / 2 for k in (0, 1)]
    if ground.owner is not None and max(on_top) <= 2 * max(ground.half):
        return [0.0, 0.0], None  # on something smaller only the middle is safe
    return None, None
