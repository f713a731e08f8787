"""Angles."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.angles import wrap


@given(st.floats(-1e3, 1e3))
def test_wrapping_keeps_the_direction(angle) -> None:
    wrapped = wrap(angle)
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)
    assert -math.pi - 1e-9 < wrapped <= math.pi + 1e-9


def test_half_a_turn_is_positive() -> None:
    assert wrap(math.pi) == math.pi
    assert wrap(-math.pi) == math.pi
