"""Parsing again after a change finds the same as parsing all of it."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks import check_time
from sketchlang.lsp import incremental
from sketchlang.lsp.incremental import Parser
from sketchlang.source import Source
from sketchlang.syntax.parser import parse

ROOT = Path(__file__).parents[2]
SKETCHES = [path.read_text(encoding="utf-8") for path in sorted(ROOT.glob("domains/**/*.sketch"))]
PIECES = [
    "rule",
    "\n",
    "goal { n = 0 }\n",
    " ",
    "# é",
    '"',
    "}",
    "n -= 1",
    "\u00a0",
    "x",
    "feature",
    "",
]


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(SKETCHES), st.data())
def test_any_edits(text: str, data: st.DataObject) -> None:
    parser = Parser()
    for _ in range(4):
        source = Source("t", text)
        assert parser.parse(source) == parse(source)
        start = data.draw(st.integers(0, len(text)))
        end = data.draw(st.integers(start, min(len(text), start + 30)))
        text = text[:start] + data.draw(st.sampled_from(PIECES)) + text[end:]


def test_what_did_not_change_is_not_parsed_again(monkeypatch: pytest.MonkeyPatch) -> None:
    text = check_time.sketch(rules=100, features=30)
    parser = Parser()
    parser.parse(Source("t", text))
    seen: list[str] = []
    monkeypatch.setattr(
        incremental, "parse", lambda source: seen.append(source.text) or parse(source)
    )
    changed = text.replace("rule r50 {", "rule r50 { p0,").replace(
        "sketch generated", "# new\nsketch x"
    )
    assert parser.parse(Source("t", changed)) == parse(Source("t", changed))
    assert len(seen) == 3
    assert sum(map(len, seen)) < 500
