"""How long a robot stands still when something has changed: the table of `docs/execution.md`.

python -m benchmarks.reflex [SCENE...] [--seeds N]

A sketch is run subgoal by subgoal, as in the closed loop but without physics. Before each subgoal
that starts with an empty hand something happens, in turn: an object has been pushed by 3 to 8 cm,
every object has been moved by a hair (3 mm, 30 mrad), or a box of 25 x 25 x 60 cm stands on the
floor. Measured is processor time from the state that is sensed to the motion of the next subplan:
the new world where it has changed, features, sampling, search and X.
"""

from __future__ import annotations

import argparse
import math
from collections import defaultdict
from collections.abc import Sequence
from time import process_time

import numpy as np

from domains.tabletop.features import swept
from domains.tabletop.features.functions import arrangement
from domains.tabletop.loop.subplan import next_subgoal
from domains.tabletop.problem import TabletopProblem
from domains.tabletop.scene.load import load_scene
from domains.tabletop.scene.model import Obstacle, UprightBox
from domains.tabletop.state import Placement, State
from domains.tabletop.world import TabletopWorld
from runtime.robot.load import DEFAULT_ROBOT, load_robot
from runtime.search.guide import Guide
from runtime.search.limits import Limits
from sketchlang.compile import compile_sketch
from sketchlang.errors import InputError
from sketchlang.library import find_scene
from sketchlang.loader import load_sketch

SKETCH, SCENES = "pick_and_place", ("sorting/4t-28",)
KINDS = ("nothing", "pushed", "noise", "obstacle")
PUSHED = 0.03, 0.08
NOISE = 0.003, 0.03
BOX = (0.25, 0.25, 0.6)
TRIES = 50
ROUNDS = 200


def pushed(state: State, rng: np.random.Generator) -> State:
    """Some object has been pushed to where there is room for it."""
    here = arrangement(state.world, state.placements)
    for _ in range(TRIES):
        index = int(rng.integers(len(state.placements)))
        placement = state.placements[index]
        if placement is None:
            continue
        bearing, way = rng.uniform(0, 2 * math.pi), rng.uniform(*PUSHED)
        x, y, yaw = placement.pose
        moved = x + way * math.cos(bearing), y + way * math.sin(bearing)
        ground, item = state.world.grounds[placement.support], state.world.items[index]
        site = np.array([[*moved, ground.height]])
        room = np.array([item.outer_radius, item.size[2]])
        if ground.contains(*moved) and not swept.occupied_sites(site, room, here.boxes, index)[0]:
            return state.placed(index, Placement.of(*moved, yaw, placement.support))
    return state


def noisy(state: State, rng: np.random.Generator) -> State:
    """Every object is a little elsewhere."""
    placements = []
    for placement in state.placements:
        if placement is not None:
            (x, y, yaw), (dx, dy) = placement.pose, rng.normal(size=2) * NOISE[0]
            turned = yaw + float(rng.normal()) * NOISE[1]
            placement = Placement.of(x + dx, y + dy, turned, placement.support)
        placements.append(placement)
    return State(state.base, tuple(placements), world=state.world)


def obstructed(problem: TabletopProblem, state: State, rng: np.random.Generator) -> TabletopProblem:
    """A problem with a box on the floor, a metre or two from the robot."""
    x, y, _ = state.base.pose
    for number in range(TRIES):
        bearing, away = rng.uniform(0, 2 * math.pi), rng.uniform(1.3, 2.5)
        centre = (x + away * math.cos(bearing), y + away * math.sin(bearing), BOX[2] / 2)
        if not problem.world.room.contains(*centre[:2]):
            continue
        box = Obstacle(f"box{number}", UprightBox(centre, BOX))
        scene = problem.world.scene.with_boxes([box])
        try:
            world = TabletopWorld.of(scene, problem.world.robot, problem.world)
        except InputError:  # the start of the scene is where the box would be
            continue
        return TabletopProblem(world, problem.executor.seed)
    return problem


def measured(scene_name: str, seed: int) -> list[tuple[str, float]]:
    """What happened before each subgoal, and the seconds to the next motion."""
    path, name = find_scene(scene_name)
    scene, robot = load_scene(path, name), load_robot(DEFAULT_ROBOT)
    compiled = compile_sketch(load_sketch(SKETCH).checked)
    problem = TabletopProblem(TabletopWorld.of(scene, robot), seed)
    problem.reporting.warm_up()
    guide, rng, state = Guide(compiled), np.random.default_rng(seed), problem.initial
    found: list[tuple[str, float]] = []
    for number in range(ROUNDS):
        kind = KINDS[(number // 2 + seed) % len(KINDS)] if state.held is None else "nothing"
        if kind == "pushed":
            state = pushed(state, rng)
        elif kind == "noise":
            state = noisy(state, rng)
        begun = process_time()
        if kind == "obstacle":
            problem = obstructed(problem, state, rng)
            state = State(state.base, state.placements, state.held, state.grasp, (), problem.world)
        guide.forget()
        if guide.is_goal(guide.values(state), state):
            break
        subgoal = next_subgoal(guide, problem, state, Limits(timeout=60.0), rng)
        found.append((kind, process_time() - begun))
        if subgoal is None:
            found.append(("given up", 0.0))
            break
        state = subgoal.states[-1]
    return found


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*", default=list(SCENES))
    parser.add_argument("--seeds", type=int, default=10)
    options = parser.parse_args(arguments)
    print("| scene | what happened | subplans | median ms | p95 ms | worst ms |")
    print("|---|---|---|---|---|---|")
    for scene in options.scenes:
        times = defaultdict(list)
        for seed in range(options.seeds):
            for kind, seconds in measured(scene, seed):
                times[kind].append(1000 * seconds)
        for kind, one in sorted(times.items()):
            median, high = np.percentile(one, [50, 95])
            print(f"| {scene} | {kind} | {len(one)} | {median:.0f} | {high:.0f} | {max(one):.0f} |")


if __name__ == "__main__":
    main()
