"""Where a robot can grasp, found by inverse kinematics over a grid of heights and distances.

Each grasp is tried over a board that ends 10 cm before the object, a table's edge, and above
the floor; postures that touch these or the robot itself do not count.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from runtime.kernels import ik
from runtime.kernels.convex import boxes_only
from runtime.robot.approach import Family, Workspace
from runtime.robot.model import RobotModel
from runtime.robot.open_hand import hand_boxes, tools
from runtime.world.poses import Pose, compose, invert
from runtime.world.solids import Floats

HEIGHT_STEP = 0.1
DISTANCE_STEP = 0.05
HALVINGS = 2
"""How often the last step at either end of a fixed robot's reach is halved: one that drives
stands a little nearer or further, a fixed one has to make use of all its reach."""

SAMPLES = 6
"""Directions that are tried for each height and distance."""

SEEDS = 4
"""Random postures that inverse kinematics starts from, besides those near by."""

ITERATIONS = 50
MARGIN = 0.001
SHARE = 0.5
"""A distance belongs to the workspace where so many of the directions can be reached."""

EDGE = 0.10
"""Metres from the object to the edge of the board that it stands on."""

ASIDE = 0.9
"""Radians between the heading of a hand and the direction from the shoulder, at most."""

FACING = 0.4
"""Radians by which the base may face aside of the object, where it can turn; a fixed one has
to reach around: `AROUND`."""

AROUND = 2.0
HIGHEST = 2.0
SLACK = 0.02
"""Metres that a distance may be beyond the stretched arm: links are measured by their axes."""


@dataclass(frozen=True, eq=False)
class Posture:
    """A solution: configuration (n,), grasp centre's pose (3, 4) of the approach frame in the
    base frame, and where on the grid it is."""

    q: Floats
    frame: Pose
    height: float


def shoulder_of(robot: RobotModel) -> tuple[float, float]:
    """Where the arm's first upright axis meets the floor, in the base frame; that of its first
    turning joint where none is upright."""
    frames = robot.frames(robot.home)
    turning = [k for k in range(len(robot.joints)) if not robot.chain.prismatic[k]]
    upright = [k for k in turning if abs(frames[k + 1, 2, 2]) > 0.98]
    first = (upright or turning or [0])[0]
    return float(frames[first + 1, 0, 3]), float(frames[first + 1, 1, 3])


def wrist_offset_of(robot: RobotModel) -> float:
    """Metres along the approach from the wrist to the grasp centre: the wrist is on the axis of
    the tool, level with the last joint but one that turns."""
    frames = robot.frames(robot.home)
    tool = compose(frames[-1], robot.tool)
    turning = [k for k, slides in enumerate(robot.chain.prismatic) if not slides] or [0]
    wrist = frames[turning[-2:][0] + 1, :, 3]
    return max(0.0, float((tool[:, 3] - wrist) @ tool[:, 0]))


def below_grasp(robot: RobotModel, family: Family) -> float:
    """Metres that the hand needs below the grasp centre, a little play included."""
    hand, fingers = hand_boxes(robot, family)
    boxes = np.vstack([hand, fingers])
    reach = boxes[:, 4].min()
    if family is Family.PINCH:
        reach = min(reach, -boxes[:, 5].max() - 0.03)
    return float(max(0.0, -reach) + 0.01)


def approach_frame(family: Family, x: float, y: float, z: float, heading: float) -> Pose:
    """The approach frame with a heading at a point."""
    c, s = math.cos(heading), math.sin(heading)
    return np.array([[c, -s, 0.0, x], [s, c, 0.0, y], [0.0, 0.0, 1.0, z]])


class Prober:
    """Asks for postures of one robot in one family."""

    def __init__(self, robot: RobotModel, family: Family) -> None:
        self.robot = robot
        self.family = family
        self.centre = shoulder_of(robot)
        ahead, up = family.ahead
        wrist = wrist_offset_of(robot)
        self.offset, self.above = wrist * ahead, -wrist * up
        self.body = robot.body(min(0.06, robot.gripper.max_opening))
        self.below = below_grasp(robot, family)
        self.rng = np.random.default_rng(0)
        self.length = stretched(robot) + SLACK
        self.low, self.high = _shoulder_heights(robot)
        self.facing = AROUND if robot.base.type == "fixed" else FACING

    def can_reach(self, height: float, distance: float) -> bool:
        """Whether the stretched arm is long enough: if not, there is no need to try."""
        wrist = height + self.above
        away = max(0.0, self.low - wrist, wrist - self.high)
        return math.hypot(away, distance) <= self.length

    def probe(
        self, height: float, distance: float, number: int, known: list[Floats]
    ) -> Posture | None:
        """A posture for the wrist at a distance, one of `SAMPLES` directions by its number.
        `known` are postures near by."""
        rng = self.rng
        bearing = rng.uniform(-self.facing, self.facing)
        share = (number + rng.uniform()) / SAMPLES
        aside, turn = (2 * share - 1) * ASIDE, share * math.pi
        if self.family is Family.TOP:
            aside = 0.0
        heading = bearing + aside
        x = self.centre[0] + distance * math.cos(bearing) + self.offset * math.cos(heading)
        y = self.centre[1] + distance * math.sin(bearing) + self.offset * math.sin(heading)
        frame = approach_frame(self.family, x, y, height, heading)
        obstacles = boxes_only(self._around(x, y, height, bearing))
        robot = self.robot
        for tool in tools(self.family, turn):
            starts = np.vstack(
                [
                    *known[-2:],
                    robot.home,
                    rng.uniform(robot.lower, robot.upper, (SEEDS, len(robot.home))),
                ]
            )
            target = compose(frame, tool)
            found = ik.first_free(
                robot.chain, robot.lower, robot.upper, robot.tool, target, starts, 0,
                ITERATIONS, np.ones(len(robot.home)), self.body, obstacles, MARGIN,
            )  # fmt: skip
            if found >= 0:
                return Posture(starts[found].copy(), frame, height)
        return None

    def reaches(self, height: float, near: Sequence[Floats], distance: float) -> bool:
        """Whether the wrist gets to a distance in enough directions. `near` are postures near
        by."""
        if not self.can_reach(height, distance):
            return False
        known, wanted = list(near), math.ceil(SHARE * SAMPLES)
        for number in range(SAMPLES):
            if SAMPLES - number < wanted:
                break
            posture = self.probe(height, distance, number, known)
            if posture is not None:
                known.append(posture.q)
                wanted -= 1
        return wanted <= 0

    def _around(self, x: float, y: float, height: float, bearing: float) -> Floats:
        """The floor, and the board under the object (2, 8)."""
        c, s = math.cos(bearing), math.sin(bearing)
        ahead, thick = 0.35 - EDGE, 0.02
        top = height - self.below
        board = [x + ahead * c, y + ahead * s, top - thick, 0.35, 0.6, thick, c, s]
        return np.array([[0.0, 0.0, -0.5, 10.0, 10.0, 0.5, 1.0, 0.0], board])


def grid(robot: RobotModel, family: Family) -> tuple[Workspace, list[Posture]]:
    """The workspace of a family, and the postures that were found in it."""
    prober = Prober(robot, family)
    lowest = math.ceil(prober.below / HEIGHT_STEP) * HEIGHT_STEP
    heights = np.arange(lowest, HIGHEST + 1e-9, HEIGHT_STEP)
    distances = np.arange(DISTANCE_STEP, stretched(robot) + SLACK, DISTANCE_STEP)
    shares = np.zeros((len(heights), len(distances)))
    found: list[tuple[int, int, Posture]] = []
    for j in range(len(distances)):
        known: list[Floats] = []
        for i, height in enumerate(heights.tolist()):
            if not prober.can_reach(height, float(distances[j])):
                continue
            for number in range(SAMPLES):
                # Where two directions in a row and the last height failed, so will the rest.
                if number == 3 and shares[i, j] == 0:
                    break
                posture = prober.probe(height, float(distances[j]), number, known)
                if posture is not None:
                    known.append(posture.q)
                    found.append((i, j, posture))
                    shares[i, j] += 1 / SAMPLES
    inner, outer = np.zeros(len(heights)), np.zeros(len(heights))
    for i, (start, end) in _intervals(_smooth(shares)):
        inner[i], outer[i] = distances[start], distances[end]
        if robot.base.type == "fixed":
            at = {j: [posture.q] for k, j, posture in found if k == i}
            for ends, j, step in ((inner, start, -DISTANCE_STEP), (outer, end, DISTANCE_STEP)):
                reaches = partial(prober.reaches, float(heights[i]), at.get(j, []))
                ends[i] = last_reached(reaches, ends[i], step)
    inside = [
        posture for i, j, posture in found if inner[i] - 1e-9 <= distances[j] <= outer[i] + 1e-9
    ]
    return Workspace(heights, inner, outer, prober.offset), inside


def last_reached(reaches: Callable[[float], bool], distance: float, step: float) -> float:
    """The last distance that is reached between one that is and the next one, `step` metres
    further (inwards where negative), to within some halvings of the step."""
    for _ in range(HALVINGS):
        step /= 2
        if reaches(distance + step):
            distance += step
    return distance


def stretched(robot: RobotModel) -> float:
    """How far the wrist can be from the shoulder at most: the links between, end to end."""
    lengths = np.linalg.norm(robot.chain.origins[:, :, 3], axis=1)
    travel = np.where(robot.chain.prismatic, np.maximum(abs(robot.lower), abs(robot.upper)), 0)
    first = next((k for k, slides in enumerate(robot.chain.prismatic) if not slides), 0)
    return max(2 * DISTANCE_STEP, float(lengths[first + 1 :].sum() + travel[first:].sum()))


def _shoulder_heights(robot: RobotModel) -> tuple[float, float]:
    """The lowest and the highest place of the first turning joint, over the travel of what
    slides before it."""
    first = next((k for k, slides in enumerate(robot.chain.prismatic) if not slides), 0)
    heights = []
    for ends in (robot.lower, robot.upper):
        q = robot.home.copy()
        q[:first] = ends[:first]
        heights.append(float(robot.frames(q)[first + 1, 2, 3]))
    return min(heights), max(heights)


def _smooth(shares: Floats) -> Floats:
    """The mean of each cell and its neighbours: few samples a cell are noisy."""
    padded = np.pad(shares, 1, mode="edge")
    rows, columns = shares.shape
    total = sum(padded[i : i + rows, j : j + columns] * weight for i, j, weight in _WEIGHTS)
    return np.asarray(total)


_WEIGHTS = [
    (i, j, weight / 16) for i, row in enumerate(((1, 2, 1), (2, 4, 2), (1, 2, 1)))
    for j, weight in enumerate(row)
]  # fmt: skip


def _intervals(shares: Floats) -> Iterator[tuple[int, tuple[int, int]]]:
    """For every height the longest run of distances of which enough is reached."""
    for i, row in enumerate(shares >= SHARE):
        best = (0, -1)
        start = None
        for j, good in enumerate([*row.tolist(), False]):
            if good and start is None:
                start = j
            elif not good and start is not None:
                if j - 1 - start > best[1] - best[0]:
                    best = (start, j - 1)
                start = None
        if best[1] > best[0]:
            yield i, best


def in_frame(posture: Posture, pose: Pose) -> Pose:
    """A pose of the base frame in the posture's approach frame."""
    return compose(invert(posture.frame), pose)
