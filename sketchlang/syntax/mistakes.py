"""What to say where the parser is stuck."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from sketchlang.source import Span
from sketchlang.suggest import did_you_mean
from sketchlang.syntax import examples, grammar
from sketchlang.syntax.item import END, StuckError
from sketchlang.syntax.lexer import ERROR, span

if TYPE_CHECKING:
    from lark import Token


class Mistake(NamedTuple):
    """Code, message, place and hint of one syntax error."""

    code: str
    message: str
    span: Span
    hint: str | None


# Message and hint of every code of grammars/mistakes.txt; {found} is the offending token.
MESSAGES: dict[str, tuple[str, str | None]] = {
    "feature-without-type": (
        "a feature needs a type, found {found}",
        "Write `feature NAME : bool` or `feature NAME : nat` (a whole number from 0 on).",
    ),
    "unknown-type": (
        "a feature is of type `bool` or `nat`, not {found}",
        "Use `nat` for whole numbers from 0 on.",
    ),
    "parameter-without-type": (
        "a parameter needs a type, found {found}",
        "Write `define NAME(PARAMETER : TYPE) = ...` with `bool`, `nat` or a sort.",
    ),
    "empty-definition": ("an expression is missing", None),
    "missing-name": ("expected a name, found {found}", None),
    "missing-arrow": (
        "expected `->` between conditions and effects, found {found}",
        "Write `rule NAME { CONDITIONS } -> { EFFECTS }`.",
    ),
    "missing-brace": (
        "expected `{`, found {found}",
        "Conditions, effects and goals are written in braces.",
    ),
    "unclosed-block": ("expected `}`, found {found}", "Close the list with `}`."),
    "missing-separator": ("expected `,` before {found}", None),
    "or-in-rule": (
        "alternatives are not allowed here",
        "Write a rule for each alternative, or a Boolean feature that is defined with `or`.",
    ),
    "expression-in-rule": (
        "rules and goals name features only, found {found}",
        "Define a feature for the expression and name it here.",
    ),
    "prefix-sign": (
        "{found} stands before the name of a feature",
        "Write the sign after the name, as in `n--`, `n++` or `n?`.",
    ),
    "double-equals": ("`==` is not an operator", "Write `=`."),
    "missing-in": (
        "expected `in`, found {found}",
        "Write `some x in SET: ...`, and so on.",
    ),
    "missing-body": (
        "this quantifier has no body",
        "Write `some x in SET: CONDITION` or `sum x in SET where CONDITION: NUMBER`.",
    ),
    "unclosed-parenthesis": ("expected `)`, found {found}", None),
    "unmatched-parenthesis": ("this `)` closes nothing", None),
    "keyword-default": (
        "there is no `min` or `max` here that `default` could belong to",
        "Write `min x in SET: NUMBER default NUMBER`.",
    ),
}

# Words that people bring from other languages.
FOREIGN = {
    "exists": "some",
    "any": "some",
    "forall": "all",
    "every": "all",
    "if": "->",
    "implies": "->",
    "int": "nat",
    "integer": "nat",
    "boolean": "bool",
}

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
_WORDS = grammar.spellings() | {
    "NOT": "!",
    "NAME": "a name",
    "NUMBER": "a number",
    "STRING": "a quoted path",
}
_DESCRIPTIONS = {"NAME", "NUMBER", "STRING"}
_EXPRESSION = frozenset({"NAME", "NUMBER", "TRUE", "_LPAR", "SOME"})
_COMPARISONS = frozenset({"EQ", "NE", "LT", "LE", "GT", "GE", "IN"})
_OPERATORS = _COMPARISONS | {"_AND", "_OR", "_ARROW", "_PLUS"}

ITEM_KINDS = frozenset(kind for kind, word in grammar.spellings().items() if word in ITEMS)
"""The terminals that items begin with."""


def is_word(token: Token) -> bool:
    """Whether a token is a keyword of the language."""
    return token.type not in {"NAME", ERROR} and token.isidentifier()


def describe(token: Token) -> str:
    """A token in a sentence."""
    if token.type == END:
        return "the end of the item"
    text = token if len(token) <= 30 else token[:29] + "…"
    return f"the keyword `{text}`" if is_word(token) else f"`{text}`"


def explain(stuck: StuckError) -> Mistake:
    """The diagnostic for a token that cannot stand where it is."""
    token = stuck.token
    place = span(token)
    if is_word(token) and "NAME" in stuck.expected and not stuck.expected & {"NUMBER"}:
        return Mistake(
            "keyword-as-name",
            f"`{token}` is a keyword and cannot be a name",
            place,
            f"Choose another name, for example `{token}_`.",
        )
    if token.type in ITEM_KINDS and END in stuck.expected:
        return Mistake(
            "items-on-one-line",
            f"{describe(token)} begins an item in the middle of a line",
            place,
            _bounded(stuck) or "Begin every item on a line of its own.",
        )
    code = examples.mistakes().get(stuck.place)
    if code is None:
        return Mistake("syntax-error", _expected(stuck), place, _foreign(stuck))
    message, hint = MESSAGES[code]
    found = describe(token)
    if code == "unknown-type":
        hint = did_you_mean(token, ("bool", "nat")) or hint
    return Mistake(code, message.replace("{found}", found), place, hint)


def _expected(stuck: StuckError) -> str:
    expected = set(stuck.expected)
    parts = []
    if expected >= _EXPRESSION:
        parts.append("an expression")
        expected -= {"NAME", "NUMBER", "TRUE", "FALSE", "_LPAR", "NOT", "SOME", "ALL"}
        expected -= {"COUNT", "SUM", "MIN", "MAX"}
    if expected >= _OPERATORS:
        parts.append("an operator")
        expected -= _OPERATORS
    elif expected >= _COMPARISONS - {"IN"}:
        parts.append("a comparison")
        expected -= _COMPARISONS
    if END in expected:
        parts.append("the end of the item")
        expected.discard(END)
    for kind in sorted(expected):
        word = _WORDS[kind]
        parts.append(word if kind in _DESCRIPTIONS else f"`{word}`")
    listed = parts[0] if len(parts) == 1 else ", ".join(parts[:-1]) + " or " + parts[-1]
    return f"expected {listed}, found {describe(stuck.token)}"


def _foreign(stuck: StuckError) -> str | None:
    """A word or sign of another language, at the place or just before it."""
    arrow = _foreign_arrow(stuck)
    if arrow is not None:
        return arrow
    for token in (stuck.token, stuck.previous):
        meant = FOREIGN.get(token) if token is not None else None
        if token is not None and meant:
            return f"Write `{meant}` for `{token}`."
    return None


def _foreign_arrow(stuck: StuckError) -> str | None:
    """What to write for `=>` and `<->`, which are two signs here."""
    before, token = stuck.previous, stuck.token
    if before is None or before.end_pos != token.start_pos:
        return None
    if (before.type, token.type) == ("EQ", "GT"):
        return "Write `->` for `=>`."
    if (before.type, token.type) == ("LT", "_ARROW"):
        return "Write an implication `->` for each direction."
    return None


def _bounded(stuck: StuckError) -> str | None:
    """What to write for `feature n : nat bounded`."""
    if stuck.token == "bounded" and stuck.number:
        return "Write `bounded` before `feature`, as in `bounded feature n : nat`."
    return None
