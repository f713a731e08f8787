"""Plans in the format of the planning competitions: one action in parentheses a line.

What `sketchlang validate` needs besides stands in comments: `; task: FILE`, `; domain: FILE`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from sketchlang.errors import InputError
from sketchlang.reading import MEGABYTE, read_text

MAX_PLAN = 64 * MEGABYTE
_STEP = re.compile(r"\(\s*([^\s()]+)((?:\s+[^\s()]+)*)\s*\)")
_NOTE = re.compile(r";\s*([a-z][a-z -]*?)\s*[:=]\s*(.*)")


@dataclass(frozen=True, slots=True)
class Step:
    """One action of a plan."""

    name: str
    arguments: tuple[str, ...]


@dataclass(frozen=True)
class PddlPlan:
    """The actions of a plan, and the notes in its comments."""

    steps: list[Step]
    notes: Mapping[str, str] = field(default_factory=dict)


def read_plan(path: str | Path) -> PddlPlan:
    """Read a plan file.

    Raises:
        InputError: what is wrong with it, and in which line.
    """
    steps: list[Step] = []
    notes: dict[str, str] = {}
    for number, line in enumerate(read_text(path, MAX_PLAN).splitlines(), 1):
        text, _, _ = line.partition(";")
        note = _NOTE.fullmatch(line.strip())
        if note:
            notes.setdefault(note[1], note[2])
        if not text.strip():
            continue
        found = _STEP.fullmatch(text.strip())
        if found is None:
            raise InputError(
                "expected an action in parentheses",
                place=f"{path}:{number}",
                hint="plans have one action a line, like `(move a b)`",
            )
        steps.append(Step(found[1].lower(), tuple(found[2].lower().split())))
    return PddlPlan(steps, notes)


def step_of(action: str) -> Step:
    """The step of an operator's name, which is written as in a plan."""
    name, *arguments = action.strip("()").split()
    return Step(name, tuple(arguments))


def plan_text(actions: Iterable[str], notes: Mapping[str, object]) -> str:
    """The text of a plan file."""
    lines = [f"; {name}: {value}" for name, value in notes.items()]
    return "\n".join([*lines, *actions]) + "\n"


def is_plan(path: str | Path) -> bool:
    """Whether a file looks like such a plan and not like JSON."""
    try:
        if not Path(path).is_file():
            return False
        with Path(path).open("rb") as file:
            start = file.read(4096).decode("utf-8", errors="replace").lstrip()
    except OSError:
        return False
    return start.startswith((";", "("))
