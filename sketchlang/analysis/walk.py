"""Closed walks that a sketch can follow for ever, found in a component that Sieve is stuck in.

A closed walk in the policy graph can be repeated for ever with real numbers if every nat
that it lowers by `n--` is also changed by `n++`, `n?` or `!n--` somewhere on it (and the
same the other way round for `n++` if n is bounded): there the number rises by as much as
the walk has taken from it. Sieve is complete because every component it leaves has one.

Here the component may know only some of the features. A walk through it is then only a
proposal: `close` looks for bits of the other features that come back to where they began.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

from sketchlang.analysis.bits import RuleBits, members
from sketchlang.analysis.elimination import drop
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.narrowing import Narrowing
from sketchlang.analysis.piece import Move, Piece, PieceGraph, WalkedGraph
from sketchlang.analysis.region import Outside
from sketchlang.model import Kind, SketchModel

SMALL = 4000
"""Cells times rules up to which a walk is made short by trying to do without each rule."""

MOST_CHOICES = 12
"""Features of goal and invariants for which all combinations of bits are tried."""


def propose(
    piece: Piece, bounded: int, budget: Budget, graph: WalkedGraph | None = None
) -> list[Move]:
    """A closed walk through a stuck component that undoes every strict change it makes.

    Preferably one that lowers again what it raises, even where no bound asks for that. `graph`
    is that of the piece, if it was already made.
    """
    rises = 0
    for rule in piece.rules:
        rises |= rule.rises
    graph = graph or PieceGraph(piece.cells, piece.tracked, piece.rules, budget)
    small = len(piece.cells) * len(piece.rules) <= SMALL
    if small or rises & ~bounded:
        narrowing = Narrowing(graph, piece, budget)
        if rises & ~bounded and narrowing.to_stuck(bounded | rises):
            bounded |= rises
        if small or len(narrowing.piece.cells) * len(narrowing.piece.rules) <= SMALL:
            narrowing.to_few_rules(bounded)
        if narrowing.piece is not piece:
            piece = narrowing.piece
            graph = PieceGraph(piece.cells, piece.tracked, piece.rules, budget)
    wanted = [piece.rules[0]]
    while True:
        walk = _covering(graph, wanted)
        used = {move.rule for move in walk}
        rules = [rule for rule in piece.rules if rule.index in used]
        unopposed = drop(rules, bounded)
        if unopposed is None:
            return walk
        bit = 1 << unopposed.feature
        for rule in piece.rules:
            if bit & (rule.may_fall if unopposed.upwards else rule.may_rise):
                wanted.append(rule)
                break


def _covering(graph: WalkedGraph, wanted: Sequence[RuleBits]) -> list[Move]:
    """A closed walk with an edge of every wanted rule, short by always taking the nearest."""
    missing = {rule.index for rule in wanted}
    start = here = graph.cell_with(wanted[0].index)
    walk: list[Move] = []
    while missing:
        more, here = graph.path_by(here, missing)
        walk += more
        missing -= {move.rule for move in more}
    if here != start:
        walk += graph.path_to(here, start)
    return walk


def close(
    walk: Sequence[Move],
    tracked: int,
    model: SketchModel,
    rules: Sequence[RuleBits],
    outside: Outside,
) -> tuple[list[Move], int]:
    """The walk with bits for all features, or features (a mask) that keep it from closing.

    `rules` are all rules of the sketch. The mask is 0 if and only if the walk was closed; it
    names only features that are not tracked.
    """
    choices: dict[int, list[list[int]]] = {}
    reasons = 0
    used = {move.rule for move in walk}
    for feature, declared in enumerate(model.features):
        if tracked >> feature & 1:
            continue
        prefer = int(declared.kind is Kind.NAT)
        pairs = {index: rules[index].pairs(feature) for index in used}
        found = list(_bit_loops([pairs[move.rule] for move in walk], prefer))
        if not found:
            reasons |= 1 << feature
        choices[feature] = found
    if reasons:
        return [], reasons

    if not choices:
        return list(walk), 0
    picked = {feature: loops[0] for feature, loops in choices.items()}
    # Cells of a piece are inside as far as its features can tell.
    if tracked and not outside.features & ~tracked:
        return _filled(walk, picked), 0
    known = (1 << len(model.features)) - 1
    delicate = [f for f in members(outside.features & ~tracked) if len(choices[f]) > 1]
    for loops in product(*(choices[f] for f in delicate[:MOST_CHOICES])):
        picked.update(zip(delicate, loops, strict=False))
        cycle = _filled(walk, picked)
        if not any(outside(known, move.before) for move in cycle):
            return cycle, 0
    return [], outside.features & ~tracked


def _filled(walk: Sequence[Move], picked: Mapping[int, Sequence[int]]) -> list[Move]:
    """The walk with bits for more features: a list for each, one bit a cell."""
    cells = [move.before for move in walk]
    for feature, bits in picked.items():
        if any(bits):
            cells = [cell | bit << feature for cell, bit in zip(cells, bits, strict=True)]
    return list(map(Move, cells, (move.rule for move in walk), cells[1:] + cells[:1]))


def _bit_loops(steps: Sequence[tuple[tuple[int, int], ...]], prefer: int) -> Iterator[list[int]]:
    """Bits before each step that come back to the first one: at most one for each first bit."""
    for first in (prefer, 1 - prefer):
        # Which bits before step i still lead back to `first`, from the last step backwards.
        good: list[set[int]] = [set() for _ in steps] + [{first}]
        for i in range(len(steps) - 1, -1, -1):
            good[i] = {before for before, after in steps[i] if after in good[i + 1]}
        if first not in good[0]:
            continue
        bits = [first]
        for i, pairs in enumerate(steps[:-1]):
            afters = {after for before, after in pairs if before == bits[i]} & good[i + 1]
            bits.append(bits[i] if bits[i] in afters else afters.pop())
        yield bits
