"""Parts that belong in a rack: their shapes, and where each of them fits.

A part is a slab, square or triangular, with a peg on it by which a hand takes it. The layout is
found by trying headings and places for one part after the other, the ones in corners first.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from domains.tabletop.kinder.observed import RIGHT, Observation, Thing
from domains.tabletop.kinder.problem import table
from domains.tabletop.kinder.slim import NEAR
from domains.tabletop.outlines import around, room_within
from runtime.world.poses import Floats

PEG = 0.01, 0.05
"""Half the width of a peg, and its height, metres."""

APART = 0.004
"""Metres between parts, and between them and walls, at least."""

TURNS = 8
"""Headings that are tried for each part."""

HAND = 0.08, 0.022
"""Metres that the open hand reaches from a peg in the direction in which its fingers close, and
across."""

HANDS = 12
"""Directions in which the fingers may close that are looked at."""

STEP = 0.004
"""Metres between places that are tried."""

TRIES = 5_000
"""Places that are looked at before a layout is given up."""


@dataclass(frozen=True, eq=False)
class PartShape:
    """The outline (n, 2) of a slab about its own origin, counter-clockwise, and its depth. A
    slab's origin is in the middle of its depth."""

    outline: Floats
    depth: float

    @property
    def middle(self) -> Floats:
        """The middle (2,) of the box around it along its own axes."""
        middle: Floats = (self.outline.min(axis=0) + self.outline.max(axis=0)) / 2
        return middle

    def smaller(self, by: float) -> PartShape:
        """The same with its sides moved inwards, none by less than some metres; its peg, on the
        mean of the corners, stays where it is."""
        mean = self.outline.mean(axis=0)
        share = 1 - by / room_within(self.outline - mean)
        return PartShape(mean + share * (self.outline - mean), self.depth)

    def mesh(self) -> str:
        """The slab and its peg, which stands on the mean of the corners, as an OBJ file."""
        half, high = PEG
        peg = np.array([(-half, -half), (half, -half), (half, half), (-half, half)])
        lines: list[str] = []
        count = 0
        solids = (
            (self.outline, 0.0, self.depth),
            (peg + self.outline.mean(axis=0), self.depth, self.depth + high),
        )
        for outline, low, top in solids:
            lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for z in (low, top) for x, y in outline.tolist()]
            lines += [f"f {a + count} {b + count} {c + count}" for a, b, c in _prism(len(outline))]
            count += 2 * len(outline)
        return "\n".join(lines) + "\n"


def _prism(n: int) -> Iterator[tuple[int, int, int]]:
    """The triangles, from 1, of a prism with n corners below and n above."""
    for k in range(1, n - 1):
        yield 1, k + 2, k + 1
        yield n + 1, n + k + 1, n + k + 2
    for k in range(n):
        a, b = k + 1, (k + 1) % n + 1
        yield a, b, n + b
        yield a, n + b, n + a


def shape_of(part: Thing) -> PartShape:
    """The shape of a part that is seen."""
    if part.type.endswith("Cuboid"):
        hx, hy, hz = part.half
        return PartShape(np.array([(-hx, -hy), (hx, -hy), (hx, hy), (-hx, hy)]), 2 * hz)
    a, b = part["side_a"], part["side_b"]
    if part["triangle_type"] == RIGHT:
        outline = np.array([(0.0, 0.0), (a, 0.0), (0.0, b)])
    else:
        high = math.sqrt(3) / 2 * a
        outline = np.array([(-a / 2, -high / 3), (a / 2, -high / 3), (0.0, 2 * high / 3)])
    return PartShape(outline, part["depth"])


def packing(seen: Observation, lift: float, wall: float) -> tuple[list[str], dict[str, str]]:
    """The rack, the parts on the table and their goals in it as tables of a scene, and meshes.
    Where no layout is found parts are wanted anywhere in the rack."""
    rack, parts = seen.things["rack"], seen.named("part")
    shapes = [shape_of(part) for part in parts]
    tables = _rack(rack, lift, wall)
    half = (rack.half[0] - wall, rack.half[1] - wall)
    layout = fit(shapes, half)
    shapes = _slimmed(parts, shapes)
    c, s = math.cos(rack.yaw), math.sin(rack.yaw)
    meshes = {}
    for number, (part, shape) in enumerate(zip(parts, shapes, strict=True)):
        meshes[f"{part.name}.obj"] = shape.mesh()
        x, y = turned(shape.middle[None], part.yaw)[0] + part.position[:2]
        tables.append(
            table(
                "object",
                name=part.name,
                shape="mesh",
                mesh=f"{part.name}.obj",
                at=[float(x), float(y)],
                yaw=math.degrees(part.yaw),
                on="table",
            )
        )
        goal: dict[str, object] = {"object": part.name, "on": rack.name}
        if layout is not None:
            px, py, yaw = layout[number]
            mx, my = turned(shape.middle[None], yaw)[0] + (px, py)
            goal["at"] = [rack.position[0] + c * mx - s * my, rack.position[1] + s * mx + c * my]
            goal["yaw"] = math.degrees(yaw + rack.yaw)
        tables.append(table("goal", **goal))
    return tables, meshes


def _slimmed(parts: Sequence[Thing], shapes: Sequence[PartShape]) -> list[PartShape]:
    """The shapes of parts as they start, those that nearly touch another one made smaller."""
    outlines = [
        turned(shape.outline, part.yaw) + part.position[:2]
        for part, shape in zip(parts, shapes, strict=True)
    ]
    found = []
    for i, shape in enumerate(shapes):
        others = [other for j, other in enumerate(outlines) if j != i]
        least = min((gap(outlines[i], other) for other in others), default=NEAR)
        found.append(shape.smaller(max(0.0, NEAR - least) / 2))
    return found


def _rack(rack: Thing, lift: float, wall: float) -> list[str]:
    """Its floor and its walls."""
    (x, y, z), (hx, hy, hz) = rack.position, rack.half
    c, s = math.cos(rack.yaw), math.sin(rack.yaw)
    bottom, yaw = z - hz + lift, math.degrees(rack.yaw)
    tables = [
        table(
            "table",
            name=rack.name,
            at=[x, y],
            yaw=yaw,
            size=[2 * hx, 2 * hy],
            top=bottom + wall,
            thickness=wall,
            region=[2 * (hx - wall), 2 * (hy - wall)],
        )
    ]
    for number, (dx, dy, size) in enumerate(
        (
            (hx - wall / 2, 0.0, (wall, 2 * hy)),
            (wall / 2 - hx, 0.0, (wall, 2 * hy)),
            (0.0, hy - wall / 2, (2 * hx, wall)),
            (0.0, wall / 2 - hy, (2 * hx, wall)),
        ),
        1,
    ):
        tables.append(
            table(
                "wall",
                name=f"{rack.name}_wall{number}",
                at=[x + c * dx - s * dy, y + s * dx + c * dy],
                yaw=yaw,
                size=[*size, 2 * hz],
                bottom=bottom,
            )
        )
    return tables


def fit(
    shapes: Sequence[PartShape], half: tuple[float, float]
) -> list[tuple[float, float, float]] | None:
    """Where the origins of some slabs go, x, y and heading each, so that they are clear of each
    other and of the walls of a rectangle of half extents around the origin. None where none was
    found."""
    order = sorted(range(len(shapes)), key=lambda i: -_area(shapes[i].outline))
    chosen = [shapes[i] for i in order]
    found = _place(chosen, half, [], [TRIES], with_hand=True)
    if found is None:
        found = _place(chosen, half, [], [TRIES], with_hand=False)
    if found is None:
        return None
    places: list[tuple[float, float, float]] = [(0.0, 0.0, 0.0)] * len(shapes)
    for i, place in zip(order, found, strict=True):
        places[i] = place
    return places


def _place(
    shapes: Sequence[PartShape],
    half: tuple[float, float],
    taken: list[Put],
    budget: list[int],
    with_hand: bool,
) -> list[tuple[float, float, float]] | None:
    if not shapes:
        return []
    for yaw in (k * 2 * math.pi / TURNS for k in range(TURNS)):
        outline = turned(shapes[0].outline, yaw)
        low, high = outline.min(axis=0), outline.max(axis=0)
        room = [2 * (h - APART) - size for h, size in zip(half, high - low, strict=True)]
        if min(room) < 0:
            continue
        for dy in _steps(room[1]):
            for dx in _steps(room[0]):
                if budget[0] <= 0:
                    return None
                budget[0] -= 1
                origin = np.array([dx - half[0] + APART, dy - half[1] + APART]) - low
                put = Put(outline + origin, box_around(shapes[0].outline, yaw) + origin)
                if any(gap(put.outline, other.outline) < APART for other in taken):
                    continue
                if with_hand and not _leave_room([*taken, put]):
                    continue
                rest = _place(shapes[1:], half, [*taken, put], budget, with_hand)
                if rest is not None:
                    return [(float(origin[0]), float(origin[1]), yaw), *rest]
    return None


@dataclass(frozen=True, eq=False)
class Put:
    """A slab in its place: its outline (n, 2), and the corners (4, 2) of the box around it along
    its own axes, by which the planner judges what is in the way of a hand."""

    outline: Floats
    box: Floats


def box_around(outline: Floats, yaw: float) -> Floats:
    """The corners (4, 2) of the box around an outline along its own axes, turned."""
    (a, b), (c, d) = outline.min(axis=0), outline.max(axis=0)
    return turned(np.array([(a, b), (c, b), (c, d), (a, d)]), yaw)


def _leave_room(taken: Sequence[Put]) -> bool:
    """Whether a hand at each peg can close in some direction beside all other slabs."""
    long, wide = HAND
    hand = np.array([(-long, -wide), (long, -wide), (long, wide), (-long, wide)])
    turns = [turned(hand, k * math.pi / HANDS) for k in range(HANDS)]
    return all(
        any(
            all(gap(turn + one.outline.mean(axis=0), other.box) > 0 for other in others)
            for turn in turns
        )
        for one in taken
        if (others := [other for other in taken if other is not one])
    )


def _steps(room: float) -> Iterator[float]:
    """Places along a side: both ends, then those in between."""
    yield 0.0
    if room > 0:
        yield room
        yield from np.arange(STEP, room, STEP).tolist()


def gap(a: Floats, b: Floats) -> float:
    """Metres between two convex outlines (n, 2) along the best line that parts them: never more
    than their distance, and at most 0 where they overlap."""
    best = -math.inf
    for outline in (a, b):
        edges = np.roll(outline, -1, axis=0) - outline
        normals = np.column_stack([edges[:, 1], -edges[:, 0]])
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        along_a, along_b = a @ normals.T, b @ normals.T
        apart = np.maximum(
            along_b.min(axis=0) - along_a.max(axis=0), along_a.min(axis=0) - along_b.max(axis=0)
        )
        best = max(best, float(apart.max()))
    return best


def turned(points: Floats, yaw: float) -> Floats:
    """Points (n, 2) turned about the origin."""
    c, s = math.cos(yaw), math.sin(yaw)
    found: Floats = points @ np.array([[c, s], [-s, c]])
    return found


def _area(outline: Floats) -> float:
    x, y = around(outline).T
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)
