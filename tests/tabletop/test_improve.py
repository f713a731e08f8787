"""Improved plans: never longer, runs of the sketch, valid, and the same for the same seed."""

from __future__ import annotations

import numpy as np
import pytest

from domains.tabletop.actions.actions import Pick, Place
from domains.tabletop.actions.retrace import retrace
from domains.tabletop.bound import execution_bound
from domains.tabletop.improve.changes import Changer, about, detour
from domains.tabletop.improve.runs import Workshop, jobs_of
from domains.tabletop.problem import TabletopProblem
from domains.tabletop.state import BasePose
from runtime.improve import Improvement
from runtime.judge.certify import certify
from runtime.judge.run_of_sketch import Snapshots, moment_faults, run_faults
from runtime.plan.write import to_json
from runtime.search.guide import Guide
from runtime.search.limits import Limits
from runtime.solve import Result, Task, open_task
from sketchlang.errors import InputError
from sketchlang.loader import load_sketch


def opened(scene: str, seed: int = 0, robot: str | None = None) -> Task:
    return open_task(load_sketch("pick_and_place").checked, scene, seed, robot)


def improved(scene: str, steps: int, robot: str | None = None) -> tuple[Result, list[float]]:
    """A plan after so many changes were tried, and the times of all that were better."""
    told: list[float] = []
    result = opened(scene, robot=robot).solve(
        Limits(timeout=120.0), improve=Improvement(steps=steps), told=lambda _, s: told.append(s)
    )
    assert result.solved
    return result, told


@pytest.fixture(scope="module")
def sorted_sticks() -> tuple[Result, list[float]]:
    return improved("sorting/3t-02", 40)


def problem_of(result: Result) -> TabletopProblem:
    assert isinstance(result.task.problem, TabletopProblem)
    return result.task.problem


def faults(result: Result) -> list[str]:
    problem, plan = problem_of(result), result.plan.plan  # type: ignore[attr-defined]
    seen = Snapshots(plan)
    world = problem.world
    certificate = certify(plan, world.scene.world, world.robot, seen)
    moments = retrace(plan, world, result.task.sketch)
    found = [finding.message for finding in certificate.findings]
    found += run_faults(plan, result.task.sketch.model, moments)
    return [*found, *moment_faults(moments, seen.moments)]


def test_each_better_plan_is_shorter_and_the_last_one_is_what_comes_out(sorted_sticks) -> None:
    result, told = sorted_sticks
    first = opened("sorting/3t-02").solve(Limits(timeout=120.0)).plan.execution_time
    assert told == sorted(told, reverse=True)
    assert told, "some change in forty is for the better"
    assert told[0] < first
    assert result.plan.execution_time == pytest.approx(told[-1], abs=1e-6)


def test_it_is_valid_and_a_run_of_the_sketch(sorted_sticks) -> None:
    assert faults(sorted_sticks[0]) == []


def test_the_same_seed_and_steps_give_the_same_plan(sorted_sticks) -> None:
    again, _ = improved("sorting/3t-02", 40)
    one, other = (to_json(r.plan.plan) for r in (again, sorted_sticks[0]))  # type: ignore[attr-defined]
    assert one == other


def test_no_plan_is_quicker_than_the_bound(sorted_sticks) -> None:
    result, _ = sorted_sticks
    bound = result.plan.execution_lower_bound
    assert bound is not None
    assert 0 < bound < result.plan.execution_time


@pytest.mark.slow
@pytest.mark.parametrize(
    "scene", ["words/tamp", "words/robot", "sorting/4t-07", "non_monotonic/2t-11", "desk/low"]
)
def test_no_plan_of_any_seed_is_quicker_than_the_bound(scene) -> None:
    robot = "ur5e_desk" if scene == "desk/low" else None
    for seed in range(6):
        task = opened(scene, seed, robot)
        result = task.solve(Limits(timeout=120.0))
        assert result.solved
        found = result.plan
        assert found.execution_lower_bound <= found.execution_time
        grips = sum(isinstance(a, Pick | Place) for s in result.outcome.subgoals for a in s.actions)
        world = problem_of(result).world
        if world.words is not None:  # there it is grips alone
            assert found.execution_lower_bound <= grips * world.robot.gripper.time


def test_nothing_is_bounded_where_all_is_done(sorted_sticks) -> None:
    problem = problem_of(sorted_sticks[0])
    assert execution_bound(problem.world, sorted_sticks[0].outcome.state) == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["non_monotonic/2t-11", "words/robot", "kitchen/tidy"])
def test_more_scenes(scene) -> None:
    result, told = improved(scene, 60)
    assert told
    assert faults(result) == []


def test_an_arm_that_does_not_drive() -> None:
    result, _ = improved("desk/low", 15, "ur5e_desk")
    assert faults(result) == []


def test_interrupted_it_gives_the_best_so_far() -> None:
    def stop(_: int, __: float) -> None:
        raise KeyboardInterrupt

    task = opened("sorting/3t-02")
    result = task.solve(Limits(timeout=120.0), improve=Improvement(steps=40), told=stop)
    assert result.solved
    assert result.improved is not None
    assert result.improved.tried < 40
    assert faults(result) == []


def test_plans_without_execution_times_cannot_be_improved() -> None:
    task = open_task(load_sketch("delivery_s1").checked, "delivery/one")
    with pytest.raises(InputError, match="no execution time"):
        task.solve(improve=Improvement(steps=3))


# -- runs -----------------------------------------------------------------------------------------


def test_a_run_in_another_order_is_validated_anew() -> None:
    """Of a plan as it was found: an improved one may have other postures of the arm."""
    result = opened("sorting/3t-02").solve(Limits(timeout=120.0))
    problem, found = problem_of(result), result.outcome.subgoals
    start = problem.initial
    workshop = Workshop(problem.executor, Guide(result.task.sketch), start, found)
    jobs = jobs_of(start, found)
    run = workshop.run_of(jobs, np.inf)
    assert run is not None
    assert run.seconds == pytest.approx(result.plan.execution_time)
    assert workshop.run_of(jobs, run.seconds) is None, "no better than before"
    assert workshop.run_of(jobs[::-1], np.inf) is None, "placed before it was picked"
    assert workshop.run_of(jobs[:2], np.inf) is None, "not at the goal"
    turned = workshop.run_of(jobs[2:] + jobs[:2], np.inf)
    if turned is not None:
        firsts = [subgoal.before for subgoal in turned.subgoals]
        assert firsts[0] == found[0].before


def test_changes_keep_what_is_picked_and_placed(sorted_sticks) -> None:
    result, _ = sorted_sticks
    problem, found = problem_of(result), result.outcome.subgoals
    start = problem.initial
    run = Workshop(problem.executor, Guide(result.task.sketch), start, found).run_of(
        jobs_of(start, found), np.inf
    )
    assert run is not None
    changer = Changer(problem.sampler, start, np.random.default_rng(0))
    drawn = [jobs for jobs in (changer.draw(run) for _ in range(60)) if jobs is not None]
    assert len(drawn) > 20
    for jobs in drawn:
        assert sorted(job.handled for job in jobs) == sorted(job.handled for job in run.jobs)
        kinds = [type(job.actions[-1]) for job in jobs]
        assert kinds == [Pick, Place] * (len(jobs) // 2)
        assert jobs != run.jobs


def test_driving_is_estimated_by_way_and_turns(robot) -> None:
    here, ahead, aside = BasePose.of(0, 0, 0), BasePose.of(1, 0, 0), BasePose.of(0, 1, 0)
    base = robot.base
    assert about(base, here, here) == 0
    assert about(base, here, ahead) < about(base, here, aside)
    assert about(base, ahead, here) == pytest.approx(about(base, here, ahead)), "backwards"
    assert detour(base, here, ahead, None) == about(base, here, ahead)
