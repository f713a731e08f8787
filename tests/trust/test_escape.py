"""Text of others, made fit to be shown."""

from __future__ import annotations

import json
import unicodedata

from hypothesis import given, settings
from hypothesis import strategies as st

from sketchlang.escape import (
    all_visible,
    dumps,
    file_part,
    markup,
    shown_line,
    shown_lines,
    visible,
)

# One half of a surrogate pair only: JSON would make one character of both.
ODD = "\n\r\x1b\x00\u202e\u2028\x9b\ud800:#[<&"
TEXTS = st.text(st.characters(exclude_categories=["Cs"]) | st.sampled_from(ODD))
HARMFUL = {"Cc", "Cf", "Cs", "Zl", "Zp"}


def harmless(text: str, keep: str = "") -> bool:
    """By Unicode's own categories, not by what the functions ask."""
    return all(unicodedata.category(c) not in HARMFUL or c in keep for c in text)


@settings(deadline=None)
@given(TEXTS)
def test_nothing_harmful_is_left(text: str) -> None:
    assert harmless(visible(text))
    assert harmless(shown_line(text))
    assert harmless(shown_lines(text), keep="\n")
    assert harmless(markup(text))
    assert harmless(dumps({text: [text]}, indent=1), keep="\n")
    assert harmless(dumps(text, compact=True))
    assert harmless(file_part(text))


@settings(deadline=None)
@given(TEXTS)
def test_no_line_is_a_command(text: str) -> None:
    for line in [shown_line(text), *shown_lines(text).split("\n")]:
        assert not line.lstrip().startswith(("::", "##[", "##vso["))


@settings(deadline=None)
@given(st.recursive(TEXTS | st.integers() | st.none(), st.lists))
def test_json_is_the_same_data(value: object) -> None:
    assert json.loads(dumps(value)) == value
    assert json.loads(dumps(value, compact=True)) == value


@settings(deadline=None)
@given(st.text(st.characters(categories=["L", "N", "P", "S"])))
def test_what_prints_is_left_alone(text: str) -> None:
    assert visible(text) == text


@settings(deadline=None)
@given(TEXTS)
def test_markup_closes_nothing(text: str) -> None:
    assert not set("<>\"'") & set(markup(text))


@settings(deadline=None)
@given(TEXTS)
def test_a_part_of_a_name_stays_where_it_is(text: str) -> None:
    part = file_part(text)
    assert not set("/\\.:\x00") & set(part)
    assert len(part) <= 60


def test_data_is_made_visible_keys_too() -> None:
    assert all_visible({"a\x1b": ["b\u202e", 1, None, "c\n"]}) == {
        "a\\x1b": ["b\\u202e", 1, None, "c\n"]
    }
