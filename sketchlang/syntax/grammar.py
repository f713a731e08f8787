"""The grammar as a Lark parser, and the words and signs that it is made of.

Lark works out its table once and saves it, where Python keeps byte code or in the user's cache
folder: reading it back is twenty times faster. Where neither can be written, every run works it
out anew.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import re
import sys
import tempfile
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import grammars
from sketchlang.files import cache_folder

if TYPE_CHECKING:
    from lark import Lark

FOLDER = Path(grammars.__file__).parent
GRAMMAR = FOLDER / "sketch.lark"
# `NAME: "word"` or `NAME.3: /word\b|sign/`
_SPELLING = re.compile(r'^(_?[A-Z]+)(?:\.\d+)?: (?:"([^"]+)"|/([^|\n]+)\|)', re.MULTILINE)


@cache
def load() -> Lark:
    """The parser of one item: from the saved table if it is this grammar's, or else made anew."""
    import lark

    text = GRAMMAR.read_text(encoding="utf-8")
    stamp = hashlib.sha256(f"{lark.__version__}\n{text}".encode()).hexdigest().encode()
    places = saved_tables()
    for place in places:
        try:
            found, _, table = place.read_bytes().partition(b"\n")
            if found == stamp:
                return lark.Lark.load(BytesIO(table))
        # Whatever a damaged file makes pickle do: it is only a copy.
        except Exception:
            continue
    parser = lark.Lark(
        text, parser="lalr", lexer="basic", maybe_placeholders=False, propagate_positions=True
    )
    table_file = BytesIO()
    parser.save(table_file)
    data = stamp + b"\n" + table_file.getvalue()
    any(_keep(place, data) for place in places)
    return parser


def saved_tables() -> list[Path]:
    """Where the table may be kept, the best place first: beside the byte code, wherever that is
    for this interpreter, unless it is told to write none there; and in the user's cache folder."""
    code = Path(importlib.util.cache_from_source(str(GRAMMAR) + ".py")).with_suffix(".lalr")
    user = cache_folder() / code.name
    return [user] if sys.dont_write_bytecode else [code, user]


def _keep(path: Path, data: bytes) -> bool:
    """Write the table as a whole or not at all; whether it was written."""
    temporary = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
            temporary = file.name
            file.write(data)
        os.replace(temporary, path)
    except OSError:
        if temporary is not None:
            Path(temporary).unlink(missing_ok=True)
        return False
    return True


@cache
def spellings() -> dict[str, str]:
    """The terminals that are words or signs, and how they are written: `_RULE`: `rule`.

    Read from the text of the grammar: declaring a domain needs the words, but no parser.
    """
    text = GRAMMAR.read_text(encoding="utf-8")
    found = {}
    for name, plain, pattern in _SPELLING.findall(text):
        found[name] = plain or pattern.removesuffix(r"\b").replace("\\", "")
    return found


@cache
def words() -> frozenset[str]:
    """The words that cannot be names in a sketch."""
    return frozenset(spelling for spelling in spellings().values() if spelling.isalpha())
