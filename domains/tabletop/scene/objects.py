"""Objects of a scene file: what they are, what they rest on, and how they lie there.

An object may rest on another one that is described later, so bodies are read first and placed
then, each after what it rests on.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from domains.tabletop.scene.bodies import orientation, read_body
from domains.tabletop.scene.furniture import AIR, Furniture, contains, local, refuse_far
from domains.tabletop.scene.model import SceneObject, Start, movable
from runtime.entry import Entry, known
from runtime.world.body import Body
from runtime.world.pegs import ABOVE, PLAY, hollow_of_body, name_of_ring, owner_of_ring, ring_of
from runtime.world.poses import Pose, compose, rotation_from_rpy
from runtime.world.snap import nearest_stable, resting_pose
from runtime.world.stable import StablePose, stable_poses
from runtime.world.tops import top_of
from runtime.world.world import FLOOR, Movable, Support

SNAP = math.radians(5.0)
"""Radians by which `rpy` may miss a stable pose, which is then taken."""

LEVEL = 0.001
"""Metres by which the tops may differ in height that bear one object together."""


@dataclass
class Drawn:
    """An object on its way from the file into the scene."""

    entry: Entry
    name: str
    body: Body | None
    rpy: tuple[float, float, float]
    at: tuple[float, float] | None
    on: list[str]
    colour: str | None
    letter: str | None
    only_on: list[str] | None = None
    stable: tuple[StablePose, ...] = ()
    placed: SceneObject | None = None


@dataclass
class Placed:
    """Supports, and where the objects are that were placed so far. `world` are the poses of
    supports in the world by their names, `index` their numbers; `tops` those of objects."""

    furniture: Furniture
    objects: list[SceneObject | None] = field(default_factory=list)
    movables: list[Movable | None] = field(default_factory=list)
    supports: list[Support] = field(default_factory=list)
    world: list[Support] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.supports = list(self.furniture.supports)
        self.world = list(self.supports)

    def index(self, name: str) -> int | None:
        """The number of the support of a name."""
        for i, support in enumerate(self.supports):
            if support.name == name:
                return i
        return None

    def add_top(self, top: Support, pose: Pose) -> None:
        """Things can rest on an object that is at a pose."""
        self.supports.append(top)
        there = compose(pose, top.pose)
        self.world.append(replace(top, pose=there))

    def height(self, index: int) -> float:
        """The height at which the bottom of what rests on a support is."""
        return float(self.world[index].pose[2, 3])

    def found_at(self, x: float, y: float) -> int | str:
        """The support at a point where the file names none: the highest table or bin there, or
        the only board; else what is wrong with that."""
        furniture = self.furniture
        solid = [
            i
            for i, s in enumerate(self.supports)
            if (s in furniture.tables or s in furniture.bins or s in furniture.pegs)
            and contains(self.world[i], x, y)
        ]
        if solid:
            over = [i for i in solid if self.supports[i].peg is not None]
            return max(over or solid, key=lambda i: (self.height(i), -i))
        boards = [s.name for s in furniture.boards if contains(s, x, y)]
        if len(boards) == 1:
            return self.index(boards[0]) or 0
        if boards:
            return f"({x:g}, {y:g}) is on several boards: say `on = {boards[0]!r}` or another one"
        return f"({x:g}, {y:g}) is not on a table"

    def nearest(self, x: float, y: float) -> str:
        """A hint for a point that is on nothing."""
        level = [s for s in self.furniture.supports if s.name != FLOOR]
        if not level:
            return f"say `on = {FLOOR!r}` for the floor"
        best = min(level, key=lambda s: math.dist((x, y), (s.pose[0, 3], s.pose[1, 3])))
        cx, cy = float(best.pose[0, 3]), float(best.pose[1, 3])
        return f"the nearest one is {best.name!r}, around ({cx:g}, {cy:g})"


def read_objects(scene: Entry, furniture: Furniture) -> tuple[list[Drawn], Placed]:
    """All objects, and those placed of which everything is well."""
    drawn = [_draw(entry, furniture) for entry in scene.tables("object")]
    placed = Placed(furniture)
    placed.objects = [None] * len(drawn)
    placed.movables = [None] * len(drawn)
    by_name = {thing.name: i for i, thing in reversed(list(enumerate(drawn)))}
    done: set[int] = set()
    for i in range(len(drawn)):
        _place(i, drawn, by_name, placed, done, [])
    # Tops of objects in the order of the objects, whatever was placed first.
    fixed = len(furniture.supports)
    _sort_tops(placed, fixed, by_name)
    for thing in drawn:
        _keep_to(thing, by_name, placed)
    return drawn, placed


def _draw(entry: Entry, furniture: Furniture) -> Drawn:
    name = furniture.claim(entry, "object")
    body, rpy = read_body(entry), orientation(entry)
    on = entry.names("on") if entry.has("on") else []
    at = None
    if entry.has("at") or not entry.has("on"):
        x, y = entry.numbers("at", 2)
        refuse_far(entry, "at", (x, y))
        at = x, y
    colour = entry.text("colour") if entry.has("colour") else None
    letter = entry.text("letter") if entry.has("letter") else None
    entry.has("bottom")
    stable = stable_poses(body) if body is not None else ()
    if body is not None and not stable:
        entry.problem(None, "does not rest on any of its sides")
    only_on = entry.names("only_on") if entry.has("only_on") else None
    return Drawn(entry, name, body, rpy, at, on, colour, letter, only_on, stable)


def _place(
    i: int,
    drawn: Sequence[Drawn],
    by_name: dict[str, int],
    placed: Placed,
    done: set[int],
    above: list[str],
) -> None:
    """Place an object, and before it what it rests on."""
    thing = drawn[i]
    if i in done:
        return
    if thing.name in above:
        circle = " on ".join([*above[above.index(thing.name) :], thing.name])
        thing.entry.problem("on", f"objects rest on each other in a circle: {circle}")
        done.add(i)
        return
    for name in map(owner_of_ring, thing.on):
        if name in by_name:
            _place(by_name[name], drawn, by_name, placed, done, [*above, thing.name])
    if i in done:
        return
    done.add(i)
    if not thing.entry.sound or thing.body is None:
        return
    borne = _bearers(thing, by_name, placed)
    if borne is None:
        return
    stable = _stable_pose(thing)
    if stable is None:
        return
    number, yaw = stable
    start = _start(thing, borne, number, yaw, placed)
    if start is None:
        return
    found = SceneObject(thing.name, thing.body, thing.stable, start, thing.colour, thing.letter)
    placed.objects[i] = found
    height = placed.height(start.support)
    placed.movables[i] = movable(found, height)
    pose = placed.movables[i]
    assert pose is not None
    for support in (top_of, ring_of):
        top = support(thing.name, thing.body, thing.stable[number], AIR)
        if top is not None:
            placed.add_top(top, pose.pose)


def _keep_to(thing: Drawn, by_name: dict[str, int], placed: Placed) -> None:
    """Note on which supports alone an object may rest."""
    i = by_name[thing.name]
    told, there = placed.objects[i], placed.movables[i]
    if thing.only_on is None or told is None or there is None:
        return
    found = [support_named(thing.entry, "only_on", name, placed, by_name) for name in thing.only_on]
    only_on = frozenset(index for index in found if index is not None)
    if not thing.entry.sound:
        return
    if told.rests.support not in only_on:
        where = placed.supports[told.rests.support].name
        thing.entry.problem("only_on", f"does not name {where!r}, on which it starts")
    names = frozenset(placed.supports[index].name for index in only_on)
    placed.objects[i] = replace(told, only_on=only_on)
    placed.movables[i] = replace(there, only_on=names)


def _bearers(thing: Drawn, by_name: dict[str, int], placed: Placed) -> list[int] | None:
    """The supports that an object rests on, or None where that is not known."""
    if not thing.on:
        assert thing.at is not None
        found = placed.found_at(*thing.at)
        if isinstance(found, str):
            thing.entry.problem("at", found, placed.nearest(*thing.at))
            return None
        return [found]
    indices = [support_named(thing.entry, "on", name, placed, by_name) for name in thing.on]
    return None if None in indices else [i for i in indices if i is not None]


def support_named(
    entry: Entry, key: str, name: str, placed: Placed, by_name: dict[str, int]
) -> int | None:
    """The number of a support; None, with a problem, where nothing can rest on what is named."""
    index = placed.index(name)
    if index is None:  # what has no other place has that around its knob
        index = placed.index(name_of_ring(name))
    if index is not None:
        return index
    if owner_of_ring(name) in by_name:
        if placed.objects[by_name[owner_of_ring(name)]] is not None:
            entry.problem(
                key,
                f"nothing can rest on {name!r}",
                "its top is not level, or too narrow for its height"
                if name in by_name
                else "it is not level all around a knob or a hole",
            )
        else:
            entry.sound = False  # what is wrong with the one below is told there
        return None
    boards = [s.name for s in placed.furniture.boards if s.owner == name]
    if boards:
        entry.problem(key, f"{name!r} is a shelf", f"its boards are {', '.join(boards)}")
    elif name in placed.furniture.names:
        what = placed.furniture.names[name]
        if what == "wall":
            entry.problem(key, f"{name!r} is a wall: nothing rests on it")
        else:
            entry.sound = False
    else:
        names = [s.name for s in placed.supports]
        entry.problem(
            key,
            f"there is no table, board, bin or object named {name!r}",
            known("there are", name, names),
        )
    return None


def _stable_pose(thing: Drawn) -> tuple[int, float] | None:
    """The number of the stable pose that is meant, and the heading."""
    assert thing.body is not None
    rotation = rotation_from_rpy(*thing.rpy)
    number, yaw, off = nearest_stable(thing.body, thing.stable, rotation)
    if off > SNAP:
        key = "rpy" if thing.entry.has("rpy") else None
        thing.entry.problem(
            key,
            f"does not rest like that: the nearest pose in which it does not tip over is "
            f"{math.degrees(off):.0f} degrees away",
            f"write `rpy = {_rpy_of(thing.stable[number], yaw)}`",
        )
        return None
    return number, yaw


def _rpy_of(stable: StablePose, yaw: float) -> list[float]:
    r = rotation_from_rpy(0.0, 0.0, yaw) @ stable.pose[:, :3]
    pitch = math.asin(min(1.0, max(-1.0, -float(r[2, 0]))))
    if abs(r[2, 0]) > 1 - 1e-9:
        angles = (0.0, pitch, math.atan2(-r[0, 1], r[1, 1]))
    else:
        angles = (math.atan2(r[2, 1], r[2, 2]), pitch, math.atan2(r[1, 0], r[0, 0]))
    return [round(math.degrees(angle), 1) + 0.0 for angle in angles]


def _start(thing: Drawn, borne: list[int], number: int, yaw: float, placed: Placed) -> Start | None:
    """Where the object rests; a problem where it would fall, or does not fit in."""
    entry, stable = thing.entry, thing.stable[number]
    supports = [placed.world[i] for i in borne]
    heights = [placed.height(i) for i in borne]
    if max(heights) - min(heights) > LEVEL:
        entry.problem(
            "on", f"what it rests on differs in height by {max(heights) - min(heights):.3g} m"
        )
        return None
    x, y = thing.at or _middle_of(supports)
    if entry.has("bottom") and not _right_bottom(entry, supports[0], heights[0]):
        return None
    pose = resting_pose(stable, x, y, heights[0], yaw)
    assert thing.body is not None
    weight = pose[:, :3] @ thing.body.centre + pose[:, 3]
    if len(supports) == 1 and not contains(supports[0], float(weight[0]), float(weight[1])):
        name = supports[0].name
        cx, cy = float(supports[0].pose[0, 3]), float(supports[0].pose[1, 3])
        entry.problem(
            "at",
            f"({x:g}, {y:g}) is not on {name!r}",
            f"the middle of {name!r} is at ({cx:g}, {cy:g})",
        )
        return None
    if len(supports) > 1 and not _between(supports, float(weight[0]), float(weight[1])):
        entry.problem("at", f"({x:g}, {y:g}) is not between {' and '.join(thing.on)}")
        return None
    if not _goes_over(thing, stable, supports):
        return None
    lowest = min(s.clearance for s in supports)
    if stable.height > lowest:
        entry.problem(
            "on", f"it is {stable.height:.3g} m high, {thing.on[0]!r} leaves {lowest:.3g} m"
        )
        return None
    return Start(borne[0], number, x, y, yaw, tuple(borne[1:]))


def _goes_over(thing: Drawn, stable: StablePose, supports: Sequence[Support]) -> bool:
    """Whether an object can be put over the pegs of what it rests on; a problem where not."""
    assert thing.body is not None
    for support in supports:
        if support.peg is None or not support.peg.height:
            continue
        hollow = hollow_of_body(thing.body, stable.pose)
        if hollow is None or not hollow.goes_over(support.peg):
            has = (
                "it has no hollow around its middle there"
                if hollow is None
                else f"its hollow is {2 * hollow.radius:.3g} m wide and {hollow.depth:.3g} m deep"
            )
            thing.entry.problem(
                "on",
                f"does not go over {support.name!r}: {has}",
                f"{2 * (support.peg.radius + PLAY):.3g} m and "
                f"{support.peg.height + ABOVE:.3g} m are needed",
            )
            return False
    return True


def _middle_of(supports: Sequence[Support]) -> tuple[float, float]:
    xs, ys = zip(*((float(s.pose[0, 3]), float(s.pose[1, 3])) for s in supports), strict=True)
    return sum(xs) / len(xs), sum(ys) / len(ys)


def _between(supports: Sequence[Support], x: float, y: float) -> bool:
    """Whether a point is in the convex hull of some supports."""
    corners = [
        (sx * s.half[0], sy * s.half[1], s) for s in supports for sx in (-1, 1) for sy in (-1, 1)
    ]
    points = []
    for lx, ly, s in corners:
        c, q = float(s.pose[0, 0]), float(s.pose[1, 0])
        points.append(
            (float(s.pose[0, 3]) + c * lx - q * ly, float(s.pose[1, 3]) + q * lx + c * ly)
        )
    # Outside, some direction has the point beyond all corners: those of the lines between two.
    for ax, ay in points:
        for bx, by in points:
            nx, ny = by - ay, ax - bx
            length = math.hypot(nx, ny)
            if length < 1e-12:
                continue
            reach = max(nx * px + ny * py for px, py in points)
            if nx * x + ny * y > reach + 1e-9 * length:
                return False
    return True


def _right_bottom(entry: Entry, support: Support, rest: float) -> bool:
    bottom = entry.number("bottom")
    if not entry.sound:
        return False
    hint = "leave `bottom` out: objects rest on what they are on"
    if abs(bottom - rest) <= 1e-6:
        return True
    inside = f"the object is inside {support.name!r}: " if bottom < rest - AIR else ""
    entry.problem(
        "bottom", f"{inside}objects on {support.name!r} rest at {rest:g} m, not {bottom:g} m", hint
    )
    return False


def _sort_tops(placed: Placed, fixed: int, by_name: dict[str, int]) -> None:
    order = sorted(
        range(fixed, len(placed.supports)), key=lambda i: by_name[placed.supports[i].owner]
    )
    moved = {old: fixed + new for new, old in enumerate(order)}
    chosen = [*range(fixed), *order]
    placed.supports = [placed.supports[i] for i in chosen]
    placed.world = [placed.world[i] for i in chosen]
    for k, thing in enumerate(placed.objects):
        if thing is not None:
            rests = thing.rests
            start = Start(
                moved.get(rests.support, rests.support), rests.stable, rests.x, rests.y, rests.yaw,
                tuple(moved.get(i, i) for i in rests.others),
            )  # fmt: skip
            placed.objects[k] = replace(thing, rests=start)


def point_in(support: Support, x: float, y: float) -> tuple[float, float]:
    """A point of the world in the frame of a support."""
    return local(support, x, y)
