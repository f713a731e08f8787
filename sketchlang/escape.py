"""The one place where text of others is made fit to be shown.

Names of files, objects and rules, and whatever stands in a file, may hold characters that move a
cursor, change colours, turn the direction of writing, or end a line and begin a command of a CI
service. Everything that is printed, drawn or exported goes through one of these functions.
"""

from __future__ import annotations

import json
import re
from typing import Any

_BESIDES_LINES = re.compile(r"[^\x20-\x7e\n]")
_UNSAFE_IN_NAMES = re.compile(r"[^A-Za-z0-9_-]")
_ENTITIES = (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ('"', "&quot;"), ("'", "&#x27;"))
LONGEST_PART = 60
"""Characters of a name that become part of a file's name."""


def visible(text: str, keep: str = "") -> str:
    r"""A text in which every character is seen: `\x1b`, `\n`, `\u202e` stand for the others.

    What is not printable is what Unicode calls controls, formats (among them those that turn
    the direction of writing), surrogates, unassigned, and all spaces but the usual one. `keep`
    are characters that are left as they are.
    """
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() or c in keep else c.encode("unicode_escape").decode() for c in text
    )


def shown_line(text: str) -> str:
    """A text as one line for a terminal or a log.

    Lines that begin with `::` or `##[` are commands to CI services; those of others' making
    must not be.
    """
    text = visible(text)
    start = text.lstrip()
    if start.startswith(("::", "##[", "##vso[")):
        return f"\\x{ord(start[0]):02x}{start[1:]}"
    return text


def shown_lines(text: str) -> str:
    """A text of several lines, each of them as `shown_line` makes it."""
    return "\n".join(map(shown_line, text.split("\n")))


def markup(text: str) -> str:
    """A text for HTML, SVG and XML, between tags or in a quoted attribute."""
    # Not by `html`, whose import is as long as all of this.
    text = visible(text)
    for sign, code in _ENTITIES:
        text = text.replace(sign, code)
    return text


def dumps(value: Any, indent: int | None = None, compact: bool = False) -> str:
    """JSON that is the same data and shows every character that does not print as `\\uXXXX`."""
    separators = (",", ":") if compact else None
    text = json.dumps(value, indent=indent, ensure_ascii=False, separators=separators)
    return _BESIDES_LINES.sub(_json_escape, text)


def _json_escape(match: re.Match[str]) -> str:
    char = match.group()
    return char if char.isprintable() else json.dumps(char)[1:-1]


def all_visible(value: Any, keep: str = "\n\t") -> Any:
    """Plain data (of JSON) with every text in it, keys too, made visible."""
    if isinstance(value, str):
        return visible(value, keep)
    if isinstance(value, dict):
        return {all_visible(k, keep): all_visible(v, keep) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [all_visible(entry, keep) for entry in value]
    return value


def file_part(name: str) -> str:
    """A name as a part of a file's name: it cannot lead to another folder, or be hidden."""
    return _UNSAFE_IN_NAMES.sub("_", name)[:LONGEST_PART]
