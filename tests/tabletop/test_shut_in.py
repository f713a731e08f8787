"""Things on the floor all round the robot: first it takes one that shuts it in."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from domains.tabletop.actions.actions import MoveBase, Pick
from domains.tabletop.problem import TabletopProblem
from domains.tabletop.state import BasePose
from runtime.search.problem import Rejection
from tests.tabletop.tasks import task

TIN = '[[object]]\nname = "{}"\nsize = [0.06, 0.06, 0.12]\nat = [{:.3f}, {:.3f}]\non = "floor"\n'
GOAL = '[[goal]]\nobject = "{}"\non = "{}"\n'
ROUND, MANY, APART = 0.52, 6, 0.1
"""A ring of so many tins at so many metres, and another tin behind each second one."""

FAR = "left", "right"
"""Goals of tins on the right of the robot and on its left: on the table that is further away."""


def ring(folder: Path, tins: int) -> TabletopProblem:
    entries = []
    for k in range(tins):
        angle = 2 * math.pi * k / MANY
        for name, away in (("ring", ROUND), ("back", ROUND + APART))[: 1 + k % 2]:
            x, y = -0.5 + away * math.cos(angle), away * math.sin(angle)
            goal = GOAL.format(f"{name}{k}", FAR[k < MANY / 2])
            entries += [TIN.format(f"{name}{k}", x, y), goal]
    return TabletopProblem(task(folder, *entries, approaches='["side", "top"]'), seed=0)


def names(the: TabletopProblem, attempt: int) -> set[str]:
    samples = the.subproblem(the.initial, attempt, np.random.default_rng(0)).samples
    return {the.world.items[index].name for index, _ in samples.picks}


@pytest.fixture
def closed(tmp_path: Path) -> TabletopProblem:
    return ring(tmp_path, MANY)


def test_the_first_pick_opens_the_ring(closed) -> None:
    outside = BasePose.of(-1.8, 0.0, 0.0)
    drive = MoveBase(outside).motion(closed.executor, closed.initial, 12)
    assert isinstance(drive, Rejection)
    subproblem = closed.subproblem(closed.initial, 0, np.random.default_rng(0))
    assert len(subproblem.samples.picks) > 1
    for index, grasps in subproblem.samples.picks:
        after = Pick(index, grasps[0]).after(closed.initial)
        drive = MoveBase(outside).motion(closed.executor, after, 12)
        assert not isinstance(drive, Rejection)


def test_what_would_leave_it_shut_in_comes_with_the_second_attempt(closed) -> None:
    first, second = names(closed, 0), names(closed, 1)
    assert first == {"ring0", "ring2", "ring4"}
    assert {"ring1", "ring3", "ring5"} <= second


def test_a_ring_with_a_gap_leaves_all_the_choice(tmp_path) -> None:
    assert names(ring(tmp_path, MANY - 2), 0) >= {"ring0", "ring1", "ring2", "ring3"}
