"""How far things fall that a plan leaves in the air: it keeps a little above supports."""

from __future__ import annotations

import numpy as np

from runtime.judge.extents import homogeneous, lowest
from runtime.judge.footing import Poses, footings, movable
from runtime.world.body import Body
from runtime.world.poses import Floats
from runtime.world.world import FLOOR, Fixed, Movable, Support, World

MOST = 0.01
"""Metres of air below a support, at most: what is further down is something else."""


def drop(world: World, poses: Poses, index: int) -> float:
    """Metres by which a body at a pose, and what it stands on, sink until they touch."""
    falls = []
    for footing in footings(world, poses, index):
        owner = movable(world, footing.support.owner)
        below = 0.0 if owner is None else drop(world, poses, owner)
        falls.append(_air(world, footing.support) + below)
    return min(falls, default=0.0)


def _air(world: World, support: Support) -> float:
    """Metres between a support and the top of its owner right below it."""
    if support.owner == FLOOR:
        return float(support.pose[2, 3])
    things: list[Fixed | Movable] = [*world.fixed, *world.movables]
    owner = next(thing for thing in things if thing.name == support.owner)
    moves = movable(world, support.owner) is not None
    height = float(support.pose[2, 3])
    tops = _tops(owner.body, np.eye(4) if moves else homogeneous(owner.pose))
    gaps = [height - top for top in tops if -1e-6 <= height - top <= MOST]
    return min(gaps, default=0.0)


def _tops(body: Body, pose: Floats) -> list[float]:
    """Heights of the tops of a body's solids."""
    over = np.diag([1.0, 1.0, -1.0, 1.0])  # upside down, the top is the bottom
    return [
        -float(lowest(part.solid, (over @ pose @ homogeneous(part.pose))[None])[0])
        for part in body.parts
    ]
