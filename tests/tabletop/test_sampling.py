"""A: what is sampled can be used, and X: what is executable is free of contact."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from domains.tabletop.actions.actions import MoveBase, Pick, Place
from domains.tabletop.problem import TabletopProblem
from domains.tabletop.state import SIDE, BasePose, Grasp, Placement, State
from domains.tabletop.subproblem import TabletopSubproblem
from domains.tabletop.world import TabletopWorld
from runtime.judge.contacts import Exact, Track
from runtime.judge.skeleton import Skeleton
from runtime.motion.motion import ArmMove, BaseMove, GripperMove
from runtime.search.problem import Rejection
from tests.runtime.reference import (
    Floats,
    corners,
    fcl_touch,
    solid_box,
    upright_pose,
    upright_row,
)
from tests.tabletop.tasks import AT, ON_RIGHT, problem, stick

SEEDS = range(3)
ATTEMPTS = range(3)


@pytest.fixture
def crowded(tmp_path: Path) -> TabletopProblem:
    """Five sticks close together, two of which go to the other table."""
    places = [(0.75, 0.55), (0.82, 0.62), (0.7, 0.7), (0.9, 0.5), (0.8, 0.75)]
    entries = [stick(f"o{i}", x, y) for i, (x, y) in enumerate(places)]
    entries += [stick("p", 0.8, -0.9), ON_RIGHT.format("o0"), AT.format("o1", 0.9, -0.8)]
    return problem(tmp_path, *entries)


def subproblems(the: TabletopProblem, state: State) -> list[TabletopSubproblem]:
    return [
        the.subproblem(state, attempt, np.random.default_rng(seed))
        for attempt, seed in itertools.product(ATTEMPTS, SEEDS)
    ]


def held_states(the: TabletopProblem) -> list[State]:
    return [Pick(i, Grasp.of(0.3 * i, 0.12)).after(the.initial) for i in (0, 1, 3)]


def row_of(world: TabletopWorld, index: int, placement: Placement) -> Floats:
    """The box of an object, from its size in the scene (8,)."""
    x, y, yaw = placement.pose
    size = np.array(world.scene.objects[index].size)
    z = world.grounds[placement.support].height + size[2] / 2
    return upright_row(np.array([x, y, z]), size / 2, yaw)


def width_of(world: TabletopWorld, index: int, grasp: Grasp) -> float:
    """How wide an object is across a grasp from the side."""
    sx, sy, _ = world.scene.objects[index].size
    return sx * abs(math.sin(grasp.heading)) + sy * abs(math.cos(grasp.heading))


def placements(the: TabletopProblem) -> list[tuple[State, Placement]]:
    found = []
    for state in held_states(the):
        for subproblem in subproblems(the, state):
            found += [(state, placement) for placement in subproblem.samples.places]
    assert len(found) > 50
    return found


def test_sampled_placements_are_inside_their_surface(crowded) -> None:
    for state, placement in placements(crowded):
        ground = crowded.world.grounds[placement.support]
        row = row_of(crowded.world, state.held, placement)
        for x, y in corners(upright_pose(row), row[3:6])[:, :2]:
            assert ground.contains(x, y)


def test_sampled_placements_touch_nothing_that_stands(crowded) -> None:
    task = crowded.world
    for state, placement in placements(crowded):
        box = row_of(task, state.held, placement)
        for j, other in enumerate(state.placements):
            if other is not None:
                row = row_of(task, j, other)
                assert not fcl_touch(upright_pose(box), box[3:6], upright_pose(row), row[3:6])


def test_sampled_base_poses_are_free_of_contact(crowded) -> None:
    task = crowded.world
    skeleton, exact = Skeleton(task.robot), Exact()
    poses = {
        action.target.pose
        for state in (crowded.initial, *held_states(crowded))
        for subproblem in subproblems(crowded, state)
        for action, _ in subproblem.actions(state)
        if isinstance(action, MoveBase)
    }
    base = np.array(sorted(poses))
    assert len(base) > 20
    base = base[:: math.ceil(len(base) / 60)]  # exact geometry takes its time
    q = np.tile(task.robot.home, (len(base), 1))
    links = skeleton.transforms(base, q, task.robot.gripper.max_opening)
    robot = skeleton.tracks(links)
    world = [
        Track("wall", solid_box(row[3:6]), np.vstack([upright_pose(row), [0, 0, 0, 1]])[None])
        for row in task.statics
    ]
    assert exact.first_hit([(a, b) for a in robot for b in world]) is None


def test_sampled_grasps_fit_the_gripper(crowded) -> None:
    task = crowded.world
    for subproblem in subproblems(crowded, crowded.initial):
        for index, grasps in subproblem.samples.picks:
            for grasp in grasps:
                width = width_of(task, index, grasp)
                assert width + 2 * task.robot.gripper.clearance <= task.robot.gripper.max_opening


@pytest.mark.parametrize("yaw", [0.0, 30.0])
def test_grasps_along_the_sides_come_first(tmp_path, yaw) -> None:
    """Wherever one of them is free, fingers lie flat."""
    the = problem(tmp_path, stick("a", 0.8, 0.6, f"yaw = {yaw}"), ON_RIGHT.format("a"))
    narrowest = min(the.world.scene.objects[0].size[:2])
    for seed in SEEDS:
        ((_, grasps),) = the.subproblem(the.initial, 0, np.random.default_rng(seed)).samples.picks
        widths = [width_of(the.world, 0, grasp) for grasp in grasps]
        flat = [width == pytest.approx(narrowest, abs=1e-4) for width in widths]
        assert flat[0]
        assert flat == sorted(flat, reverse=True)


def test_few_grasps_get_several_base_poses(tmp_path) -> None:
    the = problem(tmp_path, stick("a", 0.8, 0.6), ON_RIGHT.format("a"))
    samples = the.subproblem(the.initial, 0, np.random.default_rng(0)).samples
    ((_, grasps),) = samples.picks
    assert len(samples.bases) > len(grasps) > 0


def test_other_objects_are_picked_up_only_after_all_else_has_failed(crowded) -> None:
    """With an object in the gripper: first the object itself, gripped anew."""
    state = held_states(crowded)[0]
    for attempt in range(5):
        samples = crowded.subproblem(state, attempt, np.random.default_rng(0)).samples
        others = {index for index, _ in samples.picks} - {state.held}
        assert bool(others) == (attempt > 2)
        assert (samples.placed is None) == (attempt > 2)


def test_actions_lead_where_the_state_says(crowded) -> None:
    for state in (crowded.initial, *held_states(crowded)):
        kinds = set()
        for subproblem in subproblems(crowded, state):
            for action, after in subproblem.actions(state):
                kinds.add(type(action))
                assert after == action.after(state)
        assert MoveBase in kinds
        assert (Place in kinds) <= (state.held is not None)
        assert (Pick in kinds) <= (state.held is None)


def test_the_same_generator_gives_the_same_samples(crowded) -> None:
    for attempt in ATTEMPTS:
        state = crowded.initial
        one, two = (
            crowded.subproblem(state, attempt, np.random.default_rng(5)).samples for _ in range(2)
        )
        assert (one.bases, one.picks, one.places) == (two.bases, two.picks, two.places)


def test_a_failed_subproblem_is_sampled_more_densely(crowded) -> None:
    sizes = []
    for attempt in range(4):
        samples = crowded.subproblem(crowded.initial, attempt, np.random.default_rng(0)).samples
        sizes.append(sum(len(grasps) for _, grasps in samples.picks) + len(samples.bases))
    assert sizes[-1] > 2 * sizes[0]


def test_in_arm_workspace_is_an_annulus_for_the_wrist(crowded, rng) -> None:
    task, executor = crowded.world, crowded.executor
    base = crowded.initial.base
    height = task.grounds[0].height + 0.12
    wrist_offset, inner, outer = task.hand.workspace(SIDE, height)
    x, y, yaw = base.pose
    axis = np.array([x, y]) + np.array(
        [
            math.cos(yaw) * task.shoulder[0] - math.sin(yaw) * task.shoulder[1],
            math.sin(yaw) * task.shoulder[0] + math.cos(yaw) * task.shoulder[1],
        ]
    )
    targets = [
        (0, Placement.of(x + dx, y + dy, turn, 0), Grasp.of(angle, 0.12))
        for dx, dy, turn, angle in zip(
            *rng.uniform(-1.2, 1.2, (2, 300)), *rng.uniform(-3, 3, (2, 300)), strict=True
        )
    ]
    expected = []
    for target in targets:
        px, py, turn = target[1].pose
        heading = turn + target[2].heading
        wrist = np.array([px, py]) - wrist_offset * np.array([math.cos(heading), math.sin(heading)])
        if inner <= np.linalg.norm(wrist - axis) <= outer:
            expected.append(target)
    before = crowded.profile.in_arm_workspace.calls
    assert executor.in_arm_workspace(crowded.initial, base, targets) == expected
    assert 0 < len(expected) < len(targets)
    assert crowded.profile.in_arm_workspace.calls == before + len(targets)


def first_pick(the: TabletopProblem) -> tuple[State, Pick, TabletopSubproblem]:
    """A sampled base move followed by a sampled pick that is executable."""
    for seed in range(10):
        subproblem = the.subproblem(the.initial, 0, np.random.default_rng(seed))
        for move, state in subproblem.actions(the.initial):
            if not isinstance(move, MoveBase) or isinstance(
                subproblem.execute(the.initial, move), Rejection
            ):
                continue
            for action, _ in subproblem.actions(state):
                if not isinstance(action, Pick):
                    continue
                if not isinstance(subproblem.execute(state, action), Rejection):
                    return state, action, subproblem
    raise AssertionError("no pick is executable")


def test_motions_start_and_end_at_home_and_go_on_where_they_were(crowded) -> None:
    state, action, subproblem = first_pick(crowded)
    motion = subproblem.execute(state, action)
    assert not isinstance(motion, Rejection)
    arm = [piece for piece in motion if isinstance(piece, ArmMove)]
    home = crowded.world.robot.home
    assert arm[0].path[0] == pytest.approx(home)
    assert arm[-1].path[-1] == pytest.approx(home)
    for before, after in itertools.pairwise(arm):
        assert after.path[0] == pytest.approx(before.path[-1])
    attached = [p.attach for p in motion if isinstance(p, GripperMove) and p.attach is not None]
    assert [a.body for a in attached] == [crowded.world.scene.objects[action.object].name]


def test_the_same_question_has_the_same_motion_whatever_was_asked_before(crowded, tmp_path) -> None:
    state, action, subproblem = first_pick(crowded)
    motion = subproblem.execute(state, action)
    assert not isinstance(motion, Rejection)
    for seed in range(3):  # other questions
        other = crowded.subproblem(crowded.initial, 1, np.random.default_rng(seed))
        for move, _ in other.actions(crowded.initial)[:5]:
            other.execute(crowded.initial, move)
    again = subproblem.execute(state, action)
    assert not isinstance(again, Rejection)
    for one, two in zip(motion, again, strict=True):
        if isinstance(one, ArmMove):
            assert np.array_equal(one.path, two.path)


def test_driving_to_where_one_cannot_stand_is_not_executable(crowded) -> None:
    subproblem = crowded.subproblem(crowded.initial, 0, np.random.default_rng(0))
    table = BasePose.of(0.8, 0.6, 0.0)
    refused = subproblem.execute(crowded.initial, MoveBase(table))
    assert refused == Rejection("motion_plan", "base")
    home = subproblem.execute(crowded.initial, MoveBase(BasePose.of(-0.6, 0.0, 1.0)))
    assert not isinstance(home, Rejection)
    assert isinstance(home[0], BaseMove)
    assert home[0].poses[-1, :2] == pytest.approx([-0.6, 0.0])


def test_every_step_of_x_is_counted(crowded) -> None:
    first_pick(crowded)
    profile = crowded.reporting.profile()
    assert list(profile) == ["in_arm_workspace", "inverse_kinematics", "motion_plan"]
    for step in profile.values():
        assert 0 < step["successes"] <= step["calls"]
        assert step["time_s"] > 0


def test_warming_up_leaves_no_trace_in_the_profile(crowded) -> None:
    crowded.reporting.warm_up()
    assert all(step["calls"] == 0 for step in crowded.reporting.profile().values())
