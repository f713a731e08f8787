"""Drawings as SVG, without any tool."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from sketchlang.analysis.graph.drawing import (
    UNREMOVED,
    Arrow,
    Box,
    Drawing,
    Look,
    TooLargeError,
    colour,
)
from sketchlang.analysis.graph.layout import Chain, Item, lay_out
from sketchlang.escape import markup

FONT = 12
LINE = 15.0
CHARACTER = 6.9
"""A character's width in the font, a little more than the mean."""
PADDING = 9.0
MARGIN = 20.0
LOOP = 30.0
"""How far a loop reaches out of its box."""

MOST_LABELS = 40
"""Arrows up to which each has its label; above, only colours and tooltips are readable."""

MOST_ARROWS = 2000
"""Arrows up to which a layout is made: nobody could follow more."""

_FILLS = {Look.PLAIN: "#ffffff", Look.GOAL: "#d9f2d9", Look.GAP: "#fde0d9", Look.RULE: "#eeeeee"}


def write(drawing: Drawing) -> str:
    """The drawing as a complete SVG document. Raises `TooLargeError` for too many arrows."""
    if len(drawing.arrows) > MOST_ARROWS:
        raise TooLargeError(f"{len(drawing.arrows):,} arrows in this view")
    number = {box.key: i for i, box in enumerate(drawing.boxes)}
    ends = [(number[arrow.source], number[arrow.target]) for arrow in drawing.arrows]
    with_labels = len(drawing.arrows) <= MOST_LABELS
    labels = [_label(arrow) if with_labels else "" for arrow in drawing.arrows]
    loops = [0.0] * len(drawing.boxes)
    for (source, target), label in zip(ends, labels, strict=True):
        if source == target:
            loops[source] = max(loops[source], LOOP + len(label) * CHARACTER)
    layout = lay_out(
        # Loops are drawn at the right side: the same space on the left keeps it centred.
        [_size(box, 2 * loop) for box, loop in zip(drawing.boxes, loops, strict=True)],
        ends,
        [(len(label) * CHARACTER + 4, LINE) if label else None for label in labels],
    )
    legend = [f"{step} {words}" for step, words in drawing.legend]
    width = max(layout.width, *(len(line) * CHARACTER for line in [drawing.title, *legend]))
    top = MARGIN + 2 * LINE
    left = MARGIN + (width - layout.width) / 2
    bottom = top + layout.height + 2 * LINE
    full = (width + 2 * MARGIN, bottom + LINE * len(legend) + MARGIN)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{full[0]:.0f}" height="{full[1]:.0f}" '
        f'viewBox="0 0 {full[0]:.0f} {full[1]:.0f}" font-family="Helvetica, Arial, sans-serif" '
        f'font-size="{FONT}">',
        '<rect width="100%" height="100%" fill="#ffffff"/>',
        *_markers(drawing.arrows),
        f'<text x="{MARGIN}" y="{MARGIN + FONT:.0f}" font-weight="bold">'
        f"{markup(drawing.title)}</text>",
        f'<g transform="translate({left:.1f} {top:.1f})">',
    ]
    sides = _sides(layout.chains)
    drawn = sorted(
        zip(drawing.arrows, ends, layout.chains, labels, strict=True),
        key=lambda entry: entry[0].endless,
    )
    for arrow, (source, _), chain, label in drawn:
        if chain is None:
            box, loop = drawing.boxes[source], loops[source]
            parts += _loop(arrow, layout.boxes[source], _size(box, 0.0), loop, label)
        else:
            parts.append(_line(arrow, chain, sides))
    for arrow, chain, label in zip(drawing.arrows, layout.chains, labels, strict=True):
        if chain is not None and chain.label is not None:
            parts += _text_on_line(arrow, chain.label, label)
    for box, item in zip(drawing.boxes, layout.boxes, strict=True):
        parts += _box(box, item)
    parts.append("</g>")
    for i, ((step, _), line) in enumerate(zip(drawing.legend, legend, strict=True)):
        y = bottom + LINE * i
        parts.append(
            f'<text x="{MARGIN}" y="{y:.1f}" fill="{colour(step)}" font-weight="bold">'
            f"{markup(line)}</text>"
        )
    parts.append("</svg>")
    return "\n".join(parts) + "\n"


def _label(arrow: Arrow) -> str:
    step = f" ({arrow.step})" if arrow.step is not None and arrow.label else ""
    return arrow.label + step


def _size(box: Box, extra: float) -> tuple[float, float]:
    width = max((len(line) for line in box.lines), default=0) * CHARACTER + 2 * PADDING
    return width + extra, len(box.lines) * LINE + PADDING


def _markers(arrows: Sequence[Arrow]) -> list[str]:
    """One arrow head a colour: SVG 1.1 cannot take it from the line."""
    tints = sorted({colour(arrow.step, arrow.endless) for arrow in arrows})
    heads = [
        f'<marker id="head{tint[1:]}" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="9" '
        f'markerHeight="9" markerUnits="userSpaceOnUse" orient="auto">'
        f'<path d="M0 1 L10 5 L0 9 z" fill="{tint}"/></marker>'
        for tint in tints
    ]
    return ["<defs>", *heads, "</defs>"]


def _sides(chains: Sequence[Chain | None]) -> dict[tuple[int, int], float]:
    """Where each arrow (by its chain and end) leaves its box, so that ends lie side by side."""
    ends: dict[tuple[int, bool], list[tuple[float, int, int]]] = {}
    for number, chain in enumerate(chains):
        if chain is None:
            continue
        for end in (0, -1):
            item, near = chain.items[end], chain.items[1 if end == 0 else -2]
            ends.setdefault((id(item), near.row > item.row), []).append((near.x, number, end))
    places: dict[tuple[int, int], float] = {}
    for group in ends.values():
        group.sort()
        for i, (_, number, end) in enumerate(group):
            places[id(chains[number]), end] = (i + 1) / (len(group) + 1) - 0.5
    return places


def _line(arrow: Arrow, chain: Chain, sides: dict[tuple[int, int], float]) -> str:
    first, *inner, last = chain.items
    points = []
    for end, item, near in ((0, first, chain.items[1]), (-1, last, chain.items[-2])):
        down = near.row > item.row
        x = item.x + sides[id(chain), end] * min(item.width, 160.0) * 0.8
        points.append((x, item.y + (item.height / 2 if down else -item.height / 2)))
    path = [points[0], *((item.x, item.y) for item in inner), points[1]]
    d = f"M{path[0][0]:.1f} {path[0][1]:.1f}"
    for (x0, y0), (x1, y1) in itertools.pairwise(path):
        middle = (y0 + y1) / 2
        d += f" C{x0:.1f} {middle:.1f} {x1:.1f} {middle:.1f} {x1:.1f} {y1:.1f}"
    return _path(arrow, d)


def _path(arrow: Arrow, d: str) -> str:
    tint = colour(arrow.step, arrow.endless)
    width = 2.6 if arrow.endless else 1.3
    rules = f' data-rules="{markup(" ".join(arrow.rules))}"' if arrow.rules else ""
    return (
        f'<path data-from="{arrow.source}"{rules} d="{d}" fill="none" stroke="{tint}" '
        f'stroke-width="{width}" '
        f'marker-end="url(#head{tint[1:]})"><title>{markup(_label(arrow))}</title></path>'
    )


def _loop(
    arrow: Arrow, item: Item, size: tuple[float, float], reach: float, label: str
) -> list[str]:
    x, y = item.x + size[0] / 2, item.y
    d = (
        f"M{x:.1f} {y - 5:.1f} C{x + LOOP:.1f} {y - 18:.1f} {x + LOOP:.1f} {y + 18:.1f} "
        f"{x:.1f} {y + 5:.1f}"
    )
    parts = [_path(arrow, d)]
    if label:
        tint = colour(arrow.step, arrow.endless)
        parts.append(
            f'<text x="{x + LOOP - 4:.1f}" y="{y + 4:.1f}" fill="{tint}">{markup(label)}</text>'
        )
    return parts


def _text_on_line(arrow: Arrow, item: Item, label: str) -> list[str]:
    tint = colour(arrow.step, arrow.endless)
    left, top = item.x - item.width / 2, item.y - item.height / 2
    return [
        f'<rect x="{left:.1f}" y="{top:.1f}" width="{item.width:.1f}" '
        f'height="{item.height:.1f}" fill="#ffffff" fill-opacity="0.9"/>',
        f'<text x="{item.x:.1f}" y="{item.y + 4:.1f}" text-anchor="middle" fill="{tint}">'
        f"{markup(label)}</text>",
    ]


def _box(box: Box, item: Item) -> list[str]:
    width, height = _size(box, 0.0)
    stroke = 0.0 if box.look is Look.RULE else 1.0 if box.step is None else 2.5
    covers = f' data-valuations="{" ".join(box.covers)}"' if box.covers else ""
    parts = [f'<g data-box="{box.key}"{covers}>']
    if box.start:
        parts.append(
            f'<circle cx="{item.x - width / 2:.1f}" cy="{item.y - height / 2:.1f}" r="6" '
            f'fill="{UNREMOVED}"/>'
        )
    parts += [
        f'<rect x="{item.x - width / 2:.1f}" y="{item.y - height / 2:.1f}" rx="6" '
        f'width="{width:.1f}" height="{height:.1f}" fill="{_FILLS[box.look]}" '
        f'stroke="{colour(box.step)}" stroke-width="{stroke}"/>'
    ]
    for i, line in enumerate(box.lines):
        y = item.y - height / 2 + PADDING / 2 + LINE * (i + 0.75)
        weight = ' font-weight="bold"' if i == 0 and len(box.lines) > 1 else ""
        parts.append(
            f'<text x="{item.x:.1f}" y="{y:.1f}" text-anchor="middle"{weight}>{markup(line)}</text>'
        )
    return [*parts, "</g>"]
