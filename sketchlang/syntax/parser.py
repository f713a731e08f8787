"""Text to tree.

A file is cut at the lines that begin with an item keyword, and every piece is parsed on its
own: a mistake spoils one item, and all the mistakes of a file are found at once.
"""

from __future__ import annotations

from collections.abc import Iterator

from sketchlang.diagnostics import Diagnostic, Label
from sketchlang.source import Source, Span
from sketchlang.suggest import closest, did_you_mean
from sketchlang.syntax import lalr
from sketchlang.syntax.build import ACTIONS, RejectedError
from sketchlang.syntax.lexer import ERROR, UNCLOSED_STRING, Token, tokenize
from sketchlang.syntax.mistakes import ITEM_KINDS, ITEMS, Mistake, describe, explain
from sketchlang.syntax.tree import Broken, Item, Name, Tree

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
            span = Span(piece[-1].end, len(text))
            items.append(Broken("", None, span))
            given_up = Mistake(
                "too-many-errors",
                f"more than {MAX_MISTAKES} mistakes: the rest of the file was not read",
                Span(span.start, span.start),
                None,
            )
            diagnostics.append(_diagnostic(source, given_up))
            break
    return Tree(source, tuple(items), tuple(comments)), diagnostics


def _pieces(tokens: list[Token]) -> Iterator[list[Token]]:
    """The tokens, cut before every line that begins with an item keyword."""
    start = 0
    for i, token in enumerate(tokens):
        if token.first and token.kind in ITEM_KINDS and i > start:
            yield tokens[start:i]
            start = i
    if start < len(tokens):
        yield tokens[start:]


def _parse_piece(tokens: list[Token], items: list[Item]) -> list[Mistake]:
    """Parse one item, add it to `items`, and return what is wrong with it."""
    whole = Span(tokens[0].start, tokens[-1].end)
    first = tokens[0]
    if first.kind not in ITEM_KINDS:
        items.append(_broken(tokens, whole))
        return [*_bad_characters(tokens)] or [_unknown_item(first)]
    bad = _bad_characters(tokens)
    if bad:
        items.append(_broken(tokens, whole))
        return bad
    try:
        items.append(lalr.parse_item(tokens, ACTIONS))
    except lalr.StuckError as stuck:
        return _recover(tokens, items, stuck)
    except lalr.TooDeepError as deep:
        items.append(_broken(tokens, whole))
        span = Span(deep.token.start, deep.token.end)
        message = "this is nested too deeply"
        hint = "Give parts of the expression names with `define`."
        return [Mistake("nested-too-deeply", message, span, hint)]
    except RejectedError as wrong:
        items.append(_broken(tokens, whole))
        return [Mistake(wrong.code, wrong.message, wrong.span, wrong.hint)]
    return []


def _recover(tokens: list[Token], items: list[Item], stuck: lalr.StuckError) -> list[Mistake]:
    token = stuck.token
    if token.first and lalr.STOP in stuck.expected:
        # A complete item and a line that begins no item, for example `rul name { ... }`.
        before = [other for other in tokens if other.end <= token.start]
        rest = tokens[len(before) :]
        return _parse_piece(before, items) + _parse_piece(rest, items)
    mistakes = [explain(stuck)]
    for number, other in enumerate(tokens):
        # A word at the margin, further on: rather an item of its own than part of this one.
        if number and other.flush and other.kind == "NAME" and other.start > token.start:
            items.append(_broken(tokens[:number], Span(tokens[0].start, tokens[number - 1].end)))
            return mistakes + _parse_piece(tokens[number:], items)
    items.append(_broken(tokens, Span(tokens[0].start, tokens[-1].end)))
    return mistakes


def _broken(tokens: list[Token], span: Span) -> Broken:
    """What is left of an item that does not parse."""
    words = [token for token in tokens[:3] if token.kind != "BOUNDED"]
    keyword = closest(words[0].text, ITEMS) or words[0].text if words else ""
    name = None
    if len(words) > 1 and words[1].kind == "NAME":
        name = Name(words[1].text, Span(words[1].start, words[1].end))
    return Broken(keyword, name, span)


def _unknown_item(token: Token) -> Mistake:
    span = Span(token.start, token.end)
    hint = did_you_mean(token.text, ITEMS)
    if hint is None:
        hint = "An item begins with one of: " + ", ".join(f"`{word}`" for word in ITEMS) + "."
    return Mistake("unknown-item", f"{describe(token)} begins no item", span, hint)


# What people mean by signs that the language does not have.
_SIGN_HINTS = {
    "-": "There is no subtraction: values are never negative.",
    "*": "There is no multiplication: write a function of the domain.",
    "&": "Write `and`.",
    "&&": "Write `and`.",
    "|": "Write `or`.",
    "||": "Write `or`.",
    "~": "Write `!`.",
    ";": "Items end where the next one begins: leave the sign out.",
    "[": "Write braces `{ ... }` around conditions and effects.",
    "//": "Comments begin with `#`.",
    "/": "Put paths in quotes.",
    ".": "Put paths in quotes.",
    "−": "There is no subtraction. `n--` is written with two hyphens.",
    "–": "There is no subtraction. `n--` is written with two hyphens.",
    "—": "There is no subtraction. `n--` is written with two hyphens.",
    "⇒": "Write `->`.",
}


def _bad_characters(tokens: list[Token]) -> list[Mistake]:
    mistakes = []
    for token in tokens:
        span = Span(token.start, token.end)
        if token.kind == UNCLOSED_STRING:
            message = 'this text has no closing `"`'
            mistakes.append(Mistake("unclosed-string", message, span, None))
        elif token.kind == ERROR:
            hint = _SIGN_HINTS.get(token.text)
            if token.text[0].isidentifier():
                hint = "Names consist of the letters a to z and A to Z, digits and `_`."
            message = f"{_printable(token)} means nothing here"
            mistakes.append(Mistake("unexpected-character", message, span, hint))
        if len(mistakes) >= MAX_MISTAKES:
            break
    return mistakes


def _printable(token: Token) -> str:
    text = token.text
    if text.isprintable():
        return describe(token._replace(kind="NAME"))
    if len(text) == 1:
        return f"the character U+{ord(text):04X}"
    return f"this run of {len(text)} characters"


def _diagnostic(source: Source, mistake: Mistake) -> Diagnostic:
    return Diagnostic(mistake.code, mistake.message, Label(source, mistake.span), hint=mistake.hint)
