"""`fmt`: canonical, idempotent, and never a change of meaning."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sketchlang.source import Source
from sketchlang.syntax import printer, tree
from sketchlang.syntax.formatter import NotFormattedError, format_source
from sketchlang.syntax.parser import parse
from tests.language.trees import bare, items

DOMAINS = Path(__file__).parents[2] / "domains"


def parsed(text: str) -> tree.Tree:
    result, diagnostics = parse(Source("t", text))
    assert not diagnostics, (text, diagnostics)
    return result


@given(st.lists(items, max_size=4))
def test_what_is_printed_parses_to_the_same_tree(nodes: list[tree.Item]) -> None:
    text = "".join("\n".join(printer.item(node)) + "\n" for node in nodes)
    assert bare(parsed(text).items) == bare(tuple(nodes))
    assert format_source(Source("t", text)) == text


@st.composite
def decorated(draw: st.DrawFn) -> str:
    """A sketch with comments and blank lines in odd places."""
    lines = []
    for node in draw(st.lists(items, max_size=4)):
        for line in printer.item(node):
            gap = draw(st.sampled_from(["", "\n", "# note\n", "\n\n\n#note\n", "  "]))
            end = draw(st.sampled_from(["", " ", "# end", "  #", "\t"]))
            # An item may go on only on lines that do not begin like one.
            lines.append(f"{gap}{line}{end}")
    return "\n".join(lines) + draw(st.sampled_from(["", "\n", "\n\n# last", "#"]))


@given(decorated())
def test_formatting_keeps_comments_and_meaning(text: str) -> None:
    before = parsed(text)
    formatted = format_source(Source("t", text))
    after = parsed(formatted)
    assert bare(after.items) == bare(before.items)
    assert [c.text for c in after.comments] == [c.text for c in before.comments]
    assert format_source(Source("t", formatted)) == formatted


def test_all_sketches_of_the_repository_are_formatted() -> None:
    paths = sorted(DOMAINS.rglob("*.sketch"))
    assert len(paths) > 10
    for path in paths:
        text = path.read_text(encoding="utf-8")
        assert format_source(Source(str(path), text)) == text, path


def test_lines_are_not_too_long() -> None:
    rule = "rule r { " + ", ".join(f"feature_{i} > 0" for i in range(20)) + " } -> { "
    rule += ", ".join(f"feature_{i}?" for i in range(30)) + " }\n"
    formatted = format_source(Source("t", rule))
    assert all(len(line) <= printer.WIDTH for line in formatted.splitlines())
    assert format_source(Source("t", formatted)) == formatted


def test_a_text_with_mistakes_is_not_formatted() -> None:
    with pytest.raises(NotFormattedError):
        format_source(Source("t", "rule r {"))
