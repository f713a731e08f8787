"""Random small scenes in which something may keep a stick from its goal, and the smallest set of
things that does, by brute force: every subset of them, smallest first, is left out of the file and
the rest is planned."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np

from runtime.search.limits import Limits
from runtime.solve import open_task, solve
from sketchlang.checking.checker import CheckedSketch
from sketchlang.errors import InputError

HEAD = """robot_start = [-0.5, 0.0, 0.0]
approaches = ["side"]
[[table]]
name = "left"
at = [0.8, 0.6]
size = [0.8, 0.8]
top = 0.765
[[table]]
name = "right"
at = [0.8, -0.9]
size = [0.6, 0.6]
top = 0.70
[[object]]
name = "a"
size = [0.04, 0.04, 0.2]
at = [{x}, {y}]
[[goal]]
object = "a"
at = [{gx}, {gy}]
on = "right"
"""
STICK = '[[object]]\nname = "{}"\nsize = [0.04, 0.04, 0.2]\nat = [{:.3f}, {:.3f}]\non = "{}"\n'
CRATE = (
    '[[object]]\nname = "{}"\nsize = [0.14, 0.14, 0.3]\nat = [{:.3f}, {:.3f}]\nyaw = {:.0f}\n'
    'on = "{}"\n'
)
WALL = '[[wall]]\nname = "{}"\nat = [{:.3f}, {:.3f}]\nyaw = {:.1f}\nsize = [{:.2f}, 0.02, 1.3]\n'


@dataclass(frozen=True)
class SmallScene:
    """The text of a scene without the things that may be left out, and theirs by name."""

    head: str
    things: dict[str, str]

    def text(self, gone: frozenset[str] = frozenset()) -> str:
        """The scene with some things left out."""
        return self.head + "".join(t for name, t in self.things.items() if name not in gone)


def small_scene(seed: int, most: int = 5) -> SmallScene:
    """A stick in the middle of a table, its goal on another one, three to `most` things around
    one of them."""
    rng = np.random.default_rng(seed)
    at, goal = (0.8, 0.6), (0.8, -0.9)
    head = HEAD.format(x=at[0], y=at[1], gx=goal[0], gy=goal[1])
    things = {}
    ring = rng.uniform(0, 2 * math.pi)
    at_goal = bool(rng.random() < 0.3)
    (x, y), table = (goal, "right") if at_goal else (at, "left")
    number = int(rng.integers(3, most + 1))
    for i in range(number):
        bearing = ring + 2 * math.pi * i / number + rng.uniform(-0.2, 0.2)
        kind = rng.random()
        if kind < 0.45:
            reach = rng.uniform(0.14, 0.2)
            name, turn = f"crate{i}", math.degrees(bearing)
            px, py = x + reach * math.cos(bearing), y + reach * math.sin(bearing)
            things[name] = CRATE.format(name, px, py, turn, table)
        elif kind < 0.8:
            reach, long = rng.uniform(0.08, 0.2), rng.uniform(0.15, 0.45)
            name, turn = f"wall{i}", math.degrees(bearing) + 90
            px, py = x + reach * math.cos(bearing), y + reach * math.sin(bearing)
            things[name] = WALL.format(name, px, py, turn, long)
        else:
            reach, name = rng.uniform(0.06, 0.12), f"stick{i}"
            px, py = x + reach * math.cos(bearing), y + reach * math.sin(bearing)
            things[name] = STICK.format(name, px, py, table)
    return SmallScene(head, things)


def solved(checked: CheckedSketch, folder: Path, text: str) -> bool:
    """Whether the planner alone, without what is asked before and after it, solves a scene."""
    path = folder / "scene.toml"
    path.write_text(text)
    task = open_task(checked, str(path))
    task.reporting.warm_up()
    return solve(task.sketch, task.problem, Limits(), np.random.default_rng(0)).solved


def by_brute_force(checked: CheckedSketch, folder: Path, scene: SmallScene) -> int | None:
    """How many things have to go at the least; None where the scene is no scene, or is not
    solved without all of them."""
    try:
        for size in range(len(scene.things) + 1):
            for gone in combinations(scene.things, size):
                if solved(checked, folder, scene.text(frozenset(gone))):
                    return size
    except InputError:
        return None  # things in one another
    return None
