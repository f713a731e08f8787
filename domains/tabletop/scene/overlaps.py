"""No object may start inside another one, or inside anything that never moves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from domains.tabletop.scene.objects import Drawn, Placed
from runtime.kernels.convex import TOLERANCE, Floats, Obstacles, gjk_distance, pose_of_row, solid_of
from runtime.world.packed import pack_bodies
from runtime.world.world import Fixed


def note_overlaps(drawn: Sequence[Drawn], placed: Placed, fixed: Sequence[Fixed]) -> None:
    """Note every object that starts inside something, once each."""
    there = [(i, thing) for i, thing in enumerate(placed.movables) if thing is not None]
    bodies = [thing.body for _, thing in there] + [thing.body for thing in fixed]
    poses = [thing.pose for _, thing in there] + [thing.pose for thing in fixed]
    names = [thing.name for _, thing in there] + [thing.name for thing in fixed]
    packed = pack_bodies(bodies)
    around = [packed.at(k, pose) for k, pose in enumerate(poses)]
    low = np.array([_bounds(obstacles.rows)[0] for obstacles in around]).reshape(-1, 3)
    high = np.array([_bounds(obstacles.rows)[1] for obstacles in around]).reshape(-1, 3)
    for k, (i, _) in enumerate(there):
        near = np.all((low <= high[k]) & (high >= low[k]), axis=1)
        near[k : len(there)] = False  # of two objects, the later one is told
        for other in np.flatnonzero(near):
            if _touch(around[k], around[other]):
                drawn[i].entry.problem(
                    None, f"{names[k]!r} starts inside {names[other]!r}", "move one of them apart"
                )
                break


def _bounds(rows: Floats) -> tuple[Floats, Floats]:
    """The corners of the box around some packed upright boxes, along the world's axes."""
    c, s = np.abs(rows[:, 6]), np.abs(rows[:, 7])
    half = np.column_stack(
        [c * rows[:, 3] + s * rows[:, 4], s * rows[:, 3] + c * rows[:, 4], rows[:, 5]]
    )
    return (rows[:, :3] - half).min(axis=0), (rows[:, :3] + half).max(axis=0)


def _touch(one: Obstacles, other: Obstacles) -> bool:
    return any(
        gjk_distance(
            solid, one.shapes.vertices, pose, solid_b, other.shapes.vertices, pose_b,
            0.0, TOLERANCE, TOLERANCE,
        ) <= 0.0
        for solid, pose in _solids(one)
        for solid_b, pose_b in _solids(other)
    )  # fmt: skip


def _solids(obstacles: Obstacles) -> Iterator[tuple[Floats, Floats]]:
    for row, shape, pose in zip(obstacles.rows, obstacles.shape, obstacles.pose, strict=True):
        solid = solid_of(shape, obstacles.shapes.solids, row[3:6])
        yield solid, pose if shape >= 0 else pose_of_row(row)
