"""Characters that nobody sees: controls, signs that turn the direction of writing, odd spaces.

In a comment, too, a text may look like another one than it is; there, spaces and what joins
letters of some scripts are left alone.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

from sketchlang.diagnostics import Fix
from sketchlang.source import Span
from sketchlang.syntax.lexer import Comment
from sketchlang.syntax.mistake import Mistake

# Everything that is worth a closer look: most texts have none of it.
_SUSPECT = re.compile(
    r"[^\n\r\t -~\u00a1-\u00ac\u00ae-\u02ff\u0370-\u05ff\u2190-\u24ff\u2600-\u27ff]|\r(?!\n)"
)
_TURNING = frozenset("\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
_BYTE_ORDER_MARK = "\ufeff"


def suspicious(text: str) -> bool:
    """Whether a text has characters that `find` has to look at."""
    return _SUSPECT.search(text) is not None


def find(text: str, comments: Sequence[Comment]) -> tuple[str, list[Mistake]]:
    """The text with spaces in place of hidden characters, and one mistake for each kind."""
    places: dict[str, list[int]] = {}
    within = iter(comments)
    comment = next(within, None)
    for match in _SUSPECT.finditer(text):
        place, sign = match.start(), match[0]
        while comment is not None and comment.end <= place:
            comment = next(within, None)
        in_comment = comment is not None and comment.start <= place
        if (place and _hidden(sign, in_comment)) or _control(sign):
            places.setdefault(sign, []).append(place)
    characters = list(text)
    for found in places.values():
        for place in found:
            characters[place] = " "
    return "".join(characters), [_mistake(sign, found) for sign, found in places.items()]


def _control(sign: str) -> bool:
    return sign in _TURNING or unicodedata.category(sign) in {"Cc", "Zl", "Zp"}


def _hidden(sign: str, in_comment: bool) -> bool:
    if in_comment:
        return _control(sign)
    return _control(sign) or unicodedata.category(sign) in {"Cf", "Zs"}


def _mistake(sign: str, places: Sequence[int]) -> Mistake:
    first = Span(places[0], places[0] + 1)
    name = unicodedata.name(sign, "a control character").lower()
    count = f", the first of {len(places)}" if len(places) > 1 else ""
    space = unicodedata.category(sign) == "Zs"
    article = "" if name.startswith("a ") else "the character "
    message = f"here is {article}{name} (U+{ord(sign):04X}){count}, which cannot be seen"
    if space:
        message = f"this space is of another kind ({name}, U+{ord(sign):04X}){count}"
    hint = "Write an ordinary space." if space else "Delete it."
    return Mistake("hidden-character", message, first, hint, Fix(first, " " if space else ""))
