"""Which valuations no infinite run passes, and trees that sort valuations into blocks."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from sketchlang.analysis.proof import Node, Tree
from sketchlang.model import And, Formula, Literal, Not, Or, SketchModel


def truth(formula: Formula, known: int, cell: int) -> bool | None:
    """The truth of a formula if only the features in the mask `known` are; None: it depends."""
    match formula:
        case Literal(feature, positive):
            if not known >> feature & 1:
                return None
            return bool(cell >> feature & 1) == positive
        case Not(operand):
            value = truth(operand, known, cell)
            return None if value is None else not value
        case And(operands):
            values = [truth(operand, known, cell) for operand in operands]
            return False if False in values else None if None in values else True
        case Or(operands):
            values = [truth(operand, known, cell) for operand in operands]
            return True if True in values else None if None in values else False


def feature_mask(formula: Formula) -> int:
    """The features that a formula names."""
    match formula:
        case Literal(feature, _):
            return 1 << feature
        case Not(operand):
            return feature_mask(operand)
        case And(operands) | Or(operands):
            mask = 0
            for operand in operands:
                mask |= feature_mask(operand)
            return mask


class Outside:
    """Tells cells that no infinite run passes: goals (no way out), and where invariants fail.

    A cell is an integer with meaning in the bits of a mask `known`; it is outside if that
    holds for all valuations that agree with it there.
    """

    def __init__(self, model: SketchModel) -> None:
        self._goal = model.goal
        self._goal_mask = self._goal_bits = 0
        for feature, positive in (model.goal or {}).items():
            self._goal_mask |= 1 << feature
            self._goal_bits |= positive << feature
        self._invariants = [invariant.formula for invariant in model.invariants]
        self.features = self._goal_mask
        for formula in self._invariants:
            self.features |= feature_mask(formula)

    def __call__(self, known: int, cell: int) -> bool:
        if (
            self._goal is not None
            and not self._goal_mask & ~known
            and not (cell ^ self._goal_bits) & self._goal_mask
        ):
            return True
        return any(truth(formula, known, cell) is False for formula in self._invariants)


class _Elsewhere:
    """The label of valuations that a tree need not sort."""


_ELSEWHERE = _Elsewhere()


def sorting_tree(
    labels: Sequence[tuple[int, int | None]],
    features: Sequence[int],
    outside: Callable[[int, int], bool],
) -> Tree:
    """The decision tree over `features` (ascending) that gives each cell its label.

    Cells that are not listed may get any number. A leaf None stands only where the answers
    on the path alone put the valuation outside: it can then be checked without the rest.
    """

    def build(part: Sequence[tuple[int, int | None]], position: int, known: int) -> object:
        if not part:
            return _ELSEWHERE
        label = part[0][1]
        if all(other == label for _, other in part) and (
            label is not None or outside(known, part[0][0] & known)
        ):
            return label
        feature = features[position]
        bit = 1 << feature
        low = build([item for item in part if not item[0] & bit], position + 1, known | bit)
        high = build([item for item in part if item[0] & bit], position + 1, known | bit)
        # With the question left out, a leaf None below might no longer follow from its path.
        if low == high and not _has_outside(low):
            return low
        if high is _ELSEWHERE and not _has_outside(low):
            return low
        if low is _ELSEWHERE and not _has_outside(high):
            return high
        return Node(feature, _tree(low), _tree(high))

    return _tree(build(labels, 0, 0))


def _tree(built: object) -> Tree:
    if built is _ELSEWHERE:
        return 0
    assert built is None or isinstance(built, int | Node)
    return built


def _has_outside(built: object) -> bool:
    if isinstance(built, Node):
        return _has_outside(built.low) or _has_outside(built.high)
    return built is None
