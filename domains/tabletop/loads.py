"""Loads: what stands on a tray, a board or the like, and is carried along with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from domains.tabletop.faces import is_turned

if TYPE_CHECKING:
    from domains.tabletop.world import Placements, TabletopWorld

FLAT = 2.0
"""Something is a tray, and carried with what stands on it, where the place for that is so many
times as wide as it is high."""

STEADY = 0.4
"""What stands on a tray may stay there where its foot is that part of its height wide, at least."""

GRAVITY = 9.81


def load_of(world: TabletopWorld, placements: Placements, index: int) -> tuple[int, ...]:
    """The objects that are carried along with one: all that rest on it, where it is flat and
    they stand steadily; none where they have to be taken off first."""
    riders = world.riders(placements, index)
    if not riders or not _is_flat(world, index) or is_turned(world, index):
        return ()
    weight = GRAVITY * world.items[index].body.mass
    for rider in riders:
        placement = placements[rider]
        assert placement is not None
        if world.grounds[placement.support].owner != index:
            return ()  # it stands on what stands there
        item = world.item(rider, placement.face)
        weight += GRAVITY * item.body.mass
        if min(item.size[:2]) < STEADY * item.size[2]:
            return ()
    return riders if weight <= world.hand.max_weight else ()


def _is_flat(world: TabletopWorld, index: int) -> bool:
    # What stands around a knob or a hole is not on a tray: it is taken off first.
    tops = [world.grounds[support] for support in world.owned[index]]
    widths = [2 * min(ground.half) for ground in tops if ground.peg is None]
    return max(widths, default=0.0) >= FLAT * world.items[index].size[2]


def tall(world: TabletopWorld, placements: Placements, index: int, face: int = 0) -> float:
    """The height of an object on a face, with what rests on it, metres."""
    found = world.item(index, face).size[2]
    for rider in world.riders(placements, index):
        placement = placements[rider]
        assert placement is not None
        low = float(world.rests_on(placements, rider, index)[2, 3])
        found = max(found, low + world.item(rider, placement.face).size[2])
    return found
