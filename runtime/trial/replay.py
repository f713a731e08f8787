"""Findings as files: a scene, and the actions that lead to the state that shows something.

Actions of domains with geometry are sampled, so each has the seed with it of which it was.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from runtime.search.guide import Values
from runtime.search.problem import SearchProblem
from runtime.trial.explore import Sample, successors
from sketchlang.compile import CompiledSketch
from sketchlang.errors import InputError
from sketchlang.reading import read_json


@dataclass(frozen=True)
class Recorded:
    """What a file says of a finding; see `Seen` for the samples that its actions are from."""

    file: str
    scene: str
    seed: int
    text: str
    actions: tuple[str, ...]
    samples: tuple[Sample | None, ...]


def read(file: str, format_: str) -> Recorded:
    """A finding from a file.

    Raises:
        InputError: it cannot be read, or is no such file.
    """
    data = read_json(file)
    if not isinstance(data, dict) or data.get("format") != format_ or data.get("version") != 1:
        raise InputError("this is no finding of `sketchlang test`", place=file)
    scene, seed, text = data.get("scene"), data.get("seed"), data.get("text")
    actions = data.get("actions")
    if (
        not isinstance(scene, str)
        or type(seed) is not int
        or seed < 0
        or not isinstance(text, str)
        or not isinstance(actions, list)
        or not all(isinstance(action, str) for action in actions)
    ):
        raise InputError("`scene`, `seed`, `text` or `actions` is not as it should be", place=file)
    samples = _samples(data.get("samples", [None] * len(actions)))
    if samples is None or len(samples) != len(actions):
        raise InputError("`samples` is not as it should be", place=file)
    return Recorded(file, scene, seed, text, tuple(actions), samples)


def _samples(values: Any) -> tuple[Sample | None, ...] | None:
    """The samples of a file: null, or a seed and the number of the attempt."""
    if not isinstance(values, list):
        return None
    for value in values:
        numbers = [] if value is None else value
        if not isinstance(numbers, list) or len(numbers) not in (0, 2):
            return None
        if not all(type(number) is int and 0 <= number < 1 << 32 for number in numbers):
            return None
    return tuple(Sample(*value) if value else None for value in values)


def states(problem: SearchProblem, found: Recorded) -> Iterator[tuple[str, Any]]:
    """Each action of a finding with the state after it, the start first.

    Raises:
        InputError: an action is not possible where it is asked for.
    """
    rng = np.random.default_rng(found.seed)
    state = problem.initial
    subproblem = problem.subproblem(state, 0, rng)
    yield "(start)", state
    for number, (wanted, sample) in enumerate(
        zip(found.actions, found.samples, strict=True), start=1
    ):
        if sample is not None:
            subproblem = sample.of(problem, state)
        for action, after in successors(subproblem, state):
            if str(action) == wanted:
                state = after
                break
        else:
            raise InputError(
                f"action {number}, {wanted!r}, is not possible in this scene", place=found.file
            )
        yield wanted, state


def replayed(
    sketch: CompiledSketch, problem: SearchProblem, found: Recorded
) -> Iterator[tuple[str, Values]]:
    """Each action with the feature values after it, the start first.

    Raises:
        InputError: an action is not possible where it is asked for.
    """
    for action, state in states(problem, found):
        yield action, sketch.evaluate(state)
