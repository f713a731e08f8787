"""Reports about PDDL tasks: plans in the competitions' format, judged by a replay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from domains.pddl.breadth import Breadth
from domains.pddl.ground.task import GroundTask
from domains.pddl.novelty import Atoms
from domains.pddl.plan import plan_text, step_of
from domains.pddl.replay import Verdict, replay
from domains.pddl.show import by_predicate
from domains.pddl.state import State, atom_texts
from domains.pddl.successors import Successors
from runtime.plan.partial import MARK
from runtime.reporting import Document, Profile, Solves, TextPicture
from runtime.search.siw_r import Outcome
from sketchlang.domain import Picture
from sketchlang.files import write_text
from sketchlang.model import SketchModel
from sketchlang.version import __version__

LISTED = 5
"""So many parts of a goal are named that do not hold."""


@dataclass(frozen=True)
class PddlDocument:
    """The plan of an outcome."""

    task: GroundTask
    sketch: str
    planner: str
    outcome: Outcome
    execution_time: float = 0.0
    execution_lower_bound: float | None = None

    @property
    def actions(self) -> list[str]:
        """The actions as a plan has them."""
        return [action.name for subgoal in self.outcome.subgoals for action in subgoal.actions]

    @property
    def cost(self) -> int:
        """What the plan costs: the number of its actions where the domain has no costs."""
        actions = [action for subgoal in self.outcome.subgoals for action in subgoal.actions]
        priced = any(action.costs for action in self.task.pddl.domain.actions)
        return sum(action.cost if priced else 1 for action in actions)

    def save(self, path: Path) -> None:
        """Write the plan file."""
        pddl = self.task.pddl
        rules = ", ".join(subgoal.rule for subgoal in self.outcome.subgoals)
        notes = {
            **({} if self.outcome.solved else {MARK: self.outcome.reason}),
            "sketchlang": __version__,
            "domain": pddl.domain.source.name,
            "task": pddl.source.name,
            "sketch": self.sketch,
            "planner": self.planner,
            "rules": rules,
            "cost": self.cost,
        }
        write_text(path, plan_text(self.actions, notes))

    def validate(self) -> Verdict:
        """Replay the plan."""
        return replay(self.task.pddl, [step_of(action) for action in self.actions])


@dataclass(frozen=True, eq=False)
class PddlReporting:
    """A PDDL task as people and files see it."""

    task: GroundTask
    generator: Successors

    @property
    def robot(self) -> str | None:
        """There is none."""
        return None

    def warm_up(self) -> None:
        """Compile the kernels and make the arrays of operators."""
        everything = Atoms((1 << self.task.layout.size) - 1, 0)
        Breadth(self.generator, everything, 1, self.task.initial).grow(1)
        next(self.generator.following(self.task.initial), None)

    def describe(self, actions: Sequence[Any]) -> str:
        """The actions as a plan has them."""
        return " ".join(action.name for action in actions)

    def profile(self) -> Profile:
        """X has no steps."""
        return {}

    def document(self, model: SketchModel, outcome: Outcome, planner: str, seed: int) -> Document:
        """The plan of an outcome, as far as it came."""
        return PddlDocument(self.task, model.name, planner, outcome)

    def picture(self, state: State) -> Picture:
        """The atoms that change and are true, by predicate, and what the goal still lacks."""
        lines = [f"{name}: {' '.join(texts)}" for name, texts in by_predicate(atom_texts(state))]
        missing = self.task.open_goals(state.bits)
        return TextPicture((*lines, f"parts of the goal that do not hold: {missing}"))

    def scene_files(self, state: State) -> dict[str, str]:
        """The task with this state at the start, and its domain, to be found beside it."""
        from domains.pddl.started import started_from

        return {".pddl": started_from(state), "-domain.pddl": self.task.pddl.domain.source.text}

    def hopeless(self, solves: Solves | None = None) -> list[dict[str, Any]]:
        """The parts of the goal that no number of actions can bring about, not even if no action
        made anything false."""
        if self.task.goal:
            return []
        parts = self.task.unreachable or ("it has no case",)
        return [
            {"cause": "unreachable goal", "text": f"the goal can never be reached: {part}"}
            for part in parts
        ]

    def why(self, outcome: Outcome, solves: Solves) -> list[dict[str, Any]]:
        """What the goal asks for and is not so where the search ended."""
        if not self.task.goal:
            return []
        parts = self.task.open_parts(outcome.state.bits)
        texts = [f"the goal is not reached: {part}" for part in parts[:LISTED]]
        if len(parts) > LISTED:
            texts.append(f"{len(parts) - LISTED} more parts of the goal do not hold")
        return [{"cause": "open goal", "text": text} for text in texts]
