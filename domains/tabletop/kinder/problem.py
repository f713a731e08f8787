"""A KinDER problem as our planner takes it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from runtime.toml_text import inline
from sketchlang.files import write_text


@dataclass(frozen=True, eq=False)
class Problem:
    """A scene file in parts: its tables in TOML, all but where the robot starts, and the meshes
    that they name. `sketch` is the built-in sketch that solves it; the floor of the scene is
    `lift` metres below the origin of KinDER. `approaches` are those that are thought of; `air` are
    metres between a support and what rests on it, where that is not the usual."""

    sketch: str
    tables: tuple[str, ...]
    approaches: tuple[str, ...] = ("side", "top")
    lift: float = 0.0
    meshes: Mapping[str, str] = field(default_factory=dict)
    air: Mapping[str, float] = field(default_factory=dict)

    def write(self, folder: Path, start: tuple[float, float, float]) -> Path:
        """Write the scene for a robot that starts at x, y and a heading in degrees.

        Raises:
            InputError: the folder cannot be written.
        """
        for name, text in self.meshes.items():
            write_text(folder / name, text)
        x, y, heading = (f"{value:.6f}" for value in start)
        path = folder / "scene.toml"
        head = [
            f"robot_start = [{x}, {y}, {heading}]",
            f"approaches = {_value(self.approaches)}",
        ]
        write_text(path, "\n".join([*head, *self.tables]) + "\n")
        return path


def table(kind: str, **values: object) -> str:
    """One table of a scene file, `[[kind]]`."""
    return "\n".join(
        ["", f"[[{kind}]]", *(f"{key} = {_value(value)}" for key, value in values.items())]
    )


def _value(value: object) -> str:
    return inline(_rounded(value))


def _rounded(value: object) -> object:
    """Numbers to a thousandth of a millimetre."""
    match value:
        case float():
            return round(value, 6)
        case list() | tuple():
            return [_rounded(each) for each in value]
        case dict():
            return {key: _rounded(each) for key, each in value.items()}
    return value
