"""The fewest formulas that cannot hold together, against all sets of them and all valuations."""

from __future__ import annotations

import random
from itertools import combinations, product

from sketchlang.analysis.contradiction import Together
from sketchlang.loader import load_text
from sketchlang.model import And, Formula, Literal, Not, Or, holds
from sketchlang.source import Source

WORK = 100_000


def formula(rng: random.Random, features: int, depth: int) -> Formula:
    kind = rng.choice(("literal", "not", "and", "or")) if depth else "literal"
    if kind == "literal":
        return Literal(rng.randrange(features), rng.random() < 0.5)
    if kind == "not":
        return Not(formula(rng, features, depth - 1))
    parts = tuple(formula(rng, features, depth - 1) for _ in range(rng.randint(0, 3)))
    return And(parts) if kind == "and" else Or(parts)


def can_hold(formulas: list[Formula], features: int, fixed: dict[int, bool]) -> bool:
    return any(
        all(holds(one, values) for one in formulas)
        for values in product((0, 1), repeat=features)
        if all(bool(values[f]) == true for f, true in fixed.items())
    )


def fewest(formulas: list[Formula], features: int, fixed: dict[int, bool]) -> int:
    """How many it takes, 0 if all can hold."""
    if can_hold(formulas, features, fixed):
        return 0
    return next(
        count
        for count in range(len(formulas) + 1)
        for some in combinations(formulas, count)
        if not can_hold(list(some), features, fixed)
    )


def test_as_few_as_there_can_be() -> None:
    sizes = set()
    for seed in range(400):
        rng = random.Random(seed)
        features = rng.randint(1, 5)
        formulas = [formula(rng, features, 2) for _ in range(rng.randint(1, 7))]
        fixed = {f: rng.random() < 0.5 for f in range(features) if rng.random() < 0.3}
        found = Together(formulas, WORK).contradiction(fixed)
        assert not found or not can_hold([formulas[i] for i in found], features, fixed), seed
        assert len(found) == fewest(formulas, features, fixed), seed
        sizes.add(len(found))
    assert {0, 1, 2, 3} <= sizes


def test_a_long_chain_needs_all_of_it() -> None:
    count = 30
    links: list[Formula] = [Or((Literal(f, False), Literal(f + 1, True))) for f in range(count)]
    ends: list[Formula] = [Literal(0, True), Literal(count, False)]
    idle: list[Formula] = [Or((Literal(f, True), Literal(f + 7, True))) for f in range(20)]
    found = Together([*idle, *links, *ends], WORK).contradiction()
    assert found == tuple(range(20, 20 + count + 2))


def test_too_much_work_is_no_contradiction() -> None:
    odd: list[Formula] = [Literal(0, True)]
    for f in range(1, 30):
        left, right = odd[-1], Literal(f, True)
        odd.append(And((Or((left, right)), Not(And((left, right))))))
    assert Together([odd[-1], Not(odd[-1])], WORK).contradiction() == ()


def test_not_all_of_many_are_shown() -> None:
    count = 40
    lines = [f"feature b{i} : bool" for i in range(count)]
    lines += [f"invariant not b{i} or b{i + 1}" for i in range(count - 1)]
    text = "\n".join(["sketch s", *lines, "invariant b0", f"invariant not b{count - 1}"])
    text += "\ngoal { b0 }\nrule r { !b0 } -> { b0 }\n"
    found = next(one for one in load_text(Source("s", text)).diagnostics if one.primary)
    assert found.code == "contradicting-invariants"
    assert f"and {count} other invariants" in found.message
    assert 1 < len(found.secondary) < 10
