"""The part of an SRDF that a robot file takes over: pairs that may touch, and postures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from sketchlang.errors import InputError
from sketchlang.reading import read_xml

HOMES = ("home", "ready", "folded", "tuck", "transport", "rest")
"""Words in the names of postures that a robot can drive in, the best first."""


@dataclass(frozen=True)
class Srdf:
    """Pairs of links whose collisions are disabled; postures by name, of some joints each."""

    pairs: tuple[frozenset[str], ...]
    states: dict[str, dict[str, float]]

    def homes(self) -> list[dict[str, float]]:
        """Postures whose names say that the arm is folded or at home."""
        return [
            state for word in HOMES for name, state in self.states.items() if word in name.lower()
        ]


def read_srdf(path: Path) -> Srdf:
    """Read an SRDF file.

    Raises:
        InputError: it cannot be read or is no SRDF.
    """
    root = read_xml(path)
    if root.tag != "robot":
        raise InputError("is no SRDF: its root is not <robot>", place=str(path))
    pairs = []
    for entry in root.findall("disable_collisions"):
        a, b = entry.get("link1"), entry.get("link2")
        if a and b and a != b:
            pairs.append(frozenset((a, b)))
    states: dict[str, dict[str, float]] = {}
    for state in root.findall("group_state"):
        values = states.setdefault(state.get("name", ""), {})
        for joint in state.findall("joint"):
            try:
                values[joint.get("name", "")] = float(joint.get("value", ""))
            except ValueError:
                continue  # joints with several values are none of an arm's
    return Srdf(tuple(pairs), states)
