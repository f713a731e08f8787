"""Coverage against a look at every valuation, and what it says of the paper's sketch."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import pytest

from sketchlang.analysis.coverage import Coverage, find_coverage, find_overlaps
from sketchlang.analysis.coverage_report import _invariant
from sketchlang.analysis.cubes import Cube, TooManyCubesError, Work, fewest_hitting
from sketchlang.analysis.words import cube
from sketchlang.model import Invariant, Literal, Not, Or, SketchModel, holds
from tests.analysis.known import KNOWN
from tests.analysis.notation import model
from tests.analysis.random_sketches import random_sketch
from tests.analysis.reference import Valuation, leads, valuations

PICK_AND_PLACE = next(k for k in KNOWN if k.name == "pick_and_place").variant(True, False)


def inside(where: Cube, valuation: Valuation) -> bool:
    bits = sum(bit << f for f, bit in enumerate(valuation))
    return bits & where.known == where.bits


def uses(sketch: SketchModel) -> dict[Valuation, set[int]]:
    """For every valuation that is no goal, the rules that lead somewhere from it."""
    possible = valuations(sketch)
    return {
        before: {
            r
            for r, rule in enumerate(sketch.rules)
            if any(leads(sketch, before, rule, after) for after in possible)
        }
        for before in possible
        if not sketch.is_goal(before)
    }


def check(sketch: SketchModel) -> Coverage:
    found = find_coverage(sketch)
    used = uses(sketch)
    gaps = {valuation for valuation, rules in used.items() if not rules}
    cubes = [gap.cube for gap in found.gaps]
    listed = {v for v in valuations(sketch) if any(inside(c, v) for c in cubes)}
    assert listed == gaps
    assert found.uncovered == len(gaps)
    assert found.possible == len(valuations(sketch))
    assert set(found.dead) == set(range(len(sketch.rules))) - set().union(*used.values())
    everything = [c for c in cubes if c.known == 0] == cubes
    for gap in cubes:
        # No literal can be left out, and no cube.
        for f in range(len(sketch.features)):
            if gap.known >> f & 1:
                wider = Cube(gap.known & ~(1 << f), gap.bits & ~(1 << f))
                assert any(inside(wider, v) and v not in gaps for v in all_valuations(sketch))
        others = [c for c in cubes if c != gap]
        assert everything or any(
            inside(gap, v) and not any(inside(c, v) for c in others) for v in gaps
        )
    pairs = {(o.first, o.second) for o in find_overlaps(sketch)}
    assert pairs == {pair for rules in used.values() for pair in combinations(sorted(rules), 2)}
    return found


def all_valuations(sketch: SketchModel) -> list[Valuation]:
    return valuations(replace(sketch, invariants=()))


@pytest.mark.parametrize("known", KNOWN, ids=lambda known: known.name)
def test_known_sketches(known: object) -> None:
    check(known.variant(True, False))  # type: ignore[attr-defined]


def test_random_sketches() -> None:
    sizes = {len(check(random_sketch(seed)).gaps) for seed in range(400)}
    assert {0, 1, 2, 3} <= sizes


def test_pick_and_place_lacks_a_rule() -> None:
    found = check(PICK_AND_PLACE)
    assert [cube(PICK_AND_PLACE, *gap.cube) for gap in found.gaps] == ["{!H, m > 0, u > 0, v = 0}"]
    (obstacle,) = found.gaps[0].obstacles
    assert (obstacle.rule, obstacle.lowered) == (1, 4)
    assert not found.dead
    assert not find_overlaps(PICK_AND_PLACE)


def test_an_invariant_closes_the_gap() -> None:
    formula = Or((Not(Literal(3, True)), Literal(4, True)))
    invariant = Invariant(formula, "u > 0 -> v > 0")
    assert not check(replace(PICK_AND_PLACE, invariants=(invariant,))).gaps


def test_an_invariant_may_take_away_where_a_rule_leads() -> None:
    sketch = model("it", "p q", "", ["p -> !p", "!p -> p"])
    closed = replace(sketch, invariants=(Invariant(Or((Literal(0, True), Literal(1, True))), ""),))
    assert not check(sketch).gaps
    (gap,) = check(closed).gaps
    assert cube(closed, *gap.cube) == "{p, !q}"
    assert gap.obstacles[0].lowered is None


def clause_of(sketch: SketchModel, text: str) -> Or:
    """An invariant as it is offered: `invariant p and n > 0 -> not q`."""
    index = {feature.name: f for f, feature in enumerate(sketch.features)}

    def literal(words: str) -> Literal:
        name = words.removeprefix("not ").split()[0]
        return Literal(index[name], not words.startswith("not ") and not words.endswith("= 0"))

    given, _, last = text.removeprefix("invariant ").rpartition(" -> ")
    premises = [literal(words) for words in given.split(" and ")] if given else []
    return Or((*(Literal(p.feature, not p.positive) for p in premises), literal(last)))


def pointless(sketch: SketchModel, clause: Or) -> bool:
    """Whether a declared invariant follows from a clause alone."""
    left = [v for v in all_valuations(sketch) if holds(clause, v)]
    return any(all(holds(one.formula, v) for v in left) for one in sketch.invariants)


def test_offered_invariants_leave_the_declared_ones_their_meaning() -> None:
    """They close the gap, make no declared one pointless, and have no premise too many."""
    offered = 0
    for seed in range(700):
        sketch = replace(random_sketch(seed), goal={0: True})
        gaps = find_coverage(sketch).gaps
        text = _invariant(sketch, gaps[0]) if gaps and sketch.invariants else None
        if text is None:
            continue
        offered += 1
        clause = clause_of(sketch, text)
        assert not find_coverage(
            replace(sketch, invariants=(*sketch.invariants, Invariant(clause, "")))
        ).gaps
        assert not pointless(sketch, clause)
        left = [v for v in valuations(sketch) if holds(clause, v)]
        for premise in clause.operands[:-1]:
            shorter = Or(tuple(p for p in clause.operands if p is not premise))
            same = [v for v in valuations(sketch) if holds(shorter, v)] == left
            assert not same or pointless(sketch, shorter), (seed, text)
    assert offered > 10


def test_rules_that_can_never_be_used() -> None:
    sketch = model("it", "p", "n", ["p -> n?", "!p -> p", "n=0 -> n--"], goal="p")
    assert check(sketch).dead == (0, 2)


def test_overlaps() -> None:
    sketch = model("it", "p", "n", ["p -> !p", "n>0 -> n--", "!p n=0 -> p"])
    (overlap,) = find_overlaps(sketch)
    assert (overlap.first, overlap.second) == (0, 1)
    assert cube(sketch, *overlap.cube) == "{p, n > 0}"


def test_too_much_work_is_an_error_not_a_wait() -> None:
    with pytest.raises(TooManyCubesError):
        find_coverage(PICK_AND_PLACE, most_work=3)


def test_fewest_hitting_is_a_smallest_set() -> None:
    sets = [0b0011, 0b0110, 0b1100, 0b1001]
    assert fewest_hitting(sets, Work(1000)).bit_count() == 2
    assert fewest_hitting([], Work(1000)) == 0
