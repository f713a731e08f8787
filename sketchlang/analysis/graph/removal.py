"""At which step of a proof each edge of the policy graph goes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from sketchlang.analysis.proof import Drop, Node, Potential, Ranks, Split, Step, Tree
from sketchlang.analysis.words import listed, rule_names
from sketchlang.model import SketchModel


class Removal:
    """The steps of a proof in the order in which they are read, counted from 1."""

    def __init__(self, model: SketchModel, steps: Sequence[Step]) -> None:
        self.steps = steps
        self._numbers: dict[int, int] = {}
        self.legend: list[str] = []
        self._number(model, steps)

    def _number(self, model: SketchModel, steps: Iterable[Step]) -> None:
        for step in steps:
            self.legend.append(_words(model, step))
            self._numbers[id(step)] = len(self.legend)
            if isinstance(step, Split):
                for block in step.blocks:
                    self._number(model, block.steps)

    def shown(self, steps: Iterable[int | None]) -> tuple[tuple[int, str], ...]:
        """The legend for the steps that occur in a picture."""
        numbers = sorted({step for step in steps if step is not None})
        return tuple((number, self.legend[number - 1]) for number in numbers)

    def of_rule(self, rule: int) -> int | None:
        """The last step that has to do with a rule: after it the rule is gone for good."""
        return self._last(self.steps, rule)

    def _last(self, steps: Sequence[Step], rule: int) -> int | None:
        for step in steps:
            if isinstance(step, Drop | Potential | Ranks):
                if rule in step.rules:
                    return self._numbers[id(step)]
            elif rule in step.drops:
                inner = [self._last(block.steps, rule) for block in step.blocks]
                numbers = [number for number in inner if number is not None]
                return max(numbers, default=self._numbers[id(step)])
        return None

    def of_edge(self, before: int, rule: int, after: int) -> int | None:
        """The step that takes away a rule's edge between two valuations."""
        return self._within(self.steps, before, rule, after)

    def _within(self, steps: Sequence[Step], before: int, rule: int, after: int) -> int | None:
        for step in steps:
            if isinstance(step, Drop | Potential | Ranks):
                if rule in step.rules:
                    return self._numbers[id(step)]
                continue
            block = leaf(step.tree, before)
            if block is None or leaf(step.tree, after) != block:
                return self._numbers[id(step)]
            inner = self._within(step.blocks[block].steps, before, rule, after)
            if inner is not None:
                return inner
        return None


def leaf(tree: Tree, valuation: int) -> int | None:
    """The block to which a tree sends a valuation."""
    while isinstance(tree, Node):
        tree = tree.high if valuation >> tree.feature & 1 else tree.low
    return tree


def _words(model: SketchModel, step: Step) -> str:
    if isinstance(step, Drop):
        change = "rises" if step.upwards else "falls"
        name = model.features[step.feature].name
        return f"{name} only {change} ({listed(rule_names(model, step.rules))})"
    if isinstance(step, Potential):
        from sketchlang.analysis.argument import weighted_sum

        falls = listed(rule_names(model, step.rules))
        return f"{weighted_sum(model, step.terms)} falls ({falls})"
    if isinstance(step, Ranks):
        return "no way back in an order of all valuations"
    asked: set[int] = set()
    todo: list[Tree] = [step.tree]
    while todo:
        tree = todo.pop()
        if isinstance(tree, Node):
            asked.add(tree.feature)
            todo += [tree.low, tree.high]
    names = listed([model.features[f].name for f in sorted(asked)])
    return f"no way back, by {names}" if names else "no way back"
