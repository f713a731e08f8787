"""docs/howto-ros.md, executed with a robot that fails in the fifth step, as on the page."""

from __future__ import annotations

import pytest

pytest.importorskip("roslibpy")
pytest.importorskip("websockets")

from runtime.export.steps import steps_of
from tests.execution.rosbridge_robot import Robot
from tests.execution.test_send import posture
from tests.pages import DOCS, run_page


@pytest.mark.slow
def test_the_how_to_for_ros(tmp_path, in_turn) -> None:
    steps = steps_of(in_turn)
    before = sum(len(step.goals) for step in steps[:4])
    robot = Robot(in_turn.robot.controllers, posture(in_turn, 0.0))
    robot.together = range(before, before + len(steps[4].goals))
    robot.fails = before + [g.controller.name for g in steps[4].goals].index("arm_controller")
    server = robot.serve()
    port = server.socket.getsockname()[1]
    try:
        run_page(DOCS / "howto-ros.md", tmp_path, {"localhost:9090": f"127.0.0.1:{port}"})
    finally:
        server.shutdown()
    assert len(robot.goals) == sum(len(step.goals) for step in steps)
