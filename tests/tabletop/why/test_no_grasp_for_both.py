"""A thing that only a hand from above can take and only a level one can put down: that is said."""

from __future__ import annotations

from runtime.search.limits import Limits
from runtime.solve import open_task
from sketchlang.loader import load_sketch
from tests.tabletop.scene.texts import RACK, write_scene


def test_it_is_said_that_no_grasp_does_for_both(tmp_path) -> None:
    path = write_scene(tmp_path, RACK.format(approaches='approaches = ["side", "top"]'))
    result = open_task(load_sketch("pick_and_place").checked, str(path), 0).solve(
        Limits(timeout=60)
    )
    assert not result.solved
    said = [finding["text"] for finding in result.outcome.why]
    wanted = "tin can be taken from above only, and put on rack/1 from the side only"
    assert any(wanted in text for text in said), said
