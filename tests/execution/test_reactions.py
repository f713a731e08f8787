"""What the robot does where something went wrong."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import product
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pybullet")

from domains.tabletop.loop.closed_loop import ClosedLoop
from domains.tabletop.loop.disturb import Disturber
from domains.tabletop.loop.sensing import Senses
from domains.tabletop.loop.watch import Watcher
from domains.tabletop.loop.ways import Ways, enclosing_box
from domains.tabletop.scene.load import load_scene
from domains.tabletop.scene.worlds import find_world
from runtime.physics.execute import lean
from runtime.physics.follow import ARM_BRAKING, Follower
from runtime.physics.recorder import Recorder
from runtime.physics.simulation import Physics
from runtime.robot.load import DEFAULT_ROBOT, load_robot
from runtime.trace.kinematics import Tree, links_at
from runtime.trace.load import load_trace
from runtime.trace.model import Grip, Trace, TraceAction
from runtime.trace.sketch import load_trace_sketch
from runtime.world.quaternions import matrix
from sketchlang.compile import compile_sketch
from sketchlang.library import find_scene
from sketchlang.loader import load_sketch

LYING = (0.0, math.sin(math.pi / 4), 0.0, math.cos(math.pi / 4))
"""A quarter turn about y, as a quaternion: an object on its side, along x."""


class Bench:
    """A simulation that stands at the start of a trace's first pick, and what drives it."""

    def __init__(self, trace: Trace) -> None:
        self.trace, self.robot = trace, load_robot(DEFAULT_ROBOT)
        self.scene = load_scene(*find_scene("sorting/3t-02"))
        self.number = next(i for i, a in enumerate(trace.actions) if a.name == "pick")
        self.pick: TraceAction = trace.actions[self.number]
        self.grip: Grip = next(g for g in trace.grips if g.object == self.pick.object)
        self.physics = Physics(trace.world, trace.robot)
        self.follower = Follower(self.physics, Recorder(self.physics), self.robot.acceleration)
        self.disturber = Disturber("none", 0, self.follower)
        self.senses = Senses(self.physics, self.disturber)
        self.own = self.follower.names.index(self.grip.object)
        self.stand(self.pick.start)

    def stand(self, time: float) -> None:
        """Put base and arm where the trace has them."""
        now = np.array([time])
        values = np.hstack([self.trace.base.at(now)[0][0], self.trace.joints.at(now)[0][0]])
        opening = float(self.trace.opening.at(now)[0][0, 0])
        for index, value in zip(self.physics._motors, values, strict=True):
            self.physics.bullet.resetJointState(self.physics.body, index, float(value))
        for index in self.physics._fingers:
            self.physics.bullet.resetJointState(self.physics.body, index, opening / 2)
        self.follower._target = values

    def lay(self, index: int, x: float, y: float, z: float) -> None:
        """Lay an object on its side, its middle at a point."""
        body = self.physics.objects[index]
        self.physics.bullet.resetBasePositionAndOrientation(body, (x, y, z), LYING)

    def tool(self, time: float) -> np.ndarray:
        """World position (3,) of the grasp centre at a time of the trace."""
        return links_at(self.trace, Tree(self.trace.robot), time)[self.trace.robot.tool][:3, 3]

    def ways(self) -> Ways:
        return Ways(self.robot, self.scene, self.senses, seed=0)

    def watcher(self) -> Watcher:
        seen = self.senses.look()
        scene, disturber = self.scene, self.disturber
        return Watcher(self.trace, self.number, seen, scene, disturber, self.senses, self.ways())

    def loses_it_when_lifted(self) -> Callable[[float], None]:
        """A watcher that sees nothing, and in whose time the fingers lose what they lift."""
        height = self.physics.object_pose(self.own)[2] + 0.01

        def watch(_: float) -> None:
            if self.physics.held is not None and self.follower.held_pose()[2, 3] > height:
                self.lost_at = self.physics.time
                self.follower.lose_grip()

        return watch


def closed_loop(kind: str, seed: int) -> ClosedLoop:
    """One that has not begun, in `sorting/3t-02`."""
    path, name = find_scene("sorting/3t-02")
    scene, robot = load_scene(path, name), load_robot(DEFAULT_ROBOT)
    compiled = compile_sketch(load_sketch("pick_and_place").checked)
    return ClosedLoop(compiled, load_trace_sketch("pick_and_place"), scene, robot, seed, kind)


@pytest.fixture
def bench(plain_file: Path) -> Iterator[Bench]:
    """Closed-loop execution has plans that do one thing after the other."""
    bench = Bench(load_trace(plain_file, find_world))
    yield bench
    bench.physics.close()


def test_a_lost_grasp_stops_the_arm_by_reflex(bench: Bench) -> None:
    watch = bench.loses_it_when_lifted()
    end = bench.follower.follow(bench.trace, watch, bench.pick.start, bench.pick.end)
    assert bench.follower.lost == bench.own
    assert end < bench.pick.end
    assert bench.physics.time - bench.lost_at < ARM_BRAKING + 0.01
    bench.follower.wait(1.0)
    assert lean(matrix(bench.physics.object_pose(bench.own))) < 0.01
    assert not bench.follower.touches


def test_fingers_that_did_not_close_on_anything_do_not_lift(bench: Bench) -> None:
    bench.follower.grasp_fails = lambda: True
    end = bench.follower.follow(bench.trace, lambda _: None, bench.pick.start, bench.pick.end)
    assert bench.follower.lost == bench.own
    assert end < bench.grip.time + 0.1


def test_after_a_drop_the_arm_goes_back_with_open_fingers(bench: Bench) -> None:
    watch = bench.loses_it_when_lifted()
    end = bench.follower.follow(bench.trace, watch, bench.pick.start, bench.pick.end)
    bench.follower.wait(1.0)
    bench.follower.let_fall()
    way = bench.ways().home(bench.trace, bench.pick.start, end)
    assert way is not None
    opening, joints = way
    assert opening > bench.physics.opening() + 0.005
    bench.follower.move_fingers(opening)
    bench.follower.move_arm(bench.trace, joints)
    assert bench.physics.robot_state()[0][3:] == pytest.approx(bench.robot.home, abs=0.01)
    assert not bench.follower.touches


def test_fingers_that_touch_what_they_lost_touch_it_once_it_is_at_rest(
    bench: Bench, monkeypatch
) -> None:
    monkeypatch.setattr("runtime.physics.follow.SPRUNG", -0.002)  # they stay on it
    watch = bench.loses_it_when_lifted()
    bench.follower.follow(bench.trace, watch, bench.pick.start, bench.pick.end)
    bench.follower.wait(0.5)
    assert not bench.follower.touches
    bench.follower.let_fall()
    bench.follower.wait(0.5)
    assert bench.follower.touches


def test_what_lies_on_its_side_is_in_the_way(bench: Bench) -> None:
    closing, other = bench.grip.start - 0.2, 1 - bench.own
    assert bench.ways().on_is_free(bench.trace, bench.pick.start, closing)
    bench.lay(other, *bench.tool(closing - 0.3))
    assert not bench.ways().on_is_free(bench.trace, bench.pick.start, closing)


def test_the_arm_goes_round_what_bars_its_way_back(bench: Bench) -> None:
    end, other = bench.grip.start - 0.1, 1 - bench.own
    straight = bench.ways().home(bench.trace, bench.pick.start, end)
    assert straight is not None
    bench.physics.bullet.changeDynamics(bench.physics.objects[other], -1, mass=0)  # it stays there
    times = np.arange(0.0, end - bench.pick.start, 0.1)
    way = None
    for share, aside in product((0.7, 0.6, 0.8, 0.5, 0.9), (0.0, 0.05, -0.05, 0.1, -0.1)):
        # Somewhere on the way there is room to go round.
        x, y, z = bench.tool(share * bench.pick.start + (1 - share) * end)
        bench.lay(other, x, y + aside, z)
        way = bench.ways().home(bench.trace, bench.pick.start, end)
        if way and not np.allclose(way[1].at(times)[0], straight[1].at(times)[0], atol=0.05):
            break
    else:
        pytest.fail("there is no way round, wherever it lies")
    bench.stand(end)
    bench.follower.move_fingers(way[0])
    bench.follower.move_arm(bench.trace, way[1])
    assert bench.physics.robot_state()[0][3:] == pytest.approx(bench.robot.home, abs=0.01)
    assert not bench.follower.touches


def test_an_arm_in_contact_with_what_fell_has_no_way(bench: Bench) -> None:
    end = bench.grip.start - 0.1
    bench.lay(1 - bench.own, *bench.tool(end))
    assert bench.ways().home(bench.trace, bench.pick.start, end) is None


def test_an_action_goes_on_where_something_moved_elsewhere(bench: Bench) -> None:
    watcher, other = bench.watcher(), 1 - bench.own
    assert watcher(bench.pick.start) is None
    bench.physics.shift(other, np.array([0.0, 0.0, 3.0]))
    assert watcher(bench.pick.start) is None
    assert watcher.surprise == f"{bench.follower.names[other]} has moved"


def test_an_arm_does_not_reach_for_what_has_moved_away(bench: Bench) -> None:
    watcher = bench.watcher()
    bench.physics.shift(bench.own, np.array([0.0, 0.0, 3.0]))
    assert watcher(bench.pick.start) == f"{bench.grip.object} has moved"


def test_what_the_fingers_would_knock_over_has_moved_away_sooner(bench: Bench) -> None:
    """6 mm are more than the fingers' clearance, and less than what matters elsewhere."""
    for index, name in ((1 - bench.own, None), (bench.own, f"{bench.grip.object} has moved")):
        watcher = bench.watcher()
        bench.physics.shift(index, np.array([0.006, 0.0, 0.0]))
        assert watcher(bench.pick.start) == name


def test_a_push_goes_on_whatever_the_robot_does() -> None:
    loop = closed_loop("pushed", 0)
    try:
        loop.follower.wait(0.5)
        stood = loop.physics.object_pose(0)
        loop.disturber._push = (0, np.array([0.0, 1.0, 0.0]), 0.04)
        loop._wait_for_rest()
        moved = loop.physics.object_pose(0) - stood
        assert moved[:3] == pytest.approx([0.0, 0.04, 0.0], abs=0.003)
    finally:
        loop.physics.close()


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.0])
def test_the_box_around_what_stands_or_lies_is_its_own(yaw: float) -> None:
    size = (0.04, 0.05, 0.2)
    c, s = math.cos(yaw), math.sin(yaw)
    turn = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    standing = turn.copy()
    standing[:3, 3] = (1.0, 2.0, 0.7)
    box = enclosing_box(standing, size)
    assert box.centre == pytest.approx((1.0, 2.0, 0.8))
    assert math.prod(box.size) == pytest.approx(math.prod(size))
    assert box.size[2] == pytest.approx(0.2)
    lying = turn @ matrix(np.array([0, 0, 0, *LYING]))
    box = enclosing_box(lying, size)
    assert box.centre == pytest.approx((0.1 * c, 0.1 * s, 0.0))
    assert math.prod(box.size) == pytest.approx(math.prod(size))
    assert box.size[2] == pytest.approx(0.04)


def test_actions_of_one_subplan_are_recorded_under_it(bench: Bench) -> None:
    recorder = bench.follower.recorder
    first = bench.trace.actions[0]
    bench.follower.follow(bench.trace, None, first.start, 0.5)
    bench.follower.follow(bench.trace, None, bench.pick.start, bench.pick.start + 0.5)
    assert len(recorder.subgoals) == len(bench.trace.subgoals)
    assert [action.subgoal for action in recorder.actions] == [first.subgoal, bench.pick.subgoal]
    assert recorder.subgoals[0].end == pytest.approx(bench.physics.time, abs=0.01)


def test_the_robot_waits_until_what_fell_is_at_rest() -> None:
    loop = closed_loop("dropped", 0)
    try:
        loop.physics.step()
        stood = loop.physics.object_pose(0)
        loop.physics.shift(0, np.array([0.0, 0.0, 0.1]))
        loop._wait_for_rest()
        assert loop.physics.object_pose(0)[2] == pytest.approx(stood[2], abs=0.003)
        assert 0.2 < loop.physics.time < 1.0
    finally:
        loop.physics.close()


@pytest.mark.parametrize("seed", [3, 5])
def test_an_object_that_fell_on_its_side_ends_it_untouched(seed: int, monkeypatch) -> None:
    wait = ClosedLoop._wait_for_rest

    def wait_beside_what_fell(loop: ClosedLoop) -> None:
        wait(loop)
        index = loop.follower.lost
        if index is None:  # at rest before it plans anew
            return
        height = loop.physics.object_pose(index)[2] + 0.025
        tool = loop.physics.tool_matrix()
        x, y, _ = tool[:3, 3] + 0.18 * tool[:3, 0]  # in front of the gripper
        body = loop.physics.objects[index]
        loop.physics.bullet.resetBasePositionAndOrientation(body, (x, y, height), LYING)
        wait(loop)

    monkeypatch.setattr(ClosedLoop, "_wait_for_rest", wait_beside_what_fell)
    verdict, _ = closed_loop("dropped", seed).run()
    assert not verdict.goal_reached
    assert verdict.reason is not None
    assert "has fallen" in verdict.reason
    assert not verdict.touches


@pytest.mark.slow
def test_a_subplan_that_was_broken_off_reached_what_was_sensed(monkeypatch) -> None:
    """And each of its actions is recorded once, with the time that it took."""
    loop = closed_loop("failed-grasp", 1)
    verdict, trace = loop.run()
    assert verdict.goal_reached
    assert verdict.broken_off
    assert trace is not None
    for before, after in zip(trace.subgoals[:-1], trace.subgoals[1:], strict=True):
        assert before.after == after.before
    assert trace.subgoals[-1].after["m"] == 0
    assert all(action.end > action.start for action in trace.actions)
    starts = [action.start for action in trace.actions]
    assert starts == sorted(set(starts))


def test_a_search_that_takes_too_long_ends_with_a_verdict(monkeypatch) -> None:
    monkeypatch.setattr("domains.tabletop.loop.closed_loop.PLANNING", 1e-6)
    verdict, _ = closed_loop("none", 0).run()
    assert not verdict.goal_reached
    assert verdict.reason == "no subgoal was found from what was sensed"
