"""A top view as SVG, without any tool."""

from __future__ import annotations

import math
from collections.abc import Iterator

from runtime.show.colours import OBJECTS, TABLE, WALL, Colour
from runtime.show.top_text import symbols_of
from runtime.show.top_view import Patch, Point, Sort, TopView
from sketchlang.escape import markup

LONGER = 800.0
"""Pixels of the longer side of the picture, without its legend."""

MARGIN, LINE, FONT = 20.0, 17.0, 12
CHARACTER = 6.9
"""A character's width in the font, a little more than the mean."""

OTHER: Colour = (0.69, 0.49, 0.78)
ROBOT = 0.25
"""Metres from the robot's middle to the tip of the arrow that stands for it."""


def svg(view: TopView) -> str:
    """The picture as a complete SVG document, its legend to the right."""
    frame = _Frame(view)
    symbols = symbols_of(view)
    lines = list(_legend(view, symbols))
    legend = max((len(line) for line in lines), default=0) * CHARACTER
    width = frame.width + 3 * MARGIN + legend
    height = max(frame.height + 2 * MARGIN, LINE * (len(lines) + 2) + MARGIN)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}" font-family="Helvetica, Arial, sans-serif" '
        f'font-size="{FONT}">',
        '<rect width="100%" height="100%" fill="#ffffff"/>',
        f'<clipPath id="picture"><rect x="{MARGIN}" y="{MARGIN}" width="{frame.width:.1f}" '
        f'height="{frame.height:.1f}"/></clipPath>',
        '<g clip-path="url(#picture)">',
        *(_patch(patch, frame) for patch in view.patches),
        "</g>",
        *(_mark(name, point, frame) for name, point in view.marks),
        *_robot(view, frame),
        *_labels(view, symbols, frame),
    ]
    left = frame.width + 2 * MARGIN
    parts += [
        f'<text x="{left:.1f}" y="{MARGIN + LINE * (i + 1):.1f}" '
        f'font-weight="{"normal" if i else "bold"}">{markup(line)}</text>'
        for i, line in enumerate([view.name, *lines])
    ]
    return "\n".join([*parts, "</svg>", ""])


class _Frame:
    """From the plane to pixels: y goes down there."""

    def __init__(self, view: TopView) -> None:
        self.left, low, right, self.top = view.bounds
        self.scale = LONGER / max(right - self.left, self.top - low, 1e-3)
        self.width = (right - self.left) * self.scale
        self.height = (self.top - low) * self.scale

    def pixel(self, point: Point) -> Point:
        """Where a point is in the picture."""
        x, y = point
        return MARGIN + (x - self.left) * self.scale, MARGIN + (self.top - y) * self.scale

    def path(self, points: tuple[Point, ...]) -> str:
        """The points of a polygon."""
        return " ".join(f"{x:.1f},{y:.1f}" for x, y in map(self.pixel, points))


def _patch(patch: Patch, frame: _Frame) -> str:
    fill = {Sort.SUPPORT: TABLE, Sort.OBSTACLE: WALL}.get(patch.sort)
    fill = fill or OBJECTS.get(patch.colour or "", OTHER)
    return (
        f'<polygon points="{frame.path(patch.corners)}" fill="{_hex(fill)}" stroke="#555555" '
        f'stroke-width="0.7"><title>{markup(patch.name)}</title></polygon>'
    )


def _hex(colour: Colour) -> str:
    return "#" + "".join(f"{round(255 * part):02x}" for part in colour)


def _mark(name: str, point: Point, frame: _Frame) -> str:
    x, y = frame.pixel(point)
    return (
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="none" stroke="#111111" '
        f'stroke-dasharray="2 2"><title>goal of {markup(name)}</title></circle>'
    )


def _robot(view: TopView, frame: _Frame) -> Iterator[str]:
    x, y, heading = view.robot
    corners = tuple(
        (x + reach * math.cos(heading + turn), y + reach * math.sin(heading + turn))
        for reach, turn in ((ROBOT, 0.0), (0.6 * ROBOT, 2.4), (0.6 * ROBOT, -2.4))
    )
    yield f'<polygon points="{frame.path(corners)}" fill="#59636f"><title>robot</title></polygon>'


def _labels(view: TopView, symbols: dict[str, str], frame: _Frame) -> Iterator[str]:
    for thing in view.things:
        if thing.middle is not None:
            x, y = frame.pixel(thing.middle)
            yield (
                f'<text x="{x:.1f}" y="{y + FONT / 3:.1f}" text-anchor="middle" '
                f'font-size="{FONT - 2}">{markup(symbols[thing.name])}</text>'
            )


def _legend(view: TopView, symbols: dict[str, str]) -> Iterator[str]:
    for name, top in view.supports:
        yield f"{name}: {top:.2f} m high"
    for thing in view.things:
        goal = f"; goal: {thing.goal}" if thing.goal else ""
        yield f"{symbols[thing.name]}  {thing.name}: {thing.where}{goal}"
    yield from (f"goal: {text}" for text in view.wanted)
