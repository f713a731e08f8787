"""Which links may touch each other: neighbours, and those that always do."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from runtime.kernels import arm
from runtime.kernels.convex import boxes_only
from runtime.robot.model import RobotModel
from runtime.robot.urdf import Urdf

SAMPLES = 400
TOUCH = 0.0041
"""Metres between links that touch, in the eyes of a planner that keeps 4 mm from everything."""

ALWAYS = 0.9
"""A pair that touches in so many random postures is one whose shapes overlap by design."""


def neighbours(urdf: Urdf) -> set[frozenset[str]]:
    """Pairs of links with shapes that hang directly on each other, links without shapes between
    them left out."""
    found = set()
    for link, shapes in urdf.shapes.items():
        if not shapes:
            continue
        above = link
        while above in urdf.joints:
            above = urdf.joints[above].parent
            if urdf.shapes[above]:
                found.add(frozenset((above, link)))
                break
    return found


def within(links: Iterable[str], urdf: Urdf) -> set[frozenset[str]]:
    """All pairs of some links that have shapes: those of a gripper."""
    return {frozenset(pair) for pair in combinations([k for k in links if urdf.shapes[k]], 2)}


def touching(robot: RobotModel, postures: NDArray[np.float64]) -> dict[frozenset[str], float]:
    """For each pair of links that is tested, the share of some postures (k, n) in which they
    touch; pairs that never do are left out."""
    counts: dict[frozenset[str], set[int]] = {}
    body = robot.body((robot.gripper.min_opening + robot.gripper.max_opening) / 2)
    nothing = boxes_only(np.empty((0, 8)))
    frames = np.empty((len(robot.joints) + 1, 3, 4))
    placed = np.empty((len(body.frame), 3, 4))
    single = [(pair, body._replace(pairs=np.array([pair], dtype=np.int64))) for pair in robot.pairs]
    for number, q in enumerate(postures):
        for (i, j), alone in single:
            if arm.collides(robot.chain, alone, nothing, TOUCH, q, frames, placed):
                names = frozenset((robot.parts[i].link, robot.parts[j].link))
                counts.setdefault(names, set()).add(number)
    return {pair: len(hits) / len(postures) for pair, hits in counts.items()}


def always_touching(robot: RobotModel, rng: np.random.Generator) -> set[frozenset[str]]:
    """Pairs of links that touch in nearly all random postures."""
    postures = rng.uniform(robot.lower, robot.upper, (SAMPLES, len(robot.joints)))
    return {pair for pair, share in touching(robot, postures).items() if share >= ALWAYS}
