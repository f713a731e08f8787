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


@dataclass(frozen=True, slots=True)
class Box:
    """A node. `key` is unique in the drawing and made of letters and digits."""

    key: str
    lines: tuple[str, ...]
    look: Look = Look.PLAIN
    step: int | None = None


@dataclass(frozen=True, slots=True)
class Arrow:
    """An edge. `step` is the step of the proof that removes it; None: none does.

    `endless` marks the counterexample.
    """

    source: str
    target: str
    label: str
    step: int | None = None
    endless: bool = False


@dataclass(frozen=True, slots=True)
class Drawing:
    """`legend` says what the steps of the proof that occur in the picture do."""

    title: str
    boxes: tuple[Box, ...]
    arrows: tuple[Arrow, ...]
    legend: tuple[tuple[int, str], ...]


COLOURS = (
    "#0072b2",
    "#e69f00",
    "#009e73",
    "#cc79a7",
    "#56b4e9",
    "#8c6d31",
    "#7b5ea7",
    "#5f9e3a",
)
"""One a step, told apart by most people with impaired colour vision (after Okabe and Ito)."""

ENDLESS = "#c8102e"
"""The counterexample."""

UNREMOVED = "#444444"


def colour(step: int | None, endless: bool = False) -> str:
    """The colour of what a step removes."""
    if endless:
        return ENDLESS
    return UNREMOVED if step is None else COLOURS[(step - 1) % len(COLOURS)]
