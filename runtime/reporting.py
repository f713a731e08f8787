"""What is reported, written and judged about a problem; the search knows nothing of it."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import wrap
from typing import Any, Protocol, runtime_checkable

from runtime.search.classical import ClassicalProblem
from runtime.search.problem import SearchProblem
from runtime.search.siw_r import Outcome
from sketchlang.domain import Picture
from sketchlang.escape import shown_line
from sketchlang.files import write_text
from sketchlang.loader import Loaded
from sketchlang.model import SketchModel

Profile = dict[str, dict[str, float]]

Solves = Callable[[SearchProblem], bool]
"""Whether the sketch of a task solves another problem, one of a few subgoals, without much ado."""


class Verdict(Protocol):
    """What a judge found."""

    @property
    def valid(self) -> bool: ...

    @property
    def findings(self) -> Sequence[Any]: ...


class Document(Protocol):
    """The plan of an outcome: it can be written and judged."""

    def save(self, path: Path) -> None:
        """Write the plan file."""
        ...

    def validate(self) -> Verdict:
        """Judge the plan independently of the planner."""
        ...

    @property
    def execution_time(self) -> float:
        """Seconds that its motions take."""
        ...

    @property
    def execution_lower_bound(self) -> float | None:
        """Seconds that the motions of any plan of the task take at least, where that is known."""
        ...


@runtime_checkable
class Watchable(Protocol):
    """A document with motions that can be watched."""

    def page(self, sketch: Loaded, start: float = 0.0) -> str:
        """The page to watch the plan in a browser, which opens at a time.

        Raises:
            InputError: there is nothing to watch.
        """
        ...


class UnsayableError(Exception):
    """No scene can begin in a state; the text says why."""


@runtime_checkable
class Restartable(Protocol):
    """A problem whose states can be written as scenes that begin there."""

    def scene_files(self, state: Any) -> Mapping[str, str]:
        """Endings of file names and texts, the scene first.

        Raises:
            UnsayableError: the scene's format has no words for the state.
        """
        ...


class Reporting(Protocol):
    """A problem as people and files see it."""

    @property
    def robot(self) -> str | None:
        """The robot's name, or None where there is none."""
        ...

    def warm_up(self) -> None:
        """Do what must not count as planning time: compile kernels, load libraries."""
        ...

    def describe(self, actions: Sequence[Any]) -> str:
        """Actions in a few words."""
        ...

    def profile(self) -> Profile:
        """Calls, successes and time of each step of X; empty where there are none."""
        ...

    def document(self, model: SketchModel, outcome: Outcome, planner: str, seed: int) -> Document:
        """The plan of an outcome, as far as it came."""
        ...

    def picture(self, state: Any) -> Picture:
        """A state as people see it."""
        ...

    def hopeless(self, solves: Solves | None = None) -> list[dict[str, Any]]:
        """Findings that make the task impossible, before any search; empty where none are.
        `solves` is for tests of what would help."""
        ...

    def why(self, outcome: Outcome, solves: Solves) -> list[dict[str, Any]]:
        """Findings about an unsolved outcome: what is in the way of what. One that is `certain`
        would be so whatever a sketch does."""
        ...


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong with a plan: at which action (from 0), or None for all of it."""

    action: int | None
    message: str


@dataclass(frozen=True)
class ClassicalVerdict:
    """What a replay of a classical plan found wrong."""

    findings: tuple[Finding, ...]

    @property
    def valid(self) -> bool:
        """Whether nothing was found."""
        return not self.findings


@dataclass(frozen=True)
class ClassicalDocument:
    """The actions of a classical plan, by rule."""

    problem: Any
    sketch: str
    planner: str
    seed: int
    outcome: Outcome
    execution_time: float = 0.0
    execution_lower_bound: float | None = None

    def save(self, path: Path) -> None:
        """Write the plan as JSON."""
        actions = [str(a) for subgoal in self.outcome.subgoals for a in subgoal.actions]
        subgoals = [{"rule": s.rule, "actions": len(s.actions)} for s in self.outcome.subgoals]
        data = {
            "format": "sketchlang-actions",
            "version": 1,
            "sketch": self.sketch,
            "planner": self.planner,
            "seed": self.seed,
            **({} if self.outcome.solved else {"failure": self.failure}),
            "subgoals": subgoals,
            "actions": actions,
        }
        write_text(path, json.dumps(data, indent=1) + "\n")

    @property
    def failure(self) -> dict[str, Any]:
        """Why the plan does not go on to the goal."""
        return {"reason": self.outcome.reason, "why": self.outcome.why}

    def validate(self) -> ClassicalVerdict:
        """Replay the actions by the domain's own successors."""
        state, number = self.problem.initial, 0
        for subgoal in self.outcome.subgoals:
            for action, after in zip(subgoal.actions, subgoal.states, strict=True):
                if (action, after) not in list(self.problem.successors(state)):
                    message = f"{action} is not applicable where it is taken"
                    return ClassicalVerdict((Finding(number, message),))
                state, number = after, number + 1
        return ClassicalVerdict(())


_PARENTHESES = re.compile(r"\([^()]*\)")


@dataclass(frozen=True)
class TextPicture:
    """A state in lines of text."""

    lines: tuple[str, ...]

    def text(self, width: int, colour: bool) -> list[str]:
        """The lines, long ones broken."""
        found: list[str] = []
        for line in map(shown_line, self.lines):
            indent = line[: len(line) - len(line.lstrip())] + "    "
            # What is in parentheses stays together.
            joined = _PARENTHESES.sub(lambda match: match[0].replace(" ", "\0"), line)
            broken = wrap(joined, max(width, 40), subsequent_indent=indent, break_on_hyphens=False)
            found += [part.replace("\0", " ") for part in broken] or [""]
        return found

    def svg(self) -> str | None:
        """Text is not drawn."""
        return None

    def data(self) -> dict[str, Any]:
        """The lines."""
        return {"lines": list(self.lines)}


class ClassicalReporting:
    """Reports of a problem without geometry."""

    robot: str | None = None

    def __init__(self, problem: ClassicalProblem) -> None:
        self.problem = problem

    def warm_up(self) -> None:
        """Nothing to do."""

    def describe(self, actions: Sequence[Any]) -> str:
        """The actions as the domain prints them."""
        return ", ".join(map(str, actions))

    def profile(self) -> Profile:
        """X has no steps."""
        return {}

    def document(self, model: SketchModel, outcome: Outcome, planner: str, seed: int) -> Document:
        """The plan of an outcome."""
        return ClassicalDocument(self.problem.problem, model.name, planner, seed, outcome)

    def picture(self, state: Any) -> Picture:
        """The lines that the domain's problem has for a state (`picture(state)`), or else what
        Python prints for it."""
        picture = getattr(self.problem.problem, "picture", None)
        return TextPicture(tuple(picture(state)) if picture is not None else (repr(state),))

    def scene_files(self, state: Any) -> Mapping[str, str]:
        """What the domain's problem has as the text of a scene (`scene(state)`)."""
        scene = getattr(self.problem.problem, "scene", None)
        if scene is None:
            raise UnsayableError("its domain writes no scenes")
        text = scene(state)
        if text is None:
            raise UnsayableError("scenes of its domain cannot begin in such a state")
        return {".toml": text}

    def hopeless(self, solves: Solves | None = None) -> list[dict[str, Any]]:
        """Nothing is known before the search."""
        return []

    def why(self, outcome: Outcome, solves: Solves) -> list[dict[str, Any]]:
        """Nothing is known of what is in the way."""
        return []
