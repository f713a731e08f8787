"""Motions of the arm that keep the tool level: what is carried has things standing on it.

RRT-Connect whose every configuration is projected onto the postures in which a given direction
of the tool points up (Berenson, Srinivasa, Ferguson and Kuffner, "Manipulation planning on
constraint manifolds", 2009): the lean is taken out by inverse kinematics, the place and the
heading of the tool are left as they are.
"""

from __future__ import annotations

import math

import numpy as np

from runtime.kernels import ik
from runtime.motion.arm_context import ArmContext
from runtime.motion.carry import lean_of, room_taken, stray
from runtime.robot.model import Floats, RobotModel
from runtime.world.poses import Pose

STEP = 0.12
"""Radians (metres) of joint space between the configurations of a path."""

ROUNDS = 60
"""Random configurations towards which the trees grow, at most. Where that is not enough ten times
as many seldom are: another posture at the grasp is the better try."""

ITERATIONS = 25
SHORTCUTS = 30

TRIES = 120
POSTURES = 10
"""Postures to carry things in that are looked at, ..."""

PLACES = 6
"""... and places where things are taken, of so many tries."""

NEAR_HOME = 0.12
"""Metres by which the tool strays from where it is at home (standard deviation)."""

AHEAD = (0.35, 0.75)
"""Metres from the shoulder's axis, ..."""

HEIGHTS = (0.4, 1.1)
"""... and above the floor, where things are taken."""

LEAN = 0.03
"""Radians that the tool may lean on a level path."""


def postures(robot: RobotModel, up: Floats) -> tuple[Floats, ...]:
    """Postures in which to carry something level, `up` (3,) the direction of the tool frame that
    points up: home, if it is level, and others near it. First those from which the tool can be
    led straight, and level, to most of some places where things are taken."""
    rng = np.random.default_rng(0)
    body = robot.body(0.0)
    alone = _Level(ArmContext(robot, body, np.empty((0, 8))), up)
    found: list[Floats] = [] if alone.leans(robot.home) else [robot.home]
    taken: list[Floats] = []
    for number in range(TRIES):
        share = number / TRIES
        q = _raised(robot, stray(robot, rng, share), up, rng, NEAR_HOME * (1 + share))
        if len(found) < POSTURES and q is not None and not alone.context.collides(q):
            found.append(q)
        there = _raised(robot, stray(robot, rng, 1.0), up, rng, None)
        if len(taken) < PLACES and there is not None and not alone.context.collides(there):
            taken.append(there)
    reached = [sum(alone.reaches(q, there) for there in taken) for q in found]
    widths = [room_taken(robot, body, q) for q in found]
    order = sorted(range(len(found)), key=lambda i: (-reached[i], widths[i]))
    return tuple(found[i] for i in order)


def _raised(
    robot: RobotModel, q: Floats, up: Floats, rng: np.random.Generator, near: float | None
) -> Floats | None:
    """A configuration, found from q, with the tool level and with any heading: near its place at
    home (metres, standard deviation), or (None) where things are taken; None if there is none."""
    if near is not None:
        place = robot.tool_pose(robot.home)[:, 3] + rng.normal(size=3) * near
    else:
        bearing, reach = rng.normal() * 0.6, rng.uniform(*AHEAD)
        x, y = robot.centre
        place = np.array(
            [x + reach * math.cos(bearing), y + reach * math.sin(bearing), rng.uniform(*HEIGHTS)]
        )
    target = np.column_stack([level_rotation(up, rng.uniform(-math.pi, math.pi)), place])
    q = q.copy()
    solved: bool = ik.solve(
        *robot.chain, robot.lower, robot.upper, robot.tool, target, q, 80, robot.ease
    )
    return q if solved else None


def level_rotation(up: Floats, yaw: float) -> Floats:
    """A rotation (3, 3) that turns a direction (3,) up, and then about the vertical."""
    side = np.eye(3)[int(np.argmin(np.abs(up)))]
    x = side - (side @ up) * up
    x /= np.linalg.norm(x)
    c, s = math.cos(yaw), math.sin(yaw)
    about = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    turned: Floats = about @ np.array([x, np.cross(up, x), up])
    return turned


def plan(
    context: ArmContext, start: Floats, goal: Floats, up: Floats, seed: int, rounds: int = ROUNDS
) -> Floats | None:
    """A free path (p, n) between two configurations on which the direction `up` (3,) of the tool
    frame stays up, None where none was found. With one round only the straight way is tried."""
    ways = _Level(context, up)
    if ways.leans(start) or ways.leans(goal) or context.collides(start) or context.collides(goal):
        return None
    rng = np.random.default_rng(seed)
    path = ways.connect(start, goal, rng, rounds)
    return None if path is None else ways.shorten(path, rng)


class _Tree:
    def __init__(self, root: Floats) -> None:
        self.nodes, self.parents = [root], [-1]

    def nearest(self, q: Floats) -> int:
        return int(np.argmin(np.linalg.norm(np.array(self.nodes) - q, axis=1)))

    def add(self, parent: int, steps: list[Floats]) -> int:
        for q in steps:
            self.nodes.append(q)
            self.parents.append(parent)
            parent = len(self.nodes) - 1
        return parent

    def way(self, node: int) -> list[Floats]:
        """From the root to a node."""
        found = []
        while node >= 0:
            found.append(self.nodes[node])
            node = self.parents[node]
        return found[::-1]


class _Level:
    def __init__(self, context: ArmContext, up: Floats) -> None:
        self.context, self.robot, self.up = context, context.robot, up

    def leans(self, q: Floats) -> bool:
        return lean_of(self.robot.tool_pose(q), self.up) > LEAN

    def connect(
        self, start: Floats, goal: Floats, rng: np.random.Generator, rounds: int
    ) -> Floats | None:
        """RRT-Connect."""
        trees, swapped = [_Tree(start), _Tree(goal)], False
        wanted = goal
        for _ in range(rounds):
            here, there = trees
            steps = self.towards(here.nodes[near := here.nearest(wanted)], wanted)
            end = here.add(near, steps)
            if steps or len(here.nodes) == 1:
                q = here.nodes[end]
                other = there.nearest(q)
                back = self.towards(there.nodes[other], q)
                last = there.add(other, back)
                if np.abs(there.nodes[last] - q).max() < 1e-9:
                    path = here.way(end) + there.way(last)[::-1][1:]
                    return np.array(path[::-1] if swapped else path)
            trees, swapped = trees[::-1], not swapped
            wanted = self._random(start, goal, rng)
        return None

    def reaches(self, start: Floats, goal: Floats) -> bool:
        steps = self.towards(start, goal)
        return bool(steps) and float(np.abs(steps[-1] - goal).max()) < 1e-9

    def towards(self, start: Floats, goal: Floats) -> list[Floats]:
        """Level configurations from one towards another, as far as they are free."""
        found: list[Floats] = []
        q, left = start, float(np.linalg.norm(goal - start))
        while left > 1e-9:
            ahead = goal if left <= STEP else q + (goal - q) * (STEP / left)
            then = levelled(self.robot, ahead, self.up)
            if then is None or np.linalg.norm(then - q) > 2.5 * STEP:
                break
            now = float(np.linalg.norm(goal - then))
            if now > left - STEP / 4 and now > 1e-9:
                break  # the way is barred by what level means
            middle = (q + then) / 2
            if self.leans(middle) or not self.context.path_is_free(np.array([q, then])):
                break
            found.append(then)
            q, left = then, now
        return found

    def shorten(self, path: Floats, rng: np.random.Generator) -> Floats:
        for _ in range(SHORTCUTS):
            if len(path) < 4:
                break
            i, j = sorted(rng.choice(len(path), 2, replace=False).tolist())
            length = float(np.linalg.norm(np.diff(path[i : j + 1], axis=0), axis=1).sum())
            if j - i < 2 or length < 1.02 * float(np.linalg.norm(path[j] - path[i])):
                continue
            steps = self.towards(path[i], path[j])
            if not steps or np.abs(steps[-1] - path[j]).max() > 1e-9:
                continue
            new = np.vstack([path[i][None], *(q[None] for q in steps)])
            if float(np.linalg.norm(np.diff(new, axis=0), axis=1).sum()) < length:
                path = np.vstack([path[:i], new, path[j + 1 :]])
        return path

    def _random(self, start: Floats, goal: Floats, rng: np.random.Generator) -> Floats:
        """A configuration near the line between both, or anywhere."""
        robot = self.robot
        if rng.random() < 0.5:
            return rng.uniform(robot.lower, robot.upper)
        middle = start + rng.random() * (goal - start)
        q: Floats = np.clip(middle + rng.normal(size=len(middle)) * 0.4, robot.lower, robot.upper)
        return q


def levelled(robot: RobotModel, q: Floats, up: Floats) -> Floats | None:
    """The configuration (n,) near q in which the tool is where it is at q and does not lean."""
    pose = robot.tool_pose(q)
    if lean_of(pose, up) < 1e-4:
        return q
    turned = q.copy()
    solved: bool = ik.solve(
        *robot.chain, robot.lower, robot.upper, robot.tool, straightened(pose, up), turned,
        ITERATIONS, robot.ease,
    )  # fmt: skip
    return turned if solved else None


def straightened(pose: Pose, up: Floats) -> Pose:
    """A pose turned the shortest way so that its direction `up` (3,) points up."""
    is_up = pose[:, :3] @ up
    sine, cosine = math.hypot(is_up[0], is_up[1]), float(is_up[2])
    if sine < 1e-12:
        return pose
    x, y, z = is_up[1] / sine, -is_up[0] / sine, 0.0
    angle = math.atan2(sine, cosine)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * (cross @ cross)
    return np.column_stack([turn @ pose[:, :3], pose[:, 3]])
