"""Scene files as text, to be changed by tests."""

from __future__ import annotations

from pathlib import Path

import runtime

TABLES = """
[arena]
inner = 2.5
outer = 2.55
height = 0.4

[[table]]
name = "left"
at = [0.8, 0.6]
yaw = 90.0
size = [0.9, 0.6]
top = 0.765
rest = 0.767

[[table]]
name = "right"
at = [0.8, -0.9]
size = [0.6, 0.6]
top = 0.765
rest = 0.767
"""

TABLE = """
[[table]]
name = "table"
at = [1.2, 0.0]
size = [0.8, 1.2]
top = 0.7
"""

RACK = """
robot_start = [0.0, -1.0, 90.0]
{approaches}
[[table]]
name = "table"
at = [0.0, 0.6]
size = [1.6, 0.8]
top = 0.72
[[shelf]]
name = "rack"
at = [2.2, -0.5]
yaw = 90.0
size = [1.4, 0.4]
boards = [0.75, 1.1]
thickness = 0.02
[[object]]
name = "tin"
shape = "cylinder"
radius = 0.035
height = 0.05
at = [0.0, 0.55]
[[goal]]
object = "tin"
on = "rack/1"
"""
"""A low thing that is to go into a shelf; `approaches` is a line of its own, or nothing."""

SCENE = f"""robot_start = [-0.5, 0.0, 0.0]
{TABLES}
[[wall]]
name = "divider"
at = [0.8, -0.2]
size = [0.6, 0.02, 1.2]

[[object]]
name = "blue1"
size = [0.04, 0.04, 0.2]
at = [0.7, 0.5]
colour = "blue"
letter = "A"

[[object]]
name = "red1"
size = [0.04, 0.05, 0.2]
at = [0.9, 0.7]
yaw = 30.0
colour = "red"
letter = "B"

[[goal]]
colour = "blue"
on = "right"

[[goal]]
object = "red1"
at = [0.9, -1.0]
"""

WORD = SCENE[: SCENE.index("[[goal]]")] + '[[goal]]\nword = "AB"\non = "right"\npitch = 0.07\n'


def write_scene(folder: Path, text: str = SCENE) -> Path:
    """Write a scene file."""
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return path


def example_of_the_documentation() -> str:
    """The scene in `docs/scenes.md`."""
    page = Path(runtime.__path__[0]).parent / "docs" / "scenes.md"
    lines = page.read_text(encoding="utf-8").splitlines()
    return "\n".join(line[4:] for line in lines if line.startswith("    ")) + "\n"
