"""Three views of a sketch: groups of valuations, all valuations, and rules."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from sketchlang.analysis.bits import rule_bits, subsets
from sketchlang.analysis.cubes import Cube, Work, fewest_cubes
from sketchlang.analysis.graph.drawing import Arrow, Box, Drawing, Look, TooLargeError
from sketchlang.analysis.graph.removal import Removal
from sketchlang.analysis.piece import Move
from sketchlang.analysis.region import Outside
from sketchlang.analysis.termination import NonTerminating, Terminating, Verdict
from sketchlang.analysis.words import cube, effect
from sketchlang.model import SketchModel

MOST_FEATURES = 8
"""Features up to which all valuations are listed to make a picture."""

START = "start"

MOST_LINES = 3
"""Cubes by which a group of valuations is described."""

Edge = tuple[int, int, int]


class _PolicyGraph:
    """The policy graph edge by edge, for sketches that are small enough."""

    def __init__(self, model: SketchModel) -> None:
        count = len(model.features)
        if count > MOST_FEATURES:
            raise TooLargeError(f"{count} features; up to {MOST_FEATURES} can be drawn")
        self.model = model
        self.count = count
        everything = (1 << count) - 1
        no_goal = Outside(SketchModel(model.name, model.features, (), None, model.invariants))
        self.valuations = [v for v in range(1 << count) if not no_goal(everything, v)]
        possible = set(self.valuations)
        self.goals = {
            v for v in self.valuations if model.is_goal(tuple(v >> f & 1 for f in range(count)))
        }
        self.edges: list[Edge] = []
        for rule in rule_bits(model):
            for before in self.valuations:
                if before in self.goals or rule.dead or before & rule.needs != rule.wants:
                    continue
                base, free = rule.fan(before)
                for chosen in subsets(free):
                    if base | chosen in possible:
                        self.edges.append((before, rule.index, base | chosen))


def policy_view(model: SketchModel, verdict: Verdict, start: int | None = None) -> Drawing:
    """A box for every valuation that an edge enters or leaves, and every gap. Boxes have the
    colour of the last step that takes an edge away from them: so they are grouped by the proof.
    The edges by which one rule leads from one valuation to several are bundled: they part at a
    small box with the rule's name. `start` is the valuation, a bit a feature, where a run starts.
    """
    graph = _PolicyGraph(model)
    removal, endless = _evidence(model, verdict)
    sources = {before for before, _, _ in graph.edges}
    targets = {after for _, _, after in graph.edges}
    last: dict[int, int] = {}
    for before, rule, after in graph.edges:
        step = removal.of_edge(before, rule, after)
        if step is not None:
            last[before] = max(last.get(before, 0), step)
    boxes = []
    for v in graph.valuations:
        if v in graph.goals and v not in targets:
            continue
        look = Look.GOAL if v in graph.goals else Look.PLAIN if v in sources else Look.GAP
        words = cube(model, (1 << graph.count) - 1, v)[1:-1]
        lines = (START, words) if v == start else (words,)
        covers = (_pattern(graph.count, v),)
        boxes.append(Box(f"v{v}", lines, look, last.get(v), covers, v == start))
    key_of = {v: f"v{v}" for v in graph.valuations}
    bundles: dict[tuple[int, int], list[Edge]] = {}
    for edge in graph.edges:
        bundles.setdefault(edge[:2], []).append(edge)
    alone = [edge for edges in bundles.values() for edge in edges if len(edges) == 1]
    arrows = list(_arrows(model, alone, key_of, removal, endless))
    for (before, rule), edges in bundles.items():
        if len(edges) > 1:
            key = f"v{before}r{rule}"
            boxes.append(Box(key, (model.rules[rule].name,), Look.RULE))
            arrows += _bundle(model, edges, key, removal, endless)
    return Drawing(
        f"{model.name}: policy graph", tuple(boxes), tuple(arrows), _legend(boxes, arrows, removal)
    )


def _bundle(
    model: SketchModel,
    edges: Sequence[Edge],
    key: str,
    removal: Removal,
    endless: tuple[Move, ...],
) -> Iterator[Arrow]:
    """An arrow to the box of a bundle, and one from there for each edge."""
    cycle = {(move.before, move.rule, move.after) for move in endless}
    before, rule, _ = edges[0]
    names = (model.rules[rule].name,)
    steps = {removal.of_edge(*edge) for edge in edges}
    common = steps.pop() if len(steps) == 1 else None
    bad = any(edge in cycle for edge in edges)
    yield Arrow(f"v{before}", key, "", None if bad else common, bad, names)
    for edge in edges:
        step = None if edge in cycle else removal.of_edge(*edge)
        yield Arrow(key, f"v{edge[2]}", "", step, edge in cycle, names)


def _pattern(count: int, valuation: int) -> str:
    return "".join("1" if valuation >> f & 1 else "0" for f in range(count))


def group_view(model: SketchModel, verdict: Verdict, start: int | None = None) -> Drawing:
    """A box for all valuations at which the same rules can be used; `start` as above."""
    graph = _PolicyGraph(model)
    removal, endless = _evidence(model, verdict)
    usable: dict[int, set[int]] = {v: set() for v in graph.valuations}
    for before, rule, _ in graph.edges:
        usable[before].add(rule)
    groups: dict[tuple[bool, tuple[int, ...]], list[int]] = {}
    for v in graph.valuations:
        groups.setdefault((v in graph.goals, tuple(sorted(usable[v]))), []).append(v)
    boxes = []
    key_of: dict[int, str] = {}
    everything = (1 << graph.count) - 1
    for number, ((goal, rules), members) in enumerate(sorted(groups.items())):
        key = f"g{number}"
        inside = set(members)
        on = [Cube(everything, v) for v in members]
        off = [Cube(everything, v) for v in graph.valuations if v not in inside]
        cubes = fewest_cubes(on, off, Work(10_000_000))
        lines = [cube(model, *c) for c in cubes[:MOST_LINES]]
        if len(cubes) > MOST_LINES:
            lines.append(f"and {len(cubes) - MOST_LINES} more")
        look = Look.GOAL if goal else Look.PLAIN if rules else Look.GAP
        lines.append("goal" if goal else "" if rules else "no rule")
        here = start in inside
        if here:
            lines.insert(0, START)
        covers = tuple(_pattern(graph.count, v) for v in members)
        shown = tuple(line for line in lines if line)
        boxes.append(Box(key, shown, look, None, covers, here))
        key_of.update(dict.fromkeys(members, key))
    arrows = _arrows(model, graph.edges, key_of, removal, endless)
    return Drawing(
        f"{model.name}: valuations with the same rules",
        tuple(boxes),
        arrows,
        _legend(boxes, arrows, removal),
    )


def rule_view(model: SketchModel, verdict: Verdict, start: int | None = None) -> Drawing:
    """A box for every rule with its conditions and effects, an arrow to every rule that can be
    next. Rules that can fire at `start` are marked."""
    removal, endless = _evidence(model, verdict)
    rules = [rule for rule in rule_bits(model) if not rule.dead]
    boxes = []
    for rule in rules:
        named = model.rules[rule.index]
        effects = ", ".join(effect(model, f, kind) for f, kind in named.effects.items())
        conditions = cube(model, rule.needs, rule.wants)[1:-1]
        here = start is not None and start & rule.needs == rule.wants
        lines = (named.name, START if here else "", conditions and f"if {conditions}", effects)
        shown = tuple(line for line in lines if line)
        step = removal.of_rule(rule.index)
        boxes.append(Box(f"r{rule.index}", shown, step=step, start=here))
    following = {
        (move.rule, after.rule)
        for move, after in zip(endless, endless[1:] + endless[:1], strict=True)
    }
    arrows = []
    for rule in rules:
        afters = {f: {b for _, b in rule.pairs(f)} for f in range(len(model.features))}
        for other in rules:
            if all({b for b, _ in other.pairs(f)} & afters[f] for f in range(len(model.features))):
                pair = (rule.index, other.index)
                arrows.append(Arrow(f"r{pair[0]}", f"r{pair[1]}", "", None, pair in following))
    return Drawing(
        f"{model.name}: rules and what can follow",
        tuple(boxes),
        tuple(arrows),
        _legend(boxes, arrows, removal),
    )


VIEWS = {"groups": group_view, "policy": policy_view, "rules": rule_view}


def _legend(
    boxes: Sequence[Box], arrows: Sequence[Arrow], removal: Removal
) -> tuple[tuple[int, str], ...]:
    return removal.shown([box.step for box in boxes] + [arrow.step for arrow in arrows])


def _evidence(model: SketchModel, verdict: Verdict) -> tuple[Removal, tuple[Move, ...]]:
    steps = verdict.steps if isinstance(verdict, Terminating | NonTerminating) else ()
    walk = verdict.walk if isinstance(verdict, NonTerminating) else ()
    return Removal(model, steps), walk


def _arrows(
    model: SketchModel,
    edges: Iterable[Edge],
    key_of: dict[int, str],
    removal: Removal,
    endless: tuple[Move, ...],
) -> tuple[Arrow, ...]:
    """One arrow for all edges between two boxes that are of one colour."""
    cycle = {(move.before, move.rule, move.after) for move in endless}
    merged: dict[tuple[str, str, int | None, bool], list[int]] = {}
    for before, rule, after in edges:
        bad = (before, rule, after) in cycle
        step = None if bad else removal.of_edge(before, rule, after)
        rules = merged.setdefault((key_of[before], key_of[after], step, bad), [])
        if rule not in rules:
            rules.append(rule)
    return tuple(
        Arrow(
            source,
            target,
            ", ".join(model.rules[rule].name for rule in rules),
            step,
            bad,
            tuple(model.rules[rule].name for rule in rules),
        )
        for (source, target, step, bad), rules in merged.items()
    )
