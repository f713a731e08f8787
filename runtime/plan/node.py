"""Plain data taken apart so that every complaint names the place in the file.

Plans and traces are read with it.
"""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from runtime.world.poses import Floats
from sketchlang import reading
from sketchlang.errors import InputError

LARGEST = 1e6
"""Metres, radians or seconds: no number in a plan or a trace is beyond."""

LONGEST = 36_000.0
"""Seconds that a plan or a trace may take: ten hours."""


def read_json(path: Path) -> Node:
    """The data of a JSON file.

    Raises:
        InputError: it cannot be read or is not JSON.
    """
    return Node(reading.read_json(path), str(path))


class Node:
    """A value in a file, and where it is. Methods raise `InputError` where it is not what
    they are asked for."""

    def __init__(self, value: Any, file: str, where: str = "") -> None:
        self.value, self.file, self.where = value, file, where

    def fail(self, message: str, hint: str | None = None) -> InputError:
        """An error about this value."""
        place = f"{self.file}: {self.where}" if self.where else self.file
        return InputError(message, place=place, hint=hint)

    def __getitem__(self, key: str) -> Node:
        data = self._of(dict, "an object")
        if key not in data:
            raise self.fail(f"the key {key!r} is missing")
        return Node(data[key], self.file, f"{self.where}.{key}" if self.where else key)

    def get(self, key: str) -> Node | None:
        """The value of a key that may be left out; None where it is."""
        return self[key] if key in self._of(dict, "an object") else None

    def only(self, *keys: str) -> None:
        """Refuse an object that has other keys: most are misspelt, and would count for nothing."""
        for key in self._of(dict, "an object"):
            if key not in keys:
                close = difflib.get_close_matches(key, keys, 1)
                hint = f"did you mean {close[0]!r}?" if close else None
                raise self.fail(f"unknown key {key!r}", hint)

    def items(self) -> Iterator[tuple[str, Node]]:
        """Keys and values of an object."""
        return ((key, self[key]) for key in self._of(dict, "an object"))

    def each(self) -> list[Node]:
        """The entries of a list."""
        entries = self._of(list, "a list")
        return [Node(e, self.file, f"{self.where}[{i}]") for i, e in enumerate(entries)]

    def text(self) -> str:
        """A string that can be written."""
        found: str = self._of(str, "a string")
        try:
            found.encode()
        except UnicodeEncodeError:
            raise self.fail("half of a surrogate pair is no text") from None
        return found

    def flag(self) -> bool:
        """True or false."""
        found: bool = self._of(bool, "true or false")
        return found

    def whole(self) -> int:
        """A whole number."""
        if isinstance(self.value, bool):
            raise self.fail(f"expected a whole number, found {self._shown()}")
        found: int = self._of(int, "a whole number")
        return found

    def number(self) -> float:
        """A finite number."""
        return float(self.numbers(()))

    def optional(self) -> Node | None:
        """None for null."""
        return None if self.value is None else self

    def choice(self, *names: str) -> str:
        """One of some strings."""
        if self.text() not in names:
            raise self.fail(f"expected {' or '.join(map(repr, names))}, found {self._shown()}")
        return self.text()

    def numbers(self, shape: tuple[int | None, ...]) -> Floats:
        """Finite numbers in rows; None in the shape stands for any count but 0."""
        try:
            array = np.array(self.value)
        except ValueError:
            raise self.fail("expected rows of numbers of equal length") from None
        if array.dtype.kind not in "iuf":
            raise self.fail(f"expected numbers, found {self._shown()}")
        fits = array.ndim == len(shape) and all(
            have == want if want is not None else have > 0
            for have, want in zip(array.shape, shape, strict=False)
        )
        if not fits:
            wanted = " x ".join("k" if n is None else str(n) for n in shape) or "one number"
            raise self.fail(f"expected {wanted} numbers, found {self._shown()}")
        array = array.astype(np.float64)
        if not np.isfinite(array).all():
            raise self.fail("numbers must be finite")
        if array.size and np.abs(array).max() > LARGEST:
            raise self.fail(f"numbers must be between -{LARGEST:g} and {LARGEST:g}")
        return array

    def _of(self, kind: type, name: str) -> Any:
        if not isinstance(self.value, kind):
            raise self.fail(f"expected {name}, found {self._shown()}")
        return self.value

    def _shown(self) -> str:
        text = json.dumps(self.value, default=repr)
        return text if len(text) <= 60 else text[:57] + "..."


def name_of(node: Node, names: list[str]) -> str:
    """The name of one of some objects."""
    if node.text() not in names:
        raise node.fail(f"unknown object {node.text()!r}")
    return node.text()


def index_of(node: Node, count: int, what: str) -> int:
    """The number of one of `count` things."""
    if not 0 <= node.whole() < count:
        raise node.fail(f"there is no {what} {node.whole()}")
    return node.whole()


def poses_of(node: Node, count: int) -> Floats:
    """Poses (count, 7): x, y, z and a unit quaternion x, y, z, w."""
    return _unit(node, node.numbers((count, 7)))


def one_pose_of(node: Node) -> Floats:
    """One pose (7,)."""
    pose: Floats = _unit(node, node.numbers((7,))[None])[0]
    return pose


def _unit(node: Node, poses: Floats) -> Floats:
    length = np.linalg.norm(poses[:, 3:], axis=1)
    if np.abs(length - 1).max() > 1e-3:
        raise node.fail("the last four numbers of a pose must be a unit quaternion")
    poses[:, 3:] /= length[:, None]
    return poses
