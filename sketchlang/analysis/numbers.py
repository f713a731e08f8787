"""Numbers for a closed walk: a concrete run that does what the rules say and starts again.

The walk fixes for each nat where it is 0 and where it is > 0. The numbers follow: a nat
moves by one where its effect demands it and stays where that is allowed, rises from 0 to as
much as the walk takes from it before it is next 0, and makes up the difference at a place
where it may change freely.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sketchlang.analysis.piece import MANY, MOST_BITS, Move
from sketchlang.model import Effect, Kind, SketchModel

_LEAST = {Effect.DEC: -1, Effect.INC: 1}


@dataclass(frozen=True, slots=True)
class Run:
    """Feature values before each move of the walk and, last, after all of them.

    The last values are the first ones, except for the features in `growing`: nats that the
    walk raises and nothing on it lowers, which grow by the same amount every time around.
    """

    values: tuple[tuple[int, ...], ...]
    growing: tuple[int, ...]


def concrete_run(model: SketchModel, walk: Sequence[Move]) -> Run:
    """Values for one time around a closed walk over full valuations."""
    columns: list[list[int]] = []
    growing: list[int] = []
    all_bits = _bits([move.before for move in walk], len(model.features))
    for (feature, declared), bits in zip(enumerate(model.features), all_bits, strict=True):
        if declared.kind is Kind.BOOL:
            columns.append([*bits, bits[0]])
            continue
        effects = [model.rules[move.rule].effects.get(feature) for move in walk]
        column = _column(bits, effects)
        if column[-1] != column[0]:
            growing.append(feature)
        columns.append(column)
    return Run(tuple(zip(*columns, strict=True)) or ((),) * (len(walk) + 1), tuple(growing))


def _bits(cells: Sequence[int], features: int) -> list[list[int]]:
    """For each feature its bit in every cell."""
    if len(cells) < MANY or features > MOST_BITS:
        return [[cell >> feature & 1 for cell in cells] for feature in range(features)]
    import numpy as np

    masks = np.array(cells, np.int64)
    return [(masks >> feature & 1).tolist() for feature in range(features)]


def _column(bits: list[int], effects: list[Effect | None]) -> list[int]:
    """Values of one nat before each move and after the last."""
    if not any(bits):
        return [0] * (len(bits) + 1)
    if all(bits):
        return _always_positive(effects)
    # Turn the walk so that it starts at a 0; from there on it is a row of hills.
    start = bits.index(0)
    turned = bits[start:] + bits[:start]
    moves = effects[start:] + effects[:start]
    values = [0] * len(bits)
    i = 0
    while i < len(turned):
        if not turned[i]:
            i += 1
            continue
        end = i
        while end < len(turned) and turned[end]:
            end += 1
        heights = [0]
        for effect in moves[i : end - 1]:
            heights.append(heights[-1] + _change(effect))
        foot = 1 - min(heights)
        values[i:end] = [height + foot for height in heights]
        i = end
    column = values[-start:] + values[:-start] if start else values
    return [*column, column[0]]


def _always_positive(effects: list[Effect | None]) -> list[int]:
    """Values of a nat that is > 0 all along: it rises and falls, or only rises, or stays."""
    changes = [_change(effect) for effect in effects]
    surplus = sum(changes)
    makes_up = (
        {Effect.INC, Effect.ANY, Effect.NOT_DEC}
        if surplus < 0
        else {Effect.DEC, Effect.ANY, Effect.NOT_INC}
    )
    for i, effect in enumerate(effects):
        if surplus and effect in makes_up:
            changes[i] -= surplus
            break
    heights = [0]
    for change in changes:
        heights.append(heights[-1] + change)
    foot = 1 - min(heights)
    return [height + foot for height in heights]


def _change(effect: Effect | None) -> int:
    """The least change that satisfies an effect."""
    return _LEAST.get(effect, 0) if effect is not None else 0
