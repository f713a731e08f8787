"""What states of scenes say of a sketch: false promises, holes, dead ends, widths."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from runtime.search.classical import ClassicalProblem
from runtime.search.guide import GOAL, Guide, Values
from runtime.search.limits import Limits, OutOfPatienceError, OutOfTimeError
from runtime.search.problem import Action, SearchProblem
from runtime.trial.explore import Explored, Sample, Seen, climb, explore
from runtime.trial.width import Width, width_of
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.termination import NonTerminating, decide_termination
from sketchlang.analysis.words import counted, cube, listed
from sketchlang.checking.checker import CheckedSketch
from sketchlang.compile import CompiledSketch, compile_sketch
from sketchlang.compile.errors import shown
from sketchlang.model import Effect, Rule, SketchModel, holds

ERRORS = ("invariant", "bounded", "dead-end")
"""Kinds of findings that make the sketch wrong. The others may be as the author wants them."""


SUBPROBLEM_SECONDS = 3.0
"""Time for the search from one state. A subproblem that takes longer counts as too wide."""

EXPLORING = 0.4
"""The part of a scene's time in which its states are looked for."""

PROOF_SECONDS = 2.0
"""Time to find out whether the sketch terminates."""


@dataclass(frozen=True)
class Effort:
    """How much to look at: states of a scene, subproblems of a scene, the largest k, states
    that are searched for any subgoal at all, and steps of a climb."""

    states: int = 2000
    subproblems: int = 120
    k_max: int = 2
    search: int = 20_000
    climb: int = 400


@dataclass(frozen=True)
class Finding:
    """`kind` is one of `invariant`, `bounded`, `dead-end`, `width`, `uncovered`, `never-fires`,
    `endless`; `actions` lead from the scene's initial state to where it can be seen, as they are
    sampled (`Seen`); `done` says them in a few words. `states` are those on the way, and last
    this one."""

    kind: str
    text: str
    scene: str | None = None
    actions: tuple[str, ...] = ()
    done: str = ""
    state: str | None = None
    values: Values | None = None
    samples: tuple[Sample | None, ...] = ()
    states: tuple[Any, ...] = field(default=(), compare=False, repr=False)

    @property
    def is_error(self) -> bool:
        """Whether the sketch is wrong, or at least these states say so."""
        return self.kind in ERRORS


@dataclass
class Trial:
    """What was found in all scenes so far. `widths` is by rule: the largest width that is known,
    None if some subproblem needs more than was tried; `by_scene` the same by scene."""

    model: SketchModel
    findings: list[Finding] = field(default_factory=list)
    states: dict[str, int] = field(default_factory=dict)
    complete: dict[str, bool] = field(default_factory=dict)
    subproblems: int = 0
    widths: dict[str, int | None] = field(default_factory=dict)
    by_scene: dict[str, int | None] = field(default_factory=dict)
    applied: set[str] = field(default_factory=set)
    valuations: set[int] = field(default_factory=set)
    out_of_time: bool = False

    def width(self) -> int | None:
        """The largest width of all subproblems, None if one needs more than was tried."""
        known = [width for width in self.by_scene.values() if width is not None]
        return max(known, default=0) if len(known) == len(self.by_scene) else None


def without_invariants(checked: CheckedSketch) -> CompiledSketch:
    """The sketch with evaluators that do not stop where an invariant is false."""
    return compile_sketch(replace(checked, model=replace(checked.model, invariants=())))


Describe = Callable[[Sequence[Action]], str]


def _each(actions: Sequence[Action]) -> str:
    return ", ".join(map(str, actions))


class Examiner:
    """Examines scenes one after another with one sketch."""

    def __init__(self, checked: CheckedSketch, effort: Effort, seed: int) -> None:
        self.sketch = without_invariants(checked)
        self.effort = effort
        self.limits = Limits()
        self.rng = np.random.default_rng(seed)
        self.trial = Trial(checked.model)
        self._wide: set[str] = set()
        self._told: set[tuple[str, object]] = set()

    def examine(
        self, scene: str, problem: SearchProblem, seconds: float, describe: Describe = _each
    ) -> None:
        """Looks at the states of a scene for so many seconds; `describe` puts actions in words.

        Raises:
            EvaluationError: a function of the domain breaks its promise.
        """
        guide = Guide(self.sketch)
        self._wide = set()
        self._describe = describe
        self.limits = Limits(timeout=seconds, k_max=self.effort.k_max)
        self.trial.states[scene], self.trial.complete[scene] = 0, False
        try:
            early = replace(self.limits, timeout=seconds * EXPLORING)
            found = explore(problem, guide, self.effort.states, early, self.rng)
            self.trial.out_of_time |= found.cut
            self.trial.states[scene] = len(found.states)
            self.trial.complete[scene] = found.complete
            for seen in found.states:
                self._look(scene, seen, guide)
            self._climbs(scene, problem, guide)
            self._subproblems(scene, problem, guide, found)
        except OutOfTimeError:
            self.trial.out_of_time = True

    def _look(self, scene: str, seen: Seen, guide: Guide) -> None:
        """Invariants and coverage of one state."""
        model, values = self.trial.model, seen.values
        self.trial.valuations.add(sum((v > 0) << f for f, v in enumerate(values)))
        for number, invariant in enumerate(model.invariants):
            if not holds(invariant.formula, values):
                self._tell("invariant", number, f"invariant {invariant.text} is false", scene, seen)
        if guide.is_goal(values, seen.state):
            return
        applicable = [rule for rule in model.rules if rule.applies(values)]
        self.trial.applied.update(rule.name for rule in applicable)
        if not any(_possible(rule, values) for rule in applicable):
            where = _valuation(model, values)
            if applicable:
                names = " and ".join(rule.name for rule in applicable)
                text = f"the effects of {names} cannot happen at {where}, and no other rule applies"
            else:
                text = f"no rule applies at {where}"
            self._tell("uncovered", where, text, scene, seen)

    def _climbs(self, scene: str, problem: SearchProblem, guide: Guide) -> None:
        for f, feature in enumerate(self.trial.model.features):
            if not feature.bounded:
                continue
            top = climb(problem, guide, f, self.effort.climb, self.limits, self.rng)
            if top is not None:
                after = counted(len(top.actions()), "action")
                text = (
                    f"{feature.name} is declared bounded, but after {after} "
                    f"it is {top.values[f]} and still rises"
                )
                self._tell("bounded", f, text, scene, top)

    def _subproblems(
        self, scene: str, problem: SearchProblem, guide: Guide, found: Explored
    ) -> None:
        """Widths: along a run from the start, and from a sample of the states."""
        for seen in (*self._run(problem, guide), *self._sample(found.states)):
            # One state of a valuation that is too wide is enough: such searches take long.
            where = _valuation(self.trial.model, seen.values)
            if guide.is_goal(seen.values, seen.state) or where in self._wide:
                continue
            self._measure(scene, problem, guide, seen)

    def _sample(self, states: Sequence[Seen]) -> list[Seen]:
        if len(states) <= self.effort.subproblems:
            return list(states)
        chosen = self.rng.choice(len(states), self.effort.subproblems, replace=False)
        return [states[i] for i in sorted(chosen)]

    def _run(self, problem: SearchProblem, guide: Guide) -> list[Seen]:
        """The states at which the sketch itself arrives, from the start on."""
        seen = Seen(problem.initial, guide.values(problem.initial))
        run: dict[object, Seen] = {}
        while seen.state not in run and not guide.is_goal(seen.values, seen.state):
            self.limits.check()
            if len(run) >= self.effort.subproblems:
                break
            run[seen.state] = seen
            found = self._width(problem, guide, seen)
            sample = found.sample
            for action, after in found.path:
                seen = Seen(after, guide.values(after), seen, action, sample)
                sample = None
        return list(run.values())

    def _width(self, problem: SearchProblem, guide: Guide, seen: Seen) -> Width:
        self.limits.check()
        timeout = SUBPROBLEM_SECONDS
        if self.limits.timeout is not None:
            timeout = min(timeout, self.limits.timeout - self.limits.elapsed())
        limits = Limits(timeout=timeout, k_max=self.effort.k_max)
        k_max, search = self.effort.k_max, self.effort.search
        try:
            return width_of(
                problem, guide, seen.state, seen.values, k_max, search, limits, self.rng
            )
        except (OutOfTimeError, OutOfPatienceError):
            self.limits.check()
            return Width(None, None, (), None)

    def _measure(self, scene: str, problem: SearchProblem, guide: Guide, seen: Seen) -> None:
        trial = self.trial
        found = self._width(problem, guide, seen)
        trial.subproblems += 1
        rules = " or ".join(r.name for r in trial.model.rules if r.applies(seen.values))
        aim = f"a subgoal of {rules}" if rules else "the goal, for no rule applies"
        where = _valuation(trial.model, seen.values)
        if found.width is None:
            self._wide.add(where)
        if found.reachable is False:
            text = f"a dead end at {where}: no action leads on to {aim}"
            self._tell("dead-end", where, text, scene, seen)
        elif found.width is None:
            trial.by_scene[scene] = None
            for rule in trial.model.rules:
                if rule.applies(seen.values):
                    trial.widths[rule.name] = None
            text = f"more than width {self.effort.k_max} is needed at {where} to find {aim}"
            if not isinstance(problem, ClassicalProblem):
                text = f"{aim} was not found at {where} with width up to {self.effort.k_max}"
                text += ", among the actions that were sampled"
            self._tell("width", where, text, scene, seen)
        else:
            name = found.rule or GOAL
            known = trial.widths.get(name, 0)
            trial.widths[name] = None if known is None else max(known, found.width)
            here = trial.by_scene.get(scene, 0)
            trial.by_scene[scene] = None if here is None else max(here, found.width)

    def finish(self) -> Trial:
        """What all scenes together say."""
        trial = self.trial
        verdict = decide_termination(trial.model, Budget(PROOF_SECONDS))
        if isinstance(verdict, NonTerminating):
            rules = listed([trial.model.rules[r].name for r in {m.rule for m in verdict.walk}])
            self._tell("endless", None, f"{rules} may go on for ever", None, None)
        for rule in trial.model.rules:
            if rule.name in trial.widths or trial.out_of_time:
                continue
            if rule.name not in trial.applied:
                text = f"{rule.name} never fires: its conditions hold in none of the states"
            else:
                text = f"{rule.name} never fires: where it applies other subgoals are nearer"
            self._tell("never-fires", rule.name, text, None, None)
        return trial

    def _tell(
        self, kind: str, key: object, text: str, scene: str | None, seen: Seen | None
    ) -> None:
        """Each thing is told once, with the first state that shows it."""
        if (kind, key) in self._told:
            return
        self._told.add((kind, key))
        if seen is None:
            self.trial.findings.append(Finding(kind, text, scene))
            return
        done = self._describe(seen.path()) if seen.parent is not None else ""
        self.trial.findings.append(
            Finding(
                kind,
                text,
                scene,
                tuple(seen.actions()),
                done,
                shown(seen.state),
                seen.values,
                tuple(seen.samples()),
                tuple(seen.states()),
            )
        )


def _possible(rule: Rule, values: Values) -> bool:
    """Whether what the rule lowers can be lowered."""
    return all(values[f] > 0 for f, effect in rule.effects.items() if effect is Effect.DEC)


def _valuation(model: SketchModel, values: Values) -> str:
    bits = sum((value > 0) << f for f, value in enumerate(values))
    return cube(model, (1 << len(values)) - 1, bits)
