"""Writes a proof of termination as a certificate (docs/certificates.md describes the format)."""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Iterable
from typing import Any

from sketchlang.analysis.fingerprint import digest, fingerprint
from sketchlang.analysis.proof import Drop, Node, Potential, Ranks, Split, Step, Term, Tree
from sketchlang.analysis.termination import Terminating
from sketchlang.model import Kind, SketchModel

FORMAT = "sketchlang-termination-certificate"
FAST = 1
"""How hard to try to make tables small: the sizes hardly differ."""

PLAIN, FULL = 1, 2
"""Versions of the format. A proof is written in the first one that has all of its steps."""


def certificate_of(model: SketchModel, verdict: Terminating) -> dict[str, Any]:
    """The certificate as a JSON value."""
    content = {
        "format": FORMAT,
        "version": FULL if _is_full(verdict.steps) else PLAIN,
        "sketch": model.name,
        "fingerprint": fingerprint(model),
        "method": verdict.method,
        "proof": _steps(model, verdict.steps),
    }
    return content | {"digest": digest(content)}


def as_text(value: Any) -> str:
    """JSON that can be read: objects over several lines, lists without objects on one."""
    return _pretty(value, "") + "\n"


def _pretty(value: Any, indent: str) -> str:
    inner = indent + "  "
    if isinstance(value, dict):
        items = [f"{json.dumps(key)}: {_pretty(item, inner)}" for key, item in value.items()]
        brackets = "{}"
    elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
        items = [_pretty(item, inner) for item in value]
        brackets = "[]"
    else:
        return json.dumps(value)
    lines = f",\n{inner}".join(items)
    return f"{brackets[0]}\n{inner}{lines}\n{indent}{brackets[1]}"


def _steps(model: SketchModel, steps: Iterable[Step]) -> list[dict[str, Any]]:
    return [_step(model, step) for step in steps]


def _step(model: SketchModel, step: Step) -> dict[str, Any]:
    def names(rules: Iterable[int]) -> list[str]:
        return [model.rules[rule].name for rule in rules]

    if isinstance(step, Drop):
        change = "raises" if step.upwards else "lowers"
        return {change: model.features[step.feature].name, "rules": names(step.rules)}
    if isinstance(step, Potential):
        return {
            "potential": {term_key(model, term): term.weight for term in step.terms},
            "rules": names(step.rules),
        }
    if isinstance(step, Ranks):
        return {
            "ranks": [model.features[feature].name for feature in step.features],
            "tables": [
                base64.b64encode(zlib.compress(table, FAST)).decode("ascii")
                for table in step.tables
            ],
            "rules": names(step.rules),
        }
    return {
        "split": _tree(model, step.tree),
        "blocks": [
            {"rules": names(block.rules), "proof": _steps(model, block.steps)}
            for block in step.blocks
        ],
        "rules": names(step.drops),
    }


def _is_full(steps: Iterable[Step]) -> bool:
    return any(
        isinstance(step, Potential | Ranks)
        or (isinstance(step, Split) and any(_is_full(block.steps) for block in step.blocks))
        for step in steps
    )


def term_key(model: SketchModel, term: Term) -> str:
    """The feature's name, with `> 0` where the truth of a nat is meant."""
    declared = model.features[term.feature]
    return f"{declared.name} > 0" if term.of_truth and declared.kind is Kind.NAT else declared.name


def _tree(model: SketchModel, tree: Tree) -> Any:
    if isinstance(tree, Node):
        name = model.features[tree.feature].name
        return [name, _tree(model, tree.low), _tree(model, tree.high)]
    return tree
