"""Drawings in the language of Mermaid, which many places render from Markdown."""

from __future__ import annotations

import json

from sketchlang.analysis.graph.drawing import Drawing, Look, colour
from sketchlang.escape import visible

_CLASSES = {Look.PLAIN: "plain", Look.GOAL: "goal", Look.GAP: "gap", Look.RULE: "rule"}


def write(drawing: Drawing) -> str:
    """The drawing as a flowchart."""
    lines = ["---", f"title: {_quoted(drawing.title)}", "---", "flowchart TB"]
    for box in drawing.boxes:
        label = "<br/>".join(_escaped(line) for line in box.lines)
        lines.append(f'  {box.key}["{label}"]:::{_CLASSES[box.look]}')
    for arrow in drawing.arrows:
        text = arrow.label if arrow.step is None else f"{arrow.label} ({arrow.step})"
        label = f'|"{_escaped(text.strip())}"|' if text else ""
        lines.append(f"  {arrow.source} -->{label} {arrow.target}")
    for number, words in drawing.legend:
        lines.append(f'  s{number}["{number} {_escaped(words)}"]:::legend')
    lines += [
        "  classDef plain fill:#ffffff,stroke:#444444,color:#000000",
        "  classDef goal fill:#d9f2d9,stroke:#444444,color:#000000",
        "  classDef gap fill:#fde0d9,stroke:#444444,color:#000000",
        "  classDef rule fill:#eeeeee,stroke:none,color:#000000",
        "  classDef legend fill:none,stroke:none,color:#444444",
    ]
    for box in drawing.boxes:
        if box.step is not None:
            lines.append(f"  style {box.key} stroke:{colour(box.step)},stroke-width:2px")
    for number, _ in drawing.legend:
        lines.append(f"  style s{number} color:{colour(number)}")
    for index, arrow in enumerate(drawing.arrows):
        width = "3px" if arrow.endless else "1.5px"
        tint = colour(arrow.step, arrow.endless)
        lines.append(f"  linkStyle {index} stroke:{tint},stroke-width:{width},color:{tint}")
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    # YAML reads what stands between quotes as JSON does.
    return json.dumps(visible(text), ensure_ascii=False)


def _escaped(text: str) -> str:
    """Signs that Mermaid or HTML would take for their own."""
    text = visible(text)
    for sign, code in (("&", "&amp;"), ('"', "&quot;"), ("<", "&lt;"), (">", "&gt;")):
        text = text.replace(sign, code)
    return text
