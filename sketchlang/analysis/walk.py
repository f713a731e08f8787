"""Closed walks that a sketch can follow for ever, found in a component that Sieve is stuck in.

A closed walk in the policy graph can be repeated for ever with real numbers if every nat
that it lowers by `n--` is also changed by `n++`, `n?` or `!n--` somewhere on it (and the
same the other way round for `n++` if n is bounded): there the number rises by as much as
the walk has taken from it. Sieve is complete because every component it leaves has one.

Here the component may know only some of the features. A walk through it is then only a
proposal: `close` looks for bits of the other features that come back to where they began.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from sketchlang.analysis.bits import RuleBits, members
from sketchlang.analysis.components import PieceGraph, components
from sketchlang.analysis.elimination import drop
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.region import Outside
from sketchlang.model import Kind, SketchModel

SMALL = 4000
"""Cells times rules up to which a walk is made short by trying to do without each rule."""

MOST_CHOICES = 12
"""Features of goal and invariants for which all combinations of bits are tried."""


@dataclass(frozen=True, slots=True)
class Move:
    """One edge of the policy graph, or of a piece of it."""

    before: int
    rule: int
    after: int


@dataclass(frozen=True, slots=True)
class Piece:
    """Cells over the features in `tracked`, and rules on them."""

    tracked: int
    cells: tuple[int, ...]
    rules: tuple[RuleBits, ...]


def propose(piece: Piece, bounded: int, budget: Budget) -> list[Move]:
    """A closed walk through a stuck component that undoes every strict change it makes.

    Preferably one that lowers again what it raises, even where no bound asks for that.
    """
    rises = 0
    for rule in piece.rules:
        rises |= rule.rises
    if rises & ~bounded:
        inner = _stuck_inside(piece, bounded | rises, budget)
        if inner is not None:
            piece, bounded = inner, bounded | rises
    piece = _with_fewer_rules(piece, bounded, budget)
    graph = PieceGraph(piece.cells, piece.tracked, piece.rules, budget)
    wanted = [piece.rules[0]]
    while True:
        walk = _covering(graph, wanted, budget)
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


def _with_fewer_rules(piece: Piece, bounded: int, budget: Budget) -> Piece:
    """A stuck component inside the given one from which no rule can be left out."""
    for candidate in piece.rules:
        if len(piece.cells) * len(piece.rules) > SMALL:
            break
        rest = tuple(rule for rule in piece.rules if rule is not candidate)
        if len(rest) == len(piece.rules):
            continue
        smaller = _stuck_inside(Piece(piece.tracked, piece.cells, rest), bounded, budget)
        piece = smaller or piece
    return piece


def _stuck_inside(piece: Piece, bounded: int, budget: Budget) -> Piece | None:
    """The first component of a piece that Sieve cannot take apart."""
    if not piece.rules:
        return None
    for component in components(piece.cells, piece.tracked, piece.rules, budget):
        left = tuple(rule for rule in piece.rules if rule.index in component.rules)
        inside = Piece(piece.tracked, component.cells, left)
        if not left:
            continue
        step = drop(left, bounded)
        if step is None:
            return inside
        rest = tuple(rule for rule in left if rule.index not in step.rules)
        found = _stuck_inside(Piece(piece.tracked, component.cells, rest), bounded, budget)
        if found is not None:
            return found
    return None


def _covering(graph: PieceGraph, wanted: Sequence[RuleBits], budget: Budget) -> list[Move]:
    """A closed walk with an edge of every wanted rule, short by always taking the nearest."""
    missing = {rule.index for rule in wanted}
    start = next(cell for cell, rule, _ in graph.arcs if rule == wanted[0].index)
    walk: list[Move] = []
    here = start

    def useful(rule: int, _: int) -> bool:
        return rule in missing

    while missing:
        walk += _path(graph, here, useful, budget)
        here = graph.number[walk[-1].after]
        missing -= {move.rule for move in walk}
    if here != start:
        walk += _path(graph, here, lambda _, after: after == start, budget)
    return walk


def _path(
    graph: PieceGraph, start: int, last: Callable[[int, int], bool], budget: Budget
) -> list[Move]:
    """The shortest path from a cell up to and with an edge (rule, cell after) that is `last`."""
    reached_by: dict[int, tuple[int, int]] = {}
    queue = deque([start])
    while queue:
        budget.check()
        cell = queue.popleft()
        for rule, node in graph.out(cell):
            for after in [node] if node < len(graph.cells) else graph.targets[node]:
                if last(rule, after):
                    moves = [Move(graph.cells[cell], rule, graph.cells[after])]
                    while cell != start:
                        earlier, by = reached_by[cell]
                        moves.append(Move(graph.cells[earlier], by, graph.cells[cell]))
                        cell = earlier
                    return moves[::-1]
                if after not in reached_by and after != start:
                    reached_by[after] = (cell, rule)
                    queue.append(after)
    raise AssertionError("a component is strongly connected")


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

    known = (1 << len(model.features)) - 1
    picked = {feature: loops[0] for feature, loops in choices.items()}
    delicate = [f for f in members(outside.features & ~tracked) if len(choices[f]) > 1]
    for loops in product(*(choices[f] for f in delicate[:MOST_CHOICES])):
        picked.update(zip(delicate, loops, strict=False))
        cells = [
            move.before | sum(bits[i] << feature for feature, bits in picked.items())
            for i, move in enumerate(walk)
        ]
        if not any(outside(known, cell) for cell in cells):
            ends = cells[1:] + cells[:1]
            return [Move(c, m.rule, e) for c, m, e in zip(cells, walk, ends, strict=True)], 0
    return [], outside.features & ~tracked


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
