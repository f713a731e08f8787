"""Sketches that are not proved to terminate: the loop that `terminate` finds on them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sketchlang.analysis.limits import Budget
from sketchlang.analysis.termination import NonTerminating, Terminating, decide_termination
from sketchlang.analysis.words import listed
from sketchlang.model import SketchModel

SECONDS = 2.0
"""What a proof may take before a run."""

NAMED = 6
"""Rules of a loop up to which they are named."""


@dataclass(frozen=True)
class Loop:
    """Rules that can be followed for ever; none are known where the proof was not finished in
    time."""

    rules: tuple[str, ...]

    @property
    def text(self) -> str:
        """The loop in words, as the subject of a sentence."""
        return listed(self.rules) if len(self.rules) <= NAMED else f"{len(self.rules)} rules"

    @property
    def warning(self) -> dict[str, Any]:
        """The warning before a run."""
        text = "the sketch is not proved to terminate"
        if self.rules:
            text += f": {self.text} can go on for ever"
        else:
            text += f" within {SECONDS:g} s: `sketchlang terminate` may tell more"
        return {"cause": "termination", "rules": list(self.rules), "text": text}


def loop_of(model: SketchModel, seconds: float = SECONDS) -> Loop | None:
    """A loop of a sketch, one without rules where that was not found out in time; None if the
    sketch is proved to terminate."""
    if not model.rules:
        return None
    verdict = decide_termination(model, Budget(seconds))
    if isinstance(verdict, Terminating):
        return None
    rules: tuple[str, ...] = ()
    if isinstance(verdict, NonTerminating):
        rules = tuple(dict.fromkeys(model.rules[move.rule].name for move in verdict.walk))
    return Loop(rules)


def circle(model: SketchModel, rules: list[str], returned_to: int) -> dict[str, Any]:
    """The finding about a state that came back after the subgoals of `rules`."""
    where = f"of subgoal {returned_to}" if returned_to else "at the start"
    used = list(dict.fromkeys(rules))
    text = f"the state {where} again: {listed(used)} go round in a circle"
    loop = loop_of(model)
    if loop is not None and loop.rules:
        same = set(loop.rules) == set(used)
        text += f", {'the' if same else 'and a'} loop that `terminate` finds"
        text += "" if same else f" is {loop.text}"
    found = [] if loop is None else list(loop.rules)
    return {"cause": "loop", "rules": used, "terminate": found, "text": text}
