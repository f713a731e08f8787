"""The step `ranks` of a certificate: a rank for every valuation of some features, in rounds.

A rule is *at hand in a rank* if a run that stays in this rank of the round before may go on
using it. Round by round the checker makes sure of this:

- the table refines the one before: lower ranks stay lower, equal ones may be told apart;
- where a rule is at hand it leads to no lower rank. So a run comes to stay in one rank, and
  there only uses rules that can keep it;
- of these, a rule that lowers a nat which none of them may raise there fires finitely often
  (and the same upside down for a bounded nat). It is no longer at hand in this rank.

After the last round no rule may be at hand anywhere. The largest number stands for
valuations that no run passes: there the goal holds or an invariant is false.

Numpy does to all valuations at once what is said here of one. A table is a tensor with an
axis of length 2 for each feature, and a rule does its work axis by axis.
"""

from __future__ import annotations

import base64
import binascii
import zlib
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sketchlang.analysis.verify_read import a_text, refuse
from sketchlang.model import And, Effect, Formula, Kind, Literal, Not, Or, Rule, SketchModel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Table = NDArray[np.uint32]

OUT = 0xFFFFFFFF
MOST_FEATURES = 28

Pairs = Callable[[Rule, int], list[tuple[bool, bool]]]
"""Truth values of a feature before and after that a rule allows."""


def check_ranks(
    model: SketchModel,
    features: Sequence[int],
    texts: Sequence[Any],
    rules: Mapping[str, Rule],
    pairs: Pairs,
    where: str,
) -> None:
    """Returns if the tables take away all the rules, else raises `RefusedError`.

    The rules test and change no other features than those given, which are in order.
    """
    if len(features) > MOST_FEATURES:
        refuse(f"{where}: a table has at most {MOST_FEATURES} features")
    before = np.zeros((2,) * len(features), np.uint32)
    at_hand = {name: np.ones(1, bool) for name in rules}
    outside = _outside(model, features)
    for text in texts:
        table = _table(text, len(features), where)
        if (outside < (table == OUT)).any():
            refuse(f"{where}: a table leaves out valuations that a run may pass")
        _check_refined(before, table, where)
        size = int(table[table != OUT].max(initial=0)) + 1
        keeping = {}
        for name, rule in rules.items():
            lowest, part = _lowest_after(table, rule, features, pairs)
            here = table[part]
            able = (here != OUT) & (lowest != OUT) & at_hand[name][before[part]]
            if (able & (lowest < here)).any():
                refuse(f"{where}: {name} leads to a lower rank")
            keeping[name] = np.zeros(size, bool)
            keeping[name][here[able & (lowest == here)]] = True
        at_hand = _without_finite(model, rules, keeping)
        before = np.where(table == OUT, 0, table)
    left = [name for name, ranks in at_hand.items() if ranks.any()]
    if left:
        refuse(f"{where}: after the last table {', '.join(sorted(left))} may still fire for ever")


def _table(text: Any, features: int, where: str) -> Table:
    """Base64 of zlib of four bytes a valuation, the lowest byte first."""
    size = 4 << features
    try:
        unpack = zlib.decompressobj()
        data = unpack.decompress(base64.b64decode(a_text(text, where), validate=True), size + 1)
    except (binascii.Error, zlib.error, ValueError):
        refuse(f"{where}: a table cannot be read")
    if len(data) != size or not unpack.eof or unpack.unused_data:
        refuse(f"{where}: a table does not have a rank for each of the {1 << features} valuations")
    table = np.frombuffer(data, "<u4").astype(np.uint32)
    if (table[table != OUT] >= table.size).any():
        refuse(f"{where}: there are more ranks than valuations")
    return table.reshape((2,) * features)


def _check_refined(before: Table, table: Table, where: str) -> None:
    inside = table != OUT
    old, new = before[inside], table[inside]
    of_rank = np.zeros(int(new.max(initial=0)) + 1, np.uint32)
    of_rank[new] = old
    used = np.unique(new)
    if (of_rank[new] != old).any() or (np.diff(of_rank[used].astype(np.int64)) < 0).any():
        refuse(f"{where}: a table does not refine the one before")


def _lowest_after(
    table: Table, rule: Rule, features: Sequence[int], pairs: Pairs
) -> tuple[Table, tuple[slice, ...]]:
    """The lowest rank to which a rule can lead, and the part of the table from which it can."""
    lowest = table
    part = [slice(0, 2)] * len(features)
    for place, feature in enumerate(features):
        if feature not in rule.conditions and feature not in rule.effects:
            continue
        axis = len(features) - 1 - place
        allowed = pairs(rule, feature)
        befores = sorted({before for before, _ in allowed})
        rows = [
            lowest.take([int(a) for b, a in allowed if b == before], axis).min(axis, keepdims=True)
            for before in befores
        ]
        lowest = np.concatenate(rows, axis)
        part[axis] = slice(int(befores[0]), int(befores[-1]) + 1)
    return lowest, tuple(part)


def _without_finite(
    model: SketchModel, rules: Mapping[str, Rule], keeping: dict[str, NDArray[np.bool_]]
) -> dict[str, NDArray[np.bool_]]:
    """The ranks in which rules stay at hand, given those that they can keep."""
    left = {name: ranks.copy() for name, ranks in keeping.items()}
    for feature, declared in enumerate(model.features):
        ways = [(Effect.DEC, (Effect.INC, Effect.ANY, Effect.NOT_DEC))]
        if declared.bounded:
            ways.append((Effect.INC, (Effect.DEC, Effect.ANY, Effect.NOT_INC)))
        for strict, against in ways if declared.kind is Kind.NAT else ():
            effects = {name: rule.effects.get(feature) for name, rule in rules.items()}
            moving = [name for name, effect in effects.items() if effect is strict]
            opposed = [keeping[name] for name, effect in effects.items() if effect in against]
            for name in moving:
                left[name] &= np.any(opposed, axis=0) if opposed else False
    return left


def _outside(model: SketchModel, features: Sequence[int]) -> NDArray[np.bool_]:
    """Where the truth of these features makes the goal true or an invariant false for certain."""
    count = len(features)
    result = np.zeros((2,) * count, bool)
    if model.goal is not None and set(model.goal) <= set(features):
        literals = tuple(Literal(f, positive) for f, positive in model.goal.items())
        result |= _certain(And(literals), features)[0]
    for invariant in model.invariants:
        result |= _certain(invariant.formula, features)[1]
    return result


def _certain(
    formula: Formula, features: Sequence[int]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Where a formula is certainly true, and where it is certainly false."""
    match formula:
        case Literal(feature, positive):
            if feature not in features:
                return np.array(False), np.array(False)
            shape = [1] * len(features)
            shape[len(features) - 1 - features.index(feature)] = 2
            values = np.array([not positive, positive]).reshape(shape)
            return values, ~values
        case Not(operand):
            true, false = _certain(operand, features)
            return false, true
        case And(operands) | Or(operands):
            true, false = np.array(True), np.array(False)
            for operand in operands:
                # Of a conjunction; a disjunction is the same with true and false exchanged.
                first, second = _certain(operand, features)
                if isinstance(formula, Or):
                    first, second = second, first
                true, false = true & first, false | second
            return (false, true) if isinstance(formula, Or) else (true, false)
