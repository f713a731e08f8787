"""A top view as characters: one column stands for half as much as one line."""

from __future__ import annotations

import math
import string
from collections.abc import Iterator

from runtime.show.top_view import Patch, Sort, Thing, TopView, contains
from sketchlang.escape import shown_line

WIDTH = 100
"""Columns, unless the terminal has fewer or more is asked for."""

LEAST_WIDTH = 30
MOST_LINES = 60

SYMBOLS = string.ascii_lowercase + string.ascii_uppercase + string.digits
"""What stands for objects, in their order; what comes after is drawn as `*`."""

SUPPORTS = (".", ":", "=")
"""What stands for a support, for one that lies on another, and for one on that."""

WALL, MARK, MANY = "#", "x", "*"
ARROWS = (">", "^", "<", "v")

CODES = {"red": 31, "green": 32, "yellow": 33, "blue": 34, "purple": 35, "orange": 33, "black": 90}
"""ANSI codes of colours that scenes name."""

FAINT, STRONG = 2, 1

Cells = dict[tuple[int, int], tuple[str, int | None]]
"""Characters and their ANSI codes, by line (from above) and column."""


def draw(view: TopView, width: int = WIDTH, colour: bool = False) -> list[str]:
    """The lines of a picture at most `width` columns wide, and of its legend."""
    grid = Grid(view, width)
    symbols = symbols_of(view)
    cells = _furniture(view, grid)
    for _, (x, y) in view.marks:
        cells[grid.cell(x, y)] = (MARK, None)
    things = {thing.name: thing for thing in view.things}
    seen: dict[tuple[int, int], str] = {}
    for patch in view.patches:
        if patch.sort is Sort.OBJECT:
            entry = (symbols[patch.name], CODES.get(things[patch.name].colour or "", STRONG))
            area = list(grid.cells(patch))
            cells |= dict.fromkeys(area, entry)
            seen |= dict.fromkeys(area, patch.name)
    x, y, heading = view.robot
    cells[grid.cell(x, y)] = (ARROWS[round(heading / (math.pi / 2)) % 4], STRONG)
    seen.pop(grid.cell(x, y), None)
    lines = list(grid.lines(cells, colour))
    scale = f"one column is {100 * grid.step:.0f} cm, one line {200 * grid.step:.0f} cm"
    legend = _legend(view, symbols, set(seen.values()), colour)
    return [*lines, "", f"{scale}; x to the right, y up", *legend]


def _furniture(view: TopView, grid: Grid) -> Cells:
    """Supports with their names, and obstacles."""
    cells: Cells = {}
    levels: dict[tuple[int, int], tuple[str, int]] = {}
    areas: dict[str, list[tuple[int, int]]] = {}
    for patch in view.patches:
        if patch.sort is Sort.SUPPORT:
            for cell in grid.cells(patch):
                below, level = levels.get(cell, (patch.name, 0))
                level += below != patch.name
                levels[cell] = patch.name, level
                cells[cell] = SUPPORTS[min(level, len(SUPPORTS) - 1)], FAINT
                areas.setdefault(patch.name, []).append(cell)
        elif patch.sort is Sort.OBSTACLE:
            cells |= dict.fromkeys(grid.cells(patch), (WALL, FAINT))
    for name, area in areas.items():
        cells |= grid.caption(shown_line(name), area, cells)
    return cells


def symbols_of(view: TopView) -> dict[str, str]:
    """The character of each object: its own letter where every object has a printable one, else
    the next of `SYMBOLS`."""
    labels = [thing.label for thing in view.things]
    if labels and all(label and len(label) == 1 and label.isprintable() for label in labels):
        return {thing.name: str(thing.label) for thing in view.things}
    return {
        thing.name: SYMBOLS[i] if i < len(SYMBOLS) else MANY for i, thing in enumerate(view.things)
    }


class Grid:
    """Where the cells of the picture lie in the plane; `step` is the width of a column, metres."""

    def __init__(self, view: TopView, width: int) -> None:
        low_x, low_y, high_x, high_y = view.bounds
        columns = max(LEAST_WIDTH, width)
        self.step = max((high_x - low_x) / (columns - 1), (high_y - low_y) / 2 / (MOST_LINES - 1))
        self.step = max(self.step, 1e-3)
        self.left, self.top = low_x, high_y
        self.columns = 1 + int((high_x - low_x) / self.step)
        self.rows = 1 + int((high_y - low_y) / (2 * self.step))

    def cell(self, x: float, y: float) -> tuple[int, int]:
        """The line and column of a point."""
        row, column = (self.top - y) // (2 * self.step), (x - self.left) // self.step
        return int(row), int(column)

    def is_inside(self, row: int, column: int) -> bool:
        """Whether a cell is in the picture."""
        return 0 <= row < self.rows and 0 <= column < self.columns

    def cells(self, patch: Patch) -> Iterator[tuple[int, int]]:
        """The cells of the picture whose middle a patch covers; the one in which it lies where
        there is none."""
        xs, ys = [x for x, _ in patch.corners], [y for _, y in patch.corners]
        first, last = self.cell(min(xs), max(ys)), self.cell(max(xs), min(ys))
        found = False
        for row in range(max(first[0], 0), min(last[0], self.rows - 1) + 1):
            for column in range(max(first[1], 0), min(last[1], self.columns - 1) + 1):
                x = self.left + (column + 0.5) * self.step
                y = self.top - (2 * row + 1) * self.step
                if contains(patch.corners, x, y):
                    found = True
                    yield row, column
        middle = self.cell(sum(xs) / len(xs), sum(ys) / len(ys))
        if not found and self.is_inside(*middle):
            yield middle

    def caption(self, name: str, area: list[tuple[int, int]], cells: Cells) -> Cells:
        """The name of a support over its area, under it, or at its upper edge: where nothing else
        is drawn."""
        rows, column = [row for row, _ in area], min(column for _, column in area)
        own = set(area)
        for row in (min(rows) - 1, max(rows) + 1, min(rows), min(rows) + 1):
            places = [(row, column + i) for i in range(len(name))]
            if all(self.is_inside(*p) and (p in own or p not in cells) for p in places):
                return {place: (sign, FAINT) for place, sign in zip(places, name, strict=True)}
        return {}

    def lines(self, cells: Cells, colour: bool) -> Iterator[str]:
        """The lines of the picture, without blanks at their ends."""
        for row in range(self.rows):
            entries = [cells.get((row, column), (" ", None)) for column in range(self.columns)]
            while entries and entries[-1][0] == " ":
                entries.pop()
            yield "".join(_painted(sign, code if colour else None) for sign, code in entries)


def _painted(text: str, code: int | None) -> str:
    return text if code is None else f"\x1b[{code}m{text}\x1b[0m"


def _legend(view: TopView, symbols: dict[str, str], seen: set[str], colour: bool) -> list[str]:
    x, y, heading = view.robot
    arrow = ARROWS[round(heading / (math.pi / 2)) % 4]
    lines = [f"{arrow}  robot at ({x:.2f}, {y:.2f}), heading {math.degrees(heading):.0f} degrees"]
    if view.supports:
        tops = shown_line(", ".join(f"{name} ({top:.2f} m high)" for name, top in view.supports))
        lines.append(f"{SUPPORTS[0]}  supports: {tops}")
    if any(patch.sort is Sort.OBSTACLE for patch in view.patches):
        lines.append(f"{WALL}  walls and other obstacles")
    if view.marks:
        lines.append(f"{MARK}  places that goals name")
    wide = max((len(thing.name) for thing in view.things), default=0)
    for thing in view.things:
        symbol = symbols[thing.name]
        code = CODES.get(thing.colour or "", STRONG) if colour else None
        hidden = thing.middle is not None and thing.name not in seen
        lines.append(f"{_painted(symbol, code)}  {_words(thing, wide)}{' (hidden)' * hidden}")
    return [*lines, *(shown_line(f"goal: {text}") for text in view.wanted)]


def _words(thing: Thing, wide: int) -> str:
    colour = f"{thing.colour}, " if thing.colour else ""
    goal = f"; goal: {thing.goal}" if thing.goal else ""
    return shown_line(f"{thing.name:<{wide}}  {colour}{thing.where}{goal}")
