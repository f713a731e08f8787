"""All valuations at once, as arrays: what rules do to sets of them.

Valuations of k features are the numbers below 2^k, and an array over them can be seen as a
tensor with an axis of length 2 for each feature. What a rule does with one feature does
not depend on the others, so it does its work axis by axis; and where a condition holds a
feature fast, half of the tensor is left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sketchlang.analysis.bits import RuleBits, members
from sketchlang.model import And, Formula, Literal, Not, Or, SketchModel

if TYPE_CHECKING:
    from numpy.typing import NDArray


MOST_BITS = 61
"""Features up to which masks are numbers that NumPy can hold."""


class Valuations:
    """The valuations of some features of a sketch. Bit i of a number is `features[i]`."""

    def __init__(self, model: SketchModel, features: Sequence[int]) -> None:
        self.model = model
        self.features = tuple(features)
        self.count = 1 << len(features)
        self.shape = (2,) * len(features)
        self._place = {feature: i for i, feature in enumerate(features)}

    def squeezed(self, mask: int) -> int:
        """A mask over features of the sketch as one over these features."""
        return sum(1 << self._place[f] for f in members(mask) if f in self._place)

    def expanded(self, mask: int) -> int:
        """The reverse of `squeezed`."""
        return sum(1 << self.features[i] for i in members(mask))

    def all_expanded(self, masks: NDArray[Any]) -> list[int]:
        """The same for an array of masks."""
        if max(self.features, default=0) > MOST_BITS:
            return [self.expanded(mask) for mask in masks.tolist()]
        masks = masks.astype(np.int64)
        found = np.zeros(len(masks), np.int64)
        for i, feature in enumerate(self.features):
            found |= (masks >> i & 1) << feature
        expanded: list[int] = found.tolist()
        return expanded

    def axis(self, feature: int) -> int:
        """The axis of a feature in a tensor."""
        return len(self.features) - 1 - self._place[feature]

    def outside(self) -> NDArray[np.bool_]:
        """Where the goal holds or an invariant fails: no infinite run comes there."""
        result = np.zeros(self.shape, bool)
        for invariant in self.model.invariants:
            result |= ~self._truth(invariant.formula)
        if self.model.goal is not None:
            index: list[Any] = [slice(None)] * len(self.features)
            for feature, positive in self.model.goal.items():
                index[self.axis(feature)] = int(positive)
            result[tuple(index)] = True
        return result

    def _truth(self, formula: Formula) -> NDArray[np.bool_]:
        match formula:
            case Literal(feature, positive):
                shape = [1] * len(self.features)
                shape[self.axis(feature)] = 2
                return np.array([not positive, positive]).reshape(shape)
            case Not(operand):
                return ~self._truth(operand)
            case And(operands) | Or(operands):
                join = np.logical_and if isinstance(formula, And) else np.logical_or
                result = np.array(isinstance(formula, And))
                for operand in operands:
                    result = join(result, self._truth(operand))
                return result

    def before(self, rule: RuleBits) -> tuple[slice, ...]:
        """The part of a tensor in which a rule applies."""
        index = [slice(None)] * len(self.features)
        for feature in members(rule.needs):
            bit = rule.wants >> feature & 1
            index[self.axis(feature)] = slice(bit, bit + 1)
        return tuple(index)

    def after(self, rule: RuleBits) -> tuple[slice, ...]:
        """The part of a tensor into which a rule leads."""
        index = list(self.before(rule))
        for feature in members(rule.touched):
            bits = sorted({after for _, after in rule.pairs(feature)})
            index[self.axis(feature)] = slice(bits[0], bits[-1] + 1)
        return tuple(index)

    def leading_into(self, rule: RuleBits, chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Where in `before(rule)` a rule can lead into a chosen set of valuations."""
        result = chosen[self.after(rule)]
        for feature in members(rule.touched):
            result = self._along(result, feature, rule.pairs(feature))
        return result

    def led_to(self, rule: RuleBits, chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Where in `after(rule)` a rule can lead from a chosen set of valuations."""
        result = chosen[self.before(rule)]
        for feature in members(rule.touched):
            turned = tuple((after, before) for before, after in rule.pairs(feature))
            result = self._along(result, feature, turned)
        return result

    def _along(
        self, tensor: NDArray[np.bool_], feature: int, pairs: Sequence[tuple[int, int]]
    ) -> NDArray[np.bool_]:
        """The tensor over the first bits of pairs, true where it is for some second bit."""
        axis = self.axis(feature)
        if tensor.shape[axis] == 1:
            halves = (tensor, tensor)
        else:
            index: list[Any] = [slice(None)] * len(self.features)
            index[axis] = slice(0, 1)
            low = tensor[tuple(index)]
            index[axis] = slice(1, 2)
            halves = (low, tensor[tuple(index)])
        parts: dict[int, NDArray[np.bool_]] = {}
        for first, second in sorted(pairs):
            half = halves[second]
            parts[first] = parts[first] | half if first in parts else half
        return np.concatenate(list(parts.values()), axis) if len(parts) > 1 else parts[first]
