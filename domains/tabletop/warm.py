"""Compile, or load from the cache, every kernel before the clock starts."""

from __future__ import annotations

import numpy as np

from domains.tabletop.actions.executability import SEEDS, Executor
from domains.tabletop.actions.schedule import Step, scheduled
from domains.tabletop.features import functions
from domains.tabletop.sampling.samples import Sampler
from domains.tabletop.sampling.stands import stand
from domains.tabletop.scene.boxes import scene_of_boxes, standing_box
from domains.tabletop.scene.model import (
    Obstacle,
    RegionGoal,
    Scene,
    Surface,
    UprightBox,
)
from domains.tabletop.state import State
from domains.tabletop.subproblem import TabletopSubproblem
from domains.tabletop.world import TabletopWorld
from runtime.kernels import arm, kept
from runtime.kernels.boxes import within_reach
from runtime.kernels.compiler import has_compiled
from runtime.kernels.convex import boxes_only
from runtime.motion import rrt
from runtime.motion.arm_context import ArmContext
from runtime.motion.course import arm_limits, with_stops
from runtime.motion.drives import drives
from runtime.robot.model import RobotModel
from runtime.search.problem import Rejection
from runtime.search.profile import Profile

_WARM: set[str] = set()


def warm_up(robot: RobotModel) -> None:
    """Run each kernel once, on a scene of two tables and two objects."""
    if robot.digest in _WARM:
        return
    _WARM.add(robot.digest)
    world = TabletopWorld.of(_scene(), robot)
    executor = Executor(world, 0, Profile())
    sampler = Sampler(world, executor, ())
    rng = np.random.default_rng(0)
    state = world.initial
    for index in range(2):
        functions.obstructions(state, index)
        functions.disturbances(state, index)
    here = functions.arrangement(world, state.placements)
    here.in_the_way(0, here.world.goals[0])
    steps: list[Step] = []
    for _ in range(2):
        samples = sampler.sample(state, 0, rng)
        found = _first(TabletopSubproblem(samples, executor, SEEDS), state)
        if found:
            steps += found
            state = found[-1].after
    list(scheduled(executor, steps))
    if has_compiled():
        # What only some scenes ask is compiled with the rest; loaded it is when it is asked for.
        _warm_up_rare(world, rng)
    kept.write()


def _warm_up_rare(world: TabletopWorld, rng: np.random.Generator) -> None:
    """The same for drives of some robots, lanes where the base cannot turn, solids that are no
    boxes, ways of the arm that are not simple, and motions that stop at corners."""
    robot = world.robot
    start, goal = (0.0, 0.0, 0.0), (0.5, 0.3, 1.0)
    if robot.base.type != "fixed":
        drives(
            robot, start, goal, np.array([start, goal]), True, world.statics, world.roads.clearance
        )
    body = robot.body(0.05)
    placed = np.zeros((len(body.frame), 3, 4))
    arm.body_collides(body, placed, boxes_only(world.statics), 0.01)
    within_reach(world.statics, 0.0, 0.0, 1.0)
    world.roads.lane((0.62, 0.0, 0.0))
    world.roads.graph.route((0.0, 0.0), (3.0, 0.0))  # around a table
    world.room.contains(0.0, 0.0)
    stand((0.5, 0.1), (0.6, 0.1), (0.0, 0.0), 0.1, 0.2, 0.3)
    context = ArmContext(robot, body, world.statics)
    rrt.staged(context, robot.home, robot.home * 0.999)
    path = rrt.rrt_connect(context, robot.home, robot.home * 0.999, 1, 0.1)
    if path is not None:
        rrt.shorten(context, np.vstack([path, path[::-1], path]), rng)
    with_stops(np.array([robot.home, robot.home * 0.999, robot.home]), arm_limits(robot))


def _first(subproblem: TabletopSubproblem, state: State) -> list[Step]:
    """The first move and the first manipulation that are executable; none where none are."""
    for action, after in subproblem.actions(state):
        motion = subproblem.execute(state, action)
        if isinstance(motion, Rejection):
            continue
        for second, end in subproblem.actions(after):
            if end.held == after.held:
                continue
            found = subproblem.execute(after, second)
            if not isinstance(found, Rejection):
                return [Step(action, motion, state, after), Step(second, found, after, end)]
    return []


def _scene() -> Scene:
    tables = [UprightBox((x, 0.0, 0.38), (0.6, 1.0, 0.76)) for x in (1.0, -1.0)]
    objects = [standing_box(f"o{i}", (0.04, 0.04, 0.2), (0.9, 0.1 * i, 0.0), 0) for i in range(2)]
    return scene_of_boxes(
        name="warm-up",
        robot_start=(0.0, 0.0, 0.0),
        surfaces=[Surface(f"t{i}", box, (0.3, 0.5), 0.762) for i, box in enumerate(tables)],
        obstacles=[Obstacle(f"t{i}", box) for i, box in enumerate(tables)],
        objects=objects,
        goals={0: RegionGoal(1), 1: RegionGoal(1)},
        word=None,
        digest="warm-up",
    )
