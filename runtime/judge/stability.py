"""Whether bodies stay where they stand: statics of stacks with level contacts.

Every contact pushes straight up. A set of bodies stands if there are forces, none of them
negative, at the corners of the contacts, with which the forces and the moments on each body
add up to nothing: a linear programme. For one body that is the old rule that its centre of
mass is over the polygon of its support.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from runtime.judge.extents import lowest_of
from runtime.judge.footing import Footing, Poses, above, footings, movable, support_pose
from runtime.judge.polygon import convex_hull, outside_by
from runtime.world.poses import Floats
from runtime.world.world import World

SLACK = 1e-4
"""Metres by which a plan's own rounding may miss the region of a support."""

DENT = 0.001
"""Metres by which a contact in a point or along a line counts as wider: things give a little."""


def fault_of_rest(world: World, poses: Poses, index: int, on: str | None) -> str | None:
    """Why a body that was let go does not rest as it should: on a support (the named one, if
    one is named), and stable, with all that it stands on and that stands on it. It may jut over
    an edge as far as it stands. None where it does."""
    name = world.movables[index].name
    if on is not None and all(support.name != on for support in world.supports):
        return f"there is no support {on!r} for {name}"
    under = footings(world, poses, index)
    if not under:
        return _in_the_air(world, poses, index)
    if on is not None and all(f.support.name != on for f in under):
        return f"{name} rests on {under[0].support.name}, the plan says on {on}"
    return _not_allowed(world, poses, index, under) or falls(
        world, poses, _connected(world, poses, index)
    )


def _not_allowed(world: World, poses: Poses, index: int, under: Sequence[Footing]) -> str | None:
    """Whether a body that may rest on some supports only does: its centre of mass is over one of
    those that bear it."""
    thing = world.movables[index]
    if thing.only_on is None:
        return None
    centre = [*centre_of(world, poses, index), 1.0]
    for footing in under:
        place = support_pose(world, footing.support, poses)
        if footing.support.name in thing.only_on and place is not None:
            local = np.linalg.inv(place) @ centre
            if np.all(np.abs(local[:2]) <= np.array(footing.support.half) + SLACK):
                return None
    return f"{thing.name} rests on {under[0].support.name}, where it may not be put"


def _in_the_air(world: World, poses: Poses, index: int) -> str:
    name = world.movables[index].name
    bottom = float(lowest_of(world.movables[index].body, poses[index][None])[0])
    heights = [
        (bottom - float(place[2, 3]), f.support.name)
        for f in footings(world, poses, index, math.inf)
        if (place := support_pose(world, f.support, poses)) is not None
    ]
    if not heights:
        return f"{name} is released over nothing that it could rest on"
    height, support = min(heights, key=lambda pair: abs(pair[0]))
    return f"{name} is released {1000 * height:.1f} mm too high for {support}"


def _connected(world: World, poses: Poses, index: int) -> list[int]:
    """A body, the stack under it, and all that stands on any of these."""
    found, pending = {index}, [index]
    while pending:
        owners = {f.support.owner for f in footings(world, poses, pending.pop())}
        new = {i for i in poses if world.movables[i].name in owners} - found
        found |= new
        pending += sorted(new)
    return sorted(found | above(world, poses, sorted(found)))


def falls(world: World, poses: Poses, group: Sequence[int]) -> str | None:
    """Why bodies, with all that they stand on and that stands on them, would not stay."""
    contacts = {i: footings(world, poses, i) for i in group}
    for i in group:
        if not contacts[i]:
            return f"nothing holds {world.movables[i].name}"
    if len(group) == 1:
        return _tips(world, poses, group[0], contacts[group[0]])
    if not _in_balance(world, poses, contacts):
        names = ", ".join(world.movables[i].name for i in group)
        return f"the stack of {names} falls over"
    return None


def centre_of(world: World, poses: Poses, index: int) -> Floats:
    """The centre of mass (3,) of a body in the world."""
    centre: Floats = (poses[index] @ [*world.movables[index].body.centre, 1.0])[:3]
    return centre


def _tips(world: World, poses: Poses, index: int, under: Sequence[Footing]) -> str | None:
    polygon = convex_hull(np.vstack([_corners(f) for f in under]))
    off = outside_by(polygon, centre_of(world, poses, index)[:2])
    if off <= 0:
        return None
    name = world.movables[index].name
    return f"{name} tips over: its centre of mass is {1000 * off:.1f} mm beside what it rests on"


def _corners(footing: Footing) -> Floats:
    """Corners (k, 2) of a contact, with some width where it has none."""
    patch = footing.patch
    if len(patch) > 2:
        return patch
    offsets = DENT * np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]])
    found: Floats = (patch[:, None] + offsets).reshape(-1, 2)
    return found


def _in_balance(world: World, poses: Poses, contacts: Mapping[int, Sequence[Footing]]) -> bool:
    from scipy.optimize import linprog

    row = {index: 3 * number for number, index in enumerate(contacts)}
    columns: list[Floats] = []
    wanted = np.zeros(3 * len(row))
    for index, under in contacts.items():
        mass = world.movables[index].body.mass
        x, y, _ = centre_of(world, poses, index)
        wanted[row[index] : row[index] + 3] = mass, mass * x, mass * y
        for footing in under:
            owner = movable(world, footing.support.owner)
            for corner in _corners(footing):
                column = np.zeros(len(wanted))
                column[row[index] : row[index] + 3] = 1.0, *corner
                if owner in row:
                    column[row[owner] : row[owner] + 3] -= 1.0, *corner
                columns.append(column)
    # Forces in units of all the weight there is, so that the solver's tolerances mean the same.
    weight = sum(world.movables[index].body.mass for index in contacts)
    done = linprog(
        np.zeros(len(columns)), A_eq=np.column_stack(columns), b_eq=wanted / weight, method="highs"
    )
    return bool(done.status == 0)
