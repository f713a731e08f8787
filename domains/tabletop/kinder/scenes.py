"""The kinematic 3D environments of KinDER, read from an observation.

What an observation leaves out (tables, boards, walls) is written here as version 0.2.5 has it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable

from domains.tabletop.kinder.observed import CYLINDER, Observation, Thing
from domains.tabletop.kinder.packing import packing
from domains.tabletop.kinder.problem import Problem, table
from domains.tabletop.kinder.slim import slimmed
from domains.tabletop.scene.furniture import AIR
from sketchlang.errors import InputError

SUNK = 0.4
"""Metres by which the robot's floor is below the origin where it works at a table."""

BOARD = (0.60198, 0.254, 0.0127)
SPACING = 0.254
LAYERS = 4
"""The shelf: a board's width, depth and thickness, what is free between two of them, and how many
there are; walls as thick as boards stand at their ends."""

LOWEST = 0.224
"""Metres above the floor at which things count as on the shelf, their middle."""

WALL = 0.01
"""Metres of the walls and floors of open boxes."""

ABOVE = ("top",)
"""What is low is taken from above: a hand from the side could put it down at an edge only."""

HANGS = 0.3
"""Share of a thing's own size that a ledge measures."""


def problem_of(env: str, seen: Observation) -> Problem:
    """The problem that an observation shows.

    Raises:
        InputError: the environment is not one of those that are read.
    """
    for pattern, read in READERS.items():
        if re.fullmatch(pattern, env):
            return read(seen)
    names = ", ".join(NAMES)
    raise InputError(f"there is no reader for the environment {env!r}", hint=f"known: {names}")


def is_known(env: str) -> bool:
    """Whether environments of a name are read."""
    return any(re.fullmatch(pattern, env) for pattern in READERS)


def _table3d(seen: Observation) -> Problem:
    """Any cube is to be held above the table: the nearest."""
    cubes = slimmed(seen.named("cube"))
    nearest = min(cubes, key=lambda cube: math.dist(cube.position[:2], seen.base[:2]))
    return Problem(
        "hold",
        (
            block(seen.things["table"], 0.0),
            *(movable(cube, "table") for cube in cubes),
            table("goal", object=nearest.name, held=True),
        ),
        ABOVE,
    )


def _shelf(seen: Observation) -> Problem:
    """All cubes are to be on the shelf, not on its lowest board."""
    shelf, tops = _boards(seen.things["shelf"])
    cubes = slimmed(seen.named("cube"))
    return Problem(
        "pick_and_place",
        (
            shelf,
            *(movable(cube, "floor") for cube in cubes),
            *(
                _on_any(cube, [i for i, top in tops if top + min(cube.half) > LOWEST])
                for cube in cubes
            ),
        ),
    )


def _cylinders(seen: Observation) -> Problem:
    """All cylinders are to stand on the shelf."""
    shelf, tops = _boards(seen.things["shelf"])
    cylinders = slimmed(seen.named("cylinder"))
    return Problem(
        "pick_and_place",
        (
            shelf,
            *(movable(each, "floor") for each in cylinders),
            *(_on_any(each, [i for i, _ in tops]) for each in cylinders),
        ),
    )


def _boards(shelf: Thing) -> tuple[str, list[tuple[int, float]]]:
    """The shelf, and of each board its number, from 1, and the height of its top."""
    width, depth, thickness = BOARD
    x, y, lowest = shelf.position
    tops = [lowest + k * (SPACING + thickness) + thickness / 2 for k in range(LAYERS)]
    text = table(
        "shelf",
        name="shelf",
        at=[x, y],
        yaw=math.degrees(shelf.yaw),
        size=[width + 2 * thickness, depth],
        boards=tops,
        thickness=thickness,
    )
    return text, list(enumerate(tops, 1))


def _on_any(thing: Thing, boards: list[int]) -> str:
    return table("goal", object=thing.name, any=[{"on": f"shelf/{i}"} for i in boards])


def _obstruction(seen: Observation) -> Problem:
    """The block is to stand within the region, whatever stands there."""
    region, target = seen.things["target_region"], seen.things["target_block"]
    x, y, _ = region.position
    first, *others = slimmed([target, *seen.named("obstruction")], [region])
    tables = [TABLE, block(region, SUNK), movable(first, "table")]
    for thing in others:
        tables += _obstacle(thing, region)
    tables.append(
        table(
            "goal",
            object=target.name,
            on=region.name,
            at=[x, y],
            yaw=math.degrees(region.yaw),
        )
    )
    return Problem("pick_and_place", tuple(tables), ABOVE, SUNK)


def _obstacle(thing: Thing, region: Thing) -> list[str]:
    """A thing on the table or the region. Without gravity it may hang in the air, its middle
    beside the region: then it gets a ledge to stand on, smaller than itself."""
    (x, y, z), (hx, hy, hz) = thing.position, thing.half
    top = region.position[2] + region.half[2]
    if abs(z - hz - top) > region.half[2]:
        return [movable(thing, "table")]
    dx, dy = x - region.position[0], y - region.position[1]
    c, s = math.cos(region.yaw), math.sin(region.yaw)
    if abs(c * dx + s * dy) < region.half[0] and abs(c * dy - s * dx) < region.half[1]:
        return [movable(thing, region.name)]
    name = f"under_{thing.name}"
    size = [HANGS * 2 * hx, HANGS * 2 * hy]
    ledge = table("table", name=name, at=[x, y], size=size, top=top + SUNK, thickness=0.001)
    return [ledge, movable(thing, name)]


def _transport(seen: Observation) -> Problem:
    """The box and all cubes are to be on the table."""
    things = slimmed(seen.named("box") + seen.named("cube"))
    tables = [block(seen.things["table"], 0.0)]
    for thing in things:
        x, y, _ = thing.position
        size = [2 * half for half in thing.half]
        shape = {"shape": "tray", "wall": WALL} if thing.name.startswith("box") else {}
        tables.append(
            table(
                "object",
                name=thing.name,
                **shape,
                size=size,
                at=[x, y],
                yaw=math.degrees(thing.yaw),
                on="floor",
            )
        )
    tables += [table("goal", object=thing.name, on="table") for thing in things]
    return Problem("pick_and_place", tuple(tables), ABOVE)


def _packing(seen: Observation) -> Problem:
    tables, meshes = packing(seen, SUNK, WALL)
    # The parts start above the table, in the air.
    air = max(AIR, min(part.bottom for part in seen.named("part")) - TOP)
    desk = f"{TABLE}\nrest = {TOP + air + SUNK:.6f}"
    return Problem("pick_and_place", (desk, *tables), ABOVE, SUNK, meshes, {"table": air})


def block(thing: Thing, lift: float) -> str:
    """A fixed cuboid as a table: solid where it reaches to the floor."""
    (x, y, z), (hx, hy, hz) = thing.position, thing.half
    top = z + hz + lift
    return table(
        "table",
        name=thing.name,
        at=[x, y],
        yaw=math.degrees(thing.yaw),
        size=[2 * hx, 2 * hy],
        top=top,
        thickness=min(top, 2 * hz),
    )


def movable(thing: Thing, on: str) -> str:
    """A cuboid or a cylinder that rests on something."""
    (x, y, _), (hx, hy, hz) = thing.position, thing.half
    if thing["object_type"] == CYLINDER:
        shape = {"shape": "cylinder", "radius": hx, "height": 2 * hz}
    else:
        shape = {"size": [2 * hx, 2 * hy, 2 * hz]}
    yaw = math.degrees(thing.yaw)
    return table("object", name=thing.name, **shape, at=[x, y], yaw=yaw, on=on)


TOP = 0.075
"""Metres above the origin that the table of Obstruction3D and Packing3D is."""

TABLE = table("table", name="table", at=[0.3, 0.0], size=[0.4, 0.8], top=TOP + SUNK)
"""That table."""

READERS: dict[str, Callable[[Observation], Problem]] = {
    r"Table3D-o\d+": _table3d,
    r"KinematicShelf3D-o\d+": _shelf,
    r"KinematicCylinderShelf3D-o\d+": _cylinders,
    r"Obstruction3D-o\d+": _obstruction,
    r"Transport3D-o\d+": _transport,
    r"Packing3D-p\d+": _packing,
}

NAMES = tuple(pattern.replace(r"\d+", "N") for pattern in READERS)
"""The environments that are read, N the number of things."""

ENVS = (
    *(f"Table3D-o{n}" for n in (1, 2, 3)),
    *(f"KinematicShelf3D-o{n}" for n in (1, 2, 3, 5, 10)),
    *(f"Obstruction3D-o{n}" for n in (0, 1, 2, 3, 4)),
    *(f"Transport3D-o{n}" for n in (1, 2)),
    *(f"KinematicCylinderShelf3D-o{n}" for n in (1, 2, 3)),
    *(f"Packing3D-p{n}" for n in (1, 2, 3)),
)
"""Those that version 0.2.5 has."""
