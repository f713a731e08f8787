"""Damaged files of every format: a message, or a result, and nothing else."""

from __future__ import annotations

import pytest

from tests.fuzz.run import tried
from tests.fuzz.targets import CORPUS, TARGETS, case

every_target = pytest.mark.parametrize("name", TARGETS)


@every_target
def test_good_files_are_read(name, tmp_path) -> None:
    """Guards the tests below against readers that refuse everything."""
    for number, data in enumerate(TARGETS[name].good()):
        path = tmp_path / f"good{number}{TARGETS[name].suffix}"
        path.write_bytes(data)
        TARGETS[name].read(path)


@pytest.mark.parametrize("path", sorted(CORPUS.iterdir()), ids=lambda path: path.name)
def test_what_was_found_once(path) -> None:
    assert tried(path.name.partition("-")[0], path.read_bytes()) is None


@every_target
def test_a_few_damaged_files(name) -> None:
    for number in range(5):
        assert tried(name, case(name, f"few {number}")) is None, number


@pytest.mark.slow
@every_target
def test_many_damaged_files(name) -> None:
    for number in range(150):
        assert tried(name, case(name, f"many {number}")) is None, number


def test_a_seed_makes_the_same_file_again() -> None:
    assert case("store", "1") == case("store", "1") != case("store", "2")
