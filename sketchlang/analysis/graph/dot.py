"""Drawings in the language of Graphviz."""

from __future__ import annotations

import json

from sketchlang.analysis.graph.drawing import Arrow, Box, Drawing, Look, colour
from sketchlang.escape import visible

_FILLS = {Look.PLAIN: "#ffffff", Look.GOAL: "#d9f2d9", Look.GAP: "#fde0d9"}


def write(drawing: Drawing) -> str:
    """The drawing as a `digraph`."""
    lines = [
        f"digraph {_text(drawing.title)} {{",
        "  rankdir=TB;",
        '  node [shape=box, style="rounded,filled", fontname="Helvetica", fontsize=11];',
        '  edge [fontname="Helvetica", fontsize=10];',
        '  labelloc="t";',
        f"  label={_text(drawing.title)};",
    ]
    lines += [_box(box) for box in drawing.boxes]
    lines += [_arrow(arrow) for arrow in drawing.arrows]
    if drawing.legend:
        legend = [f"{number} {words}" for number, words in drawing.legend]
        lines.append(f"  legend [shape=note, style=solid, label={_text(*legend)}];")
    lines.append("}")
    return "\n".join(lines) + "\n"


def _box(box: Box) -> str:
    if box.look is Look.RULE:
        return (
            f'  {box.key} [label={_text(*box.lines)}, fillcolor="#eeeeee", penwidth=0, height=0.2];'
        )
    border = colour(box.step)
    width = 1 if box.step is None and not box.start else 2
    return (
        f"  {box.key} [label={_text(*box.lines)}, "
        f'fillcolor="{_FILLS[box.look]}", color="{border}", penwidth={width}];'
    )


def _arrow(arrow: Arrow) -> str:
    label = arrow.label if arrow.step is None else f"{arrow.label} ({arrow.step})"
    tint = colour(arrow.step, arrow.endless)
    width = 2.5 if arrow.endless else 1.2
    return (
        f"  {arrow.source} -> {arrow.target} [label={_text(label.strip())}, "
        f'color="{tint}", fontcolor="{tint}", penwidth={width}];'
    )


def _text(*lines: str) -> str:
    return json.dumps("\n".join(map(visible, lines)), ensure_ascii=False)
