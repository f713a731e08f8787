"""In which line of a TOML file a table or a key stands; `tomllib` does not say.

The text is known to be TOML. Only what begins a line is found: keys inside inline tables are
looked for in the line of the key that holds them.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

HEADER = re.compile(r"\s*(\[\[?)\s*([^\[\]]+?)\s*\]")
KEY = re.compile(r"""\s*("[^"]*"|'[^']*'|[A-Za-z0-9_-]+)\s*[.=]""")
STRING = re.compile(r'''"""|\'\'\'|"(?:\\.|[^"\\])*"|'[^']*'|#.*|[\[\]{}]''')


@dataclass
class Lines:
    """Numbers of lines, from 1: of tables by name and how many of that name came before, of
    keys by table, number and key."""

    tables: dict[tuple[str, int], int] = field(default_factory=dict)
    keys: dict[tuple[str, int, str], int] = field(default_factory=dict)

    def of(self, table: str, number: int, key: str | None = None) -> int | None:
        """The line of a key, or of its table where it has none."""
        found = None if key is None else self.keys.get((table, number, key))
        return found or self.tables.get((table, number))


def lines_of(text: str) -> Lines:
    """Where everything stands in a text."""
    found = Lines()
    table, number, depth, quote = "", 0, 0, ""
    counted: dict[str, int] = {}
    for line, content in enumerate(text.splitlines(), 1):
        if not quote and depth == 0:
            header, key = HEADER.match(content), KEY.match(content)
            if header:
                table = header[2].strip("\"'")
                number = counted.get(table, 0)
                counted[table] = number + 1
                found.tables[table, number] = line
                continue
            if key:
                found.keys.setdefault((table, number, key[1].strip("\"'")), line)
        depth, quote = _after(content, depth, quote)
    return found


def _after(content: str, depth: int, quote: str) -> tuple[int, str]:
    """How many brackets, and which string of several lines, are open behind a line."""
    at = 0
    while at < len(content):
        if quote:
            end = content.find(quote, at)
            if end < 0:
                return depth, quote
            at, quote = end + 3, ""
            continue
        token = STRING.search(content, at)
        if token is None or token[0].startswith("#"):
            break
        at = token.end()
        if token[0] in ('"""', "'''"):
            quote = token[0]
        elif token[0] in "[{":
            depth += 1
        elif token[0] in "]}":
            depth = max(0, depth - 1)
    return depth, quote
