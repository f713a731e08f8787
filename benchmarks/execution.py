"""The tables of `docs/execution.md`.

python -m benchmarks.execution open [SCENE...]
python -m benchmarks.execution closed [KIND...]
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from time import perf_counter

import numpy as np

from benchmarks.carried_out import SKETCH, carried_out, trace_of
from domains.tabletop.actions.document import document
from domains.tabletop.loop.closed_loop import ClosedLoop
from domains.tabletop.loop.disturb import KINDS
from domains.tabletop.problem import TabletopProblem
from domains.tabletop.scene.load import load_scene
from domains.tabletop.world import TabletopWorld
from runtime.bench.paper import SCENES
from runtime.plan.model import Plan
from runtime.robot.load import DEFAULT_ROBOT, load_robot
from runtime.search.limits import Limits
from runtime.search.retreat import lazy_siiw_r
from runtime.trace.model import Trace
from runtime.trace.sketch import load_trace_sketch
from sketchlang.compile import compile_sketch
from sketchlang.library import find_scene
from sketchlang.loader import load_sketch


def planned(scene_name: str, seed: int) -> Trace:
    """The trace of a plan made now, for the first built-in robot."""
    path, name = find_scene(scene_name)
    scene, robot = load_scene(path, name), load_robot(DEFAULT_ROBOT)
    world = TabletopWorld.of(scene, robot)
    compiled = compile_sketch(load_sketch(SKETCH).checked)
    problem = TabletopProblem(world, seed)
    outcome = lazy_siiw_r(compiled, problem, Limits(timeout=300.0), np.random.default_rng(seed))
    assert outcome.solved, f"{scene_name}, seed {seed}: {outcome.reason}"
    plan: Plan = document(world, compiled.model, outcome, "lazy-siiw-r", seed, problem.executor)
    return trace_of(world, plan)


def open_loop(scenes: Sequence[str] = SCENES, seeds: Sequence[int] = range(5)) -> None:
    """Execute plans of all scenes, and print a row for each scene."""
    print("| scene | plans | executed well | objects | largest error | median error | slips |"
          " touches | simulated | x real time |")  # fmt: skip
    print("|---|---|---|---|---|---|---|---|---|---|")
    exceptions = []
    for scene in scenes:
        errors: list[float] = []
        well = slips = touches = 0
        simulated = wall = 0.0
        for seed in seeds:
            trace = planned(scene, seed)
            started = perf_counter()
            report, _ = carried_out(trace)
            wall += perf_counter() - started
            simulated += report.duration
            errors += [pose.error for pose in report.objects]
            well += report.success
            slips += len(report.slips)
            touches += len(report.touches)
            if not report.success or report.slips or report.touches:
                far = [f"{p.object} {1000 * p.error:.0f} mm" for p in report.objects if not p.near]
                what = [f"{s.time:.1f} s {s.object} {s.what}" for s in report.slips]
                what += [f"{t.time:.1f} s {t.link} touches {t.thing}" for t in report.touches]
                exceptions.append(f"{scene}, seed {seed}: {[*report.unmet, *far, *what]}")
        print(
            f"| {scene} | {len(seeds)} | {well} | {len(errors)} | {1000 * max(errors):.1f} mm |"
            f" {1000 * float(np.median(errors)):.2f} mm | {slips} | {touches} |"
            f" {simulated:.0f} s | {simulated / wall:.0f} |",
            flush=True,
        )
    print("\n".join(["", *exceptions]))


def closed_loop(kinds: Sequence[str] = KINDS, seeds: Sequence[int] = range(10)) -> None:
    """Execute the sketch in `sorting/4t-07` with each kind of disturbance."""
    path, name = find_scene("sorting/4t-07")
    scene, robot = load_scene(path, name), load_robot(DEFAULT_ROBOT)
    compiled = compile_sketch(load_sketch(SKETCH).checked)
    text = load_trace_sketch(SKETCH)
    print("| disturbance | runs | disturbed | goal reached | touches of sensed objects | subplans |"
          " broken off | time |")  # fmt: skip
    print("|---|---|---|---|---|---|---|---|")
    exceptions = []
    for kind in kinds:
        verdicts, disturbances = [], 0
        for seed in seeds:
            verdict, trace = ClosedLoop(compiled, text, scene, robot, seed, kind).run()
            verdicts.append(verdict)
            events = trace.events if trace is not None else ()
            disturbances += any(event.kind == "disturbance" for event in events)
            what = [] if verdict.reason is None else [verdict.reason]
            what += [f"{t.time:.1f} s {t.link} touches {t.thing}" for t in verdict.touches]
            if what:
                happened = [f"{e.time:.1f} s {e.text}" for e in events if e.kind == "disturbance"]
                exceptions.append(f"{kind}, seed {seed}: {what}, after {happened}")
        count = len(verdicts)
        print(
            f"| {kind} | {count} | {disturbances} | {sum(v.goal_reached for v in verdicts)} |"
            f" {sum(len(v.touches) for v in verdicts)} |"
            f" {sum(v.subplans for v in verdicts) / count:.1f} |"
            f" {sum(v.broken_off for v in verdicts) / count:.1f} |"
            f" {sum(v.duration for v in verdicts) / count:.0f} s |",
            flush=True,
        )
    print("\n".join(["", *exceptions]))


if __name__ == "__main__":
    command, *names = [*sys.argv[1:], "open"][: max(1, len(sys.argv) - 1)]
    if command == "closed":
        closed_loop(names or KINDS)
    else:
        open_loop(names or SCENES)
