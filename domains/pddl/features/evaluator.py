"""A sketch's features of the states of PDDL tasks, and its invariants."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from domains.pddl.features.compiler import Compiler, Meaning, Run, kept_of
from domains.pddl.ground.task import GroundTask
from domains.pddl.state import State
from sketchlang.checking.checker import CheckedSketch
from sketchlang.checking.typed import BINDERS, Node
from sketchlang.compile.errors import EvaluationError
from sketchlang.compile.invariants import truth
from sketchlang.domain import Function
from sketchlang.model import And, Formula, Kind, Literal, Not, Or, SketchModel

Values = tuple[int, ...]


class Evaluator:
    """The function from states to feature values. It is compiled for a task when a state of that
    task is seen first."""

    def __init__(
        self,
        checked: CheckedSketch,
        meanings: Mapping[Function, Meaning],
        sorts: Mapping[str, str],
    ) -> None:
        self.checked, self.meanings, self.sorts = checked, meanings, sorts
        self._task: GroundTask | None = None
        self._compiled: tuple[Features, Part] | None = None

    def __call__(self, state: State) -> Values:
        """Feature values of a state."""
        return self._of(state.task)[1].values(state.bits)

    def part(self, task: GroundTask, wanted: frozenset[int], otherwise: Values) -> Part:
        """Some features of a task; see `Features.part`."""
        return self._of(task)[0].part(wanted, otherwise)

    def _of(self, task: GroundTask) -> tuple[Features, Part]:
        compiled = self._compiled
        if compiled is None or task is not self._task:
            features = of_task(self.checked, task, self.meanings, self.sorts)
            everything = features.part(frozenset(features.steps), (0,) * len(features.steps))
            self._task, self._compiled = task, (features, everything)
            return self._compiled
        return compiled


@dataclass(frozen=True, eq=False)
class Part:
    """Some features of a task: their values by the bits of a state, and the bits looked at."""

    values: Callable[[int], Values]
    mask: int


@dataclass(frozen=True, eq=False)
class Step:
    """How a feature is computed: its place in a frame, the bits of a state that it looks at, its
    values so far by these bits, how many of them are kept, and the features that it is made of."""

    slot: int
    mask: int
    kept: dict[int, int]
    most: int
    run: Run
    uses: frozenset[int]


@dataclass(frozen=True, eq=False)
class Features:
    """The features of a sketch, compiled for a task, in an order in which each comes after those
    that it is made of. `first` is the place of the first of them in a frame."""

    task: GroundTask
    model: SketchModel
    steps: Mapping[int, Step]
    first: int

    def part(self, wanted: frozenset[int], otherwise: Values) -> Part:
        """The values of some features, of those that these are made of, and of those that
        invariants speak of; for the others, `otherwise` has them.

        Values are kept by the bits that features look at, all together and one by one: what an
        action does not touch is not computed again.
        """
        model, task, first = self.model, self.task, self.first
        wanted |= {literal for i in model.invariants for literal in _spoken_of(i.formula)}
        for index, step in reversed(list(self.steps.items())):
            if index in wanted:
                wanted |= step.uses
        steps = [
            (s.slot, s.mask, s.kept, s.most, s.run) for i, s in self.steps.items() if i in wanted
        ]
        everything = 0
        for _, mask, _, _, _ in steps:
            everything |= mask
        memory: dict[int, Values] = {}
        most = kept_of(everything)
        invariants = [(truth(invariant.formula), invariant.text) for invariant in model.invariants]
        start = [*[0] * first, *otherwise]

        def evaluate(bits: int) -> Values:
            key = bits & everything
            found = memory.get(key)
            if found is not None:
                return found
            frame: list[Any] = start[:]
            frame[0] = bits
            for slot, mask, kept, room, run in steps:
                part = bits & mask
                value = kept.get(part)
                if value is None:
                    if len(kept) >= room:
                        kept.clear()
                    value = kept[part] = run(frame)
                frame[slot] = value
            values = tuple(frame[first:])
            for holds, text in invariants:
                if not holds(values):
                    listed = ", ".join(
                        f"{f.name} = {v}" for f, v in zip(model.features, values, strict=True)
                    )
                    message = f"the invariant does not hold: {listed}"
                    raise EvaluationError(message, expression=text, state=State(bits, task))
            if len(memory) >= most:
                memory.clear()
            memory[key] = values
            return values

        return Part(evaluate, everything)


def of_task(
    checked: CheckedSketch,
    task: GroundTask,
    meanings: Mapping[Function, Meaning],
    sorts: Mapping[str, str],
) -> Features:
    """The features of a sketch, compiled for a task."""
    model = checked.model
    definitions = [node for node in checked.definitions if node is not None]
    depth = 1 + max((_levels(node) for node in definitions), default=0)
    first = 1 + depth
    masks: dict[int, int] = {}
    compiler = Compiler(task, meanings, sorts, first, masks)
    steps: dict[int, Step] = {}
    for index in checked.order:
        node = definitions[index]
        run = compiler.run(node)
        if model.features[index].kind is Kind.BOOL:
            run = _as_number(run)
        mask = masks[index] = compiler.depends(node)
        uses = frozenset(_features(node))
        steps[index] = Step(first + index, mask, {}, kept_of(mask), run, uses)
    return Features(task, model, steps, first)


def _spoken_of(formula: Formula) -> Iterator[int]:
    """The features in a formula."""
    match formula:
        case Literal(feature, _):
            yield feature
        case Not(operand):
            yield from _spoken_of(operand)
        case And(operands) | Or(operands):
            for operand in operands:
                yield from _spoken_of(operand)


def _features(node: Node) -> Iterator[int]:
    """The features that an expression names."""
    if node.kind == "feature":
        assert isinstance(node.value, int)
        yield node.value
    for part in node.parts:
        yield from _features(part)


def _as_number(run: Run) -> Run:
    return lambda frame: 1 if run(frame) else 0


def _levels(node: Node) -> int:
    """One more than the highest level of a variable."""
    own = 0
    if node.kind in BINDERS or node.kind == "variable":
        assert isinstance(node.value, int)
        own = node.value + (2 if node.kind == "pairs" else 1)
    return max([own, *map(_levels, node.parts)])
