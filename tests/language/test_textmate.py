"""The TextMate grammar: up to date, and it cuts sketches where Lark cuts them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from editors import textmate
from sketchlang.syntax import grammar

ROOT = Path(__file__).parents[2]
SKETCHES = sorted(ROOT.glob("domains/**/*.sketch"))
SIGNS = 'rule r { ¬H ∧ n > 0, !(b ≠ 1) } ↦ { n↓ ∧ m?, !v++ } ∃ x ∈ s: true + 12 <= "p"'


def test_the_file_is_up_to_date() -> None:
    """Run `python -m editors.textmate` after a change of the grammar."""
    assert textmate.FILE.read_text(encoding="utf-8") == textmate.render()


def coloured(text: str) -> list[tuple[int, str]]:
    """Places and scopes, as editors find them: the leftmost match, of those the first pattern."""
    # The first pattern has captures and only says where names are declared.
    patterns = [(re.compile(one["match"]), one["name"]) for one in textmate.build()["patterns"][1:]]
    found = []
    place = 0
    while True:
        matches = [(match, name) for one, name in patterns if (match := one.search(text, place))]
        if not matches:
            return found
        match, name = min(matches, key=lambda entry: entry[0].start())
        found.append((match.start(), name))
        place = match.end()


@pytest.mark.parametrize("text", [*[path.read_text("utf-8") for path in SKETCHES], SIGNS])
def test_colours_are_those_of_the_terminals(text: str) -> None:
    patterns = {one.name: one.pattern.to_regexp() for one in grammar.load().terminals}
    expected = [
        (token.start_pos, f"{textmate.scope(token.type, patterns[token.type])}.sketch")
        for line in [text]
        for token in grammar.load().lex(line, dont_ignore=True)
        if token.type not in {"SPACE", "NEWLINE"}
    ]
    assert coloured(text) == expected


def test_declared_names_are_told_from_others() -> None:
    first = textmate.build()["patterns"][0]
    match = re.search(first["match"], "bounded feature n : nat")
    assert match is not None
    assert match.groups() == ("feature", "n")
    assert set(first["captures"]) == {"1", "2"}
