"""Where the robot can get to at all: the part of the floor that hangs together with its start."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from runtime.kernels import plane
from runtime.robot.model import Floats

CELL = 0.05
"""Metres; passages narrower than this may be overlooked."""

SPAN = 3.0
"""Metres around the outermost obstacles and the start that are looked at."""


class Floor(NamedTuple):
    """Marks (rows, columns) of the cells of the floor, from the corner (x0, y0); obstacles with
    the clearance that the base keeps from each. As `runtime.kernels.plane.in_room` takes them."""

    marks: NDArray[np.int8]
    x0: float
    y0: float
    cell: float
    boxes: Floats
    clearance: Floats


class Room(NamedTuple):
    """A room: which `cells` (rows, columns) of the floor hang together."""

    cells: NDArray[np.bool_]
    floor: Floor

    def contains(self, x: float, y: float) -> bool:
        """Whether the robot can get to a position and turn there."""
        inside: bool = plane.in_room(*self.floor, x, y)
        return inside


def whole(room: Room) -> Room:
    """All of the floor where a robot can turn, whether or not it hangs together with the room."""
    floor = room.floor
    grid = plane.grid(
        floor.boxes, floor.clearance, floor.x0, floor.y0, floor.cell, *room.cells.shape
    )
    clear = grid != plane.BLOCKED
    return Room(clear, floor._replace(marks=plane.marked_cells(clear, grid)))


def bare(room: Room) -> Room:
    """The same floor with nothing on it."""
    empty = room.floor._replace(boxes=np.zeros((0, 8)), clearance=np.zeros(0))
    return whole(room._replace(floor=empty))


def room_around(boxes: Floats, clearance: Floats, x: float, y: float) -> Room:
    """The room in which a robot stands at (x, y)."""
    reach = np.hypot(boxes[:, 3], boxes[:, 4]) if len(boxes) else np.zeros(0)
    low = np.min(np.vstack([boxes[:, :2] - reach[:, None], [[x, y]]]), axis=0) - SPAN
    high = np.max(np.vstack([boxes[:, :2] + reach[:, None], [[x, y]]]), axis=0) + SPAN
    rows, columns = (math.ceil(span / CELL) for span in high - low)
    x0, y0 = float(low[0]), float(low[1])
    grid = plane.grid(boxes, clearance, x0, y0, CELL, rows, columns)
    clear = grid != plane.BLOCKED
    i, j = int((x - x0) / CELL), int((y - y0) / CELL)
    # The edge of the room runs through cells: where the own one is not clear, a neighbour's
    # room counts, the largest of them.
    own = [(i, j)] if clear[i, j] else [(i + a, j + b) for a in (-1, 0, 1) for b in (-1, 0, 1)]
    rooms = [
        plane.connected(clear, a, b)
        for a, b in own
        if 0 <= a < clear.shape[0] and 0 <= b < clear.shape[1]
    ]
    cells = max(rooms, key=lambda cells: int(cells.sum()))
    marks = plane.marked_cells(cells, grid)
    return Room(cells, Floor(marks, x0, y0, CELL, boxes, clearance))
