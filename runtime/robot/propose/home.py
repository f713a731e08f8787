"""A posture to drive and to wait in: free of collision, the arm folded over its own base and out
of the way of the work in front of it, the joints near the middle of their ranges.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from runtime.kernels import arm
from runtime.kernels.convex import boxes_only
from runtime.robot.model import Ints, RobotModel
from runtime.robot.urdf import MOVING
from runtime.world.poses import compose, identity
from runtime.world.solids import Floats

DRAWN = 4000
BEST = 24
STEPS = 250
MARGINS = (0.01, 0.005, 0.0042)
"""Metres kept from the robot itself and the floor: the largest that can be kept, the last being
what a planner keeps."""

NEAR_LIMIT = 0.12
"""A joint is near its limit where less of its range is left than this share."""

ROOM = 0.02
"""Metres kept above the plane that a fixed arm is mounted on, where its parts allow that."""


class _Judge:
    """What a posture costs: how far the arm sticks out, above all to the front and the sides, and
    how far the joints are from the middle of their ranges."""

    def __init__(self, robot: RobotModel, margin: float, floor: float, parked: bool) -> None:
        self.robot = robot
        self.parked = parked
        self.margin = margin
        self.body = robot.body(robot.gripper.min_opening)
        self.moving = np.flatnonzero(self.body.frame > 0)
        self._frames = np.empty((len(robot.joints) + 1, 3, 4))
        self._placed = np.empty((len(self.body.frame), 3, 4))
        self.floor = floor
        rows = [[0.0, 0.0, self.floor - 0.5, 10.0, 10.0, 0.5, 1.0, 0.0]]
        self.around = boxes_only(np.array(rows))
        self.span = np.maximum(robot.upper - robot.lower, 1e-9)
        self.middle = (robot.upper + robot.lower) / 2
        self.first = next((k for k, slides in enumerate(robot.chain.prismatic) if not slides), 0)
        self.ahead = float(np.clip(0.0, robot.lower[self.first], robot.upper[self.first]))
        self.high = float(robot.frames(self.middle)[self.first + 1, 2, 3]) + 0.4

    def cost(self, q: Floats) -> float:
        """Metres, and a little more for what is unhandy."""
        robot = self.robot
        arm.forward(robot.chain.origins, robot.chain.prismatic, q, self._frames)
        arm.place_boxes(self._frames, self.body.frame, self.body.pose, self._placed)
        if self.parked:
            return self._in_the_way() + 0.3 * self._strain(q)
        return self._extent() + self._strain(q) + self._unready()

    def _extent(self) -> float:
        """Where the whole arm is, in metres: how far it reaches; and again what is in front, where
        work is, and what is aside of the arm's own plane."""
        placed, _, reach, front = self._spread(self.moving)
        aside = float(np.abs(placed[:, 1, 3]).max())
        return reach + 0.5 * front + 0.5 * aside

    def _in_the_way(self) -> float:
        """How far an arm that is not used reaches and is in front, and is over on the side of the
        one that is used, in metres."""
        placed, radius, reach, front = self._spread(np.flatnonzero(self.body.frame > self.first))
        side = float(self._frames[self.first + 1, 1, 3])
        across = float((radius - math.copysign(1.0, side) * placed[:, 1, 3]).max())
        beyond = max(0.0, across) if abs(side) > ROOM else 0.0
        return reach + front + 2.0 * beyond

    def _spread(self, parts: Ints) -> tuple[Floats, Floats, float, float]:
        """Poses (k, 3, 4) and radii (k,) of some parts; how far they reach, in metres: the furthest
        from the base's axis, and half of how far they are stretched from the shoulder, upwards
        too; and how far they are in front."""
        placed, radius = self._placed[parts], 0.7 * self.body.radius[parts]
        out = np.hypot(placed[:, 0, 3], placed[:, 1, 3]) + radius
        front = max(0.0, float((placed[:, 0, 3] + radius).max()))
        shoulder = self._frames[self.first + 1, :, 3]
        stretch = np.linalg.norm(placed[:, :, 3] - shoulder, axis=1) + radius
        return placed, radius, float(out.max() + 0.5 * stretch.max()), front

    def _strain(self, q: Floats) -> float:
        """Joints away from the middle of their ranges, and a first joint that is turned away from
        its zero: the same posture the other way round leaves little room to turn."""
        away = ((q - self.middle) / self.span) ** 2
        room = 0.5 - math.sqrt(float(away.max()))
        turned = min(math.pi, abs(float(q[self.first]) - self.ahead))
        return (
            0.3 * float(away.max())
            + 0.6 * float(away.mean())
            + 2.0 * max(0.0, NEAR_LIMIT - room)
            + 0.1 * turned
        )

    def _unready(self) -> float:
        """How far the hand is from being ready for work: ahead, neither below the load that it may
        carry nor high up, and pointing forwards or down."""
        tool = compose(self._frames[-1], self.robot.tool)
        cost = 0.25 * (1.0 - max(float(tool[0, 0]), -float(tool[2, 0])))
        aside = math.atan2(float(tool[1, 3]), float(tool[0, 3]))
        cost += 0.15 * (1.0 - math.cos(aside)) + 0.3 * max(0.0, -float(tool[0, 3]))
        height = float(tool[2, 3])
        return cost + max(0.0, self.floor + 0.25 - height) + 0.5 * max(0.0, height - self.high)

    def free(self, q: Floats) -> bool:
        """Whether the robot touches neither itself nor the floor."""
        hit: bool = arm.collides(
            self.robot.chain, self.body, self.around, self.margin, q, self._frames, self._placed
        )
        return not hit


def _mount_height(robot: RobotModel) -> float:
    """The height of the plane that the arm is mounted on: the frame of the last link of its
    chain that does not move."""
    pose = identity()
    for joint in robot.urdf.chain(robot.urdf_tool):
        if joint.type in MOVING:
            break
        pose = compose(pose, joint.origin)
    return float(pose[2, 3])


def propose_home(
    robot: RobotModel,
    rng: np.random.Generator,
    wanted: Sequence[Floats] = (),
    parked: bool = False,
) -> Floats | None:
    """A home posture (n,), or None where none is found free. The first of the wanted ones that
    is free is taken as it is. An arm that is `parked` is only to be out of another one's way."""
    for margin, floor in ((m, f) for m in MARGINS for f in _floors(robot, m)):
        judge = _Judge(robot, margin, floor, parked)
        for q in wanted:
            if judge.free(q):
                return q
        found = _search(judge, rng)
        if found is not None:
            return found
    return None


def _floors(robot: RobotModel, margin: float) -> tuple[float, ...]:
    """Heights above which the whole arm is to stay, the best first. A fixed arm usually stands
    on a desk, which reaches to its mount; but the first links of some are in that plane, and
    others hang beside a torso: these keep off the floor alone."""
    if robot.base.type != "fixed":
        return (margin,)
    mount = _mount_height(robot)
    return (mount + ROOM, mount - margin, margin)


def _search(judge: _Judge, rng: np.random.Generator) -> Floats | None:
    """The best of many random postures, made better step by step."""
    robot = judge.robot
    inset = 0.05 * (robot.upper - robot.lower)
    lower, upper = robot.lower + inset, robot.upper - inset
    drawn = rng.uniform(lower, upper, (DRAWN, len(lower)))
    # Half of them nearer the middle: with many joints hardly any would be there by chance.
    drawn[::2] = (drawn[::2] + judge.middle) / 2
    costs = np.array([judge.cost(q) for q in drawn])
    kept = []
    for k in np.argsort(costs):
        if judge.free(drawn[k]):
            kept.append(drawn[k])
            if len(kept) == BEST:
                break
    best: tuple[float, Floats] | None = None
    for q in kept:
        now, size = judge.cost(q), 0.15
        for _ in range(STEPS):
            near = np.clip(q + rng.normal(size=len(q)) * size * (upper - lower), lower, upper)
            cost = judge.cost(near)
            if cost < now and judge.free(near):
                q, now = near, cost
            else:
                size = max(0.01, 0.97 * size)
        if best is None or now < best[0]:
            best = now, q
    return None if best is None else np.round(best[1], 3)
