"""The saved table of the grammar: made once, never believed when it is not this grammar's."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from sketchlang.syntax import examples, grammar

ITEM = "rule r { a, n > 0 } -> { !a, n-- }"


@pytest.fixture(autouse=True)
def saved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Where the table is kept in a test: a folder that is not there yet."""
    monkeypatch.setattr(sys, "pycache_prefix", str(tmp_path / "code"))
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    grammar.load.cache_clear()
    yield grammar.saved_tables()[0]
    # Every table numbers its states in its own way.
    grammar.load.cache_clear()
    examples.mistakes.cache_clear()


def again() -> str:
    grammar.load.cache_clear()
    return grammar.load().parse(ITEM).pretty()


def test_a_saved_table_parses_the_same(saved: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = grammar.load().parse(ITEM).pretty()
    assert saved.exists()
    # Read back this time: the grammar is not compiled.
    monkeypatch.setattr("lark.load_grammar.load_grammar", None)
    monkeypatch.setattr("lark.lark.load_grammar", None)
    assert again() == made
    assert [path.name for path in saved.parent.iterdir()] == [saved.name]


def test_a_table_of_another_grammar_is_made_anew(saved: Path) -> None:
    made = grammar.load().parse(ITEM).pretty()
    whole = saved.read_bytes()
    saved.write_bytes(b"0" * 64 + whole[64:])
    assert again() == made
    assert saved.read_bytes()[:64] == whole[:64]


@pytest.mark.parametrize("damage", [slice(0), slice(70), slice(1000)])
def test_a_damaged_table_is_made_anew(saved: Path, damage: slice) -> None:
    made = grammar.load().parse(ITEM).pretty()
    whole = saved.read_bytes()
    saved.write_bytes(whole[damage])
    assert again() == made
    assert len(saved.read_bytes()) > len(whole) // 2


def test_where_no_byte_code_is_written_the_cache_folder_serves(
    saved: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    made = grammar.load().parse(ITEM).pretty()
    assert not saved.exists()
    assert list((tmp_path / "cache" / "sketchlang").iterdir()) == grammar.saved_tables()
    monkeypatch.setattr("lark.load_grammar.load_grammar", None)
    monkeypatch.setattr("lark.lark.load_grammar", None)
    assert again() == made


def test_folders_that_cannot_be_made(saved: Path, tmp_path: Path) -> None:
    for in_the_way in (Path(str(sys.pycache_prefix)), tmp_path / "cache"):
        in_the_way.write_text("a file")
    assert grammar.load().parse(ITEM).data == "rule"


def test_words_are_those_that_the_lexer_takes_for_no_name() -> None:
    kinds = {word: next(grammar.load().lex(word)).type for word in grammar.words()}
    assert "NAME" not in kinds.values()
    spelled = grammar.spellings()
    assert {word: spelled[kind] for word, kind in kinds.items()} == {word: word for word in kinds}
