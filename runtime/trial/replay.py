"""Findings as files: a scene, and the actions that lead to the state that shows something."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from runtime.reporting import Restartable
from runtime.search.guide import Values
from runtime.search.problem import SearchProblem
from runtime.trial.explore import successors
from sketchlang.compile import CompiledSketch
from sketchlang.errors import InputError
from sketchlang.reading import read_json

if TYPE_CHECKING:
    from runtime.solve import Task


@dataclass(frozen=True)
class Recorded:
    """What a file says of a finding."""

    file: str
    scene: str
    seed: int
    text: str
    actions: tuple[str, ...]


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
    return Recorded(file, scene, seed, text, tuple(actions))


def states(
    problem: SearchProblem, file: str, seed: int, actions: Sequence[str]
) -> Iterator[tuple[str, Any]]:
    """Each action with the state after it, the start first.

    Raises:
        InputError: an action is not possible where it is asked for.
    """
    rng = np.random.default_rng(seed)
    state = problem.initial
    yield "(start)", state
    for number, wanted in enumerate(actions, start=1):
        for action, after in successors(problem, state, rng):
            if str(action) == wanted:
                state = after
                break
        else:
            raise InputError(
                f"action {number}, {wanted!r}, is not possible in this scene", place=file
            )
        yield wanted, state


def replayed(
    sketch: CompiledSketch, problem: SearchProblem, found: Recorded
) -> Iterator[tuple[str, Values]]:
    """Each action with the feature values after it, the start first.

    Raises:
        InputError: an action is not possible where it is asked for.
    """
    for action, state in states(problem, found.file, found.seed, found.actions):
        yield action, sketch.evaluate(state)


def scene_files(task: Task, file: str, seed: int, actions: Sequence[str]) -> Mapping[str, str]:
    """A scene that starts in the state to which actions lead, see `Restartable`; empty where the
    domain cannot write one.

    Raises:
        InputError: an action is not possible where it is asked for.
    """
    if not isinstance(task.reporting, Restartable):
        return {}
    *_, (_, state) = states(task.problem, file, seed, actions)
    return task.reporting.scene_files(state)
