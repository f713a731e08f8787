"""Coverage as text for people, JSON for programs, and warnings of `check`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

from sketchlang.analysis.bits import members
from sketchlang.analysis.coverage import Coverage, Gap, Obstacle, Overlap, find_coverage
from sketchlang.analysis.cubes import Cube, TooManyCubesError, Work, contains, cubes_of
from sketchlang.analysis.words import Position, counted, cube, listed, literal
from sketchlang.diagnostics import Diagnostic, Label, Severity
from sketchlang.model import NO_SPAN, Invariant, Kind, Literal, Or, Rule, SketchModel
from sketchlang.source import Source

MOST_GAPS = 20
"""Gaps that are written out; JSON has them all."""

MOST_WARNINGS = 3
"""Gaps that `check` warns of one by one."""

MOST_PREMISES = 5
"""Conditions of a proposed invariant up to which weaker ones are tried."""

PROPOSAL_WORK = 20_000
"""Steps of work to see whether a proposed invariant leaves other gaps."""

CHECK_WORK = 40_000
"""Steps of work that `check` is ready to spend: well under a tenth of a second."""


def as_text(
    model: SketchModel, found: Coverage, overlaps: list[Overlap] | None, position: Position
) -> str:
    """The findings, or that there are none."""
    lines: list[str] = []
    if found.gaps:
        lines.append(
            f"{model.name}: no rule for {found.uncovered:,} of "
            f"{counted(found.possible, 'valuation')}."
        )
        for gap in found.gaps[:MOST_GAPS]:
            lines += ["", f"  {cube(model, *gap.cube)}"]
            lines += [f"    {_obstacle(model, o, position)}" for o in gap.obstacles]
        if len(found.gaps) > MOST_GAPS:
            more = len(found.gaps) - MOST_GAPS
            lines += ["", f"  ... and {counted(more, 'more group')}; --json lists them all."]
        if model.goal is None:
            lines += ["", "The sketch has no goal: some of these may be where it should end."]
        proposal = _invariant(model, found.gaps[0])
        lines += ["", "Write a rule for them."]
        if proposal is not None:
            lines[-1] += " Or say that no state is like that, for instance:"
            lines.append(f"  {proposal}")
    else:
        lines.append(f"{model.name}: every valuation but the goal has a rule.")
    for rule in found.dead:
        place = position(model.rules[rule], None)
        lines += ["", f"{place}: rule {model.rules[rule].name} can never be used."]
    if overlaps is not None:
        lines.append("")
        lines += [_overlap(model, overlap) for overlap in overlaps]
        if not overlaps:
            lines.append("No two rules apply together.")
    return "\n".join(lines)


def as_json(
    model: SketchModel, found: Coverage, overlaps: list[Overlap] | None, position: Position
) -> dict[str, Any]:
    """The findings; docs/termination.md lists the keys."""
    result: dict[str, Any] = {
        "sketch": model.name,
        "covered": not found.gaps,
        "valuations": found.possible,
        "uncovered": found.uncovered,
        "gaps": [
            {
                "valuations": _literals(model, gap.cube),
                "text": cube(model, *gap.cube),
                "obstacles": [
                    {
                        "rule": model.rules[obstacle.rule].name,
                        "lowers": None
                        if obstacle.lowered is None
                        else model.features[obstacle.lowered].name,
                        "text": _obstacle(model, obstacle, position),
                    }
                    for obstacle in gap.obstacles
                ],
            }
            for gap in found.gaps
        ],
        "dead_rules": [model.rules[rule].name for rule in found.dead],
    }
    if overlaps is not None:
        result["overlaps"] = [
            {
                "rules": [model.rules[o.first].name, model.rules[o.second].name],
                "valuations": _literals(model, o.cube),
            }
            for o in overlaps
        ]
    return result


def warnings(
    model: SketchModel, source_of: Callable[[Rule], Source], start: Label
) -> list[Diagnostic]:
    """What `check` says of coverage. `start` is the place for what belongs to no rule."""
    try:
        found = find_coverage(model, CHECK_WORK)
    except TooManyCubesError:
        return []
    # Without a goal every run ends where no rule is left: that is no news.
    gaps = found.gaps if model.goal is not None else ()
    shown = gaps[:MOST_WARNINGS]
    result = [_gap_warning(model, gap, source_of, start) for gap in shown]
    if len(gaps) > len(shown):
        result = [
            Diagnostic(
                "uncovered",
                f"no rule for {found.uncovered:,} of {counted(found.possible, 'valuation')}, "
                f"{cube(model, *gaps[0].cube)} for one",
                start,
                hint="`sketchlang coverage` lists them.",
                severity=Severity.WARNING,
            )
        ]
    for index in found.dead:
        rule = model.rules[index]
        result.append(
            Diagnostic(
                "unusable-rule",
                f"rule {rule.name} can never be used",
                Label(source_of(rule), rule.span),
                hint="Goal, invariants or its own effects exclude every state it is meant for.",
                severity=Severity.WARNING,
            )
        )
    return result


def _gap_warning(
    model: SketchModel, gap: Gap, source_of: Callable[[Rule], Source], start: Label
) -> Diagnostic:
    primary, secondary = start, []
    for obstacle in gap.obstacles:
        rule = model.rules[obstacle.rule]
        span = rule.span
        if obstacle.lowered is not None and rule.effect_spans:
            span = rule.effect_spans.get(obstacle.lowered, NO_SPAN)
        secondary.append(Label(source_of(rule), span, _why_not(model, obstacle)))
    if secondary:
        primary = secondary.pop(0)
    proposal = _invariant(model, gap)
    return Diagnostic(
        "uncovered",
        f"no rule for {cube(model, *gap.cube)}",
        primary,
        tuple(secondary),
        hint=f"Write a rule, or `{proposal}` if no state is like that."
        if proposal is not None
        else "Write a rule for it.",
        severity=Severity.WARNING,
    )


def _why_not(model: SketchModel, obstacle: Obstacle) -> str:
    if obstacle.lowered is None:
        return "all that it could lead to is excluded by invariants"
    return f"cannot happen: `{model.features[obstacle.lowered].name}` is 0 there"


def _obstacle(model: SketchModel, obstacle: Obstacle, position: Position) -> str:
    rule = model.rules[obstacle.rule]
    span = None
    what = "its effects"
    if obstacle.lowered is not None:
        what = f"`{model.features[obstacle.lowered].name}--`"
        span = (rule.effect_spans or {}).get(obstacle.lowered)
    why = _why_not(model, obstacle)
    if obstacle.lowered is None:
        return f"{position(rule, span)}: {rule.name} applies, but {why}."
    return f"{position(rule, span)}: {rule.name} applies, but {what} {why}."


def _invariant(model: SketchModel, gap: Gap) -> str | None:
    """An invariant that excludes a gap, in the language's own words.

    It is the weakest one that leaves no other gap and spoils no rule: to forbid a valuation
    may take the last rule from the valuations before it. It makes no declared invariant
    pointless and has no premise that those imply. None if there is no such invariant.
    """
    features = list(members(gap.cube.known))
    if not features or len(features) > MOST_PREMISES + 1:
        return None
    last = next((o.lowered for o in gap.obstacles if o.lowered in features), features[-1])
    assert last is not None
    rest = tuple(f for f in features if f != last)
    try:
        dead = find_coverage(model, PROPOSAL_WORK).dead
        best: tuple[int, tuple[int, ...]] | None = None  # valuations left, premise
        for dropped in range(len(rest) + 1):
            for premise in combinations(rest, len(rest) - dropped):
                parts = tuple(Literal(f, not gap.cube.bits >> f & 1) for f in (*premise, last))
                if _makes_pointless(model, Or(parts)):
                    continue
                invariants = (*model.invariants, Invariant(Or(parts), ""))
                found = find_coverage(replace(model, invariants=invariants), PROPOSAL_WORK)
                if found.gaps or found.dead != dead:
                    continue
                # As weak as the one found before, but with fewer words?
                if best is None or (found.possible == best[0] and len(premise) < len(best[1])):
                    best = found.possible, premise
    except TooManyCubesError:
        return None
    return None if best is None else _implication(model, gap.cube, best[1], last)


def _makes_pointless(model: SketchModel, clause: Or) -> bool:
    """Whether a declared invariant follows from a clause alone."""
    work = Work(PROPOSAL_WORK)
    (excluded,) = cubes_of(clause, False, work)
    return any(
        all(contains(excluded, cube) for cube in cubes_of(invariant.formula, False, work))
        for invariant in model.invariants
    )


def _implication(model: SketchModel, where: Cube, premise: Sequence[int], last: int) -> str:
    conclusion = _condition(model, last, not where.bits >> last & 1)
    if not premise:
        return f"invariant {conclusion}"
    given = " and ".join(_condition(model, f, bool(where.bits >> f & 1)) for f in premise)
    return f"invariant {given} -> {conclusion}"


def _condition(model: SketchModel, feature: int, positive: bool) -> str:
    text = literal(model, feature, positive)
    return f"not {text[1:]}" if text.startswith("!") else text


def _literals(model: SketchModel, where: Cube) -> dict[str, bool | str]:
    """Feature names with true / false, or "> 0" / "= 0"."""
    result: dict[str, bool | str] = {}
    for feature in members(where.known):
        positive = bool(where.bits >> feature & 1)
        declared = model.features[feature]
        numeric = "> 0" if positive else "= 0"
        result[declared.name] = positive if declared.kind is Kind.BOOL else numeric
    return result


def _overlap(model: SketchModel, overlap: Overlap) -> str:
    names = listed([model.rules[overlap.first].name, model.rules[overlap.second].name])
    return f"{names} both apply, for instance at {cube(model, *overlap.cube)}."
