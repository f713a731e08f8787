"""What is wrong with an item that does not parse: every mistake that can be told.

Where the phrasebook knows what was meant, the item is read on as if it had been written so, and
the next mistake is looked for.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from sketchlang.diagnostics import Fix
from sketchlang.source import Span
from sketchlang.syntax import phrases, shapes
from sketchlang.syntax.grammar import spellings
from sketchlang.syntax.item import StuckError, TooDeepError, parse_item
from sketchlang.syntax.lexer import span, tokenize
from sketchlang.syntax.mistake import Mistake
from sketchlang.syntax.rejected import RejectedError
from sketchlang.syntax.tree import Broken, FeatureItem, Item, RuleItem

if TYPE_CHECKING:
    from lark import Token

MAX_REPAIRS = 10
"""Mistakes in one item after which it is given up."""

_VAGUE = {"syntax-error", "unexpected-character", "unknown-item", "unclosed-string"}

MAX_LENGTH = 2000
"""Characters of an item that is looked at so closely."""

BUDGET = 200_000
"""Characters of a file that are read again to try what a phrase would put in: about a second."""


class Diagnosis(NamedTuple):
    """The mistakes of an item, and what it stands for as far as that can be told."""

    mistakes: list[Mistake]
    keyword: str
    repaired: Item | None


@dataclass
class Budget:
    """How many characters may still be read again."""

    left: int = BUDGET

    def spend(self, text: str) -> bool:
        """Take what reading a text costs; False where nothing is left."""
        self.left -= len(text) + 50
        return self.left > 0


def diagnose(
    text: str,
    start: int,
    stuck: StuckError,
    otherwise: Callable[[StuckError], Mistake],
    budget: Budget,
) -> Diagnosis:
    """The mistakes of the item `text`, which stands at `start` in its file and got `stuck`.

    `otherwise` says what is wrong where the phrasebook is silent.
    """
    keyword = keyword_of(stuck.first)
    if len(text) > MAX_LENGTH or not budget.spend(text):
        return Diagnosis([otherwise(stuck)], keyword, None)
    mistakes: list[Mistake] = []
    # How far places in the text are ahead of those in the file, after what was put right.
    shift = start
    place = span(stuck.token)
    place = Span(place.start - start, place.end - start)
    stands_for = keyword
    while True:
        found = _phrase(text, keyword, place, budget, mending=True)
        whole = None
        if not mistakes and (found is None or failure(_applied(text, found)) is not None):
            whole = _shape(text, keyword)
        if whole is not None:
            mistake = _reshaped(text, whole, place, start, otherwise(stuck))
            return Diagnosis([mistake], whole.partition(" ")[0], _item(whole))
        found = found or _phrase(text, keyword, place, budget, mending=False)
        if found is None:
            if not mistakes:
                mistakes.append(otherwise(stuck))
            return Diagnosis(mistakes, stands_for, None)
        where = Span(max(start, found.span.start + shift), found.span.end + shift)
        fix = None if found.text is None else Fix(where, found.text)
        mistake = Mistake(found.phrase.code, found.message, where, found.hint, fix)
        if mistake[:2] != (mistakes[-1][:2] if mistakes else ()) or mistakes[-1].hint != found.hint:
            mistakes.append(mistake)
        stands_for = found.phrase.stands_for or stands_for
        if found.text is None or found.phrase.alone or len(mistakes) >= MAX_REPAIRS:
            mended = None if found.text is None else _item(_applied(text, found))
            return Diagnosis(mistakes, stands_for, mended)
        shift += found.span.end - found.span.start - len(found.text)
        text = _applied(text, found)
        next_place = failure(text)
        if next_place is None:
            return Diagnosis(mistakes, stands_for, _item(text))
        place, keyword = next_place, keyword_of(tokenize(text)[0][0])


def keyword_of(token: Token) -> str:
    """The keyword of the item that a token begins, or `unknown`."""
    word = spellings().get(token.type, "")
    if word == "bounded":
        return "feature"
    return word if word in ITEMS else "unknown"


ITEMS = (
    "sketch",
    "use",
    "include",
    "bounded",
    "feature",
    "define",
    "invariant",
    "atoms",
    "goal",
    "rule",
)
"""The words that items begin with."""


def failure(text: str) -> Span | None:
    """Where the parser is stuck in a text, or None if it is an item."""
    tokens, _ = tokenize(text)
    if not tokens:
        return Span(0, len(text))
    try:
        parse_item(tokens)
    except StuckError as stuck:
        return span(stuck.token)
    except (TooDeepError, RejectedError):
        return None
    return None


def _phrase(
    text: str, keyword: str, place: Span, budget: Budget, mending: bool
) -> phrases.Found | None:
    for found in phrases.find(text, keyword, place, mending):
        if found.text is None or (budget.spend(text) and _helps(text, found, place)):
            return found
    return None


def _helps(text: str, found: phrases.Found, place: Span) -> bool:
    """Whether the parser gets beyond what a phrase would put in, and beyond where it was."""
    assert found.text is not None
    if found.text.startswith("#"):
        return True
    mended = _applied(text, found)
    reached = failure(mended)
    if reached is None:
        return True
    grown = len(mended) - len(text)
    after = found.span.start + len(found.text.rstrip())
    return reached.start >= after and reached.start > place.start + min(grown, 0)


def _applied(text: str, found: phrases.Found) -> str:
    return text[: found.span.start] + (found.text or "") + text[found.span.end :]


def _shape(text: str, keyword: str) -> str | None:
    """The item in the shape of the language, if that is all that it lacks."""
    candidates = [*shapes.goals(text)] if keyword in ("goal", "unknown") else []
    if keyword in ("rule", "unknown"):
        candidates += shapes.rules(text)
    return next((whole for whole in candidates if failure(whole) is None), None)


def _reshaped(text: str, whole: str, place: Span, start: int, plain: Mistake) -> Mistake:
    """`plain` is what is said without a suggestion: if it is to the point, it stays."""
    kind = whole.partition(" ")[0]
    shape = "rule NAME { CONDITIONS } -> { EFFECTS }" if kind == "rule" else "goal { CONDITIONS }"
    stripped = text.rstrip()
    where = Span(start + min(place.start, len(stripped)), start + min(place.end, len(stripped)))
    code, message = plain.code, plain.message
    if code in _VAGUE:
        code, message = phrases.FOREIGN, f"a {kind} is written `{shape}`"
    return Mistake(
        code,
        message,
        where,
        f"Write `{whole if len(whole) <= 100 else shape}`.",
        Fix(Span(start, start + len(stripped)), whole),
    )


def _item(text: str) -> Item | None:
    tokens, _ = tokenize(text)
    try:
        return parse_item(tokens)
    except (StuckError, TooDeepError, RejectedError, IndexError):
        return None


def declared(item: Item | None) -> str | None:
    """The name that an item declares for others to use."""
    if isinstance(item, (FeatureItem, RuleItem)):
        return item.name.text
    name = getattr(item, "name", None)
    return name.text if name is not None and not isinstance(item, Broken) else None
