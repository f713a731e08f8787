"""Tables, shelves, bins, pegs, walls and the fence of a scene file: what never moves, and where
things can rest on it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from domains.tabletop.scene.model import UprightBox, fixed_box
from runtime.entry import Entry
from runtime.world.body import Part
from runtime.world.making import body_of, open_box, standing
from runtime.world.poses import compose, upright
from runtime.world.solids import Box, Cylinder
from runtime.world.world import FLOOR, Fixed, Peg, Support

AIR = 0.002
"""Metres between a support and what rests on it, unless the scene says otherwise."""

LEAST_AIR = 0.0015
"""Less than that, and the planner sees objects touch the table that they rest on."""

LARGEST = 10.0
"""Metres a table may measure."""

FARTHEST = 50.0
"""Metres from the origin that things may be."""

THICKNESS = 0.02
"""Metres of the boards and sides of a shelf, unless the scene says otherwise."""

WALL = 0.005
"""Metres of the walls and the floor of a bin or a tray, unless the scene says otherwise."""


@dataclass
class Furniture:
    """What the file says so far. `names` are those of everything, with where it was given."""

    fixed: list[Fixed] = field(default_factory=list)
    tables: list[Support] = field(default_factory=list)
    boards: list[Support] = field(default_factory=list)
    bins: list[Support] = field(default_factory=list)
    pegs: list[Support] = field(default_factory=list)
    floor: Support = field(
        default_factory=lambda: Support(
            FLOOR, FLOOR, upright(0.0, 0.0, AIR, 0.0), (FARTHEST, FARTHEST)
        )
    )
    names: dict[str, str] = field(default_factory=dict)

    @property
    def supports(self) -> list[Support]:
        """All of them: tables, boards, bins, pegs, the floor."""
        return [*self.tables, *self.boards, *self.bins, *self.pegs, self.floor]

    def claim(self, entry: Entry, what: str) -> str:
        """The name of an entry, which nothing else may have."""
        name = entry.text("name")
        if name == FLOOR:
            entry.problem("name", f"{FLOOR!r} is the name of the floor")
        elif name and name in self.names:
            other = self.names[name]
            found = f"two {what}s" if other == what else f"a {other} and a {what}"
            entry.problem("name", f"there are {found} named {name!r}")
        self.names.setdefault(name, what)
        return name


def read_furniture(scene: Entry) -> Furniture:
    """Everything that never moves."""
    found = Furniture()
    for entry in scene.tables("table"):
        _table(entry, found)
    for entry in scene.tables("shelf"):
        _shelf(entry, found)
    if scene.has("arena"):
        _fence(scene.table("arena"), found)
    for entry in scene.tables("wall"):
        _wall(entry, found)
    for entry in scene.tables("bin"):
        _bin(entry, found)
    for entry in scene.tables("peg"):
        _peg(entry, found)
    return found


def place_of(entry: Entry) -> tuple[float, float]:
    """Where on the floor something is."""
    x, y = entry.numbers("at", 2)
    refuse_far(entry, "at", (x, y))
    return x, y


def refuse_far(entry: Entry, key: str, lengths: Sequence[float]) -> None:
    """Note lengths that are too far from the origin."""
    if max(map(abs, lengths)) > FARTHEST:
        entry.problem(key, f"nothing may be further than {FARTHEST:g} m from the origin")


def contains(support: Support, x: float, y: float, slack: float = 1e-9) -> bool:
    """Whether a point of the world's plane is on a support that never moves."""
    lx, ly = local(support, x, y)
    return abs(lx) <= support.half[0] + slack and abs(ly) <= support.half[1] + slack


def local(support: Support, x: float, y: float) -> tuple[float, float]:
    """A point of the plane in the frame of a support that never moves."""
    pose = support.pose
    dx, dy = x - float(pose[0, 3]), y - float(pose[1, 3])
    c, s = float(pose[0, 0]), float(pose[1, 0])
    return c * dx + s * dy, c * dy - s * dx


def _sizes(entry: Entry, key: str, count: int, what: str) -> list[float]:
    size = entry.positives(key, count)
    if max(size) > LARGEST:
        entry.problem(key, f"{what} may measure {LARGEST:g} m at most")
    return size


def _table(entry: Entry, found: Furniture) -> None:
    name, (x, y) = found.claim(entry, "table"), place_of(entry)
    size = _sizes(entry, "size", 2, "a table")
    region = entry.positives("region", 2) if entry.has("region") else size
    if entry.sound and (region[0] > size[0] or region[1] > size[1]):
        entry.problem("region", "the region is larger than the table")
    top = entry.positive("top")
    thickness = entry.positive("thickness", top)
    if entry.sound and thickness > top:
        entry.problem("thickness", f"is more than the height of the top, {top:g} m")
    rest = entry.number("rest", top + AIR)
    if entry.sound and rest < top + LEAST_AIR:
        entry.problem(
            "rest",
            f"objects at {rest:g} m would touch the table, whose top is at {top:g} m",
            f"leave {1000 * AIR:g} mm of air: rest = {top + AIR:g}",
        )
    yaw = math.radians(entry.number("yaw", 0.0))
    if not entry.sound:
        return
    # Unless it has a thickness, the body of a table reaches down to the floor.
    box = UprightBox((x, y, top - thickness / 2), (size[0], size[1], thickness), yaw)
    found.fixed.append(fixed_box(name, box))
    half = (region[0] / 2, region[1] / 2)
    found.tables.append(Support(name, name, upright(x, y, rest, yaw), half))


def _shelf(entry: Entry, found: Furniture) -> None:
    name, (x, y) = found.claim(entry, "shelf"), place_of(entry)
    width, depth = _sizes(entry, "size", 2, "a shelf")
    heights = entry.positives("boards", None)
    thickness = entry.positive("thickness", THICKNESS)
    sides = entry.flag("sides", True)
    yaw = math.radians(entry.number("yaw", 0.0))
    if not heights:
        entry.problem("boards", "a shelf has one board at least")
    if entry.sound and max(heights) > LARGEST:
        entry.problem("boards", f"a shelf may be {LARGEST:g} m high at most")
    gaps = [high - low for low, high in zip([0.0, *heights], heights, strict=False)]
    if entry.sound and any(gap <= thickness for gap in gaps[1:]):
        entry.problem("boards", "must rise from board to board, by more than their thickness")
    if entry.sound and heights[0] < thickness:
        entry.problem("boards", f"the lowest is {thickness:g} m thick: it would be in the floor")
    if entry.sound and sides and width <= 2 * thickness:
        entry.problem("size", f"nothing is left between two sides of {thickness:g} m")
    if not entry.sound:
        return
    between = width - 2 * thickness if sides else width
    parts = [
        Part(Box((between, depth, thickness)), upright(0, 0, h - thickness / 2, 0)) for h in heights
    ]
    if sides:
        high, out = heights[-1], (width - thickness) / 2
        parts += [
            Part(Box((thickness, depth, high)), upright(side * out, 0.0, high / 2, 0.0))
            for side in (-1, 1)
        ]
    found.fixed.append(Fixed(name, body_of(parts), upright(x, y, 0.0, yaw)))
    room = [gap - thickness - AIR for gap in gaps[1:]] + [math.inf]
    for number, (height, clearance) in enumerate(zip(heights, room, strict=True), 1):
        board = f"{name}/{number}"
        pose, half = upright(x, y, height + AIR, yaw), (between / 2, depth / 2)
        found.boards.append(Support(board, name, pose, half, clearance))
        found.names.setdefault(board, "board")


def _bin(entry: Entry, found: Furniture) -> None:
    name, (x, y) = found.claim(entry, "bin"), place_of(entry)
    size = _sizes(entry, "size", 2, "a bin")
    height, wall = entry.positive("height"), entry.positive("wall", WALL)
    yaw = math.radians(entry.number("yaw", 0.0))
    if entry.sound and (min(size) <= 2 * wall or height <= wall):
        entry.problem("wall", f"nothing is left inside of walls of {wall:g} m")
    stand = _stand(entry, found, x, y, lambda support: contains(support, x, y))
    if not entry.sound:
        return
    # It does not move: it stands on the very top, and what rests in it keeps the air.
    bottom = float(stand.pose[2, 3]) if stand.name != FLOOR else 0.0
    pose = upright(x, y, bottom, yaw)
    found.fixed.append(Fixed(name, open_box((size[0], size[1], height), wall), pose))
    inside = compose(pose, upright(0.0, 0.0, wall + AIR, 0.0))
    half = (size[0] / 2 - wall, size[1] / 2 - wall)
    found.bins.append(Support(name, name, inside, half))


def _stand(
    entry: Entry, found: Furniture, x: float, y: float, on: Callable[[Support], bool]
) -> Support:
    """What something that does not move stands on: without `on` the highest thing there, else the
    floor. `on` tells whether it is on a support."""
    under = [s for s in [*found.tables, *found.boards] if on(s)]
    if entry.has("on"):
        wanted = entry.text("on")
        under = [s for s in [*found.tables, *found.boards, found.floor] if s.name == wanted]
        if not under and wanted:
            entry.problem("on", f"there is no table, board or floor named {wanted!r}")
        elif under and not on(under[0]):
            entry.problem("at", f"({x:g}, {y:g}) is not on {wanted!r}")
    return max(under, key=lambda s: float(s.pose[2, 3]), default=found.floor)


def _is_on_top(found: Furniture, support: Support, x: float, y: float) -> bool:
    """Whether a point is on the thing that a support belongs to, if beside its region."""
    owner = next((thing for thing in found.fixed if thing.name == support.owner), None)
    if owner is None:
        return contains(support, x, y)
    (low, high), pose = owner.body.bounds, owner.pose
    dx, dy = x - pose[0, 3], y - pose[1, 3]
    lx, ly = pose[0, 0] * dx + pose[1, 0] * dy, pose[0, 0] * dy - pose[1, 0] * dx
    return bool(low[0] <= lx <= high[0] and low[1] <= ly <= high[1])


def _peg(entry: Entry, found: Furniture) -> None:
    """A rod that stands upright. What goes over it rests on what the peg stands on."""
    name, (x, y) = found.claim(entry, "peg"), place_of(entry)
    radius, height = entry.positive("radius"), entry.positive("height")
    refuse_far(entry, "height", (radius, height))
    stand = _stand(entry, found, x, y, lambda support: _is_on_top(found, support, x, y))
    if not entry.sound:
        return
    rest = float(stand.pose[2, 3])
    bottom = 0.0 if stand.name == FLOOR else rest - AIR
    top = bottom + height
    body = standing(Cylinder(radius, height))
    found.fixed.append(Fixed(name, body, upright(x, y, bottom, 0.0)))
    pose, peg = upright(x, y, rest, 0.0), Peg(radius, max(0.0, top - rest))
    found.pegs.append(Support(name, name, pose, (radius, radius), stand.clearance, peg))


def _fence(arena: Entry, found: Furniture) -> None:
    """Four walls around the origin."""
    inner, outer, height = arena.positive("inner"), arena.number("outer"), arena.positive("height")
    if arena.sound and not inner < outer:
        arena.problem("outer", "the fence needs 0 < inner < outer")
    refuse_far(arena, "outer", [outer])
    if not arena.sound:
        return
    middle, thick = (inner + outer) / 2, outer - inner
    sides = {"east": (1, 0), "north": (0, 1), "west": (-1, 0), "south": (0, -1)}
    for side, (x, y) in sides.items():
        size = (thick, 2 * outer, height) if x else (2 * outer, thick, height)
        box = UprightBox((x * middle, y * middle, height / 2), size)
        found.fixed.append(fixed_box(f"fence_{side}", box))


def _wall(entry: Entry, found: Furniture) -> None:
    name, (x, y) = found.claim(entry, "wall"), place_of(entry)
    a, b, c = entry.positives("size", 3)
    bottom = entry.number("bottom", 0.0)
    refuse_far(entry, "size", (a, b, c))
    refuse_far(entry, "bottom", [bottom])
    yaw = math.radians(entry.number("yaw", 0.0))
    if entry.sound:
        found.fixed.append(fixed_box(name, UprightBox((x, y, bottom + c / 2), (a, b, c), yaw)))
