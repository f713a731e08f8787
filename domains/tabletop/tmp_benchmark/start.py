"""Where a robot of another size than the benchmark's PR2 can start."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from pathlib import Path

from domains.tabletop.problem import load_problem
from domains.tabletop.tmp_benchmark.problem import Problem
from domains.tabletop.tmp_benchmark.scene import scene_of
from domains.tabletop.tmp_benchmark.wanted import Wanted
from domains.tabletop.why.before import before
from sketchlang.domain import LoadOptions
from sketchlang.errors import InputError

STEP = 0.1
FURTHEST = 1.5
"""Metres between places that are tried, and to the last of them."""

TURNS = (0, 1, -1, 2, -2, 3, -3, 4)
"""Quarters of a right angle from straight back, in the order in which they are tried."""


def with_free_start(
    problem: Problem,
    wanted: Wanted,
    path: Path,
    robot: str | None,
    *,
    separate: bool = False,
    any_grasp: bool = False,
) -> tuple[str, list[str]]:
    """The text of a scene file at `path`, in which the robot (None: the default one) starts as
    near as it can to where the PR2 does; and notes, also on what this robot cannot do there. The
    file is written in any case.

    Raises:
        InputError: the goal wants what a scene cannot say, or the scene is not sound.
    """
    first = None
    for start in _starts(problem.start):
        text, notes = scene_of(problem, wanted, path.parent, separate, any_grasp, start)
        path.write_text(text, encoding="utf-8")
        try:
            loaded = load_problem(str(path), LoadOptions(robot=robot))
        except InputError as error:
            if "robot_start" not in str(error):
                raise _named(error, path) from None
            first = first or error
            continue
        if start != problem.start:
            x, y, _ = start
            notes.append(
                f"the robot has no room where the PR2 starts: at ({x:.2f}, {y:.2f}) it has"
            )
        return text, [*notes, *(finding["text"] for finding in before(loaded))]
    assert first is not None
    raise _named(first, path)


def _starts(start: tuple[float, float, float]) -> Iterator[tuple[float, float, float]]:
    """The given one, and others with the same heading, the nearest first, backwards first."""
    x, y, yaw = start
    yield start
    for ring, turn in itertools.product(range(1, round(FURTHEST / STEP) + 1), TURNS):
        way = yaw + math.pi + turn * math.pi / 4
        yield x + ring * STEP * math.cos(way), y + ring * STEP * math.sin(way), yaw


def _named(error: InputError, path: Path) -> InputError:
    """The error without the name of a file that is not there yet."""
    said = str(error).splitlines()[0].replace(str(path), "").lstrip(": ")
    return InputError(f"the scene is not sound: {said}")
