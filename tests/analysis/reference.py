"""Sieve as in the textbook, slow and obvious: valuations are tuples, every edge is listed.

Nothing here is shared with the prover. Edges come from `Rule.satisfied_by` on concrete
numbers, not from a table of bits: a rule leads from one valuation to another if some
numbers below `BIG` with these truth values satisfy it.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from sketchlang.model import Effect, Kind, Rule, SketchModel, holds

BIG = 3
"""0, 1 and 2 are enough: they have n = 0, n > 0, and room to rise and fall within n > 0."""

Valuation = tuple[int, ...]
Edge = tuple[Valuation, int, Valuation]


def valuations(model: SketchModel) -> list[Valuation]:
    """All valuations in which the invariants hold."""
    return [
        v
        for v in product((0, 1), repeat=len(model.features))
        if all(holds(invariant.formula, v) for invariant in model.invariants)
    ]


def numbers(model: SketchModel, valuation: Valuation) -> Iterator[tuple[int, ...]]:
    choices = [
        range(1, BIG) if bit and feature.kind is Kind.NAT else (bit,)
        for bit, feature in zip(valuation, model.features, strict=True)
    ]
    return product(*choices)


def leads(model: SketchModel, before: Valuation, rule: Rule, after: Valuation) -> bool:
    """Whether some numbers with these valuations satisfy the rule.

    Features do not depend on each other, so each may be looked at alone.
    """
    if not rule.applies(before):
        return False
    for f in range(len(model.features)):
        alone = Rule("alone", {}, {0: rule.effects[f]} if f in rule.effects else {})
        one = SketchModel("one", (model.features[f],), ())
        if not any(
            alone.satisfied_by(x, y)
            for x in numbers(one, before[f : f + 1])
            for y in numbers(one, after[f : f + 1])
        ):
            return False
    return True


def policy_graph(model: SketchModel) -> set[Edge]:
    """All edges; none leaves a goal."""
    found = valuations(model)
    return {
        (before, r, after)
        for before in found
        if not model.is_goal(before)
        for r, rule in enumerate(model.rules)
        if rule.applies(before)
        for after in found
        if leads(model, before, rule, after)
    }


def component_edges(edges: set[Edge]) -> list[set[Edge]]:
    """The edges of each strongly connected component, by who reaches whom."""
    successors: dict[Valuation, set[Valuation]] = {}
    for before, _, after in edges:
        successors.setdefault(before, set()).add(after)
    reaches: dict[Valuation, set[Valuation]] = {}
    for start in successors:
        seen: set[Valuation] = set()
        todo = [start]
        while todo:
            for after in successors.get(todo.pop(), ()):
                if after not in seen:
                    seen.add(after)
                    todo.append(after)
        reaches[start] = seen
    groups: dict[frozenset[Valuation], set[Edge]] = {}
    for edge in edges:
        before, _, after = edge
        if before in reaches.get(after, ()):
            group = frozenset(v for v in reaches[before] if before in reaches.get(v, ()))
            groups.setdefault(group, set()).add(edge)
    return list(groups.values())


def surviving_components(model: SketchModel) -> list[set[Edge]]:
    """What Sieve leaves: the sketch terminates if and only if it is nothing."""
    stuck: list[set[Edge]] = []
    todo = component_edges(policy_graph(model))
    while todo:
        component = todo.pop()
        removed = removable(model, component)
        if removed:
            todo += component_edges(component - removed)
        else:
            stuck.append(component)
    return stuck


def removable(model: SketchModel, component: set[Edge]) -> set[Edge]:
    """Edges that lower a nat which no edge of the component may raise, or the reverse."""

    def with_effect(f: int, *effects: Effect) -> set[Edge]:
        return {edge for edge in component if model.rules[edge[1]].effects.get(f) in effects}

    for f, feature in enumerate(model.features):
        if feature.kind is not Kind.NAT:
            continue
        lowered = with_effect(f, Effect.DEC)
        if lowered and not with_effect(f, Effect.INC, Effect.ANY, Effect.NOT_DEC):
            return lowered
        raised = with_effect(f, Effect.INC)
        opposed = with_effect(f, Effect.DEC, Effect.ANY, Effect.NOT_INC)
        if feature.bounded and raised and not opposed:
            return raised
    return set()


def terminates(model: SketchModel) -> bool:
    return not surviving_components(model)
