"""Text to tree.

A file is cut at the lines that begin with an item keyword, and every piece is parsed on its
own: a mistake spoils one item, and all the mistakes of a file are found at once.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from sketchlang.diagnostics import Diagnostic, Label
from sketchlang.source import Source, Span
from sketchlang.suggest import closest, did_you_mean
from sketchlang.syntax.characters import bad_characters
from sketchlang.syntax.item import END, StuckError, TooDeepError, parse_item
from sketchlang.syntax.lexer import begins_line, span, tokenize
from sketchlang.syntax.mistakes import ITEM_KINDS, ITEMS, Mistake, describe, explain
from sketchlang.syntax.rejected import RejectedError
from sketchlang.syntax.tree import Broken, Item, Name, Tree

if TYPE_CHECKING:
    from lark import Token

MAX_CHARACTERS = 100_000
"""Length of the longest text that is read; learned sketches stay far below."""

MAX_MISTAKES = 100
"""Syntax errors after which a file is given up."""


def parse(source: Source) -> tuple[Tree, list[Diagnostic]]:
    """The tree of a text, with `Broken` items where it does not parse, and what is wrong."""
    text = source.text
    if len(text) > MAX_CHARACTERS:
        mistake = Mistake(
            "file-too-large",
            f"this file has {len(text)} characters, more than the {MAX_CHARACTERS} that are read",
            Span(0, 0),
            None,
        )
        return Tree(source, ()), [_diagnostic(source, mistake)]
    tokens, comments = tokenize(text)
    items: list[Item] = []
    diagnostics: list[Diagnostic] = []
    for piece in _pieces(tokens):
        diagnostics.extend(_diagnostic(source, mistake) for mistake in _parse_piece(piece, items))
        if len(diagnostics) >= MAX_MISTAKES:
            rest = Span(span(piece[-1]).end, len(text))
            items.append(Broken("", None, rest))
            given_up = Mistake(
                "too-many-errors",
                f"more than {MAX_MISTAKES} mistakes: the rest of the file was not read",
                Span(rest.start, rest.start),
                None,
            )
            diagnostics.append(_diagnostic(source, given_up))
            break
    return Tree(source, tuple(items), tuple(comments)), diagnostics


def _pieces(tokens: list[Token]) -> Iterator[list[Token]]:
    """The tokens, cut before every line that begins with an item keyword."""
    start = 0
    for i, token in enumerate(tokens):
        if token.type in ITEM_KINDS and i > start and begins_line(tokens, i):
            yield tokens[start:i]
            start = i
    if start < len(tokens):
        yield tokens[start:]


def _parse_piece(tokens: list[Token], items: list[Item]) -> list[Mistake]:
    """Parse one item, add it to `items`, and return what is wrong with it."""
    bad = bad_characters(tokens, MAX_MISTAKES)
    if bad or tokens[0].type not in ITEM_KINDS:
        items.append(_broken(tokens))
        return bad or [_unknown_item(tokens[0])]
    try:
        items.append(parse_item(tokens))
    except StuckError as stuck:
        return _recover(tokens, items, stuck)
    except TooDeepError as deep:
        items.append(_broken(tokens))
        message = "this is nested too deeply"
        hint = "Give parts of the expression names with `define`."
        return [Mistake("nested-too-deeply", message, span(deep.token), hint)]
    except RejectedError as wrong:
        items.append(_broken(tokens))
        return [Mistake(wrong.code, wrong.message, wrong.span, wrong.hint)]
    return []


def _recover(tokens: list[Token], items: list[Item], stuck: StuckError) -> list[Mistake]:
    place = stuck.number
    if place < len(tokens) and begins_line(tokens, place) and END in stuck.expected:
        # A complete item and a line that begins no item, for example `rul name { ... }`.
        return _parse_piece(tokens[:place], items) + _parse_piece(tokens[place:], items)
    mistakes = [explain(stuck)]
    for number in range(place + 1, len(tokens)):
        # A word at the margin, further on: rather an item of its own than part of this one.
        other = tokens[number]
        if other.column == 1 and other.type == "NAME":
            items.append(_broken(tokens[:number]))
            return mistakes + _parse_piece(tokens[number:], items)
    items.append(_broken(tokens))
    return mistakes


def _broken(tokens: list[Token]) -> Broken:
    """What is left of an item that does not parse."""
    words = [token for token in tokens[:3] if token.type != "BOUNDED"]
    keyword = closest(words[0], ITEMS) or str(words[0]) if words else ""
    name = None
    if len(words) > 1 and words[1].type == "NAME":
        name = Name(str(words[1]), span(words[1]))
    return Broken(keyword, name, span(tokens[0]).to(span(tokens[-1])))


def _unknown_item(token: Token) -> Mistake:
    hint = did_you_mean(token, ITEMS)
    if hint is None:
        hint = "An item begins with one of: " + ", ".join(f"`{word}`" for word in ITEMS) + "."
    return Mistake("unknown-item", f"{describe(token)} begins no item", span(token), hint)


def _diagnostic(source: Source, mistake: Mistake) -> Diagnostic:
    return Diagnostic(mistake.code, mistake.message, Label(source, mistake.span), hint=mistake.hint)
