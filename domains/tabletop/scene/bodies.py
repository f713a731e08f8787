"""The bodies of objects in a scene file: what `shape` says, and the keys that go with it."""

from __future__ import annotations

import math

from domains.tabletop.scene.furniture import WALL
from runtime.entry import Entry
from runtime.world.body import Body
from runtime.world.load_mesh import load_mesh
from runtime.world.making import open_box, standing
from runtime.world.solids import Box, Capsule, Cylinder, Sphere
from sketchlang.errors import InputError

KEYS = {
    "box": ("size",),
    "cylinder": ("radius", "height"),
    "sphere": ("radius",),
    "capsule": ("radius", "height"),
    "tray": ("size", "wall"),
    "mesh": ("mesh", "scale"),
}
"""The keys that say how large an object of each shape is."""

LARGEST = 5.0
"""Metres an object may measure."""

SMALLEST = 0.001
"""Metres that it measures along each axis, at least."""


def read_body(entry: Entry) -> Body | None:
    """The body of an object, or None where something is wrong with it."""
    default = "mesh" if entry.has("mesh") and not entry.has("shape") else "box"
    shape = entry.one_of("shape", list(KEYS), default)
    if entry.has("shape") and entry.data["shape"] != shape:
        entry.ignore([key for keys in KEYS.values() for key in (*keys, "mass")])
        return None  # without a shape nobody knows which lengths it has
    others = sorted({key for keys in KEYS.values() for key in keys} - set(KEYS[shape]))
    entry.refuse(others, f"a {shape} has none; it has {' and '.join(KEYS[shape])}")
    mass = entry.positive("mass") if entry.has("mass") else None
    if shape == "mesh":
        return _mesh(entry, mass)
    lengths = {key: _lengths(entry, key) for key in KEYS[shape]}
    if not entry.sound:
        return None
    size, radius = lengths.get("size", []), lengths.get("radius", [0.0])[0]
    height = lengths.get("height", [0.0])[0]
    match shape:
        case "box":
            return standing(Box((size[0], size[1], size[2])), mass)
        case "cylinder":
            return standing(Cylinder(radius, height), mass)
        case "sphere":
            return standing(Sphere(radius), mass)
        case "capsule":
            if height <= 2 * radius:
                entry.problem("height", f"a capsule of radius {radius:g} m is higher than its ends")
                return None
            return standing(Capsule(radius, height - 2 * radius), mass)
    wall = lengths["wall"][0]
    if min(size[:2]) <= 2 * wall or size[2] <= wall:
        entry.problem("wall", f"nothing is left inside of walls of {wall:g} m")
        return None
    return open_box((size[0], size[1], size[2]), wall, mass)


def _lengths(entry: Entry, key: str) -> list[float]:
    match key:
        case "size":
            lengths = entry.positives(key, 3)
        case "wall":
            return [entry.positive(key, WALL)]
        case _:
            lengths = [entry.positive(key)]
    if max(lengths) > LARGEST:
        entry.problem(key, f"an object may measure {LARGEST:g} m at most")
    if min(lengths) < SMALLEST:
        entry.problem(key, f"an object measures {1000 * SMALLEST:g} mm at least")
    return lengths


def _mesh(entry: Entry, mass: float | None) -> Body | None:
    name, scale = entry.text("mesh"), entry.positive("scale", 1.0)
    if not entry.sound:
        return None
    try:
        return load_mesh(entry.document.path.parent / name, scale, mass)
    except InputError as error:
        entry.problem("mesh", f"{error.place}: {error.message}", error.hint)
        return None


def orientation(entry: Entry) -> tuple[float, float, float]:
    """Roll, pitch and yaw of an object, radians."""
    if entry.has("rpy"):
        entry.refuse(["yaw"], "`rpy` says the heading already")
        roll, pitch, yaw = entry.numbers("rpy", 3)
        return math.radians(roll), math.radians(pitch), math.radians(yaw)
    return 0.0, 0.0, math.radians(entry.number("yaw", 0.0))
