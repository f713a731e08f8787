"""`sketchlang compare`: whether two sketches name the same subgoals."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import click

from sketchlang.cli import names
from sketchlang.cli.common import domain_option, fail, interruptible, load_valid, say

if TYPE_CHECKING:
    from sketchlang.analysis.comparison import Comparison, Witness
    from sketchlang.model import SketchModel


@click.command("compare")
@click.argument("first", metavar="A", shell_complete=names.sketches)
@click.argument("second", metavar="B", shell_complete=names.sketches)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@domain_option
@interruptible
def command(*, first: str, second: str, as_json: bool, domain_file: str | None) -> None:
    """Tell whether two sketches name the same subgoals.

    A refines B if every subgoal of A is one of B. Features are matched by name; one that a
    sketch does not have may do anything there. Goals end runs, and the invariants of both
    sketches are taken for granted.

    Exit 0 if the sketches are equivalent, 1 if they are not, 2 if a file cannot be read or
    has errors, or a name stands for different kinds of features.

    \b
    Example:
      sketchlang compare my.sketch pick_and_place
    """
    a = load_valid(first, domain_file).checked.model
    b = load_valid(second, domain_file).checked.model
    from sketchlang.analysis.comparison import NotComparableError, compare
    from sketchlang.analysis.cubes import TooManyCubesError

    names = (first, second) if a.name == b.name else (a.name, b.name)
    try:
        found = compare(a, b)
    except NotComparableError as error:
        fail(str(error))
    except TooManyCubesError:
        fail(f"{names[0]} and {names[1]} are too large to be compared")
    if as_json:
        from sketchlang.escape import dumps

        result: dict[str, Any] = {
            "verdict": found.verdict,
            "first": a.name,
            "second": b.name,
            "only_first": _as_json(found.only_first),
            "only_second": _as_json(found.only_second),
        }
        click.echo(dumps(result, indent=2))
    else:
        _print(found, names, (a, b))
    sys.exit(0 if found.verdict == "equivalent" else 1)


def _as_json(witness: Witness | None) -> dict[str, Any] | None:
    if witness is None:
        return None
    return {"before": witness.before, "after": witness.after, "rule": witness.rule}


def _print(
    found: Comparison, names: tuple[str, str], models: tuple[SketchModel, SketchModel]
) -> None:
    a, b = names
    say(
        {
            "equivalent": f"{a} and {b} are equivalent: they name the same subgoals.",
            "first-refines-second": f"{a} refines {b}: each of its subgoals is one of {b}.",
            "second-refines-first": f"{b} refines {a}: each of its subgoals is one of {a}.",
            "different": f"{a} and {b} name different subgoals.",
        }[found.verdict]
    )
    for witness, own, other, model in (
        (found.only_first, a, b, models[1]),
        (found.only_second, b, a, models[0]),
    ):
        if witness is None:
            continue
        reason = f"by rule {witness.rule}" if witness.rule else "since it is its goal"
        say("", f"A subgoal of {own} ({reason}), but not of {other}:")
        say(f"  from {_values(witness, 0)}", f"  to   {_values(witness, 1)}")
        say(*(f"  {line}" for line in _why_not(witness, model)))


def _values(witness: Witness, side: int) -> str:
    values = (witness.before, witness.after)[side]
    return ", ".join(f"{name} = {value}" for name, value in values.items())


def _why_not(witness: Witness, model: SketchModel) -> list[str]:
    """For each rule of the other sketch that applies, the first feature that it forbids."""
    from sketchlang.analysis.words import effect

    before = tuple(witness.before[feature.name] for feature in model.features)
    after = tuple(witness.after[feature.name] for feature in model.features)
    if model.is_goal(before):
        return ["There the run has ended."]
    lines = []
    for rule in model.rules:
        if not rule.applies(before):
            continue
        for f, feature in enumerate(model.features):
            written = rule.effects.get(f)
            if written is None and before[f] != after[f]:
                lines.append(f"{rule.name} applies, but keeps {feature.name} as it is.")
                break
            if written is not None and not written.allows(before[f], after[f]):
                lines.append(f"{rule.name} applies, but has `{effect(model, f, written)}`.")
                break
    return lines or ["None of its rules applies."]
