"""A sketch's features of the states of PDDL tasks, and its invariants."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from domains.pddl.features.compiler import MEMORY, Compiler, Meaning, Run
from domains.pddl.ground.task import GroundTask
from domains.pddl.state import State
from sketchlang.checking.checker import CheckedSketch
from sketchlang.checking.typed import BINDERS, Node
from sketchlang.compile.errors import EvaluationError
from sketchlang.compile.invariants import truth
from sketchlang.domain import Function
from sketchlang.model import Kind

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
        self._compiled: tuple[Callable[[int], Values], int] | None = None

    def __call__(self, state: State) -> Values:
        """Feature values of a state."""
        return self._of(state.task)[0](state.bits)

    def looks_at(self, task: GroundTask) -> int:
        """The bits of a state that feature values depend on."""
        return self._of(task)[1]

    def _of(self, task: GroundTask) -> tuple[Callable[[int], Values], int]:
        compiled = self._compiled
        if compiled is None or task is not self._task:
            compiled = of_task(self.checked, task, self.meanings, self.sorts)
            self._task, self._compiled = task, compiled
        return compiled


def of_task(
    checked: CheckedSketch,
    task: GroundTask,
    meanings: Mapping[Function, Meaning],
    sorts: Mapping[str, str],
) -> tuple[Callable[[int], Values], int]:
    """The function from the bits of a task's states to feature values, and the bits it looks at.

    Values are kept by the bits that features look at, all together and one by one: what an
    action does not touch is not computed again.
    """
    model = checked.model
    definitions = [node for node in checked.definitions if node is not None]
    depth = 1 + max((_levels(node) for node in definitions), default=0)
    first = 1 + depth
    masks: dict[int, int] = {}
    compiler = Compiler(task, meanings, sorts, first, masks)
    steps: list[tuple[int, int, dict[int, int], Run]] = []
    for index in checked.order:
        node = definitions[index]
        run = compiler.run(node)
        if model.features[index].kind is Kind.BOOL:
            run = _as_number(run)
        masks[index] = compiler.depends(node)
        steps.append((first + index, masks[index], {}, run))
    everything = 0
    for mask in masks.values():
        everything |= mask
    memory: dict[int, Values] = {}
    invariants = [(truth(invariant.formula), invariant.text) for invariant in model.invariants]
    size = first + len(definitions)

    def evaluate(bits: int) -> Values:
        key = bits & everything
        found = memory.get(key)
        if found is not None:
            return found
        frame: list[Any] = [0] * size
        frame[0] = bits
        for slot, mask, kept, run in steps:
            part = bits & mask
            value = kept.get(part)
            if value is None:
                if len(kept) > MEMORY:
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
        if len(memory) > MEMORY:
            memory.clear()
        memory[key] = values
        return values

    return evaluate, everything


def _as_number(run: Run) -> Run:
    return lambda frame: 1 if run(frame) else 0


def _levels(node: Node) -> int:
    """One more than the highest level of a variable."""
    own = 0
    if node.kind in BINDERS or node.kind == "variable":
        assert isinstance(node.value, int)
        own = node.value + (2 if node.kind == "pairs" else 1)
    return max([own, *map(_levels, node.parts)])
