"""What a robot looks like, apart from what it collides with: a file of rounded shapes.

[colours]
shell = [0.93, 0.93, 0.92]

[[part]]
link = "arm_1_link"
colour = "shell"
form = "tube"                       # rounded_box, turned, cylinder, loft, tube
points = [[0, 0, 0, 0.06], [0.12, 0, 0, 0.05]]
at = [0, 0, 0]                      # and rpy, in degrees
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from runtime.show import forms
from runtime.show.colours import Colour
from runtime.show.forms import Triangles
from runtime.world.poses import rotation_from_rpy


def read_looks(path: Path) -> list[tuple[str, Triangles, Colour]]:
    """Link, triangles in its frame, and colour of each part of a file that comes with us."""
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    colours: Mapping[str, list[float]] = data["colours"]
    found = []
    for part in data["part"]:
        vertices, faces = _form(part)
        rotation = rotation_from_rpy(*np.radians(part.get("rpy", [0.0, 0.0, 0.0])).tolist())
        placed = vertices @ rotation.T + np.array(part.get("at", [0.0, 0.0, 0.0]))
        red, green, blue = colours[part["colour"]]
        found.append((part["link"], (placed, faces), (red, green, blue)))
    return found


def _form(part: Mapping[str, Any]) -> Triangles:
    match part["form"]:
        case "rounded_box":
            return forms.rounded_box(part["size"], part["radius"], 3)
        case "turned":
            return forms.turned(part["profile"], 48)
        case "cylinder":
            return forms.cylinder(part["radius"], part["height"], part.get("bevel", 0.006))
        case "loft":
            return forms.loft(part["sections"], part.get("power", 4.0), part.get("bevel", 0.02))
        case "tube":
            return forms.tube(part["points"])
    raise ValueError(f"{part['form']!r} is no form")
