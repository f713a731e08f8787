"""Tables hand out values by type and refuse what nobody asked for."""

from __future__ import annotations

import pytest

from runtime.tables import Table
from sketchlang.errors import InputError


def test_values_come_by_type() -> None:
    table = Table({"name": "a", "length": 2, "list": [1, 2.5], "words": ["x"]}, "file")
    assert table.text("name") == "a"
    assert table.number("length") == 2.0
    assert table.numbers("list", 2) == [1.0, 2.5]
    assert table.texts("words") == ["x"]
    assert table.number("missing", 3.0) == 3.0
    table.finish()


@pytest.mark.parametrize(
    ("value", "ask"),
    [
        (True, "number"),
        ("1", "number"),
        (float("nan"), "number"),
        (10**400, "number"),
        (0, "positive"),
        (-1, "positive"),
        (1, "text"),
        (1, "numbers"),
        (["a"], "numbers"),
        ([1], "texts"),
        ([1], "table"),
        ({}, "tables"),
        ([1], "tables"),
        ([["a"]], "pairs"),
    ],
)
def test_values_of_another_type_are_refused_with_key_and_place(value, ask) -> None:
    table = Table({"key": value}, "file: [table]")
    with pytest.raises(InputError, match="key") as caught:
        getattr(table, ask)("key")
    assert caught.value.place == "file: [table]"


def test_keys_nobody_asked_for_are_refused_in_inner_tables_as_well() -> None:
    table = Table({"inner": {"colour": 1}}, "file")
    table.table("inner").has("color")
    with pytest.raises(InputError, match="unknown key 'colour'") as caught:
        table.finish()
    assert caught.value.place == "file: [inner]"
    assert caught.value.hint == "did you mean 'color'?"


def test_a_missing_key_suggests_one_that_was_not_asked_for() -> None:
    table = Table({"name": "a", "lenght": 2}, "file")
    table.text("name")
    with pytest.raises(InputError, match="'length' is missing") as caught:
        table.number("length")
    assert caught.value.hint == "'lenght' looks like it: is it misspelt?"


def test_tables_of_an_array_are_told_apart_by_name_or_number() -> None:
    table = Table({"things": [{"name": "cup"}, {}]}, "file")
    assert [entry.place for entry in table.tables("things")] == [
        "file: [[things]] cup",
        "file: [[things]] 2",
    ]
