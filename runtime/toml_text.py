"""Tables of Python values as the text of a TOML file."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def document(data: Mapping[str, Any]) -> str:
    """A file whose tables, and lists of tables, are at its top: values come first."""
    plain = {key: value for key, value in data.items() if not _is_tables(value)}
    parts = [_lines(plain)] if plain else []
    for key, value in data.items():
        if isinstance(value, Mapping):
            parts.append(f"[{_key(key)}]\n{_lines(value)}")
        elif _is_tables(value):
            parts += [f"[[{_key(key)}]]\n{_lines(table)}" for table in value]
    return "\n".join(parts)


def inline(value: Any) -> str:
    """A value in one line: text, a truth value, a number, a list or a table of these."""
    match value:
        case bool():
            return "true" if value else "false"
        case int():
            return repr(value)
        case float():
            return repr(float(value))  # NumPy's floats are floats, too, and print their type
        case str():
            # Escapes of JSON are escapes of TOML; only DEL is to be written as one there.
            return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
        case Mapping():
            inside = ", ".join(f"{_key(key)} = {inline(each)}" for key, each in value.items())
            return f"{{ {inside} }}" if inside else "{}"
        case Sequence():
            return f"[{', '.join(map(inline, value))}]"
    raise TypeError(f"TOML has no {type(value).__name__}")


def _is_tables(value: Any) -> bool:
    """Whether a value has headings of its own."""
    if isinstance(value, Mapping):
        return True
    return isinstance(value, list) and bool(value) and all(isinstance(v, Mapping) for v in value)


def _lines(table: Mapping[str, Any]) -> str:
    return "".join(f"{_key(key)} = {inline(value)}\n" for key, value in table.items())


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else inline(key)
