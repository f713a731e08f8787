"""A sketch that does not terminate: the table of its cycle, its numbers, what would help."""

from __future__ import annotations

from typing import Any

from sketchlang.analysis.changes import as_words
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.loops import Loops, Part
from sketchlang.analysis.refutation import Change, Edit, Refutation, Remedy, refutation
from sketchlang.analysis.termination import NonTerminating, endless_rules
from sketchlang.analysis.words import Position, cube, effect, listed, rule_names
from sketchlang.model import Kind, SketchModel

MOST_STEPS = 40
"""Steps of a cycle that are written out; JSON has up to a thousand."""

MOST_NAMED = 8
"""Rules of a cycle up to which the first line names them."""


def as_lines(
    model: SketchModel, verdict: NonTerminating, position: Position, limits: Budget | None = None
) -> list[str]:
    """The counterexample for people."""
    found = refutation(model, verdict, limits)
    used = rule_names(model, found.rules)
    subject = listed(used) if len(used) <= MOST_NAMED else f"{len(used)} of its rules"
    lines = [
        f"{model.name} does not terminate: {subject} can "
        f"{'go on' if len(used) > 1 else 'fire'} for ever.",
        "",
    ]
    lines += _table(
        ["step", "valuation", "rule", "what changes"],
        [
            [
                str(number),
                _valuation(model, step.values),
                model.rules[step.rule].name,
                ", ".join(_change(model, change) for change in step.changes) or "nothing",
            ]
            for number, step in enumerate(found.steps[:MOST_STEPS], start=1)
        ],
    )
    more = found.total - MOST_STEPS
    if found.total > len(found.steps):
        lines += [f"... and {more:,} more steps.", "", *_loops(model, found)]
    elif more > 0:
        lines.append(f"... and {more} more steps; --json lists them all.")
    lines.append("")
    if found.growing:
        names = listed([model.features[f].name for f in found.growing])
        lines.append(f"Then it starts again, with {names} grown by the same amount each time.")
    else:
        lines.append("Then it starts again with the same numbers:")
    lines.append("")
    rows = [
        [*map(str, step.values), model.rules[step.rule].name] for step in found.steps[:MOST_STEPS]
    ]
    again = "and so on" if found.growing else "as at the start"
    if more <= 0:
        rows.append([*map(str, found.last), again])
    lines += _table([feature.name for feature in model.features] + ["rule"], rows)
    endless = endless_rules(model) or frozenset()
    others = endless - set(found.rules)
    if others:
        names = listed(rule_names(model, sorted(others)))
        lines += ["", f"There are other such cycles, with {names}."]
    lines += ["", *_remedies(model, found, position)]
    return lines


def _loops(model: SketchModel, found: Refutation) -> list[str]:
    """A long cycle as loops within loops."""
    if found.loops is None:
        return [f"The cycle has {found.total:,} steps."]

    def written(parts: tuple[Part, ...]) -> str:
        names = (f"loop {p.number + 1}" if p.loop else model.rules[p.number].name for p in parts)
        times = (f"{p.times:,} times " if p.times > 1 else "" for p in parts)
        return ", ".join(t + name for t, name in zip(times, names, strict=True))

    lines = [f"The cycle has {found.total:,} steps: {written(found.loops.cycle)}. In this,"]
    return lines + [
        f"  loop {number} ({steps:,} steps) is {written(parts)}"
        for number, (steps, parts) in enumerate(found.loops.loops, start=1)
    ]


def _valuation(model: SketchModel, values: tuple[int, ...]) -> str:
    bits = sum((value > 0) << f for f, value in enumerate(values))
    return cube(model, (1 << len(values)) - 1, bits)


def _change(model: SketchModel, change: Change) -> str:
    if model.features[change.feature].kind is Kind.BOOL:
        if change.written.endswith("?"):
            return f"{change.written}: {'true' if change.after else 'false'}"
        return change.written
    if change.before == change.after:
        return f"{change.written}: stays {change.after}"
    return f"{change.written}: {change.before} -> {change.after}"


def _remedies(model: SketchModel, found: Refutation, position: Position) -> list[str]:
    """What would help, all of it proved."""
    if found.remedies:
        lines = ["To break this cycle, do one of these:"]
        for remedy in found.remedies:
            if remedy.bound is not None:
                lines.append(
                    f"- {remedy.reason}: declare it bounded, if it is. Then the sketch terminates."
                )
                continue
            lines.append(f"- {remedy.reason}. Then the sketch terminates.")
            lines += [f"    {_edit(model, edit, position)}" for edit in remedy.edits]
        return lines
    lines = []
    if found.idle:
        lines = [
            "No rule on this cycle has to change anything for good: each needs an effect that "
            "lowers a nat or turns a Boolean, with nothing to undo it."
        ]
    if found.repair is None:
        return [*lines, "No small change was found after which it terminates."]
    one = len(found.repair.changes) == 1
    lines += [f"With {'this change' if one else 'these changes'} the sketch terminates:"]
    for change in found.repair.changes:
        rule = getattr(change, "rule", None)
        place = "" if rule is None else f"{position(model.rules[rule], None)}: "
        lines.append(f"- {place}{as_words(model, change)}")
    return [*lines, "`sketchlang repair` looks for others."]


def _edit(model: SketchModel, edit: Edit, position: Position) -> str:
    rule = model.rules[edit.rule]
    written = effect(model, edit.feature, rule.effects[edit.feature])
    place = position(rule, edit.span)
    if edit.effect is None:
        return f"{place}: leave out {rule.name}, which has `{written}`"
    return (
        f"{place}: {rule.name} with `{effect(model, edit.feature, edit.effect)}`, not `{written}`"
    )


def _table(header: list[str], rows: list[list[str]]) -> list[str]:
    widths = [max(len(row[i]) for row in [header, *rows]) for i in range(len(header))]
    return [
        "  "
        + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in [header, *rows]
    ]


def as_json(
    model: SketchModel, verdict: NonTerminating, position: Position, limits: Budget | None = None
) -> dict[str, Any]:
    """The keys `counterexample` and, unless there are too many features, `endless_rules`."""
    result: dict[str, Any] = {
        "counterexample": _counterexample(model, refutation(model, verdict, limits), position)
    }
    endless = endless_rules(model)
    if endless is not None:
        result["endless_rules"] = rule_names(model, sorted(endless))
    return result


def _counterexample(model: SketchModel, found: Refutation, position: Position) -> dict[str, Any]:
    names = [feature.name for feature in model.features]
    return {
        "rules": rule_names(model, found.rules),
        "steps": found.total,
        "cycle": [
            {
                "values": dict(zip(names, step.values, strict=True)),
                "valuation": _valuation(model, step.values),
                "rule": model.rules[step.rule].name,
                "changes": [
                    {
                        "feature": names[change.feature],
                        "effect": change.written,
                        "before": change.before,
                        "after": change.after,
                    }
                    for change in step.changes
                ],
            }
            for step in found.steps
        ],
        "loops": None if found.loops is None else _loops_json(model, found.loops),
        "last": dict(zip(names, found.last, strict=True)),
        "growing": [names[f] for f in found.growing],
        "remedies": [_remedy(model, remedy, position) for remedy in found.remedies],
        "repair": None
        if found.repair is None
        else [as_words(model, change) for change in found.repair.changes],
    }


def _loops_json(model: SketchModel, loops: Loops) -> dict[str, Any]:
    def written(parts: tuple[Part, ...]) -> list[dict[str, Any]]:
        return [
            {
                "loop" if p.loop else "rule": p.number if p.loop else model.rules[p.number].name,
                "times": p.times,
            }
            for p in parts
        ]

    return {
        "cycle": written(loops.cycle),
        "loops": [{"steps": steps, "parts": written(parts)} for steps, parts in loops.loops],
    }


def _remedy(model: SketchModel, remedy: Remedy, position: Position) -> dict[str, Any]:
    return {
        "reason": remedy.reason,
        "then_terminates": remedy.suffices,
        "declare_bounded": None if remedy.bound is None else model.features[remedy.bound].name,
        "edits": [
            {
                "rule": model.rules[edit.rule].name,
                "feature": model.features[edit.feature].name,
                "written": effect(
                    model, edit.feature, model.rules[edit.rule].effects[edit.feature]
                ),
                "instead": None
                if edit.effect is None
                else effect(model, edit.feature, edit.effect),
                "place": position(model.rules[edit.rule], edit.span),
            }
            for edit in remedy.edits
        ],
    }
