"""What a picture shows, before anything is said about where or in which format."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class TooLargeError(Exception):
    """The sketch has too much of something for this view; the text says what."""


class Look(Enum):
    """What a box stands for."""

    PLAIN = "plain"
    GOAL = "goal"
    GAP = "gap"  # no rule can be used there
    RULE = "rule"  # where the arrows of one rule from one valuation part


@dataclass(frozen=True, slots=True)
class Box:
    """A node. `key` is unique in the drawing and made of letters and digits.

    `step` is the step of the proof after which no arrow leads on from it. `covers` are the
    valuations that it stands for: a `0`, `1` or `*` for each feature. `start`: a run starts here.
    """

    key: str
    lines: tuple[str, ...]
    look: Look = Look.PLAIN
    step: int | None = None
    covers: tuple[str, ...] = ()
    start: bool = False


@dataclass(frozen=True, slots=True)
class Arrow:
    """An edge. `step` is the step of the proof that removes it; None: none does.

    `endless` marks the counterexample. `rules` are the rules that it stands for.
    """

    source: str
    target: str
    label: str
    step: int | None = None
    endless: bool = False
    rules: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Drawing:
    """`legend` says what the steps of the proof that occur in the picture do."""

    title: str
    boxes: tuple[Box, ...]
    arrows: tuple[Arrow, ...]
    legend: tuple[tuple[int, str], ...]


COLOURS = (
    "#0063a6",
    "#a34a00",
    "#00704f",
    "#a8327d",
    "#1b6f96",
    "#7a5a1e",
    "#6a4a96",
    "#437a23",
)
"""One a step, after Okabe and Ito: told apart by most people with impaired colour vision, and dark
enough to be read as text on white (a contrast of 4.5 to 1)."""

ENDLESS = "#b80d28"
"""The counterexample."""

UNREMOVED = "#444444"


def colour(step: int | None, endless: bool = False) -> str:
    """The colour of what a step removes."""
    if endless:
        return ENDLESS
    return UNREMOVED if step is None else COLOURS[(step - 1) % len(COLOURS)]
