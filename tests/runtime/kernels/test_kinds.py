"""What has one kind has one type to the compiler, and the other way round."""

from __future__ import annotations

import enum
import itertools
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.kernels.kinds import UNKNOWN, kind_of, number_of, numbers_of


class Pair(NamedTuple):
    """Something with a name and two places."""

    first: object
    second: object


class Other(NamedTuple):
    """The same with another name."""

    first: object
    second: object


class Index(int):
    """A number with a meaning of its own."""


DTYPES = ("f8", "f4", "i8", "i4", "u8", "u1", "?")


@st.composite
def arrays(draw: st.DrawFn) -> np.ndarray:
    """Arrays of every layout: rows, columns, with steps, mirrored, read-only, empty."""
    shape = draw(st.lists(st.integers(0, 3), min_size=1, max_size=3))
    array = np.zeros(shape, draw(st.sampled_from(DTYPES)), order=draw(st.sampled_from("CF")))
    step = draw(st.sampled_from((1, 2, -1)))
    array = array[::step] if draw(st.booleans()) else array[..., ::step]
    array.flags.writeable = draw(st.booleans())
    return array


SCALARS = (0, 0.5, True, Index(3), *(np.dtype(each).type(1) for each in DTYPES), None)
VALUES = st.recursive(
    st.one_of(arrays(), st.sampled_from(SCALARS)),
    lambda inner: st.one_of(
        st.tuples(inner, inner), st.builds(Pair, inner, inner), st.builds(Other, inner, inner)
    ),
    max_leaves=4,
)


@given(values=st.lists(VALUES, min_size=2, max_size=6))
def test_kinds_are_types(values) -> None:
    numba = pytest.importorskip("numba")
    numbers = numbers_of(tuple(values))
    assert UNKNOWN not in numbers
    for (a, one), (b, another) in itertools.combinations(zip(values, numbers, strict=True), 2):
        assert (numba.typeof(a) == numba.typeof(b)) == (one == another), (a, b)


def test_numbers_of_kinds_are_found_again() -> None:
    values = (1.0, np.zeros((2, 3)), Pair(1, np.zeros(3)))
    for number in numbers_of(values):
        assert number_of(kind_of(number)) == number


@pytest.mark.parametrize(
    "value",
    [
        "text",
        [1, 2],
        1j,
        np.zeros(2, "c16"),
        np.zeros(2, "S3"),
        np.zeros(2, [("a", "f8")]),
        np.zeros(2, ">f8"),
        np.ma.zeros(2),
        enum.IntEnum("Colour", "RED")(1),
        Pair(1, "text"),
        (1, [2]),
    ],
    ids=repr,
)
def test_what_only_the_compiler_knows(value) -> None:
    assert numbers_of((value,)) == (UNKNOWN,)


def test_a_named_tuple_that_is_gone_is_not_taken_for_another() -> None:
    for _ in range(600):
        assert numbers_of((Pair(1, 2),)) != numbers_of((Pair(1, 2.0),))
