"""A sketch that does not terminate: the table of its cycle, its numbers, what would help."""

from __future__ import annotations

from typing import Any

from sketchlang.analysis.refutation import Change, Edit, Refutation, Remedy, refutation
from sketchlang.analysis.termination import NonTerminating, endless_rules
from sketchlang.analysis.words import Position, cube, effect, listed, rule_names
from sketchlang.model import Kind, SketchModel

MOST_STEPS = 40
"""Steps of a cycle that are written out; JSON has them all."""


def as_lines(model: SketchModel, verdict: NonTerminating, position: Position) -> list[str]:
    """The counterexample for people."""
    found = refutation(model, verdict)
    used = list(dict.fromkeys(model.rules[step.rule].name for step in found.steps))
    lines = [
        f"{model.name} does not terminate: {listed(used)} can "
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
    if len(found.steps) > MOST_STEPS:
        lines.append(f"... and {len(found.steps) - MOST_STEPS} more steps; --json lists them all.")
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
    if len(found.steps) <= MOST_STEPS:
        rows.append([*map(str, found.last), again])
    lines += _table([feature.name for feature in model.features] + ["rule"], rows)
    endless = endless_rules(model) or frozenset()
    others = endless - {step.rule for step in found.steps}
    if others:
        names = listed(rule_names(model, sorted(others)))
        lines += ["", f"There are other such cycles, with {names}."]
    lines += ["", *_remedies(model, found, position)]
    return lines


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
    if not found.remedies:
        return [
            "No rule on this cycle has to change anything for good: each needs an effect that "
            "lowers a nat or turns a Boolean, with nothing to undo it."
        ]
    lines = ["To break this cycle, do one of these:"]
    for remedy in found.remedies:
        outcome = {
            True: " Then the sketch terminates.",
            False: " Other cycles remain then.",
            None: "",
        }[remedy.suffices]
        if remedy.bound is not None:
            lines.append(f"- {remedy.reason}: declare it bounded, if it is.{outcome}")
            continue
        lines.append(f"- {remedy.reason}.{outcome}")
        lines += [f"    {_edit(model, edit, position)}" for edit in remedy.edits]
    return lines


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


def as_json(model: SketchModel, verdict: NonTerminating, position: Position) -> dict[str, Any]:
    """The keys `counterexample` and, unless there are too many features, `endless_rules`."""
    result: dict[str, Any] = {
        "counterexample": _counterexample(model, refutation(model, verdict), position)
    }
    endless = endless_rules(model)
    if endless is not None:
        result["endless_rules"] = rule_names(model, sorted(endless))
    return result


def _counterexample(model: SketchModel, found: Refutation, position: Position) -> dict[str, Any]:
    names = [feature.name for feature in model.features]
    return {
        "rules": list(dict.fromkeys(model.rules[step.rule].name for step in found.steps)),
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
        "last": dict(zip(names, found.last, strict=True)),
        "growing": [names[f] for f in found.growing],
        "remedies": [_remedy(model, remedy, position) for remedy in found.remedies],
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
