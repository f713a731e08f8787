"""The solids of the objects where they rest, as the kernels take them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from runtime.kernels.convex import Obstacles, boxes_only, join
from runtime.world.body import Part
from runtime.world.packed import UPRIGHT, PackedBodies, pack_bodies, upright_row
from runtime.world.poses import Pose, compose, upright
from runtime.world.solids import Box

if TYPE_CHECKING:
    from domains.tabletop.world import Placements, TabletopWorld


def packed(world: TabletopWorld) -> PackedBodies | None:
    """The solids of all objects, as they stand, and of what is fixed, in one table; None
    where all of them are upright boxes."""
    fixed = [thing.body for thing in world.scene.world.fixed]
    parts = [part for item in world.forms for part in item.parts]
    parts += [
        Part(p.solid, compose(f.pose, p.pose))
        for f in world.scene.world.fixed
        for p in f.body.parts
    ]
    if all(_is_upright_box(part) for part in parts):
        return None
    standing = [replace(item.body, parts=item.parts, mesh=None) for item in world.forms]
    return pack_bodies([*standing, *fixed])


def object_at(
    world: TabletopWorld, index: int, at: tuple[float, float, float, float], face: int = 0
) -> Obstacles:
    """The solids of an object that rests at x, y, height and heading on a face."""
    kind = world.kinds[index]
    return world.memory.answer(
        "solids", (kind, at, face), lambda: _object_at(world, kind, at, face)
    )


def _object_at(
    world: TabletopWorld, index: int, at: tuple[float, float, float, float], face: int
) -> Obstacles:
    parts = world.faces[index][face].parts
    if world.packed is None and len(parts) == 1:
        return boxes_only(world.box_row(index, at, face)[None])
    if world.packed is None:
        stands = upright(*at)
        rows = [upright_row(part.solid, compose(stands, part.pose)) for part in parts]
        return boxes_only(np.array(rows))
    return world.packed.at(world.first_form[index] + face, upright(*at))


def obstacles(world: TabletopWorld, placements: Placements, without: Collection[int]) -> Obstacles:
    """What is fixed and all objects that rest, but for some."""
    standing = _standing(world, placements)
    return join(
        world.fixed,
        *(g for i, g in enumerate(standing) if g is not None and i not in without),
    )


def _standing(world: TabletopWorld, placements: Placements) -> list[Obstacles | None]:
    """The solids of each object, None where it does not rest anywhere. From one question to
    the next most things stay where they are: only the others are looked up."""
    last = world.memory.table("standing")
    before, known = last.get("latest", ((None,) * len(placements), [None] * len(placements)))
    if before is placements:
        return known  # type: ignore[no-any-return]
    found: list[Obstacles | None] = []
    for i, placement in enumerate(placements):
        if placement is None:
            found.append(None)
        elif placement is before[i] and world.grounds[placement.support].owner is None:
            found.append(known[i])
        else:
            at = world.rests_at(placements, i, placement)
            found.append(None if at is None else world.object_at(i, at, placement.face))
    last["latest"] = placements, found
    return found


def rider_parts(world: TabletopWorld, placements: Placements, index: int) -> tuple[Part, ...]:
    """The solids of what rests on an object, in the object's standing frame."""
    found: list[Part] = []
    for rider in world.riders(placements, index):
        at, placement = rests_on(world, placements, rider, index), placements[rider]
        assert placement is not None
        parts = world.item(rider, placement.face).parts
        found += [Part(p.solid, compose(at, p.pose)) for p in parts]
    return tuple(found)


def rests_on(world: TabletopWorld, placements: Placements, rider: int, below: int) -> Pose:
    """The standing frame of a rider (3, 4) in that of the object it is carried by."""
    pose = upright(0.0, 0.0, 0.0, 0.0)
    index = rider
    while index != below:
        placement = placements[index]
        assert placement is not None
        ground = world.grounds[placement.support]
        assert ground.owner is not None
        x, y, yaw = placement.pose
        pose = compose(upright(x, y, ground.height, yaw), pose)
        index = ground.owner
    return pose


def _is_upright_box(part: Part) -> bool:
    return isinstance(part.solid, Box) and abs(abs(part.pose[2, 2]) - 1) < UPRIGHT
