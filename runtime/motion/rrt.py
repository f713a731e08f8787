"""Free arm motions: a straight line where it is free, else the joints in two stages, else
RRT-Connect (OMPL), shortened."""

from __future__ import annotations

from typing import Any

import numpy as np

from runtime.kernels.staged import quickest_corner
from runtime.motion.arm_context import FREE_MARGIN, ArmContext
from runtime.robot.model import Floats

MAX_CHECKS = 6000
"""Configurations tested before a query is given up: a count and not a time, so that the
same seed gives the same plan on every machine."""

CHECK_RESOLUTION = 0.08
RANGE = 1.2
ATTEMPTS = 2
SHORTCUTS = 12

ROUNDING = 0.5
"""Radians of path on either side of a corner that an arc may replace, at most."""

ARC_POINTS = 7

WIDTHS = (0.98, 0.7, 0.5, 0.3, 0.15)
"""Shares of both stages of a way that the arc from one to the other may replace, widest first."""


def plan(
    context: ArmContext, start: Floats, goal: Floats, seed: int, checks: int = MAX_CHECKS
) -> Floats | None:
    """A collision-free path (p, n) from start to goal (n,), or None where none was found. A
    search may test so many configurations."""
    if not _is_possible(context, start, goal):
        return None
    path = simple(context, start, goal)
    if path is not None or not checks:
        return path
    for attempt in range(ATTEMPTS):
        # The planner tests states a step apart; a path that the dense check refuses is
        # searched anew at half the step.
        step = CHECK_RESOLUTION / 2**attempt
        path = rrt_connect(context, start, goal, seed + attempt, step, checks)
        if path is None:
            return None
        if context.path_is_free(path):
            path = shorten(context, path, np.random.default_rng(seed))
            return round_corners(context, path)
    return None


def simple(context: ArmContext, start: Floats, goal: Floats) -> Floats | None:
    """A collision-free path between free ends without a search: a straight line, or two stages."""
    line = np.array([start, goal])
    return line if context.path_is_free(line) else staged(context, start, goal)


def _is_possible(context: ArmContext, start: Floats, goal: Floats) -> bool:
    """Whether both ends are within the joint limits and free."""
    robot = context.robot
    ends = np.array([start, goal])
    if np.any(ends < robot.lower) or np.any(ends > robot.upper):
        return False
    return not any(context.collides(q) for q in ends)


def staged(context: ArmContext, start: Floats, goal: Floats) -> Floats | None:
    """The quickest free path (p, n) on which first some joints move and then the others, with an
    arc in place of the corner; None where none is free."""
    corner = quickest(context, start, goal)
    if corner is None:
        return None
    for width in WIDTHS:
        before, after = corner + width * (start - corner), corner + width * (goal - corner)
        path = np.vstack([start, _arc(before, corner, after), goal])
        if context.path_is_free(path):
            return path
    return np.array([start, corner, goal])


def quickest(context: ArmContext, start: Floats, goal: Floats) -> Floats | None:
    """The posture between the stages of the quickest free way in two stages; None for none."""
    robot = context.robot
    corner, is_free = quickest_corner(
        robot.chain, context.body, context.obstacles, context.lowest, FREE_MARGIN, context.sweep,
        robot.velocity, start, goal,
    )  # fmt: skip
    return corner if is_free else None


def rrt_connect(
    context: ArmContext,
    start: Floats,
    goal: Floats,
    seed: int,
    resolution: float,
    most: int = MAX_CHECKS,
) -> Floats | None:
    """RRT-Connect (Kuffner & LaValle 2000) on the planning joints.

    Start and goal must be within the joint limits and free of collision: OMPL waits for
    another goal, without testing states, where one is not. `resolution` is the step, in
    radians of joint-space distance, between tested states, of which there are at `most` so many.
    """
    from ompl import base as ob
    from ompl import geometric as og
    from ompl import util as ou

    ou.setLogLevel(ou.LOG_NONE)
    ou.RNG.setSeed(seed % (2**31 - 1) + 1)
    robot = context.robot
    n = len(robot.joints)
    space = ob.RealVectorStateSpace(n)
    bounds = ob.RealVectorBounds(n)
    for i in range(n):
        bounds.setLow(i, float(robot.lower[i]) - 1e-9)
        bounds.setHigh(i, float(robot.upper[i]) + 1e-9)
    space.setBounds(bounds)
    info = ob.SpaceInformation(space)
    q = np.empty(n)
    checks = polls = 0

    def is_valid(state: Any) -> bool:
        nonlocal checks
        checks += 1
        for i in range(n):
            q[i] = state[i]
        return not context.collides(q)

    def is_over() -> bool:
        nonlocal polls
        polls += 1
        return checks >= most or polls >= most

    info.setStateValidityChecker(is_valid)
    info.setStateValidityCheckingResolution(resolution / space.getMaximumExtent())
    info.setup()
    planner = og.RRTConnect(info)
    planner.setRange(RANGE)
    problem = ob.ProblemDefinition(info)
    first, last = space.allocState(), space.allocState()
    for i in range(n):
        first[i], last[i] = float(start[i]), float(goal[i])
    problem.setStartAndGoalStates(first, last)
    planner.setProblemDefinition(problem)
    planner.setup()
    planner.solve(ob.PlannerTerminationCondition(is_over))
    path = None
    if problem.hasExactSolution():
        states = problem.getSolutionPath().getStates()
        path = np.array([[state[i] for i in range(n)] for state in states])
        path[0], path[-1] = start, goal
    # The checker refers to this frame and the frame to the space: without breaking the
    # circle OMPL reports leaked instances on stderr at exit.
    info.setStateValidityChecker(_always)
    return path


def _always(_: Any) -> bool:
    return True


def shorten(context: ArmContext, path: Floats, rng: np.random.Generator) -> Floats:
    """Replace stretches of a path by straight lines where these are free."""
    path = _skip_ahead(context, path)
    for _ in range(SHORTCUTS):
        if len(path) < 3:
            break
        lengths = np.linalg.norm(np.diff(path, axis=0), axis=1)
        marks = np.concatenate([[0.0], np.cumsum(lengths)])
        low, high = np.sort(rng.uniform(0.0, marks[-1], 2))
        i, j = np.searchsorted(marks, [low, high], side="right") - 1
        j = min(int(j), len(path) - 2)
        if i == j:
            continue
        a = path[i] + (low - marks[i]) / max(lengths[i], 1e-12) * (path[i + 1] - path[i])
        b = path[j] + (high - marks[j]) / max(lengths[j], 1e-12) * (path[j + 1] - path[j])
        if context.path_is_free(np.array([a, b])):
            path = np.vstack([path[: i + 1], a, b, path[j + 1 :]])
    return _skip_ahead(context, path)


def _skip_ahead(context: ArmContext, path: Floats) -> Floats:
    """Leave out way points: from each one go on to the last, else to half as far, and so on."""
    kept = [path[0]]
    i, last = 0, len(path) - 1
    while i < last:
        j = last
        while j > i + 1 and not context.path_is_free(np.array([path[i], path[j]])):
            j = i + (j - i) // 2
        kept.append(path[j])
        i = j
    return np.array(kept)


def round_corners(context: ArmContext, path: Floats) -> Floats:
    """Replace corners by arcs (parabolas), as wide as is free, so that the arm need not stop."""
    rounded = [path[0]]
    for before, corner, after in zip(path[:-2], path[1:-1], path[2:], strict=True):
        arc = corner[None]
        to, away = before - corner, after - corner
        widest = min(ROUNDING, np.linalg.norm(to) / 2, np.linalg.norm(away) / 2)
        for halving in range(3):
            width = widest / 2**halving
            start = corner + to * (width / np.linalg.norm(to))
            end = corner + away * (width / np.linalg.norm(away))
            wider = _arc(start, corner, end)
            if context.path_is_free(wider):
                arc = wider
                break
        rounded += list(arc)
    return np.array([*rounded, path[-1]])


def _arc(start: Floats, corner: Floats, end: Floats) -> Floats:
    """Points of a parabola (ARC_POINTS, n) that leaves along one line and arrives along another."""
    t = np.linspace(0.0, 1.0, ARC_POINTS)[:, None]
    arc: Floats = (1 - t) ** 2 * start + 2 * t * (1 - t) * corner + t**2 * end
    return arc
