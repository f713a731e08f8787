"""A thing that only a hand from above can take and only a level one can put down: that is said."""

from __future__ import annotations

from runtime.search.limits import Limits
from runtime.solve import open_task
from sketchlang.loader import load_sketch

SCENE = """
robot_start = [0.0, -1.0, 90.0]
approaches = ["side", "top"]
[[table]]
name = "table"
at = [0.0, 0.6]
size = [1.6, 0.8]
top = 0.72
[[shelf]]
name = "rack"
at = [2.2, -0.5]
yaw = 90.0
size = [1.4, 0.4]
boards = [0.75, 1.1]
thickness = 0.02
[[object]]
name = "tin"
shape = "cylinder"
radius = 0.035
height = 0.05
at = [0.0, 0.55]
[[goal]]
object = "tin"
on = "rack/1"
"""


def test_it_is_said_that_no_grasp_does_for_both(tmp_path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    result = open_task(load_sketch("pick_and_place").checked, str(path), 0).solve(
        Limits(timeout=60)
    )
    assert not result.solved
    said = [finding["text"] for finding in result.outcome.why]
    wanted = "tin can be taken from above only, and put on rack/1 from the side only"
    assert any(wanted in text for text in said), said
