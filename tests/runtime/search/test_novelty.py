"""Novelty tables against sets of tuples."""

from __future__ import annotations

from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.search.novelty import NoveltyTable, PartitionedNovelty, new_tuples

ATOMS = st.lists(st.integers(0, 6), max_size=5, unique=True).map(tuple)


@pytest.mark.parametrize("k", [1, 2, 3])
@given(states=st.lists(ATOMS, max_size=12))
def test_a_state_is_novel_if_a_tuple_of_its_atoms_is_new(k, states) -> None:
    table, seen = NoveltyTable(k), set()
    for atoms in states:
        tuples = {
            frozenset(found) for size in range(1, k + 1) for found in combinations(atoms, size)
        }
        assert table.is_novel(atoms) == bool(tuples - seen)
        table.add(atoms)
        seen |= tuples
        assert not table.is_novel(atoms)


def test_atoms_of_different_kinds_live_together() -> None:
    table = NoveltyTable(2)
    table.add(((0, "a"), (1, 3), (1, None)))
    assert not table.is_novel(((1, None), (0, "a")))
    assert table.is_novel(((1, None), (0, "b")))


PARTS = st.lists(st.tuples(st.integers(0, 1), ATOMS), max_size=12)


@pytest.mark.parametrize("k", [1, 2, 3])
@given(states=PARTS)
def test_the_width_of_a_state_is_that_of_its_smallest_new_tuple_in_its_part(k, states) -> None:
    table, seen = PartitionedNovelty(k), {0: set(), 1: set()}
    for part, atoms in states:
        sizes = [
            size
            for size in range(1, k + 1)
            for found in combinations(atoms, size)
            if frozenset(found) not in seen[part]
        ]
        assert table.width(part, atoms) == min(sizes, default=k + 1)
        table.add(part, atoms)
        for size in range(1, k + 1):
            seen[part].update(map(frozenset, combinations(atoms, size)))


@given(
    st.lists(st.integers(0, 3), max_size=6),
    st.lists(st.integers(0, 3), max_size=6),
    st.integers(1, 2),
)
def test_new_tuples_are_those_that_are_not_all_true_in_the_other_state(here, there, k) -> None:
    atoms, other = tuple(enumerate(here)), tuple(enumerate(there))
    known = frozenset(other)
    found = new_tuples(atoms, other, known, k)
    sizes = range(1, k + 1)
    expected = [c for n in sizes for c in combinations(atoms, n) if not known.issuperset(c)]
    assert list(found) == ([c[0] for c in expected] if k == 1 else expected)
