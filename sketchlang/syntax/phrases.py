"""The phrasebook: what people write who come from other languages, and how it is written here.

`grammars/phrasebook.toml` has the phrases, and says what their fields mean.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

from sketchlang.source import Span
from sketchlang.syntax.grammar import FOLDER
from sketchlang.syntax.signs import SIGNS

BOOK = FOLDER / "phrasebook.toml"
FOREIGN = "foreign-notation"
"""The code of phrases that have none of their own."""

_ARROW = re.compile(r"[-−–—=|]+>|→|↦|⇒|⟹|⟶|⟼|\bthen\b|\}\s*\{")
_NAME = r"\\b(?P<n>[A-Za-z_]\\w*)"
_HOLE = re.compile(r"\{(\w)\}")


@dataclass(frozen=True)
class Phrase:
    """One entry of the book. `examples` are pairs of items, before and after."""

    pattern: str
    says: str
    code: str = FOREIGN
    within: tuple[str, ...] = ()
    at: str = ""
    write: str | None = None
    rewrite: str | None = None
    hint: str | None = None
    stands_for: str = ""
    alone: bool = False
    examples: tuple[tuple[str, str], ...] = ()

    @cached_property
    def regex(self) -> re.Pattern[str]:
        """The pattern with its abbreviations spelled out."""
        text = re.sub(r"(?<![\w\\])N(?!\w)", _NAME, self.pattern)
        text = re.sub(r"(?<![\w\\])K(?!\w)", r"(?P<k>\\d+)", text, count=1)
        text = re.sub(r"(?<![\w\\])K(?!\w)", r"\\d+", text)
        text = re.sub(r"(?<!\\)~", r"\\s{1,80}", text)
        # Not any number: a search would take time with the square of it.
        return re.compile(text.replace(" ", r"\s{0,80}"))

    @property
    def mends(self) -> bool:
        """Whether it says what to write in place of the match."""
        return self.write is not None or self.rewrite is not None


@dataclass(frozen=True)
class Found:
    """A phrase in a text: where, what to say, and what to write there (None: no single text)."""

    phrase: Phrase
    span: Span
    message: str
    hint: str
    text: str | None


@cache
def phrases() -> tuple[Phrase, ...]:
    """All phrases, in the order of the book."""
    with BOOK.open("rb") as file:
        entries = tomllib.load(file)["phrase"]
    return tuple(map(_phrase, entries))


def _phrase(entry: dict[str, Any]) -> Phrase:
    entry["within"] = tuple(entry.get("within", ()))
    entry["examples"] = tuple(map(tuple, entry.get("examples", ())))
    return Phrase(**entry)


def find(text: str, keyword: str, place: Span, mending: bool) -> Iterator[Found]:
    """The phrases of an item's text that touch a place, of those that mend (or say all there is
    to say) or of the others.

    `keyword` is the item's, or `unknown`.
    """
    arrow = _ARROW.search(text)
    for phrase in phrases():
        decisive = phrase.mends or phrase.alone
        if decisive is not mending or not _applies(phrase, keyword):
            continue
        for match in phrase.regex.finditer(text):
            if _fits(phrase, match, text, place) and _inside(phrase, keyword, match, arrow):
                yield _found(phrase, match)
                break


def _applies(phrase: Phrase, keyword: str) -> bool:
    parts = {"conditions", "effects", "rule"} if keyword == "rule" else {keyword}
    return not phrase.within or bool(parts & set(phrase.within))


def _inside(
    phrase: Phrase, keyword: str, match: re.Match[str], arrow: re.Match[str] | None
) -> bool:
    """Whether a match in a rule is on the side of the arrow that the phrase is for."""
    if keyword != "rule" or not phrase.within or "rule" in phrase.within:
        return True
    after = arrow is not None and match.start() >= arrow.end()
    return ("effects" if after else "conditions") in phrase.within


def _fits(phrase: Phrase, match: re.Match[str], text: str, place: Span) -> bool:
    start, end = match.span()
    reach = end + len(text[end:]) - len(text[end:].lstrip())
    if start == end or not (start <= place.end and reach >= place.start):
        return False
    match phrase.at:
        case "start":
            return start == 0
        case "line":
            return not text[text.rfind("\n", 0, start) + 1 : start].strip()
        case "end":
            return not text[end:].strip()
    return True


def _found(phrase: Phrase, match: re.Match[str]) -> Found:
    def filled(template: str) -> str:
        return _HOLE.sub(lambda hole: _spelled(match.groupdict().get(hole[1])), template)

    write = None
    if phrase.rewrite is not None:
        write = _REWRITES[phrase.rewrite](match)
    elif phrase.write is not None:
        write = filled(phrase.write)
    hint = filled(phrase.hint) if phrase.hint else f"Write `{(write or '').strip()}`."
    start, end = match.span()
    end -= len(match[0]) - len(match[0].rstrip())
    start += len(match[0]) - len(match[0].lstrip())
    return Found(phrase, Span(start, end), filled(phrase.says), hint, write)


def _spelled(group: str | None) -> str:
    return SIGNS.get(group, group) if group else ""


# What a template cannot say.


def _atoms(match: re.Match[str]) -> str:
    return "atoms " + ", ".join(name for name in re.findall(r"\w+", match["a"]) if name != "and")


def _joined(match: re.Match[str]) -> str:
    keyword = match[0].split()[0]
    return f"{keyword} {match['a']}" + re.sub(r"[^\w]+", "_", match["b"])


def _count(match: re.Match[str]) -> str:
    return f"count {match['x']} in {match['s']}: {_closed(match['c']) or 'true'}"


def _quantifier(match: re.Match[str]) -> str:
    kind = "some" if match["q"] == "any" else match["q"]
    where = f" where {_closed(match['c'])}" if match["c"] else ""
    return f"{kind} {match['x']} in {match['s']}{where}: {_closed(match['b'])}"


def _closed(text: str | None) -> str:
    """A part of an expression with the parentheses that its end lost to what stood around it."""
    text = text or ""
    return text + ")" * (text.count("(") - text.count(")"))


_REWRITES: dict[str, Callable[[re.Match[str]], str]] = {
    "atoms": _atoms,
    "joined": _joined,
    "count": _count,
    "quantifier": _quantifier,
}
