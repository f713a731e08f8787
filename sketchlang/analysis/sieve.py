"""Sieve, complete on the policy graph, that looks at as few features as it can.

Sieve (Srivastava et al., AAAI 2011; Bonet & Geffner, AAAI 2021) takes the components of the
policy graph apart: in a component where some edges lower n and none may raise it, those
edges go; then the components of what is left; and so on. If no cycle is left the sketch
terminates. On 2^n valuations that is out of reach, and mostly not needed. So:

- the graph starts as a single cell that ignores all features, with every rule a loop;
- a component that is stuck gets a closed walk, and if bits of the ignored features can
  follow the walk as well, the sketch does not terminate and the walk shows it;
- if not, a feature that cannot follow is tracked from now on in this component, which
  doubles its cells and breaks this walk.

An ignored feature only ever adds edges, so what is eliminated is eliminated for good; with
all features tracked the graph is the policy graph itself, so the answer is complete. As
soon as a rule is gone from all components it is gone from the sketch, and the search begins
anew without it: proofs get short, and features that only that rule tested are ignored again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from sketchlang.analysis.bits import RuleBits, bounded_mask, members
from sketchlang.analysis.components import Component, components
from sketchlang.analysis.elimination import drop, eliminate
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.piece import Move, Piece
from sketchlang.analysis.proof import Block, Drop, Split, Step
from sketchlang.analysis.region import Outside, sorting_tree
from sketchlang.analysis.walk import close, propose
from sketchlang.model import SketchModel

TRIAL_CELLS = 64
"""Components up to this size try every feature that would break the walk and keep the best."""

GONE = 0.2
"""The part of the rules whose end makes a large graph begin anew."""

MOST_FEATURES = 10
"""Features up to which all rules that may fire for ever are found, not only one cycle's."""


@dataclass(eq=False)
class Part:
    """A piece of the graph under work: `steps` took it from `entered` to `rules`.

    After a split the work goes on in the split's own parts.
    """

    tracked: int
    cells: tuple[int, ...]
    entered: tuple[RuleBits, ...]
    outside: tuple[int, ...] = ()
    rules: tuple[RuleBits, ...] = ()
    drops: list[Drop] = field(default_factory=list)
    split: list[tuple[tuple[int, ...], Part]] | None = None

    def __post_init__(self) -> None:
        self.rules = self.entered

    def stuck(self) -> list[Part]:
        """The parts at the bottom that still have rules."""
        if self.split is None:
            return [self] if self.rules else []
        return [part for _, block in self.split for part in block.stuck()]


@dataclass(frozen=True, slots=True)
class SieveResult:
    """Steps that end with no rules, or a closed walk of full valuations."""

    steps: tuple[Step, ...]
    cycle: tuple[Move, ...]


class Sieve:
    """The state that all parts share."""

    def __init__(self, model: SketchModel, rules: Sequence[RuleBits], budget: Budget) -> None:
        self.model = model
        self.rules = rules
        self.bounded = bounded_mask(model)
        self.outside = Outside(model)
        self.budget = budget

    def run(self, left: Sequence[RuleBits]) -> SieveResult:
        """Takes the rules apart until none is left or a walk closes."""
        steps: list[Step] = []
        while left:
            root = self._refined(Part(0, (0,), tuple(left)), 0)
            while self._goes_on(root, len(left), len(kept := self._kept(root))):
                for part in root.stuck():
                    cycle = self._refine(part)
                    if cycle:
                        return SieveResult(tuple(steps), tuple(cycle))
            gone = frozenset(rule.index for rule in left) - kept
            steps += self._steps(root, gone)[0]
            quick = eliminate([rule for rule in left if rule.index in kept], self.bounded)
            steps += quick.steps
            left = [rule for rule in left if rule.index in quick.left]
        return SieveResult(tuple(steps), ())

    def _goes_on(self, root: Part, before: int, kept: int) -> bool:
        """Whether to refine further, and not to begin anew with the rules that are kept.

        To begin anew costs what it cost to get here; it pays for small graphs, which tell
        more clearly what matters, and when many rules are gone.
        """
        if kept == before:
            return True
        size = sum(len(part.cells) for part in root.stuck())
        return bool(kept) and size > TRIAL_CELLS and before - kept < GONE * before

    def survivors(self) -> frozenset[int] | None:
        """The rules with an edge that textbook Sieve, with every feature, cannot remove."""
        count = len(self.model.features)
        if count > MOST_FEATURES:
            return None
        known = (1 << count) - 1
        cells = tuple(cell for cell in range(1 << count) if not self.outside(known, cell))
        everything = Part(known, cells, tuple(rule for rule in self.rules if not rule.dead))
        self._take_apart(everything)
        return self._kept(everything)

    def _kept(self, root: Part) -> frozenset[int]:
        return frozenset(rule.index for part in root.stuck() for rule in part.rules)

    def _refine(self, part: Part) -> list[Move]:
        """Tracks one more feature in a stuck part; or returns the walk that shows why not."""
        piece = Piece(part.tracked, part.cells, part.rules)
        walk = propose(piece, self.bounded, self.budget)
        cycle, reasons = close(walk, part.tracked, self.model, self.rules, self.outside)
        if not reasons:
            return cycle
        if len(part.cells) > TRIAL_CELLS:
            reasons &= -reasons
        candidates = [self._refined(part, 1 << feature) for feature in members(reasons)]
        best = min(candidates, key=_unfinished)
        part.tracked, part.cells, part.outside = best.tracked, best.cells, best.outside
        part.rules, part.split = best.rules, best.split
        part.drops += best.drops
        return []

    def _refined(self, part: Part, bit: int) -> Part:
        """A copy of a part with one more feature tracked, taken apart as far as it goes."""
        tracked = part.tracked | bit
        both = [*part.cells, *(cell | bit for cell in part.cells)] if bit else [*part.cells]
        outside = part.outside
        if not bit or bit & self.outside.features:
            gone = {cell for cell in both if self.outside(tracked, cell)}
            both = [cell for cell in both if cell not in gone]
            outside = (*_doubled(part.outside, bit), *gone)
        else:
            outside = _doubled(part.outside, bit)
        result = Part(tracked, tuple(both), part.rules, outside)
        self._take_apart(result)
        return result

    def _take_apart(self, part: Part) -> None:
        """Drops and splits until nothing more can be done with the features tracked."""
        while part.rules:
            found = components(part.cells, part.tracked, part.rules, self.budget)
            whole = len(found) == 1 and len(found[0].rules) == len(part.rules)
            if not whole or part.outside:
                part.split = [(cells, self._block(part, cells, r)) for cells, r in _blocks(found)]
                for _, block in part.split:
                    self._take_apart(block)
                return
            step = drop(part.rules, self.bounded)
            if step is None:
                return
            part.drops.append(step)
            part.rules = tuple(rule for rule in part.rules if rule.index not in step.rules)

    def _block(self, part: Part, cells: tuple[int, ...], inside: tuple[int, ...]) -> Part:
        chosen = set(inside)
        rules = tuple(rule for rule in part.rules if rule.index in chosen)
        return Part(part.tracked, cells, rules)

    def _steps(self, part: Part, useful: frozenset[int]) -> tuple[list[Step], frozenset[int]]:
        """The steps of a part and the rules that they leave, without steps that lead nowhere."""
        self.budget.check()
        left = frozenset(rule.index for rule in part.entered)
        steps: list[Step] = []
        for step in part.drops:
            if left & useful:
                steps.append(step)
                left -= frozenset(step.rules)
        if part.split is None or not left & useful:
            return steps, left
        before, left = left, frozenset()
        blocks: list[Block] = []
        labels: list[tuple[int, int | None]] = [(cell, None) for cell in part.outside]
        for number, (cells, block) in enumerate(part.split):
            labels += [(cell, number) for cell in cells]
            inner, kept = self._steps(block, useful)
            left |= kept
            blocks.append(Block(tuple(rule.index for rule in block.entered), tuple(inner)))
        tree = sorting_tree(labels, list(members(part.tracked)), self.outside)
        steps.append(Split(tree, tuple(blocks), tuple(sorted(before - left))))
        return steps, left


def _blocks(found: list[Component]) -> list[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Cells and rules of the blocks that components make, in an order that no rule goes back in.

    Components without rules share a block if they are on one level: nothing connects them.
    """
    flat: dict[int, list[int]] = {}
    order: list[tuple[int, tuple[int, ...], tuple[int, ...]]] = []
    for component in found:
        if component.rules:
            order.append((component.level, component.cells, component.rules))
        else:
            flat.setdefault(component.level, []).extend(component.cells)
    order += [(level, tuple(cells), ()) for level, cells in flat.items()]
    # A tree needs a number for its leaves even if all cells are outside.
    return [(cells, rules) for _, cells, rules in sorted(order)] or [((), ())]


def _doubled(cells: tuple[int, ...], bit: int) -> tuple[int, ...]:
    return (*cells, *(cell | bit for cell in cells)) if bit else cells


def _unfinished(part: Part) -> tuple[int, int]:
    """How much is left: rules, then cells times rules."""
    stuck = part.stuck()
    rules = {rule.index for below in stuck for rule in below.rules}
    return len(rules), sum(len(below.cells) * len(below.rules) for below in stuck)
