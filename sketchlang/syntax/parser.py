"""Text to tree.

A file is cut at the lines that begin with an item keyword, and every piece is parsed on its
own: a mistake spoils one item, and all the mistakes of a file are found at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from sketchlang.diagnostics import Diagnostic, Label
from sketchlang.source import Source, Span
from sketchlang.suggest import closest
from sketchlang.syntax import hidden
from sketchlang.syntax.item import END, StuckError, TooDeepError, parse_item
from sketchlang.syntax.lexer import Comment, begins_line, span, tokenize
from sketchlang.syntax.mistake import Mistake
from sketchlang.syntax.mistakes import ITEM_KINDS, explain
from sketchlang.syntax.rejected import RejectedError
from sketchlang.syntax.repair import ITEMS, Budget, declared, diagnose
from sketchlang.syntax.tree import Broken, Item, Name, Tree

if TYPE_CHECKING:
    from lark import Token

MAX_CHARACTERS = 100_000
"""Length of the longest text that is read; learned sketches stay far below."""

MAX_MISTAKES = 100
"""Syntax errors after which a file is given up."""


def parse(source: Source) -> tuple[Tree, list[Diagnostic]]:
    """The tree of a text, with `Broken` items where it does not parse, and what is wrong."""
    if len(source.text) > MAX_CHARACTERS:
        size = f"this file has {len(source.text)} characters"
        message = f"{size}, more than the {MAX_CHARACTERS} that are read"
        return Tree(source, ()), [_diagnostic(source, _about("file-too-large", message, 0))]
    return _Parser(source).run()


class _Parser:
    """One text on its way: what is left to tell, and the items so far."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.mistakes: list[Mistake] = []
        self.items: list[Item] = []
        self.tokens, self.comments = tokenize(source.text)
        self.unseen: list[int] = []
        self.budget = Budget()
        text = source.text
        if hidden.suspicious(text):
            text, found = hidden.find(text, self.comments)
            if found:
                self.mistakes.extend(found)
                self.unseen = [i for i, sign in enumerate(source.text) if text[i] != sign]
                self.tokens, self.comments = tokenize(text)
        self.plain = _blanked(text, self.comments)

    def run(self) -> tuple[Tree, list[Diagnostic]]:
        for piece in _pieces(self.tokens):
            self._piece(piece)
            if len(self.mistakes) >= MAX_MISTAKES:
                rest = Span(span(piece[-1]).end, len(self.source.text))
                self.items.append(Broken("", None, rest))
                message = f"more than {MAX_MISTAKES} mistakes: the rest of the file was not read"
                self.mistakes.append(_about("too-many-errors", message, rest.start))
                break
        tree = Tree(self.source, tuple(self.items), tuple(self.comments))
        self.mistakes.sort(key=lambda mistake: mistake.span.start)
        return tree, [_diagnostic(self.source, mistake) for mistake in self.mistakes]

    def _piece(self, tokens: list[Token]) -> None:
        """Parse one item, and note it and what is wrong with it."""
        try:
            self.items.append(parse_item(tokens))
        except StuckError as stuck:
            self._recover(tokens, stuck)
        except TooDeepError as deep:
            self.items.append(_broken(tokens))
            message = "this is nested too deeply"
            hint = "Give parts of the expression names with `define`."
            self.mistakes.append(Mistake("nested-too-deeply", message, span(deep.token), hint))
        except RejectedError as wrong:
            self.items.append(_broken(tokens))
            self.mistakes.append(Mistake(wrong.code, wrong.message, wrong.span, wrong.hint))

    def _recover(self, tokens: list[Token], stuck: StuckError) -> None:
        place = stuck.number
        if 0 < place < len(tokens) and begins_line(tokens, place) and END in stuck.expected:
            # A complete item and a line that begins no item, for example `rul name { ... }`.
            self._piece(tokens[:place])
            self._piece(tokens[place:])
            return
        for number in range(place + 1, len(tokens)):
            # A word at the margin, further on: rather an item of its own than part of this one.
            other = tokens[number]
            if other.column == 1 and other.type in {"NAME", "_IF"}:
                self._explain(tokens[:number], stuck)
                self._piece(tokens[number:])
                return
        self._explain(tokens, stuck)

    def _explain(self, tokens: list[Token], stuck: StuckError) -> None:
        whole = span(tokens[0]).to(span(tokens[-1]))
        if any(whole.start <= place < whole.end for place in self.unseen):
            # What cannot be seen is to blame, and was reported.
            self.items.append(_broken(tokens))
            return
        text = self.plain[whole.start : whole.end]
        found = diagnose(text, whole.start, stuck, explain, self.budget)
        first = found.mistakes[0]
        if first.code == "empty-definition" and self._comment_follows(whole.end):
            hint = "`#` begins a comment. Elements are counted by `count x in SET: CONDITION`."
            found.mistakes[0] = first._replace(hint=hint)
        self.mistakes.extend(found.mistakes)
        broken = _broken(tokens)
        name = declared(found.repaired)
        if name is not None and found.keyword in ITEMS:
            broken = Broken(found.keyword, Name(name, whole), whole)
        elif tokens[0].type not in ITEM_KINDS:
            broken = Broken(
                found.keyword if found.keyword in ITEMS else broken.keyword, None, whole
            )
        self.items.append(broken)

    def _comment_follows(self, place: int) -> bool:
        """Whether the line goes on with a comment."""
        line = self.source.text[place:].partition("\n")[0]
        return line.lstrip().startswith("#")


def _blanked(text: str, comments: Sequence[Comment]) -> str:
    """A text with spaces for its comments."""
    parts = []
    done = 0
    for comment in comments:
        parts += [text[done : comment.start], " " * (comment.end - comment.start)]
        done = comment.end
    return "".join([*parts, text[done:]])


def _pieces(tokens: list[Token]) -> Iterator[list[Token]]:
    """The tokens, cut before every line that begins with an item keyword."""
    start = 0
    for i, token in enumerate(tokens):
        if (
            token.type in ITEM_KINDS
            and i > start
            and begins_line(tokens, i)
            and not _atom(tokens, i)
        ):
            yield tokens[start:i]
            start = i
    if start < len(tokens):
        yield tokens[start:]


def _atom(tokens: list[Token], number: int) -> bool:
    """Whether a `goal` on an indented line is part of an expression: `goal on(x, y)`."""
    token, following = tokens[number], tokens[number + 1 : number + 2]
    return (
        token.type == "_GOAL"
        and token.column != 1
        and any(other.type == "NAME" for other in following)
    )


def _broken(tokens: list[Token]) -> Broken:
    """What is left of an item that does not parse; a keyword that is none could be any."""
    words = [token for token in tokens[:3] if token.type != "BOUNDED"]
    known = [word for word in words[:1] if word.type in ITEM_KINDS]
    keyword = str(known[0]) if known else closest(words[0], ITEMS) or "" if words else ""
    name = None
    if keyword and len(words) > 1 and words[1].type == "NAME":
        name = Name(str(words[1]), span(words[1]))
    return Broken(keyword, name, span(tokens[0]).to(span(tokens[-1])))


def _about(code: str, message: str, place: int) -> Mistake:
    return Mistake(code, message, Span(place, place), None)


def _diagnostic(source: Source, mistake: Mistake) -> Diagnostic:
    place = Label(source, mistake.span)
    return Diagnostic(mistake.code, mistake.message, place, hint=mistake.hint, fix=mistake.fix)
