"""Transits: whatever overlaps, what is near an object happens as it was planned, and all is free.

Robot and room are as plain as can be: a base that drives along x, a joint that stretches the arm,
one that goes into an object, and a slow lift; what bars the way are boxes in that space, one for
each way to hold the fingers.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.motion.course import TICK, Limits, course
from runtime.motion.transit import Fingers, Leg, Question, Transit, transit
from runtime.motion.whole import Whole

STRETCH, INTO, LIFT = 0, 1, 2
LIMITS = Limits(np.array([1.0, 1.0, 0.07]), np.array([2.0, 2.0, 0.14]), np.array([20.0, 20.0, 1.4]))
WIDE, NARROW = 0.08, 0.02


@dataclass
class Zone:
    """Bars rows in which the base is between two places and the arm stretched further than so."""

    low: float
    high: float
    stretched: float
    asked: list[int] = field(default_factory=list)

    def bars(self, rows: np.ndarray) -> np.ndarray:
        x, arm = rows[:, 0], np.abs(rows[:, 3 + STRETCH])
        barred: np.ndarray = (self.low < x) & (x < self.high) & (arm > self.stretched)
        return barred

    def first_hit(self, rows: np.ndarray, margin: float = 0.0) -> int | None:
        self.asked.append(len(rows))
        hits = np.flatnonzero(self.bars(rows))
        return int(hits[0]) if len(hits) else None

    def is_free(self, rows: np.ndarray, margin: float = 0.0) -> bool:
        return self.first_hit(rows) is None


def drive(distance: float) -> np.ndarray:
    limits = Limits(np.array([0.8]), np.array([0.6]), np.array([12.0]))
    along = course(np.array([[0.0], [distance]]), limits)
    return np.column_stack([along, np.zeros((len(along), 2))])


ZONES = st.tuples(st.floats(0.1, 0.8), st.floats(0.1, 0.9), st.floats(0.02, 0.9))


@dataclass(frozen=True)
class Case:
    """What is asked: how far it is, where the arm is at both ends, how the fingers change."""

    distance: float
    out: float
    into: float
    lifts: tuple[float, float]
    ticks: int
    zones: tuple[Zone, Zone]

    def ask(self) -> Transit:
        home, (low, high) = np.zeros(3), self.lifts
        left = np.array([self.out, 0.0, low])
        right = np.array([-self.into, 0.0, high])
        further = np.array([0.0, 0.2, 0.0])
        deep, deeper = left + further, right - further
        before, after = (cast(Whole, zone) for zone in self.zones)
        openings = np.linspace(WIDE, NARROW, self.ticks + 1)
        return transit(
            Question(
                Leg(np.array([left, home]), (np.array([deep, left]),)),
                Leg(np.array([home, right]), (np.array([right, deeper]),)),
                [drive(self.distance)],
                Fingers(openings, before, after),
                LIMITS,
            )
        )


def case(data: Any) -> Case:
    """One of any; the zones are clear of both ends, and of the arm in its driving posture."""
    distance = data.draw(st.floats(0.5, 3.0))
    zones = []
    for _ in range(2):
        start, length, stretched = data.draw(ZONES)
        low = 0.02 + start * distance * 0.5
        zones.append(Zone(low, min(low + length * distance, 0.98 * distance), stretched))
    lifts = data.draw(st.sampled_from([(0.0, 0.0), (0.3, 0.25), (0.05, 0.3)]))
    ends = data.draw(st.floats(0.3, 1.5)), data.draw(st.floats(0.3, 1.5))
    return Case(distance, *ends, lifts, data.draw(st.integers(1, 60)), (zones[0], zones[1]))


@given(st.data())
def test_what_overlaps_is_free_and_nothing_near_an_object_is_disturbed(data) -> None:
    asked = case(data)
    found = asked.ask()
    rows, openings, arm = found.rows, found.openings, found.rows[:, 3:]
    assert len(rows) == len(openings)
    start = [0, 0, 0, asked.out, 0.2, asked.lifts[0]]
    end = [asked.distance, 0, 0, -asked.into, -0.2, asked.lifts[1]]
    assert rows[0] == pytest.approx(start, abs=1e-6)
    assert rows[-1] == pytest.approx(end, abs=1e-6)
    # The limits, at rest before and after.
    padded = np.vstack([np.repeat(arm[:1], 3, 0), arm, np.repeat(arm[-1:], 3, 0)])
    for order, most in enumerate((LIMITS.velocity, LIMITS.acceleration, LIMITS.jerk), 1):
        means = np.abs(np.diff(padded, order, axis=0)).max(axis=0) / TICK**order
        assert (means <= most * 1.001).all()
    # While the hand is at the one object, the base stands there and the fingers are as they were;
    # while it goes into the other, base and fingers are where they have to be.
    leaving, coming = arm[:, INTO] > 1e-6, arm[:, INTO] < -1e-6
    assert np.ptp(rows[leaving, 0]) < 1e-9
    assert np.all(openings[leaving] == WIDE)
    assert np.all(rows[coming, 0] == asked.distance)
    assert np.all(openings[coming] == NARROW)
    assert np.all(np.diff(openings) <= 1e-12)
    # What moves on is told: the hand is out, then the base is there.
    assert 0 < found.out <= found.there < len(rows)
    assert not leaving[found.out + 1 :].any()
    assert np.all(rows[found.there :, 0] == asked.distance)
    # Fingers that change are tested as they were and as they will be.
    before, after = asked.zones
    assert not before.bars(rows).any()
    assert not after.bars(rows[openings < WIDE]).any()


def test_it_overlaps_where_it_can_and_folds_where_it_must() -> None:
    nothing = Zone(0.0, 0.0, 0.0)
    wall = Zone(0.05, 1.95, 0.01)
    free = Case(2.0, 1.0, 1.0, (0.0, 0.0), 20, (nothing, nothing)).ask()
    folded = Case(2.0, 1.0, 1.0, (0.0, 0.0), 20, (wall, wall)).ask()
    only_after = Case(2.0, 1.0, 1.0, (0.0, 0.0), 20, (nothing, wall)).ask()
    assert free.seconds < only_after.seconds <= folded.seconds + 1e-9
    base_moves = np.diff(folded.rows[:, 0]) > 1e-3
    stretched = np.abs(folded.rows[1:, 3 + STRETCH]) > 0.05
    assert not (base_moves & stretched)[np.abs(folded.rows[1:, 0] - 1.0) < 0.9].any()


def test_a_lift_that_is_slower_than_all_the_rest_is_waited_for() -> None:
    """It goes straight up, not by way of its driving posture, and the hand goes in after it."""
    nothing = Zone(0.0, 0.0, 0.0)
    found = Case(0.5, 0.3, 0.3, (0.05, 0.3), 5, (nothing, nothing)).ask()
    lift, goes_in = found.rows[:, 3 + LIFT], found.rows[:, 3 + INTO] < -1e-6
    assert np.all(np.diff(lift) >= -1e-9)
    assert lift[goes_in] == pytest.approx(0.3, abs=1e-6)
    at_least = 0.25 / LIMITS.velocity[LIFT]
    assert at_least < found.seconds < at_least + 5.0
