"""Small hand-made tasks on two tables, `left` and `right`, at y = 0.6 and y = -0.9."""

from __future__ import annotations

from pathlib import Path

from domains.tabletop.problem import TabletopProblem
from domains.tabletop.scene.load import load_scene
from domains.tabletop.world import TabletopWorld
from runtime.robot.load import load_robot
from tests.tabletop.scene.texts import TABLES, write_scene

ON_RIGHT = '[[goal]]\nobject = "{}"\non = "right"\n'
AT = '[[goal]]\nobject = "{}"\nat = [{}, {}]\n'


def stick(name: str, x: float, y: float, more: str = "") -> str:
    """A stick of 4 cm by 4 cm."""
    return f'[[object]]\nname = "{name}"\nsize = [0.04, 0.04, 0.2]\nat = [{x}, {y}]\n{more}\n'


def task(folder: Path, *entries: str, approaches: str = '["side"]') -> TabletopWorld:
    """The task of a scene with the given objects and goals, taken from the side."""
    text = (
        f"robot_start = [-0.5, 0.0, 0.0]\napproaches = {approaches}\n"
        + TABLES
        + "\n"
        + "\n".join(entries)
    )
    return TabletopWorld.of(load_scene(write_scene(folder, text)), load_robot("tiago"))


def problem(folder: Path, *entries: str) -> TabletopProblem:
    """The same, ready to be searched."""
    return TabletopProblem(task(folder, *entries), seed=0)
