"""Where the robot takes objects to be: where it expects them, while it sees them there.

Features of a state may hang on fractions of a millimetre. What stands still, or was put down as
planned, does not change them only because it was measured anew.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from domains.tabletop.features.goals import turn_error
from domains.tabletop.loop.sensing import Seen
from runtime.robot.model import Floats
from runtime.world.quaternions import matrix, pose_of
from runtime.world.world import World

STEADY = 0.002
"""Metres, in the plane, by which an object may be seen beside where it is expected."""

TURNED = 0.02
"""Radians by which it may be seen turned, or leaning."""


class Beliefs:
    """Expected poses (7,) of a world's objects; at first those in which they start.

    `noise` is the standard deviation of a measured position, in metres; that of a heading is
    ten times as much, in radians.
    """

    def __init__(self, world: World, noise: float) -> None:
        self.poses: list[Floats] = [pose_of(thing.pose) for thing in world.movables]
        self.steady = STEADY + noise
        self.turned = TURNED + 10 * noise

    def expect(self, index: int, pose: Floats) -> None:
        """From now on an object is expected at another pose (7,)."""
        self.poses[index] = pose

    def of(self, seen: Seen) -> Seen:
        """What is seen, with what is where it was expected exactly there; what is not is
        expected where it is seen from now on."""
        for index, pose in enumerate(seen.objects):
            if index == seen.held or not self._is_there(self.poses[index], pose):
                self.poses[index] = pose
        return replace(seen, objects=tuple(self.poses))

    def _is_there(self, expected: Floats, pose: Floats) -> bool:
        turn = matrix(pose)[:3, :3] @ matrix(expected)[:3, :3].T
        return bool(
            np.hypot(*(pose[:2] - expected[:2])) < self.steady
            and abs(pose[2] - expected[2]) < 0.01
            and turn[2, 2] > np.cos(TURNED)
            and turn_error(float(np.arctan2(turn[1, 0], turn[0, 0])), 1) < self.turned
        )
