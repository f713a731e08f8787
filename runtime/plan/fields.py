"""What pieces of all versions of the plan format have in common."""

from __future__ import annotations

import numpy as np

from runtime.plan.node import Node
from runtime.world.poses import Floats

FARTHEST = 1000.0
"""Metres (and radians) from the origin that a base pose in a file may be."""


def times_of(node: Node) -> Floats:
    """The times (k,) of a piece."""
    times = node["times"].numbers((None,))
    if times[0] != 0 or np.any(np.diff(times) < 0):
        raise node["times"].fail("times must start at 0 and not fall")
    return times


def base_poses_of(node: Node, count: int) -> Floats:
    """The poses (count, 3) of a base piece."""
    poses = node["poses"].numbers((count, 3))
    if np.abs(poses).max() > FARTHEST:
        raise node["poses"].fail("the base drives out of this world")
    return poses
