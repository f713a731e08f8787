"""A verdict on termination as text for people and as JSON for programs.

Evidence is written by the modules next to this one, each imported when there is some of
its kind: to be quick about it is part of the command.
"""

from __future__ import annotations

from typing import Any

from sketchlang.analysis.limits import Budget
from sketchlang.analysis.termination import NonTerminating, Terminating, Undecided, Verdict
from sketchlang.analysis.words import Position
from sketchlang.model import SketchModel

WIDTH = 100

METHODS = {
    "rule-elimination": "rule elimination",
    "potentials": "potentials",
    "sieve": "Sieve",
}
"""How the methods of `Terminating` are called in a sentence."""


def as_text(
    model: SketchModel, verdict: Verdict, position: Position, limits: Budget | None = None
) -> str:
    """The verdict and its evidence, lines broken for a terminal. `limits` hold for what is
    looked for to write it."""
    match verdict:
        case Terminating():
            from sketchlang.analysis.argument import argument

            lines = [f"{model.name} terminates (proved by {METHODS[verdict.method]}).", ""]
            lines += argument(model, verdict.steps)
        case NonTerminating():
            from sketchlang.analysis import refutation_report

            lines = refutation_report.as_lines(model, verdict, position, limits)
        case Undecided():
            lines = [
                f"{model.name}: undecided, the {verdict.limit} was reached.",
                "The sketch may terminate or not. A higher limit may tell.",
            ]
    return "\n".join(part for line in lines for part in wrapped(line))


def as_json(
    model: SketchModel, verdict: Verdict, position: Position, limits: Budget | None = None
) -> dict[str, Any]:
    """The verdict and its evidence; docs/termination.md lists the keys."""
    result: dict[str, Any] = {
        "verdict": "undecided",
        "sketch": model.name,
        "method": "sieve",
        "features": len(model.features),
        "rules": len(model.rules),
    }
    match verdict:
        case Terminating():
            from sketchlang.analysis.argument import argument
            from sketchlang.analysis.certificate import certificate_of

            result["verdict"] = "terminating"
            result["method"] = verdict.method
            result["argument"] = argument(model, verdict.steps)
            result["certificate"] = certificate_of(model, verdict)
        case NonTerminating():
            from sketchlang.analysis import refutation_report

            result["verdict"] = "non-terminating"
            result |= refutation_report.as_json(model, verdict, position, limits)
        case Undecided():
            result["limit"] = {"kind": verdict.kind, "text": verdict.limit}
    return result


def wrapped(line: str) -> list[str]:
    """Long lines of prose are broken; tables (with two blanks in a row inside) are not."""
    body = line.lstrip()
    if len(line) <= WIDTH or "  " in body:
        return [line]
    indent = " " * (len(line) - len(body))
    lines, current = [], indent
    for word in body.split(" "):
        if len(current) + len(word) > WIDTH and current.strip():
            lines.append(current.rstrip())
            current = indent + "   "
        current += word + " "
    return [*lines, current.rstrip()]
