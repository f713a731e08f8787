"""Pages that are run: their files, their commands, and what they show.

A fenced block `sketch NAME` is a file, a block `console` has commands after `$ ` and what they
show. A line `...` stands for any lines. Times, places and counts differ from run to run.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

REST = "..."
_BLOCK = re.compile(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_VOLATILE = re.compile(
    r"-?\d+\.\d+|\d+(?= (?:s\b|ms\b|robot configurations|states? generated|actions?\b|subplans?\b))"
)


@dataclass(frozen=True)
class Write:
    """A file that the reader writes."""

    name: str
    text: str


@dataclass(frozen=True)
class Command:
    """A command line, and what the page shows of its output."""

    line: str
    shown: tuple[str, ...]


def steps(page: Path) -> Iterator[Write | Command]:
    """What a reader of a page does, in order."""
    for kind, name, text in _BLOCK.findall(page.read_text(encoding="utf-8")):
        if kind == "sketch":
            yield Write(name, text)
        elif kind == "console":
            for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
                line, *shown = part.rstrip("\n").split("\n")
                yield Command(line, tuple(shown))


def settled(line: str) -> str:
    """A line without what differs from run to run."""
    return " ".join(_VOLATILE.sub("N", line).split())


def agrees(shown: tuple[str, ...], output: str) -> str | None:
    """What of a page's lines is not in an output, in their order; None if all of it is."""
    lines = [settled(line) for line in output.rstrip("\n").split("\n")]
    place, anywhere = 0, False
    for line in shown:
        if line == REST:
            anywhere = True
            continue
        wanted = settled(line)
        if anywhere:
            while place < len(lines) and lines[place] != wanted:
                place += 1
        if place >= len(lines) or lines[place] != wanted:
            found = lines[place] if place < len(lines) else "the end"
            return f"expected {line!r}, found {found!r}"
        place, anywhere = place + 1, False
    if not anywhere and place < len(lines):
        return f"more than the page shows: {lines[place]!r}"
    return None
