"""States, actions and their quantised coordinates."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from domains.tabletop.actions.actions import MoveBase, Pick, Place
from domains.tabletop.state import (
    TURN,
    UNIT,
    BasePose,
    Grasp,
    Placement,
    State,
    quantise,
    quantise_angle,
)

LENGTHS = st.floats(-20, 20)
ANGLES = st.floats(-20, 20)


@given(LENGTHS)
def test_lengths_are_kept_to_half_a_unit(value) -> None:
    assert abs(quantise(value) * UNIT - value) <= UNIT / 2 + 1e-12


@given(ANGLES)
def test_angles_are_kept_up_to_whole_turns(angle) -> None:
    found = quantise_angle(angle)
    assert 0 <= found < TURN
    off = math.remainder(found * UNIT - angle, 2 * math.pi)
    turns = abs(angle) / (2 * math.pi) + 1
    assert abs(off) <= UNIT * (1 + turns)  # a turn is no whole number of units


@given(LENGTHS, LENGTHS, ANGLES)
def test_a_pose_that_is_read_back_is_the_same_placement(x, y, yaw) -> None:
    placement = Placement.of(x, y, yaw, 1)
    assert Placement.of(*placement.pose, 1) == placement
    base = BasePose.of(x, y, yaw)
    assert BasePose.of(*base.pose) == base


def test_poses_that_round_alike_are_equal() -> None:
    assert Placement.of(1.0, 2.0, 0.5, 0) == Placement.of(1.0 + 4e-6, 2.0 - 4e-6, 0.5, 0)
    assert Placement.of(1.0, 2.0, 0.5, 0) != Placement.of(1.0, 2.0, 0.5, 1)
    assert Placement.of(0.3, 0.0, 0.0, 0) == Placement.of(0.1 + 0.2, 0.0, 0.0, 0)


HERE, THERE = BasePose.of(0.0, 0.0, 0.0), BasePose.of(1.0, 0.5, 2.0)
STANDS = (Placement.of(1.0, 0.0, 0.0, 0), Placement.of(2.0, 0.0, 0.0, 0))
GRASP = Grasp.of(0.5, 0.12)
START = State(HERE, STANDS)


def test_moving_the_base_changes_nothing_else() -> None:
    assert MoveBase(THERE).after(START) == State(THERE, STANDS)


def test_picking_takes_the_object_from_its_place() -> None:
    assert Pick(1, GRASP).after(START) == State(HERE, (STANDS[0], None), 1, GRASP)


def test_placing_puts_the_held_object_down() -> None:
    there = Placement.of(1.5, 0.5, 1.0, 1)
    held = Pick(0, GRASP).after(START)
    assert Place(0, there).after(held) == State(HERE, (there, STANDS[1]))


def test_putting_an_object_back_leads_to_the_state_before() -> None:
    back = Place(1, STANDS[1]).after(Pick(1, GRASP).after(START))
    assert back == START
    assert hash(back) == hash(START)


def test_a_held_object_is_carried_along() -> None:
    held = MoveBase(THERE).after(Pick(0, GRASP).after(START))
    assert (held.held, held.grasp, held.base) == (0, GRASP, THERE)


@pytest.mark.parametrize("angle", [0.0, 1.0, -1.0, 3 * math.pi])
def test_a_grasp_keeps_its_heading(angle) -> None:
    heading = Grasp.of(angle, 0.12).heading
    assert math.remainder(heading - angle, 2 * math.pi) == pytest.approx(0.0, abs=3 * UNIT)
