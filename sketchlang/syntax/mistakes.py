"""What to say where the parser is stuck."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sketchlang.diagnostics import Fix
from sketchlang.suggest import closest
from sketchlang.syntax import examples, grammar
from sketchlang.syntax.item import END, StuckError
from sketchlang.syntax.lexer import ERROR, UNCLOSED_STRING, span
from sketchlang.syntax.mistake import Mistake
from sketchlang.syntax.repair import ITEMS

if TYPE_CHECKING:
    from lark import Token


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

# Types of other languages with two values.
_TRUTH = {"boolean", "flag", "truth", "logical", "predicate", "binary", "bit", "proposition"}

# Words that people bring from other languages.
FOREIGN = {
    "exists": "some",
    "any": "some",
    "forall": "all",
    "every": "all",
    "implies": "->",
    "&&": "and",
    "||": "or",
    "int": "nat",
    "integer": "nat",
    "boolean": "bool",
}

_WORDS = grammar.spellings() | {
    "NOT": "!",
    "NAME": "a name",
    "NUMBER": "a number",
    "STRING": "a quoted path",
    "CLOSURE": "+",
}
_DESCRIPTIONS = {"NAME", "NUMBER", "STRING"}
_EXPRESSION = frozenset({"NAME", "NUMBER", "TRUE", "_LPAR", "SOME"})
_COMPARISONS = frozenset({"EQ", "NE", "LT", "LE", "GT", "GE", "IN"})
_OPERATORS = _COMPARISONS | {"_AND", "_OR", "_ARROW", "_PLUS", "BAR", "MINUS", "_AMP"}

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
    if token.type == UNCLOSED_STRING:
        return Mistake("unclosed-string", 'this text has no closing `"`', place, None)
    if token.type == ERROR:
        return unexpected(token)
    if stuck.number == 0:
        return unknown_item(token)
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
    fix = None
    if code == "unknown-type" and token.type == "NAME":
        meant = "bool" if token.lower() in _TRUTH else closest(token, ("bool", "nat")) or "nat"
        hint, fix = f"Write `{meant}`.", Fix(place, meant)
    return Mistake(code, message.replace("{found}", found), place, hint, fix)


def _expected(stuck: StuckError) -> str:
    expected = set(stuck.expected)
    parts = []
    if expected >= _EXPRESSION:
        parts.append("an expression")
        expected -= {"NAME", "NUMBER", "TRUE", "FALSE", "_LPAR", "NOT", "SOME", "ALL"}
        expected -= {"COUNT", "SUM", "MIN", "MAX", "_GOAL", "_IF", "_LBRACE"}
    if expected >= _OPERATORS:
        parts.append("an operator")
        expected -= _OPERATORS | {"CLOSURE"}
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
    """A word of another language, at the place or just before it."""
    for token in (stuck.token, stuck.previous):
        meant = FOREIGN.get(token) if token is not None else None
        if token is not None and meant:
            return f"Write `{meant}` for `{token}`."
    return None


def _bounded(stuck: StuckError) -> str | None:
    """What to write for `feature n : nat bounded`."""
    if stuck.token == "bounded" and stuck.number:
        return "Write `bounded` before `feature`, as in `bounded feature n : nat`."
    return None


def unexpected(token: Token) -> Mistake:
    """What to say of characters that no terminal of the grammar has."""
    hint = "The signs of the language are `{ } ( ) , : = != < > <= >= + ! -> -- ++ ?`."
    if token[0].isidentifier():
        hint = "Names consist of the letters a to z and A to Z, digits and `_`."
    message = f"{_printable(token)} means nothing here"
    return Mistake("unexpected-character", message, span(token), hint)


def _printable(token: Token) -> str:
    if token.isprintable():
        return describe(token)
    if len(token) == 1:
        return f"the character U+{ord(token):04X}"
    return f"this run of {len(token)} characters"


def unknown_item(token: Token) -> Mistake:
    """What to say of a line that begins with no keyword."""
    meant = closest(token, ITEMS)
    hint = (
        f"Did you mean `{meant}`?"
        if meant
        else ("An item begins with one of: " + ", ".join(f"`{word}`" for word in ITEMS) + ".")
    )
    fix = Fix(span(token), meant) if meant else None
    return Mistake("unknown-item", f"{describe(token)} begins no item", span(token), hint, fix)
