"""Base, arm and fingers at once: what the judge lets pass, and what not."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.judge.certify import certify
from runtime.judge.together import derivatives, together_fault
from runtime.robot.load import load_robot
from tests.runtime.plans import Json, parse, pieces

TIAGO, FRANKA, DESK = (load_robot(name) for name in ("tiago", "franka_mobile", "ur5e_desk"))
TICK = 0.05


def moved(robot: Any, **parts: np.ndarray) -> str | None:
    """What is wrong with a motion of which some parts are given, a tick between rows."""
    count = max(len(part) for part in parts.values())
    rows = {
        "base": np.zeros((count, 3)),
        "path": np.tile(robot.home, (count, 1)),
        "openings": np.full(count, robot.gripper.max_opening),
    } | parts
    found = together_fault(robot, np.arange(count) * TICK, **rows)
    return None if found is None else found[1]


def smooth(distance: float, seconds: float) -> np.ndarray:
    """From rest to rest by a polynomial with continuous acceleration (minimum jerk), whose
    largest derivatives are 1.875, 5.774 and 60 for a distance and a time of one."""
    s = np.clip(np.arange(-2, math.ceil(seconds / TICK) + 3) * TICK / seconds, 0.0, 1.0)
    return np.asarray(distance * (10 * s**3 - 15 * s**4 + 6 * s**5))


LEAST = {1: 1.875, 2: 5.774, 3: 60.0}


@given(st.floats(0.05, 1.0), st.integers(0, 7))
def test_a_smooth_motion_within_the_limits_passes_and_a_quicker_one_does_not(
    distance: float, joint: int
) -> None:
    distance *= (TIAGO.upper - TIAGO.home)[joint] or -(TIAGO.home - TIAGO.lower)[joint]
    limits = (TIAGO.velocity, TIAGO.acceleration, TIAGO.jerk)
    needed = max(
        (LEAST[order] * abs(distance) / limit[joint]) ** (1 / order)
        for order, limit in zip((1, 2, 3), limits, strict=True)
    )
    for factor, fine in ((1.02, True), (0.7, False)):
        seconds = max(needed * factor, 0.0)
        way = smooth(distance, seconds)
        path = np.tile(TIAGO.home, (len(way), 1))
        path[:, joint] += way
        # Differences are means over a tick or more: they blur what is shorter.
        if fine or seconds > 10 * TICK:
            assert (moved(TIAGO, path=path) is None) == fine


def test_each_limit_is_named() -> None:
    def lifted(values: list[float]) -> str | None:
        path = np.tile(TIAGO.home, (len(values), 1))
        path[:, 0] -= values
        return moved(TIAGO, path=path)

    slow = (np.arange(61) * TICK) * 0.0699
    assert "faster than its limit" in str(lifted([*(slow * 1.2)]))
    assert "changes its speed faster" in str(lifted([*slow]))  # at once to full speed
    v = np.minimum(np.arange(100) * TICK * 0.139, 0.06)
    v = np.concatenate([v, v[::-1]])[:160]
    assert lifted(list(np.cumsum(np.zeros(5)))) is None
    quick = replace(TIAGO, jerk=TIAGO.jerk / 100)
    path = np.tile(TIAGO.home, (100, 1))
    path[:, 1] += smooth(0.5, 3.0)[np.minimum(np.arange(100), len(smooth(0.5, 3.0)) - 1)]
    assert moved(TIAGO, path=path) is None
    assert "changes its acceleration faster" in str(moved(quick, path=path))


def circle(turn: float, radius: float, seconds: float) -> np.ndarray:
    angle = smooth(turn, seconds)
    return np.column_stack([radius * np.sin(angle), radius * (1 - np.cos(angle)), angle])


def test_a_differential_base_drives_curves_but_not_sideways() -> None:
    way = circle(1.5, 0.6, 4.0)
    assert moved(TIAGO, base=way) is None
    assert moved(TIAGO, base=way[::-1]) is None, "and backwards"
    assert "sideways" in str(moved(TIAGO, base=way + np.outer(smooth(0.1, 4.0), [0, 1, 0])))
    assert "sideways" in str(moved(TIAGO, base=way * [1, 1, 0.9]))
    assert "turning, is faster" in str(moved(TIAGO, base=circle(3.0, 0.1, 3.0)))
    assert "fixed" in str(moved(DESK, base=way))


def test_a_holonomic_base_moves_in_any_direction_within_the_length_of_its_limits() -> None:
    s = smooth(1.0, 4.0)
    assert moved(FRANKA, base=np.column_stack([s, 0.5 * s, s])) is None
    # 0.8 m/s along each axis would be 1.1 m/s in all.
    both = np.column_stack([1.6 * s, 1.6 * s, 0 * s])
    assert "the base is faster" in str(moved(FRANKA, base=both))


def test_way_points_are_neither_too_close_nor_too_far_apart() -> None:
    still = {"base": np.zeros((3, 3)), "path": np.tile(TIAGO.home, (3, 1)), "openings": np.zeros(3)}
    for times in ([0, 0.001, 0.05], [0, 0.05, 0.2]):
        found = together_fault(TIAGO, np.array(times), **still)
        assert found is not None
        assert "apart" in found[1]


def test_fingers_keep_their_speed() -> None:
    wide, count = TIAGO.gripper.max_opening, 40
    assert moved(TIAGO, openings=np.linspace(wide, 0.0, count)) is None
    assert "fingers" in str(moved(TIAGO, openings=np.linspace(wide, 0.0, 5)))
    assert "cannot open" in str(moved(TIAGO, openings=np.full(3, wide + 0.01)))


@given(st.lists(st.floats(0.02, 0.1), min_size=6, max_size=12), st.integers(0, 99))
def test_differences_at_uneven_times_are_means_of_derivatives(
    steps: list[float], seed: int
) -> None:
    """Of a polynomial of third degree, whose third derivative is one number."""
    a = np.random.default_rng(seed).uniform(-1, 1, 4)
    t = np.concatenate([[0.0], np.cumsum(steps)])
    values = (a[0] + a[1] * t + a[2] * t**2 + a[3] * t**3)[:, None]
    first, second, third = (means for means, _, _ in derivatives(t, values))
    assert third[3:-3] == pytest.approx(6 * a[3], abs=1e-4)
    slopes = a[1] + 2 * a[2] * t + 3 * a[3] * t**2
    inside = first[3:-3, 0]
    bound = 3 * abs(a[3]) * 0.1**2 + 1e-9
    assert np.all(inside <= np.maximum(slopes[:-1], slopes[1:]) + bound)
    assert np.all(second[3:-3, 0] <= np.abs(2 * a[2]) + 6 * abs(a[3]) * t[-1] + 1e-9)


# -- whole plans -------------------------------------------------------------------------------


@pytest.fixture
def judge(tmp_path, sticks, robot) -> Any:
    return lambda data: certify(parse(tmp_path, data), sticks.world, robot)


def longest(data: Json) -> tuple[int, Json]:
    """The longest piece that moves the base, and its action."""
    found = [(i, p) for i, _, p in pieces(data, "together") if np.ptp(p["poses"], axis=0).max() > 1]
    return max(found, key=lambda entry: len(entry[1]["times"]))


def test_a_produced_plan_overlaps_base_and_arm_and_is_certified(judge, plan_data) -> None:
    assert judge(plan_data).valid
    _, piece = longest(plan_data)
    base = np.abs(np.diff(piece["poses"], axis=0)).max(axis=1) > 1e-5
    arm = np.abs(np.diff(piece["path"], axis=0)).max(axis=1) > 1e-5
    assert (base & arm).sum() > 10


def test_what_the_arm_hits_while_the_base_drives_is_found(judge, plan_data, robot) -> None:
    number, piece = longest(plan_data)
    middle = len(piece["times"]) // 2
    low = np.array(piece["path"][middle])
    low[1:4] = robot.lower[1:4]  # stretched out to the side
    piece["path"][middle] = low.tolist()
    certificate = judge(plan_data)
    assert not certificate.valid
    assert certificate.findings[0].action == number


def test_a_limit_is_passed_in_the_action_where_it_is(judge, plan_data) -> None:
    number, piece = longest(plan_data)
    piece["times"] = [round(t / 2, 6) for t in piece["times"]]
    certificate = judge(plan_data)
    assert [finding.action for finding in certificate.findings] == [number]
    assert "limit" in certificate.findings[0].message


def test_the_last_motion_is_tested_as_well(judge, plan_data) -> None:
    """Nothing comes after it: the plan ends where it comes to rest."""
    *_, (number, _, piece) = pieces(plan_data, "together")
    assert number == len(plan_data["actions"]) - 1
    assert plan_data["actions"][number]["pieces"][-1] is piece
    piece["times"] = [round(0.5 * t, 6) for t in piece["times"]]
    certificate = judge(plan_data)
    assert [finding.action for finding in certificate.findings] == [number]
    assert "limit" in certificate.findings[0].message


def test_pieces_in_a_row_are_one_motion(judge, plan_data) -> None:
    """The end of one cut off: the next one would begin at once, and elsewhere."""
    _, piece = longest(plan_data)
    for key in ("times", "poses", "path", "openings"):
        del piece[key][-3:]
    assert "jumps" in judge(plan_data).findings[0].message


def test_older_files_have_no_such_pieces(tmp_path, plan_data) -> None:
    from sketchlang.errors import InputError

    plan_data["version"] = 2
    with pytest.raises(InputError, match="expected 'base' or 'arm' or 'gripper'"):
        parse(tmp_path, plan_data)
