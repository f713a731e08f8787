"""Text to tokens. What no terminal of the grammar matches becomes an `ERROR` token."""

from __future__ import annotations

import re
from typing import NamedTuple

from grammars.table import KEYWORDS, PATTERNS

ERROR = "ERROR"
UNCLOSED_STRING = "UNCLOSED_STRING"


class Token(NamedTuple):
    """One word or sign; `first` tells whether it is the first one on its line, `flush`
    whether there is not even space before it."""

    kind: str
    text: str
    start: int
    end: int
    first: bool
    flush: bool = False


class Comment(NamedTuple):
    """A `#` comment without its line break; `first` as for tokens."""

    text: str
    start: int
    end: int
    first: bool


# Signs that nothing else claims are taken together, so that `@@@` is one mistake.
_MASTER = re.compile(
    "|".join(
        f"(?P<{name}>{pattern})"
        for name, pattern in [
            *PATTERNS,
            (UNCLOSED_STRING, r'"[^"\n]*'),
            (ERROR, r"[^\w\s\"#(){},:=<>!?+¬∧∨↦→↓↑∃∀∈≠≤≥]+|\w+|."),
        ]
    )
)


def tokenize(text: str) -> tuple[list[Token], list[Comment]]:
    """All tokens and all comments of a text, in order."""
    tokens: list[Token] = []
    comments: list[Comment] = []
    keywords = KEYWORDS
    first = True
    for match in _MASTER.finditer(text):
        kind = match.lastgroup
        if kind == "SPACE":
            continue
        if kind == "NEWLINE":
            first = True
            continue
        start, end = match.span()
        word = text[start:end]
        if kind == "COMMENT":
            comments.append(Comment(word.rstrip(), start, end, first))
            continue
        if kind == "NAME":
            kind = keywords.get(word, "NAME")
        elif kind == ERROR and tokens and tokens[-1].end == start and word[0].isalpha():
            # `größe`: the whole word is wrong, not its middle.
            start = tokens.pop().start
            word = text[start:end]
        assert kind is not None
        flush = first and (start == 0 or text[start - 1] == "\n")
        tokens.append(Token(kind, word, start, end, first, flush))
        first = False
    return tokens, comments
