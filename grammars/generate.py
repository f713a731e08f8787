"""Makes `table.py` of `sketch.lark` and `mistakes.txt`: `python -m grammars.generate`.

Lark works out the LALR table; reading it back is all that `sketchlang` has to do, which
saves every command the time to import Lark and compile the grammar.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from lark import Lark, Token
from lark.exceptions import UnexpectedToken
from lark.parsers.lalr_analysis import Shift

HERE = Path(__file__).parent
END = "$END"


def build() -> Lark:
    """The grammar as a Lark parser."""
    text = (HERE / "sketch.lark").read_text(encoding="utf-8")
    return Lark(text, parser="lalr", lexer="basic", maybe_placeholders=False)


def mistakes(parser: Lark, text: str) -> dict[tuple[int, str], str]:
    """Parser state and offending terminal of every example, with its code."""
    numbers = numbering(parser)
    found: dict[tuple[int, str], str] = {}
    origin: dict[tuple[int, str], str] = {}
    code = ""
    for line in text.splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        if not line.startswith(" "):
            code = line.strip()
            continue
        example = line.strip()
        state, terminal = stuck_at(parser, example)
        key = numbers[state], terminal
        if found.setdefault(key, code) != code:
            raise ValueError(f"{code}: {example!r} is stuck where {origin[key]!r} is")
        origin.setdefault(key, example)
    return found


def stuck_at(parser: Lark, example: str) -> tuple[int, str]:
    """State and terminal at which the parser stops in an item that is a mistake."""
    interactive = parser.parse_interactive(example)
    try:
        last = Token(END, "")
        for last in interactive.lexer_thread.lex(interactive.parser_state):
            interactive.feed_token(last)
        interactive.feed_eof(last)
    except UnexpectedToken as error:
        return settled(parser, error.state.state_stack), error.token.type
    raise ValueError(f"{example!r} is no mistake")


def settled(parser: Lark, states: Sequence[int]) -> int:
    """The state after all reductions that do not depend on what follows."""
    table = parser.parser.parser._parse_table
    stack = list(states)
    while True:
        row = table.states[stack[-1]]
        actions = {entry for symbol, entry in row.items() if symbol.isupper() or symbol == END}
        if len(actions) != 1 or (only := actions.pop())[0] is Shift:
            return stack[-1]
        rule = only[1]
        del stack[-len(rule.expansion) :]
        stack.append(table.states[stack[-1]][rule.origin.name][1])


def numbering(parser: Lark) -> dict[int, int]:
    """Lark's states in the order in which they are reached from the first one.

    Lark numbers them by the iteration order of sets, which changes from run to run.
    """
    table = parser.parser.parser._parse_table
    numbers = {table.start_states["start"]: 0}
    todo = list(numbers)
    for state in todo:
        for _, (action, target) in sorted(table.states[state].items(), key=lambda e: e[0]):
            if action is Shift and target not in numbers:
                numbers[target] = len(numbers)
                todo.append(target)
    return numbers


def tables(parser: Lark) -> dict[str, Any]:
    """Everything that `sketchlang.syntax` needs, as plain data."""
    numbers, parse_table = numbering(parser), parser.parser.parser._parse_table
    rules = {rule: number for number, rule in enumerate(parser.rules)}
    actions: list[dict[str, int]] = []
    gotos: list[dict[str, int]] = []
    for state in numbers:
        row = parse_table.states[state]
        on_terminal: dict[str, int] = {}
        on_rule: dict[str, int] = {}
        for symbol, (action, argument) in sorted(row.items(), key=lambda e: e[0]):
            if action is not Shift:
                on_terminal[symbol] = ~rules[argument]
            elif symbol.isupper() or symbol == END:
                on_terminal[symbol] = numbers[argument]
            else:
                on_rule[symbol] = numbers[argument]
        actions.append(on_terminal)
        gotos.append(on_rule)
    keywords, patterns = terminals(parser)
    return {
        "PATTERNS": patterns,
        "KEYWORDS": keywords,
        "PRODUCTIONS": [production(rule) for rule in parser.rules],
        "ACTIONS": actions,
        "GOTOS": gotos,
        "START": numbers[parse_table.start_states["start"]],
        "END": numbers[parse_table.end_states["start"]],
        "MISTAKES": mistakes(parser, (HERE / "mistakes.txt").read_text(encoding="utf-8")),
    }


def terminals(parser: Lark) -> tuple[dict[str, str], list[tuple[str, str]]]:
    """Keywords, and the other terminals' patterns in the order in which they are tried."""
    keywords: dict[str, str] = {}
    others = []
    for terminal in parser.terminals:
        pattern = terminal.pattern
        if pattern.type == "str" and pattern.value.isalpha():
            keywords[pattern.value] = terminal.name
        else:
            order = (-terminal.priority, -pattern.max_width, -len(pattern.value), terminal.name)
            others.append((order, terminal.name, pattern.to_regexp()))
    return keywords, [(name, pattern) for _, name, pattern in sorted(others)]


def production(rule: Any) -> tuple[str, int, str, tuple[int, ...]]:
    """Origin, length, what to do with the children, and which children are kept.

    What to do: an action's name, "" to splice the children into the parent's, "?" to
    stand for the only child.
    """
    kept = tuple(
        i for i, symbol in enumerate(rule.expansion) if not (symbol.is_term and symbol.filter_out)
    )
    origin = str(rule.origin.name)
    if rule.alias:
        action = rule.alias
    elif origin.startswith("_"):
        action = ""
    elif rule.options.expand1 and len(kept) == 1:
        action = "?"
    else:
        action = origin
    return origin, len(rule.expansion), action, kept


def render(values: dict[str, Any]) -> str:
    """The text of `table.py`."""
    lines = [
        '"""Made by `python -m grammars.generate` of sketch.lark and mistakes.txt: do not edit."""',
        "",
        "# ruff: noqa",
        "# fmt: off",
        "from __future__ import annotations",
        "",
    ]
    types = {
        "PATTERNS": "list[tuple[str, str]]",
        "KEYWORDS": "dict[str, str]",
        "PRODUCTIONS": "list[tuple[str, int, str, tuple[int, ...]]]",
        "ACTIONS": "list[dict[str, int]]",
        "GOTOS": "list[dict[str, int]]",
        "START": "int",
        "END": "int",
        "MISTAKES": "dict[tuple[int, str], str]",
    }
    for name, value in values.items():
        if isinstance(value, list):
            lines.append(f"{name}: {types[name]} = [")
            lines.extend(f"    {entry!r}," for entry in value)
            lines.append("]")
        elif isinstance(value, dict):
            lines.append(f"{name}: {types[name]} = {{")
            lines.extend(f"    {key!r}: {entry!r}," for key, entry in value.items())
            lines.append("}")
        else:
            lines.append(f"{name}: {types[name]} = {value!r}")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    (HERE / "table.py").write_text(render(tables(build())), encoding="utf-8")
