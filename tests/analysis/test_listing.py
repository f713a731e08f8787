"""Sieve on lists of all valuations, and the tables of ranks that are its evidence."""

from __future__ import annotations

import base64
import random
import zlib
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest

import sketchlang.analysis.numbers as numbers_module
import sketchlang.analysis.walk as walk_module
from benchmarks.families import FAMILIES
from sketchlang.analysis.bits import bounded_mask, rule_bits
from sketchlang.analysis.certificate import certificate_of
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.listed_piece import ListedPiece
from sketchlang.analysis.listing import Listed, Listing
from sketchlang.analysis.narrowing import Narrowing
from sketchlang.analysis.numbers import concrete_run
from sketchlang.analysis.piece import PieceGraph
from sketchlang.analysis.proof import Ranks
from sketchlang.analysis.region import Outside
from sketchlang.analysis.termination import NonTerminating, Terminating, decide_termination
from sketchlang.analysis.verify import verify
from sketchlang.analysis.walk import close, propose
from sketchlang.loader import load_text
from sketchlang.model import SketchModel
from sketchlang.source import Source
from tests.analysis import notation
from tests.analysis.random_sketches import dense_sketch, random_sketch
from tests.analysis.reference import Edge, policy_graph, surviving_components
from tests.analysis.replay import replay
from tests.analysis.test_certificates import refused, signed


def listed(sketch: SketchModel) -> Listed | None:
    alive = [rule for rule in rule_bits(sketch) if not rule.dead]
    return Listing(sketch, alive, Budget()).run() if alive else None


def check(sketch: SketchModel, terminates: bool) -> dict[str, Any] | None:
    """The evidence is right, and the verdict the one expected. A certificate, if there is one."""
    found = listed(sketch)
    if found is None:
        return None
    assert (found.step is not None) == terminates
    if found.step is not None:
        certificate = certificate_of(sketch, Terminating((found.step,), "sieve"))
        verify(certificate, sketch)
        return certificate
    assert found.stuck is not None
    for graph in (None, found.graph):
        walk = propose(found.stuck, bounded_mask(sketch), Budget(), graph)
        tracked = found.stuck.tracked
        cycle, reasons = close(walk, tracked, sketch, rule_bits(sketch), Outside(sketch))
        assert not reasons
        replay(sketch, NonTerminating(tuple(cycle), concrete_run(sketch, cycle), ()))
    return None


def test_random_sketches() -> None:
    answers = set()
    for seed in range(200):
        sketch = random_sketch(seed)
        terminates = not surviving_components(sketch)
        answers.add(terminates)
        check(sketch, terminates)
    assert answers == {True, False}


def test_walks_through_large_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those that are not made smaller first, and whose numbers are arrays."""
    monkeypatch.setattr(walk_module, "SMALL", -1)
    monkeypatch.setattr(numbers_module, "MANY", 0)
    for seed in range(150):
        sketch = random_sketch(seed)
        check(sketch, not surviving_components(sketch))


def test_paths_through_a_listed_piece() -> None:
    """Each step is an edge, and one starts where the one before ends."""
    paths = longest = 0
    for seed in range(40):
        sketch = dense_sketch(seed, 5, 8 + seed % 6)
        found = listed(sketch)
        if found is None or found.stuck is None:
            continue
        piece, graph = found.stuck, found.graph
        assert isinstance(graph, ListedPiece)
        edges = {
            (sum(b << f for f, b in enumerate(v)), rule, sum(b << f for f, b in enumerate(w)))
            for v, rule, w in policy_graph(sketch)
        }
        for start, end in product(range(len(piece.cells)), repeat=2):
            moves = graph.path_to(start, end)
            assert set(moves) <= edges
            assert [move.after for move in moves[:-1]] == [move.before for move in moves[1:]]
            assert (moves[0].before, moves[-1].after) == (piece.cells[start], piece.cells[end])
            paths, longest = paths + 1, max(longest, len(moves))
    assert paths > 300
    assert longest > 2


def test_few_rules() -> None:
    """None of the rules that are left in a stuck piece can be left out."""
    pieces = 0
    for seed in range(200):
        sketch = random_sketch(seed)
        found = listed(sketch)
        if found is None or found.stuck is None:
            continue
        pieces += 1
        piece, bounded = found.stuck, bounded_mask(sketch)
        narrowing = Narrowing(
            PieceGraph(piece.cells, piece.tracked, piece.rules, Budget()), piece, Budget()
        )
        narrowing.to_few_rules(bounded)
        kept = narrowing.piece.rules
        assert set(narrowing.piece.cells) <= set(piece.cells)
        for chosen, ends in [(kept, False)] + [
            ([rule for rule in kept if rule is not left_out], True) for left_out in kept
        ]:
            rules = tuple(sketch.rules[rule.index] for rule in chosen)
            assert (not surviving_components(replace(sketch, rules=rules))) == ends
    assert pieces > 20


@pytest.mark.slow
def test_many_random_sketches() -> None:
    for seed in range(40_000, 43_000):
        sketch = random_sketch(seed)
        check(sketch, not surviving_components(sketch))


def test_dense_sketches() -> None:
    for seed in range(60):
        sketch = dense_sketch(seed, 6 + seed % 5, 8 + seed % 9)
        check(sketch, isinstance(decide_termination(sketch), Terminating))


def ranks_prove(sketch: SketchModel, edges: set[Edge], tables: list[Any]) -> bool:
    """What the format says of ranks, edge by edge."""
    at_hand = set(edges)
    order = {v: 0 for edge in edges for v in (edge[0], edge[2])}
    for table in tables:
        rank = {v: int(table[sum(bit << f for f, bit in enumerate(v))]) for v in order}
        if any((order[a] < order[b]) > (rank[a] < rank[b]) for a in order for b in order) or any(
            rank[before] > rank[after] for before, _, after in at_hand
        ):
            return False
        at_hand = {edge for edge in at_hand if rank[edge[0]] == rank[edge[2]]}
        order = rank
        gone: set[Edge] = set()
        for edge in at_hand:
            inside = [e for e in at_hand if rank[e[0]] == rank[edge[0]]]
            for f, declared in enumerate(sketch.features):
                signs = {
                    sketch.rules[r].effects[f].value
                    for _, r, _ in inside
                    if f in sketch.rules[r].effects
                }
                own = sketch.rules[edge[1]].effects.get(f)
                falls = own is not None and own.value == "n--"
                rises = own is not None and own.value == "n++" and declared.bounded
                if (falls and not signs & {"n++", "?", "!n--"}) or (
                    rises and not signs & {"n--", "?", "!n++"}
                ):
                    gone.add(edge)
        at_hand -= gone
    return not at_hand


def packed(table: Any) -> str:
    return base64.b64encode(zlib.compress(table.astype("<u4").tobytes())).decode()


def test_altered_tables() -> None:
    """What is accepted is a proof. (Not the reverse: the checker asks for every valuation.)"""
    rng = random.Random(1)
    altered = accepted = 0
    for seed in range(160):
        sketch = random_sketch(seed, most_features=4)
        if surviving_components(sketch) or (certificate := check(sketch, True)) is None:
            continue
        (step,) = certificate["proof"]
        if len(step["ranks"]) < len(sketch.features):
            continue
        tables = [
            np.frombuffer(zlib.decompress(base64.b64decode(text)), "<u4") for text in step["tables"]
        ]
        # An edge to a goal is the last one of its run.
        edges = {edge for edge in policy_graph(sketch) if not sketch.is_goal(edge[2])}
        assert ranks_prove(sketch, edges, tables)
        for _ in range(12):
            forged = [table.copy() for table in tables]
            chosen = rng.choice(forged)
            chosen[rng.randrange(len(chosen))] = rng.choice([0, 1, 2, len(chosen) - 1, 2**32 - 1])
            if rng.random() < 0.2:
                forged.pop()
            proof = [step | {"tables": [packed(table) for table in forged]}]
            altered += 1
            if not refused(signed(certificate | {"proof": proof}), sketch):
                accepted += 1
                assert ranks_prove(sketch, edges, forged), seed
    assert altered > 300
    assert accepted < 0.7 * altered  # many a rank may be moved


def test_malformed_tables() -> None:
    sketch = random_sketch(next(s for s in range(99) if not surviving_components(random_sketch(s))))
    certificate = check(sketch, True)
    assert certificate is not None
    (step,) = certificate["proof"]
    good = zlib.decompress(base64.b64decode(step["tables"][0]))
    bad = [
        {"tables": []},
        {"tables": 7},
        {"tables": [7]},
        {"tables": ["no base64"]},
        {"tables": [base64.b64encode(b"no zlib").decode()]},
        {"tables": [base64.b64encode(zlib.compress(good + b"0000")).decode()]},
        {"tables": [base64.b64encode(zlib.compress(good[:-4])).decode()]},
        {"tables": [base64.b64encode(zlib.compress(bytes(10_000_000))).decode()]},
        {"tables": [base64.b64encode(zlib.compress(b"\xfe" * len(good))).decode()]},
        {"ranks": step["ranks"][1:]},
        {"ranks": step["ranks"][::-1]},
        {"ranks": [*step["ranks"], step["ranks"][-1]]},
        {"ranks": "b0"},
        {"rules": step["rules"][1:]},
        {"more": 1},
    ]
    for change in bad:
        if change.get("ranks") == step["ranks"]:
            continue  # of a single feature
        assert refused(signed(certificate | {"proof": [step | change]}), sketch), change
    assert refused(signed(certificate | {"version": 1}), sketch)


def family(name: str, features: int) -> SketchModel:
    return load_text(Source("it.sketch", FAMILIES[name](features))).checked.model


def test_a_gray_code_of_twenty_features() -> None:
    sketch = family("gray", 20)
    verdict = decide_termination(sketch)
    assert isinstance(verdict, Terminating)
    (step,) = [s for s in verdict.steps if isinstance(s, Ranks)]
    assert len(step.features) >= 19  # the highest bit turns but once
    certificate = certificate_of(sketch, verdict)
    verify(certificate, sketch)


def test_a_closed_gray_code() -> None:
    sketch = family("closed", 14)
    verdict = decide_termination(sketch)
    assert isinstance(verdict, NonTerminating)
    assert len(verdict.walk) == 1 << 13
    replay(sketch, verdict)


@pytest.mark.parametrize("bounded", [False, True])
@pytest.mark.parametrize("strict", ["n--", "n++"])
@pytest.mark.parametrize("undoes", ["", "n--", "n++", "!n++", "!n--", "n?"])
def test_a_rule_is_finite_only_where_no_other_may_undo_it(bounded, strict, undoes) -> None:
    """Two rules take turns. The tables say that the first fires finitely often, and the other then
    leads to a higher rank: a forger may write them for any two rules."""
    rules = [f"!p -> p {strict}", f"p -> !p {undoes}"]
    sketch = notation.model("turns", "p", "n", rules, bounded=bounded)
    tables = [[0, 0, 0, 0], [1, 0, 1, 0]]  # of !p, p with n = 0, then with n > 0
    packed = tuple(np.array(table, "<u4").tobytes() for table in tables)
    step = Ranks((0, 1), packed, (0, 1))
    certificate = certificate_of(sketch, Terminating((step,), "sieve"))
    assert refused(certificate, sketch) == bool(surviving_components(sketch))
