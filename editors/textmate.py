"""The TextMate grammar, made of the Lark grammar: `python -m editors.textmate`.

VS Code, Sublime Text, JetBrains IDEs and others colour texts by such a grammar. A terminal that
has no scope of its own below gets one by its looks: a new word or sign is coloured at once.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from sketchlang.syntax import grammar
from sketchlang.syntax.repair import ITEMS

FILE = Path(__file__).parent / "vscode" / "syntaxes" / "sketch.tmLanguage.json"

_SCOPES = {
    "storage.type": ["BOOL", "NAT"],
    "constant.language": ["TRUE", "FALSE"],
    "keyword.operator.effect": ["DEC", "INC", "ANY"],
    "keyword.operator.comparison": ["EQ", "NE", "LE", "GE", "LT", "GT"],
    "keyword.operator.arrow": ["_ARROW"],
    "keyword.operator.logical": ["_AND", "_OR", "NOT"],
    "punctuation.separator": ["_COMMA", "_COLON"],
    "punctuation.section": ["_LPAR", "_RPAR", "_LBRACE", "_RBRACE"],
    "constant.numeric": ["NUMBER"],
    "string.quoted.double": ["STRING"],
    "comment.line.number-sign": ["COMMENT"],
    "variable.other": ["NAME"],
    "invalid.illegal": ["UNCLOSED_STRING"],
}
_LEFT_OUT = {"NEWLINE", "SPACE", "ERROR"}


def scope(terminal: str, pattern: str) -> str:
    """The scope of a terminal with its pattern."""
    for name, terminals in _SCOPES.items():
        if terminal in terminals:
            return name
    if grammar.spellings().get(terminal) in ITEMS:
        return "keyword.control"
    return "keyword.other" if re.search(r"[a-z]", pattern) else "keyword.operator"


def build() -> dict[str, Any]:
    """The grammar as data."""
    declaring = ("sketch", "feature", "define", "rule")
    declarations = "|".join(word for word in ITEMS if word in declaring)
    patterns: list[dict[str, Any]] = [
        {
            "match": rf"\b({declarations})\s+([A-Za-z_][A-Za-z0-9_]*)",
            "captures": {
                "1": {"name": "keyword.control.sketch"},
                "2": {"name": "entity.name.function.sketch"},
            },
        }
    ]
    for terminal, pattern in _ordered():
        spelled = rf"\b{pattern}\b" if pattern.isalpha() else pattern
        patterns.append({"match": spelled, "name": f"{scope(terminal, pattern)}.sketch"})
    return {
        "information_for_contributors": [
            "Made by `python -m editors.textmate` of grammars/sketch.lark: do not edit."
        ],
        "name": "Sketch",
        "scopeName": "source.sketch",
        "fileTypes": ["sketch"],
        "patterns": patterns,
    }


def _ordered() -> list[tuple[str, str]]:
    """Terminals with their patterns in the order in which they are tried: words before names,
    longer signs before shorter ones."""
    found = []
    for terminal in grammar.load().terminals:
        if terminal.name in _LEFT_OUT:
            continue
        pattern = terminal.pattern.to_regexp()
        # What Lark tries first comes first: `!=` before `!`.
        word = pattern.isalpha() or r"\b" in pattern or terminal.priority > 0
        rank = 0 if terminal.name in ("COMMENT", "STRING") else 1 if word else 2
        if terminal.name == "NAME":
            rank = 3
        order = rank, -terminal.priority, -len(terminal.pattern.value)
        found.append((*order, terminal.name, pattern))
    return [(name, pattern) for *_, name, pattern in sorted(found)]


def render() -> str:
    """The text of the file."""
    return json.dumps(build(), indent=2, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    FILE.parent.mkdir(parents=True, exist_ok=True)
    FILE.write_text(render(), encoding="utf-8")
