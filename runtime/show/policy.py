"""The graph of a trace's sketch, as it is drawn on a replay page."""

from __future__ import annotations

from runtime.trace.model import Trace
from sketchlang.analysis.graph import svg
from sketchlang.analysis.graph.drawing import TooLargeError
from sketchlang.analysis.graph.views import group_view, rule_view
from sketchlang.analysis.termination import decide_termination
from sketchlang.checking.checker import check
from sketchlang.model import SketchModel
from sketchlang.source import Source
from sketchlang.syntax import tree
from sketchlang.syntax.parser import parse

MOST_FEATURES = 8
MOST_RULES = 40
"""Up to so many the graph is drawn: it is to be read, and the page is to be written at once."""


def policy_svg(trace: Trace) -> str:
    """An SVG: valuations with the same rules in one box, the start marked; rules and what can
    follow, where that would be too large; empty where there is nothing to draw."""
    sketch = trace.sketch
    if not sketch.rules or len(sketch.rules) > MOST_RULES:
        return ""
    if len(sketch.features) > MOST_FEATURES:
        return ""
    model = _model(trace)
    if model is None:
        return ""
    values = trace.subgoals[0].before if trace.subgoals else None
    names = [feature.name for feature in model.features]
    start = None if values is None else sum(1 << f for f, n in enumerate(names) if values.get(n))
    verdict = decide_termination(model)
    for view in (group_view, rule_view):
        try:
            return svg.write(view(model, verdict, start))
        except TooLargeError:
            continue
    return ""


def _model(trace: Trace) -> SketchModel | None:
    """The sketch without the definitions of its features: what a trace keeps of it suffices, and
    no domain is needed."""
    lines = [f"sketch {trace.sketch.name}"]
    lines += [f"feature {name} : {kind}" for name, kind in trace.sketch.features]
    for name, text in trace.sketch.texts:
        parsed, _ = parse(Source(name, text))
        lines += [
            text[item.span.start : item.span.end]
            for item in parsed.items
            if isinstance(item, tree.Goal | tree.InvariantItem | tree.RuleItem)
        ]
    checked, found = check(parse(Source("trace", "\n".join(lines) + "\n"))[0], None)
    if any(each.severity.value == "error" for each in found):
        return None
    return checked.model
