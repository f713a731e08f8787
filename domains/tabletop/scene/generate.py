"""Sorting scenes of any size at the density of `sorting/4t-28`, as scene files.

The arena is tiled with groups of four tables, laid out as in that scene: objects start on two
of them, 14 to a table at the most, one quarter of them blue, one quarter green, half red;
blue goes to the third table of its group, green to the fourth, red is in the way.
"""

from __future__ import annotations

import math

import numpy as np

PER_GROUP = 28
PITCH = 6.0
"""Metres between the centres of neighbouring groups."""

GRID = 0.1
"""Metres between the places where objects may start, as in `sorting/4t-28`."""


def sorting_scene(objects: int, seed: int) -> str:
    """The text of a scene file with a number of objects."""
    rng = np.random.default_rng(seed)
    groups = max(1, math.ceil(objects / PER_GROUP))
    columns = math.ceil(math.sqrt(groups))
    rows = math.ceil(groups / columns)
    half = max(columns, rows) * PITCH / 2
    lines = [
        f"# {objects} sticks on {2 * groups} tables at the density of sorting/4t-28, seed {seed}.",
        "",
    ]
    x0, y0 = _centre(0, columns, rows)
    lines += [f"robot_start = [{x0:.3f}, {y0:.3f}, 0.0]", ""]
    lines += ["[arena]", f"inner = {half:.3f}", f"outer = {half + 0.025:.3f}", "height = 0.4", ""]
    for group in range(groups):
        x, y = _centre(group, columns, rows)
        spots = ((2.2, 0.0, 90.0), (-2.2, 0.0, 90.0), (0.0, 2.2, 0.0), (0.0, -2.2, 0.0))
        for number, (dx, dy, yaw) in enumerate(spots):
            lines += ["[[table]]", f'name = "table{group}_{number + 1}"']
            lines += [f"at = [{x + dx:.3f}, {y + dy:.3f}]", f"yaw = {yaw}", "size = [1.5, 0.7]"]
            lines += ["top = 0.765", "rest = 0.767", ""]
    for group in range(groups):
        count = objects // groups + (group < objects % groups)
        x, y = _centre(group, columns, rows)
        cells = [(side, i, j) for side in (2.2, -2.2) for i in range(-3, 4) for j in range(-6, 7)]
        chosen = rng.permutation(len(cells))[:count]
        for number, cell in enumerate(chosen):
            side, i, j = cells[cell]
            colour = ("blue", "green", "red", "red")[number % 4]
            lines += ["[[object]]", f'name = "{colour}{group}_{number}"']
            lines += ["size = [0.04, 0.04, 0.2]"]
            lines += [f"at = [{x + side + i * GRID:.3f}, {y + j * GRID:.3f}]"]
            lines += [f'colour = "{colour}{group}"', ""]
        for colour, table in (("blue", 3), ("green", 4)):
            if count > ("blue", "green").index(colour):
                lines += ["[[goal]]", f'colour = "{colour}{group}"']
                lines += [f'on = "table{group}_{table}"', ""]
    return "\n".join(lines)


def _centre(group: int, columns: int, rows: int) -> tuple[float, float]:
    row, column = divmod(group, columns)
    return (column - (columns - 1) / 2) * PITCH, (row - (rows - 1) / 2) * PITCH
