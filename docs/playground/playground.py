"""The Python side of the playground: a text goes in, what is to be shown of it comes out.

It runs in the browser (Pyodide), with the language and nothing of robots.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from sketchlang.analysis import report
from sketchlang.analysis.graph import svg
from sketchlang.analysis.graph.drawing import TooLargeError
from sketchlang.analysis.graph.views import VIEWS
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.termination import Terminating, decide_termination
from sketchlang.findings import Places
from sketchlang.loader import Loaded, builtin_sketches, load_builtin, load_text
from sketchlang.render import full
from sketchlang.source import Source
from sketchlang.syntax.formatter import format_tree
from sketchlang.syntax.parser import parse

NAME = "my.sketch"
SECONDS = 30.0
"""A proof that takes longer is given up."""

# Long proofs call deeper than Python allows at first, and not as deep as a browser's stack.
sys.setrecursionlimit(5_000)


def examples() -> str:
    """The sketches that come along, by name."""
    return json.dumps({name: load_builtin(name).text for name in builtin_sketches()})


def check(text: str) -> str:
    """What is to be said of a sketch: `text` as the command line prints it, and `findings`, each
    with its severity, its message, and the characters from `start` to `end` that it is about."""
    loaded = load_text(Source(NAME, text))
    return json.dumps({"text": _said(loaded), "findings": _findings(loaded), "ok": loaded.ok})


def format_text(text: str) -> str:
    """The canonical form, or why there is none."""
    parsed, found = parse(Source(NAME, text))
    if found:
        return json.dumps({"ok": False, "text": "\n\n".join(map(full.render, found))})
    return json.dumps({"ok": True, "formatted": format_tree(parsed)})


def prove(text: str) -> str:
    """The proof or the counterexample."""
    loaded = load_text(Source(NAME, text))
    if not loaded.ok:
        return json.dumps({"ok": False, "text": _said(loaded), "findings": _findings(loaded)})
    model, budget = loaded.checked.model, Budget(SECONDS)
    try:
        verdict = decide_termination(model, budget)
    except ModuleNotFoundError as error:
        # Larger ones want arrays (numpy) or a linear programme (scipy).
        said = f"This sketch is too large for the browser: its proof needs {error.name}.\n"
        return json.dumps({"ok": False, "text": said + "Use `sketchlang terminate` for it."})
    said = report.as_text(model, verdict, Places(loaded).shown, budget)
    proved = isinstance(verdict, Terminating)
    return json.dumps({"ok": proved, "text": said})


def draw(text: str, view: str) -> str:
    """The graph of a sketch as SVG: a view of `sketchlang.analysis.graph`."""
    loaded = load_text(Source(NAME, text))
    if not loaded.ok:
        return json.dumps({"ok": False, "text": _said(loaded), "findings": _findings(loaded)})
    model = loaded.checked.model
    try:
        drawing = VIEWS[view](model, decide_termination(model, Budget(SECONDS)))
    except TooLargeError as error:
        return json.dumps({"ok": False, "text": f"The sketch has {error}; try the rules."})
    except ModuleNotFoundError as error:
        return json.dumps({"ok": False, "text": f"Too large for the browser (needs {error.name})."})
    return json.dumps({"ok": True, "svg": svg.write(drawing)})


def _said(loaded: Loaded) -> str:
    return "\n\n".join(full.render(found) for found in loaded.diagnostics) or "No findings."


def _findings(loaded: Loaded) -> list[dict[str, Any]]:
    found = []
    for each in loaded.diagnostics:
        label = each.primary
        if label.source.name != NAME:
            continue
        line, column = label.source.position(label.span.start)
        found.append(
            {
                "severity": each.severity.value,
                "message": each.message,
                "hint": each.hint,
                "line": line,
                "column": column,
                "start": label.span.start,
                "end": label.span.end,
            }
        )
    return found
