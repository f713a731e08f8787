"""Termination when rules are fair: the reading of qualitative numeric problems.

A rule is fair if its outcomes are all taken: a run that uses it again and again in a valuation
sees each valuation that it may lead to from there again and again (strong cyclic plans; Bonet
and Geffner, Qualitative Numeric Planning, JAIR 2020). So in a strongly connected component
a fair rule goes from every valuation from which it may leave the component, or reach a goal.
The rest is Sieve. An outcome that an invariant excludes is none.
"""

from __future__ import annotations

from collections.abc import Collection

from sketchlang.analysis.bits import bounded_mask, rule_bits, subsets
from sketchlang.analysis.components import strongly_connected
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.region import Outside
from sketchlang.model import SketchModel

MOST_FEATURES = 14
"""Features up to which all valuations are listed."""

GOAL = -1
"""Stands for a goal among the outcomes of a rule."""

Edges = dict[tuple[int, int], tuple[int, ...]]
"""By valuation and rule: the valuations that the rule may lead to from there."""


class TooManyFeaturesError(Exception):
    """There are too many valuations to list them all."""


def terminates_fairly(model: SketchModel, fair: Collection[int], budget: Budget) -> bool:
    """Whether no infinite run exists in which the rules `fair` are fair. Complete.

    Raises:
        TooManyFeaturesError: the sketch is too large.
        LimitReachedError: a limit of the budget was reached.
    """
    if len(model.features) > MOST_FEATURES:
        raise TooManyFeaturesError(f"{len(model.features)} features, at most {MOST_FEATURES}")
    edges = _edges(model, budget)
    rules, bounded = rule_bits(model), bounded_mask(model)
    while edges:
        budget.check()
        component = _components(edges)
        left: Edges = {}
        changes: dict[int, tuple[int, int, int, int]] = {}
        for (v, r), after in edges.items():
            inside = tuple(w for w in after if w != GOAL and component[w] == component[v])
            if not inside or (r in fair and len(inside) < len(after)):
                continue
            left[v, r] = inside if r not in fair else after
            old = changes.get(component[v], (0, 0, 0, 0))
            rule = rules[r]
            new = (rule.falls, rule.may_rise, rule.rises & bounded, rule.may_fall)
            changes[component[v]] = (
                old[0] | new[0],
                old[1] | new[1],
                old[2] | new[2],
                old[3] | new[3],
            )
        # A nat that some edges change strictly and none of the component changes back.
        kept = {
            (v, r): after
            for (v, r), after in left.items()
            if not rules[r].falls & ~changes[component[v]][1]
            and not rules[r].rises & bounded & ~changes[component[v]][3]
        }
        if len(kept) == len(edges):
            return False
        edges = kept
    return True


def _edges(model: SketchModel, budget: Budget) -> Edges:
    outside = Outside(model)
    no_goal = Outside(SketchModel(model.name, model.features, (), None, model.invariants))
    known = (1 << len(model.features)) - 1
    kind = [0 if not outside(known, v) else 2 if no_goal(known, v) else 1 for v in range(known + 1)]
    edges: Edges = {}
    for rule in rule_bits(model):
        budget.check()
        for v in range(known + 1):
            if rule.dead or kind[v] or (v ^ rule.wants) & rule.needs:
                continue
            base, free = rule.fan(v)
            after = [base | s for s in subsets(free) if kind[base | s] < 2]
            budget.spend(len(after))
            if after:
                edges[v, rule.index] = tuple(GOAL if kind[w] else w for w in after)
    return edges


def _components(edges: Edges) -> dict[int, int]:
    """The component of every valuation that occurs."""
    reached = {w for after in edges.values() for w in after if w != GOAL}
    nodes = sorted({v for v, _ in edges} | reached)
    number = {v: i for i, v in enumerate(nodes)}
    targets: list[list[int]] = [[] for _ in nodes]
    for (v, _), after in edges.items():
        targets[number[v]] += [number[w] for w in after if w != GOAL]
    owner, _ = strongly_connected(targets)
    return {v: owner[i] for v, i in number.items()}
