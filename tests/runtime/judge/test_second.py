"""Plans and worlds spoilt in many ways: what a second, independent judge refuses, ours does."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("pybullet")

from domains.tabletop.scene.model import Scene
from runtime.judge.certify import certify
from runtime.robot.model import RobotModel
from sketchlang.errors import InputError
from tests.runtime.judge.mutations import PLANS, WORLDS, mutated, spoilt
from tests.runtime.judge.second import Second
from tests.runtime.plans import Json, parse

ALL_PLANS, ALL_WORLDS = 200, 50


@pytest.fixture(scope="module")
def second(sticks: Scene, robot: RobotModel) -> Iterator[Second]:
    judge = Second(sticks.world, robot.digest)
    yield judge
    judge.close()


@pytest.fixture(scope="module")
def produced(plain_file: Path) -> Json:
    data: Json = json.loads(plain_file.read_text(encoding="utf-8"))
    return data


def refused(folder: Path, data: Json, world: Any, robot: RobotModel) -> bool:
    """Whether our judge refuses a plan, or the reader does."""
    try:
        return not certify(parse(folder, data), world, robot).valid
    except InputError:
        return True


def test_both_accept_the_plan_as_it_is(second, produced, sticks, robot, tmp_path) -> None:
    assert second.fault(produced) is None
    assert not refused(tmp_path, produced, sticks.world, robot)


def compare(numbers: range, second, produced, sticks, robot, folder: Path) -> Counter[str]:
    """Spoil the plan in ways of some numbers; how many the second judge refused, by the way."""
    found: Counter[str] = Counter()
    for number in numbers:
        name, data = mutated(produced, number)
        fault = second.fault(data)
        if fault is not None:
            found[name] += 1
            assert refused(folder, data, sticks.world, robot), (number, name, fault)
    return found


def test_some_spoilt_plans(second, produced, sticks, robot, tmp_path) -> None:
    """Every third way."""
    numbers = range(0, len(PLANS), 3)
    found = compare(numbers, second, produced, sticks, robot, tmp_path)
    assert found.total() >= 0.6 * len(numbers), found


@pytest.mark.slow
def test_many_spoilt_plans(second, produced, sticks, robot, tmp_path) -> None:
    found = compare(range(ALL_PLANS), second, produced, sticks, robot, tmp_path)
    assert found.total() >= 0.6 * ALL_PLANS, found
    assert len(found) >= 0.9 * len(PLANS), found


def judged_alike(numbers: range, produced, sticks, robot, folder: Path) -> int:
    """Judge the plan in spoilt worlds; how many the second judge refused."""
    count = 0
    for number in numbers:
        name, world = spoilt(sticks.world, number)
        other = Second(world, robot.digest)
        try:
            fault = other.fault(produced)
        finally:
            other.close()
        if fault is not None:
            count += 1
            assert refused(folder, produced, world, robot), (number, name, fault)
    return count


def test_some_spoilt_worlds(produced, sticks, robot, tmp_path) -> None:
    assert judged_alike(range(0, len(WORLDS), 3), produced, sticks, robot, tmp_path) >= 2


@pytest.mark.slow
def test_many_spoilt_worlds(produced, sticks, robot, tmp_path) -> None:
    found = judged_alike(range(ALL_WORLDS), produced, sticks, robot, tmp_path)
    assert found >= 0.4 * ALL_WORLDS
