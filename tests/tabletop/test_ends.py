"""Long things side by side: taken at the ends that jut out, where their middles are not free."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from domains.tabletop.actions.actions import Pick
from domains.tabletop.hand import hand_of
from domains.tabletop.state import END, SIDE, TOP
from domains.tabletop.world import TabletopWorld
from runtime.judge.certify import certify
from runtime.robot.load import load_robot
from runtime.search.limits import Limits
from runtime.solve import open_task
from sketchlang.loader import load_sketch
from tests.tabletop.scene.texts import TABLES, write_scene
from tests.tabletop.tasks import ON_RIGHT, task

PLANK = '[[object]]\nname = "{}"\nsize = [0.2, 0.04, 0.06]\nat = [{}, {}]\n'
LONG, WIDE = 0.2, 0.04


def planks(juts: float, gap: float) -> list[str]:
    """Two planks side by side, the second further to the right by what it juts out."""
    entries = [PLANK.format("p", 0.75, 0.5), PLANK.format("q", 0.75 + juts, 0.5 + WIDE + gap)]
    return [*entries, ON_RIGHT.format("p"), ON_RIGHT.format("q")]


def world(folder: Path, juts: float, gap: float) -> TabletopWorld:
    return task(folder, *planks(juts, gap), approaches='["top"]')


@pytest.mark.parametrize(
    ("juts", "gap", "wanted"),
    [
        (0.06, 0.01, True),
        (0.0, 0.01, False),  # nothing juts out
        (0.06, 0.2, False),  # the middle is free
    ],
)
def test_ends_are_thought_of_where_they_help(tmp_path, juts, gap, wanted) -> None:
    assert (END in world(tmp_path, juts, gap).families) is wanted


def test_a_scene_for_hands_from_the_side_has_no_ends(tmp_path) -> None:
    assert task(tmp_path, *planks(0.06, 0.01)).families == (SIDE,)


def test_an_end_is_taken_squarely_with_the_fingers_on_it(tmp_path) -> None:
    """Only along its length, either way; the fingers reach to its end and no further."""
    item, hand = world(tmp_path, 0.0, 0.2).items[0], hand_of(load_robot("tiago"))
    angles = np.arange(24) * math.pi / 12
    hold = item.holds(hand, END, angles)
    assert hold is not None
    assert np.flatnonzero(hold.fits).tolist() == [0, 12]
    for k in (0, 12):
        grasp = item.grasp(hold, k, float(angles[k]))
        x, y, _ = grasp.tool[:, 3].tolist()
        assert abs(x) + hand.fingertip == pytest.approx(LONG / 2, abs=1e-4)
        assert math.copysign(1.0, x) == math.cos(angles[k])
        assert y == pytest.approx(0.0, abs=1e-4)
        assert item.width(hand, grasp) == pytest.approx(WIDE, abs=1e-6)
    middle = item.holds(hand, TOP, angles)
    assert middle is not None
    assert hold.height == middle.height


def test_planks_that_bar_each_other_are_taken_at_their_ends(tmp_path) -> None:
    text = 'robot_start = [-0.5, 0.0, 0.0]\napproaches = ["top"]\n' + TABLES + "\n"
    scene = write_scene(tmp_path, text + "\n".join(planks(0.06, 0.01)))
    done = open_task(load_sketch("pick_and_place").checked, str(scene)).solve(Limits(timeout=30))
    assert done.solved
    picks = [a for s in done.outcome.subgoals for a in s.actions if isinstance(a, Pick)]
    assert [pick.grasp.family for pick in picks] == [END, TOP]
    here = done.task.problem.world
    assert certify(done.plan.plan, here.scene.world, here.robot).valid
