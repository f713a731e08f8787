"""Scenes of the open world, drawn at random: one thing, its way to a place, all else as it falls.

`SCENES` maps a name to a function from a seed to the text of a scene file. Where tables, boards and
the robot are is drawn too, so that twenty seeds are twenty rooms.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

MUG = Path(__file__).resolve().parents[1] / "domains" / "kitchen" / "meshes" / "mug.obj"

THINGS = {
    "cube": "size = [0.05, 0.05, 0.05]",
    "carton": "size = [0.3, 0.08, 0.05]",
    "jutting": "size = [0.3, 0.2, 0.05]\nmass = 0.5",
    "can": 'shape = "cylinder"\nradius = 0.033\nheight = 0.12',
    "stick": "size = [0.2, 0.04, 0.04]",
    "plank": "size = [0.6, 0.05, 0.04]\nmass = 0.4",
    "mug": f'shape = "mesh"\nmesh = "{MUG}"',
}
PLACES = {"shelf": "shelf/2", "bin": "bin"}
JUTS = 0.08
"""Metres by which the jutting carton hangs over the edge of its table."""

CUBE = 0.05
CLEAR = 0.002
"""Metres between neighbours in the lowest row of the pyramid."""


def moved(thing: str, place: str, seed: int) -> str:
    """A thing on a table, with a shelf of two boards and a bin on a second table about it."""
    rng = random.Random(f"{thing} {place} {seed}")
    top = rng.uniform(0.65, 0.8)
    x, y, yaw = 1.2 + rng.uniform(-0.25, 0.1), rng.uniform(-0.3, 0.3), rng.uniform(0, 360)
    if thing == "jutting":
        x, yaw = 0.8 + 0.15 - JUTS, 0.0
    upper = rng.uniform(0.8, 1.0)
    return "\n".join(
        [
            _start(rng),
            _table("table", (1.2, 0.0), (0.8, 1.2), top),
            f'[[shelf]]\nname = "shelf"\nat = [{-1.4 + rng.uniform(-0.1, 0.1):.3f}, 0.9]',
            f"yaw = {rng.uniform(-30, 30):.1f}\nsize = [0.4, 0.9]",
            f"boards = [{upper - rng.uniform(0.35, 0.45):.3f}, {upper:.3f}]\n",
            _table("side", (0.0, -1.5), (0.8, 0.6), rng.uniform(0.4, 0.6)),
            '[[bin]]\nname = "bin"\nat = [0.0, -1.5]\nsize = [0.5, 0.4]\nheight = 0.12',
            'wall = 0.01\non = "side"\n',
            _object(thing, THINGS[thing], (x, y), "table", yaw),
            f'[[goal]]\nobject = "{thing}"\non = "{PLACES[place]}"\n',
        ]
    )


def tower(seed: int) -> str:
    """Three cubes become a tower."""
    rng = random.Random(seed)
    lines = [_start(rng), _table("bench", (1.2, 0.0), (0.8, 1.4), rng.uniform(0.65, 0.8))]
    for name, y in zip("abc", (-0.45, -0.25, -0.05), strict=True):
        at = (1.0 + rng.uniform(-0.05, 0.05), y + rng.uniform(-0.04, 0.04))
        lines.append(_cube(name, at, "bench", rng.uniform(0, 90)))
    at = f"[{1.0 + rng.uniform(-0.05, 0.05):.3f}, {rng.uniform(0.3, 0.5):.3f}]"
    return "\n".join([*lines, f'[[goal]]\nobject = "a"\nat = {at}\n', *_stacked("abc")])


def tower_moved(seed: int) -> str:
    """A tower of three cubes is moved, cube by cube, to the other end of its table."""
    rng = random.Random(seed)
    lines = [_start(rng), _table("bench", (1.2, 0.0), (0.8, 1.4), rng.uniform(0.65, 0.8))]
    at = (1.0 + rng.uniform(-0.05, 0.1), rng.uniform(-0.5, -0.3))
    lines += [_cube("a", at, "bench", rng.uniform(0, 90)), _cube("b", at, "a", 0.0)]
    lines += [_cube("c", at, "b", 0.0)]
    to = f"[{1.0 + rng.uniform(-0.05, 0.1):.3f}, {rng.uniform(0.3, 0.5):.3f}]"
    return "\n".join([*lines, f'[[goal]]\nobject = "a"\nat = {to}\n', *_stacked("abc")])


def pyramid(seed: int) -> str:
    """Six cubes become a pyramid: three below, two across their joints, one on top."""
    rng = random.Random(seed)
    lines = [_start(rng), _table("bench", (1.2, 0.0), (0.8, 1.6), rng.uniform(0.65, 0.8))]
    for number, name in enumerate("abcdef"):
        at = (0.98 + 0.13 * (number % 2), 0.3 + 0.13 * (number // 2))
        shifted = (at[0] + rng.uniform(-0.02, 0.02), at[1] + rng.uniform(-0.02, 0.02))
        lines.append(_cube(name, shifted, "bench", rng.uniform(0, 90)))
    x, y, pitch = 1.05 + rng.uniform(-0.05, 0.05), rng.uniform(-0.5, -0.4), CUBE + 2 * CLEAR
    for number, name in enumerate("abc"):
        lines.append(f'[[goal]]\nobject = "{name}"\nat = [{x:.3f}, {y + number * pitch:.3f}]')
        lines.append("yaw = 0.0\ntolerance = 0.003\n")
    for name, below in (("d", '["a", "b"]'), ("e", '["b", "c"]'), ("f", '["d", "e"]')):
        lines.append(f'[[goal]]\nobject = "{name}"\non = {below}\nat = [0.0, {pitch / 2:.3f}]')
        lines.append("yaw = 0.0\ntolerance = 0.005\n")
    return "\n".join(lines)


def tray(seed: int) -> str:
    """A tray with three cubes goes to another table as a whole."""
    rng = random.Random(seed)
    x, y, yaw = 1.1 + rng.uniform(-0.05, 0.05), rng.uniform(-0.2, 0.2), rng.uniform(0, 360)
    shape = 'shape = "tray"\nsize = [0.3, 0.22, 0.04]\nwall = 0.006'
    lines = [
        _start(rng),
        _table("bench", (1.2, 0.0), (0.8, 1.2), rng.uniform(0.65, 0.8)),
        _table("side", (-0.3, 1.5), (1.0, 0.6), rng.uniform(0.65, 0.8)),
        _object("tray", shape, (x, y), "bench", yaw),
    ]
    c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    for name, middle in zip("abc", (-0.09, 0.0, 0.09), strict=True):
        u, v = middle + rng.uniform(-0.01, 0.01), rng.uniform(-0.03, 0.03)
        lines.append(_cube(name, (x + c * u - s * v, y + s * u + c * v), "tray", yaw))
    lines.append('[[goal]]\nobject = "tray"\non = "side"\n')
    lines += [f'[[goal]]\nobject = "{name}"\non = "tray"\n' for name in "abc"]
    return "\n".join(lines)


def grid(pitch: int, top: bool, seed: int) -> str:
    """Sticks of 4 x 4 x 20 cm on one table, `pitch` centimetres apart, 12 blue ones of which go to
    another one; taken from the side, or from the top as well."""
    rng = random.Random(seed * 100 + pitch)
    deep, wide = 60 // pitch if pitch > 6 else 9, 90 // pitch
    cells = [(i, j) for i in range(deep) for j in range(wide)]
    blue = set(rng.sample(cells, 12))
    lines = ["robot_start = [-0.6, 0.0, 0.0]", 'approaches = ["side"]' if not top else ""]
    lines.append(_table("a", (0.8, 0.0), (0.8, 1.1), 0.7))
    lines.append(_table("b", (-1.8, 0.0), (0.8, 1.4), 0.7))
    for i, j in cells:
        at = (
            0.8 + (i - (deep - 1) / 2) * pitch / 100,
            (j - (wide - 1) / 2) * pitch / 100,
        )
        shape = f'size = [0.04, 0.04, 0.2]\ncolour = "{"blue" if (i, j) in blue else "grey"}"'
        lines.append(_object(f"s{i}_{j}", shape, at, "a", 0.0))
    return "\n".join([*lines, '[[goal]]\ncolour = "blue"\non = "b"\n'])


def cabinet(seed: int) -> str:
    """Four cans under a cabinet half a metre above a bench go to an island."""
    rng = random.Random(seed)
    lines = [
        "robot_start = [-1.0, 0.0, 0.0]",
        _table("bench", (0.5, 0.0), (0.6, 2.4), 0.85),
        '[[wall]]\nname = "cabinet"\nat = [0.55, 0.0]\nsize = [0.5, 2.4, 0.6]\nbottom = 1.35\n',
        '[[wall]]\nname = "back"\nat = [0.85, 0.0]\nsize = [0.05, 2.4, 2.0]\n',
        _table("island", (-2.2, 0.0), (0.6, 1.6), 0.85),
    ]
    for number in range(4):
        at = (0.35 + rng.uniform(-0.05, 0.1), -0.6 + 0.4 * number + rng.uniform(-0.1, 0.1))
        lines.append(_object(f"can{number}", THINGS["can"], at, "bench", 0.0))
        lines.append(f'[[goal]]\nobject = "can{number}"\non = "island"\n')
    return "\n".join(lines)


def impossible(what: str, seed: int) -> str:
    """What cannot be: `large` for the gripper, `flat` in the middle of a table, `far` or with a
    goal that is far (`goal`), and a bin that is too `deep`."""
    rng = random.Random(f"{what} {seed}")
    at = (1.1 + rng.uniform(-0.1, 0.1), rng.uniform(-0.2, 0.2))
    cube, goal = _object("c", THINGS["cube"], at, "table", rng.uniform(0, 90)), 'on = "side"'
    if what == "large":
        cube = _object("c", "size = [0.1, 0.1, 0.1]", at, "table", rng.uniform(0, 90))
    if what == "flat":
        cube = _object("c", THINGS["jutting"], (1.2, at[1]), "table", rng.uniform(0, 90))
    if what == "far":
        cube = _object("c", THINGS["cube"], (6.0 + at[0], at[1]), "huge", 0.0)
    if what == "goal":
        goal = f'at = [{6.0 + at[0]:.3f}, {at[1]:.3f}]\non = "huge"'
    lines = [
        _start(rng),
        _table("table", (1.2, 0.0), (0.8, 1.2), 0.7),
        _table("side", (0.0, -1.5), (0.8, 0.6), 0.7),
        _table("huge", (7.0, 0.0), (5.0, 5.0), 0.7),
    ]
    if what == "deep":
        goal = 'on = "well"'
        lines.append(_table("low", (1.2, 1.8), (0.6, 0.6), 0.3))
        lines.append('[[bin]]\nname = "well"\nat = [1.2, 1.8]\nsize = [0.2, 0.2]')
        lines.append(f'height = {rng.uniform(0.55, 0.7):.3f}\nwall = 0.01\non = "low"\n')
    return "\n".join([*lines, cube, f'[[goal]]\nobject = "c"\n{goal}\n'])


def _start(rng: random.Random) -> str:
    place = (rng.uniform(-0.3, 0.1), rng.uniform(-0.2, 0.2), rng.uniform(-180, 180))
    return f"robot_start = [{place[0]:.3f}, {place[1]:.3f}, {place[2]:.1f}]\n"


def _table(name: str, at: tuple[float, float], size: tuple[float, float], top: float) -> str:
    return (
        f'[[table]]\nname = "{name}"\nat = [{at[0]}, {at[1]}]\nsize = [{size[0]}, {size[1]}]\n'
        f"top = {top:.3f}\n"
    )


def _object(name: str, shape: str, at: tuple[float, float], on: str, yaw: float) -> str:
    return (
        f'[[object]]\nname = "{name}"\n{shape}\nat = [{at[0]:.3f}, {at[1]:.3f}]\n'
        f'yaw = {yaw:.1f}\non = "{on}"\n'
    )


def _cube(name: str, at: tuple[float, float], on: str, yaw: float) -> str:
    return _object(name, f"size = [{CUBE}, {CUBE}, {CUBE}]", at, on, yaw)


def _stacked(names: Sequence[str]) -> list[str]:
    pairs = zip(names[1:], names, strict=False)
    return [f'[[goal]]\nobject = "{upper}"\non = "{lower}"\n' for upper, lower in pairs]


MOVED = {f"{thing}-{place}": partial(moved, thing, place) for thing in THINGS for place in PLACES}
BUILT: dict[str, Callable[[int], str]] = {
    "tower": tower,
    "tower-moved": tower_moved,
    "pyramid": pyramid,
    "tray": tray,
    "cabinet": cabinet,
}
GRIDS = {f"grid-{pitch}": partial(grid, pitch, False) for pitch in (8, 7, 6)} | {
    f"grid-{pitch}-top": partial(grid, pitch, True) for pitch in (8, 7, 6)
}
IMPOSSIBLE = {
    f"no-{what}": partial(impossible, what) for what in ("large", "flat", "far", "goal", "deep")
}
SCENES: dict[str, Callable[[int], str]] = MOVED | BUILT | GRIDS | IMPOSSIBLE
