"""Walking through a task by commands of one letter; the terminal is another room's."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from runtime.inspect.look import goal_lines, look, where
from runtime.inspect.walk import Walk
from runtime.search.guide import GOAL, Subgoal
from sketchlang.analysis.words import counted, effect, literal
from sketchlang.inspection.rules import changes, rule_lines, shown_value
from sketchlang.inspection.words import feature_lines, value_text
from sketchlang.model import SketchModel

HELP = (
    "enter next subgoal, b back, g N go to subgoal N, f features, r rules, s scene, h help, q quit"
)


@dataclass(frozen=True)
class Reply:
    """What is said to a command; `quits` where it was the last."""

    lines: tuple[str, ...]
    quits: bool = False


class Stepper:
    """A place on the way through a task, and what can be asked there. `width` and `colour` are
    for scenes that are drawn."""

    def __init__(self, walk: Walk, width: int = 100, colour: bool = False) -> None:
        self.walk = walk
        self.width, self.colour = width, colour
        self.at = 0
        """How many subgoals have been taken."""

    @property
    def model(self) -> SketchModel:
        """The sketch."""
        return self.walk.task.sketch.model

    def answer(self, text: str) -> Reply:
        """What a line of input is answered.

        Raises:
            EvaluationError: a function of the domain, or an invariant, breaks its promise.
        """
        word, _, argument = text.strip().partition(" ")
        if word in ("q", "quit", "exit"):
            return Reply((), quits=True)
        commands: dict[str, Callable[[], Iterator[str]]] = {
            "": self._next,
            "n": self._next,
            "b": self._back,
            "f": self._features,
            "r": self._rules,
            "s": self._scene,
            "h": lambda: iter((HELP,)),
            "?": lambda: iter((HELP,)),
        }
        if word == "g":
            return Reply(tuple(self._go(argument)))
        if word not in commands or argument:
            return Reply((f"{text.strip()!r} is no command here: {HELP}",))
        return Reply(tuple(commands[word]()))

    def here(self) -> Iterator[str]:
        """Where one is: the values of the features, and the rules that apply."""
        values = self.walk.values(self.at)
        named = ", ".join(
            f"{feature.name} = {value_text(shown_value(feature, value))}"
            for feature, value in zip(self.model.features, values, strict=True)
        )
        yield f"{where(self.at)}: {named}"
        applicable = [rule.name for rule in self.model.rules if rule.applies(values)]
        if self.model.is_goal(values):
            yield "the goal of the sketch holds"
        elif applicable:
            yield f"rules that apply: {', '.join(applicable)}"
        else:
            yield "no rule applies"

    def _next(self) -> Iterator[str]:
        if self.walk.reach(self.at + 1) == self.at:
            yield from self._end()
            return
        self.at += 1
        yield from self._subgoal(self.walk.subgoal(self.at))

    def _back(self) -> Iterator[str]:
        if not self.at:
            yield "this is the start"
            return
        self.at -= 1
        yield from self.here()

    def _go(self, argument: str) -> Iterator[str]:
        if not (argument.isascii() and argument.strip().isdigit()):
            yield "say where to: `g 3` goes to the state after three subgoals, `g 0` to the start"
            return
        wanted = int(argument)
        self.at = self.walk.reach(wanted)
        if self.at < wanted:
            yield from self._end()
        if self.at:
            yield from self._subgoal(self.walk.subgoal(self.at))
        yield from self.here()

    def _end(self) -> Iterator[str]:
        outcome = self.walk.outcome
        if outcome.solved:
            yield f"the goal is reached {where(self.walk.known)}"
            return
        yield f"the run ends {where(self.walk.known)}: {outcome.reason}"
        told = outcome.reason or ""
        yield from (f"  {f['text']}" for f in outcome.why if f["text"] not in told)

    def _subgoal(self, subgoal: Subgoal) -> Iterator[str]:
        describe = self.walk.task.reporting.describe
        actions = [describe([action]) for action in subgoal.actions]
        yield f"{self.at}  {subgoal.rule}: {', '.join(actions)}"
        yield f"   {self._rule(subgoal.rule)}"
        changed = changes(self.model, subgoal.before, subgoal.after)
        yield f"   {', '.join(changed) or 'no feature changes'}"
        tries = f", sampled {subgoal.attempt + 1} times" if subgoal.attempt else ""
        made = counted(subgoal.generated, "state")
        yield f"   found by IW({subgoal.width}){tries}, {made} generated"

    def _rule(self, name: str) -> str:
        """A rule as it is written."""
        if name == GOAL:
            return "a goal state, which no rule names"
        model = self.model
        rule = next(rule for rule in model.rules if rule.name == name)
        conditions = [literal(model, f, wanted) for f, wanted in rule.conditions.items()]
        effects = [effect(model, f, kind) for f, kind in rule.effects.items()]
        sides = [f"{{ {', '.join(side)} }}" if side else "{}" for side in (conditions, effects)]
        return " -> ".join(sides)

    def _features(self) -> Iterator[str]:
        for feature in look(self.walk, self.at).features:
            yield from feature_lines(feature)

    def _rules(self) -> Iterator[str]:
        seen = look(self.walk, self.at)
        yield from rule_lines(seen.rules)
        yield from goal_lines(seen)

    def _scene(self) -> Iterator[str]:
        picture = self.walk.task.reporting.picture(self.walk.state(self.at))
        yield from picture.text(self.width, self.colour)
