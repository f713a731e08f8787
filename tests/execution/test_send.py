"""Plans sent to a robot behind a rosbridge server, which fails where it is told to."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner

pytest.importorskip("roslibpy")
pytest.importorskip("websockets")

from runtime.export.goals import joint_track
from runtime.export.resume import from_rest, resumed
from runtime.export.rosbridge import answer_of
from runtime.export.steps import steps_of
from runtime.trace.track import Track
from sketchlang.cli import cli
from sketchlang.errors import InputError
from tests.execution.rosbridge_robot import Robot


@pytest.fixture
def plan_file(in_turn_file):
    """TIAGo's base keeps no times: what is sent to it is a plan in turn."""
    return in_turn_file


@pytest.fixture
def trace(in_turn):
    return in_turn


def posture(trace, time: float) -> dict[str, float]:
    names = [name for each in trace.robot.controllers for name in each.joints]
    now = np.array([time])
    return {name: float(joint_track(trace, name).at(now)[0][0, 0]) for name in names}


@pytest.fixture
def robot(trace):
    robot = Robot(trace.robot.controllers, posture(trace, 0.0))
    server = robot.serve()
    robot.url = f"ws://127.0.0.1:{server.socket.getsockname()[1]}"
    yield robot
    server.shutdown()


def send(plan_file, robot, *options: str):
    words = ["send", str(plan_file), "--rosbridge", robot.url, *options]
    return CliRunner().invoke(cli, words)


def ended_well(trace, robot) -> None:
    """The robot is where the plan ends."""
    wanted = posture(trace, trace.duration)
    assert robot.values == pytest.approx(wanted, abs=1e-5)
    assert robot.base == pytest.approx(trace.base.values[-1][:2], abs=1e-5)


def test_a_plan_is_carried_out(plan_file, trace, robot) -> None:
    done = send(plan_file, robot)
    assert done.exit_code == 0, done.output
    ended_well(trace, robot)
    assert len(robot.goals) == sum(len(step.goals) for step in steps_of(trace))


@pytest.mark.parametrize("kind", ["arm_controller", "gripper_controller", "base"])
def test_it_stops_at_a_failure_and_goes_on_from_there(plan_file, trace, robot, kind) -> None:
    steps = steps_of(trace)
    wanted = [s for s in steps if kind in [goal.controller.name for goal in s.goals]]
    step = wanted[len(wanted) // 2]
    before = sum(len(each.goals) for each in steps[: step.number])
    names = [goal.controller.name for goal in step.goals]
    robot.together = range(before, before + len(names))
    robot.fails = before + names.index(kind)

    stopped = send(plan_file, robot)
    assert stopped.exit_code == 1
    assert f"stopped at step {step.number}: {kind}: path tolerance violated" in stopped.output
    assert f"--from {step.number}" in stopped.output
    assert len(robot.goals) == before
    # What was moving with it was told to stop.
    others = [g.controller.action for g in step.goals if g.controller.name != kind]
    assert robot.cancelled == others

    again = send(plan_file, robot, "--from", str(step.number))
    assert again.exit_code == 0, again.output
    ended_well(trace, robot)


def test_a_robot_that_is_elsewhere_gets_nothing(plan_file, robot) -> None:
    robot.values["arm_2_joint"] += 0.3
    done = send(plan_file, robot)
    assert done.exit_code == 1
    assert "arm_2_joint" in done.output
    assert robot.goals == []


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--rosbridge", "http://x"], "no address"),
        (["--rosbridge", "ws://127.0.0.1:99999"], "no address"),
        ([], "either"),
        (["--dry-run", "--from", "9999"], "no step 9999"),
    ],
)
def test_mistakes_are_said_in_one_line(plan_file, words, said) -> None:
    done = CliRunner().invoke(cli, ["send", str(plan_file), *words])
    assert done.exit_code == 2
    assert said in done.output
    assert len(done.output.splitlines()) <= 2


def test_a_base_that_keeps_no_times_gets_no_arm_beside_it(overlapping, robot) -> None:
    done = send(overlapping, robot)
    assert done.exit_code == 2
    assert "--in-turn" in done.output
    assert robot.goals == []
    assert send(overlapping, robot, "--untimed").exit_code == 0


def test_half_a_plan_is_not_sent(plan_data, tmp_path) -> None:
    plan_data["failure"] = {"reason": "no way", "stuck": {}, "why": []}
    half = tmp_path / "plan.unsolved.json"
    half.write_text(json.dumps(plan_data))
    done = CliRunner().invoke(cli, ["send", str(half), "--dry-run"])
    assert done.exit_code == 2
    assert "does not reach its goal" in done.output


def test_a_dry_run_lists_the_steps(plan_file, trace) -> None:
    done = CliRunner().invoke(cli, ["send", str(plan_file), "--dry-run"])
    assert done.exit_code == 0
    assert len(done.output.splitlines()) == len(steps_of(trace)) + 1


@pytest.mark.parametrize("since", [0.0, 0.3, 1.0, 1.9, 2.0])
def test_the_rest_of_a_motion_starts_and_ends_at_rest(since) -> None:
    motion = Track(np.array([0.0, 1.0, 2.0]), np.array([[0.0], [0.5], [1.0]]), np.zeros((3, 1)))
    motion.velocities[1] = 0.8
    here = motion.at(np.array([since]))[0][0] + 0.03
    rest = from_rest(motion, since, here)
    assert rest.values[0] == pytest.approx(here)
    assert rest.values[-1] == pytest.approx([1.0])
    assert rest.velocities[[0, -1]] == pytest.approx(0.0)
    times = np.linspace(0, rest.times[-1], 2000)
    values, velocities = rest.at(times)
    assert np.abs(velocities).max() < 0.9
    # The velocities are those of the values, knots included.
    assert np.abs(np.gradient(values[:, 0], times) - velocities[:, 0]).max() < 0.02


def test_no_step_is_resumed_from_beside_its_path(trace) -> None:
    step = next(s for s in steps_of(trace) if "arm_controller" in str(s.goals))
    found = posture(trace, (step.start + step.end) / 2)
    on_the_way = resumed(trace, step, found, "map")
    assert on_the_way.goals[0].motion.times[-1] < step.duration
    with pytest.raises(InputError, match=f"not where step {step.number} starts"):
        resumed(trace, step, {**found, "arm_1_joint": found["arm_1_joint"] + 0.5}, "map")


@pytest.mark.parametrize(
    ("result", "succeeded", "said"),
    [
        ({"status": 4, "values": {"error_code": 0}}, True, ""),
        ({"status": 4, "values": {"result": {"error_code": -5, "error_string": "x"}}}, False, "x"),
        ({"status": 4, "values": {"error_code": -5}}, False, "error -5"),
        ({"status": 6, "values": {}}, False, "the goal was aborted"),
        ({"status": 0, "values": "no such action"}, False, "no such action"),
    ],
)
def test_results_are_understood(result, succeeded, said) -> None:
    answer = answer_of(result)
    assert answer.succeeded == succeeded
    assert said in answer.reason
