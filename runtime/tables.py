"""Read TOML with the errors that a user needs: file, key, what was expected.

A `Table` hands out values by type and remembers what was asked for, so that a misspelt key
is an error instead of a setting that is silently ignored.
"""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sketchlang import reading
from sketchlang.errors import InputError


def read_toml(path: Path) -> Table:
    """Read a TOML file.

    Raises:
        InputError: it cannot be read or is not TOML.
    """
    return Table(reading.read_toml(path), str(path))


class Table:
    """One table of a TOML file; `place` names the file and the table for messages."""

    def __init__(self, data: Mapping[str, Any], place: str) -> None:
        self._data = data
        self._asked: set[str] = set()
        self._children: list[Table] = []
        self.place = place

    def error(self, key: str, message: str, hint: str | None = None) -> InputError:
        """An error about the value of a key."""
        return InputError(f"{key}: {message}", place=self.place, hint=hint)

    def has(self, key: str) -> bool:
        """Whether the key is given."""
        self._asked.add(key)
        return key in self._data

    def is_text(self, key: str) -> bool:
        """Whether the key is given and holds a string."""
        return self.has(key) and isinstance(self._data[key], str)

    def keys(self) -> list[str]:
        """The keys given, in file order, all counted as asked for."""
        self._asked.update(self._data)
        return list(self._data)

    def _get(self, key: str) -> Any:
        self._asked.add(key)
        if key not in self._data:
            close = difflib.get_close_matches(key, set(self._data) - self._asked, 1)
            raise InputError(
                f"the key {key!r} is missing",
                place=self.place,
                hint=f"{close[0]!r} looks like it: is it misspelt?" if close else None,
            )
        return self._data[key]

    def text(self, key: str, default: str | None = None) -> str:
        """A string."""
        if default is not None and not self.has(key):
            return default
        value = self._get(key)
        if not isinstance(value, str):
            raise self.error(key, f"expected a string, found {value!r}")
        return value

    def number(self, key: str, default: float | None = None) -> float:
        """A finite number."""
        if default is not None and not self.has(key):
            return default
        return self._number(key, self._get(key))

    def positive(self, key: str, default: float | None = None) -> float:
        """A number above 0."""
        value = self.number(key, default)
        if value <= 0:
            raise self.error(key, f"must be positive, found {value:g}")
        return value

    def _number(self, key: str, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.error(key, f"expected a number, found {value!r}")
        if not abs(value) < 1e6:
            raise self.error(key, f"expected a number of sensible size, found {value!r}")
        return float(value)

    def flag(self, key: str) -> bool:
        """True or false."""
        value = self._get(key)
        if not isinstance(value, bool):
            raise self.error(key, f"expected true or false, found {value!r}")
        return value

    def numbers(self, key: str, count: int | None = None) -> list[float]:
        """A list of numbers, of the given length."""
        value = self._get(key)
        if not isinstance(value, list) or (count is not None and len(value) != count):
            wanted = "a list of numbers" if count is None else f"a list of {count} numbers"
            raise self.error(key, f"expected {wanted}, found {value!r}")
        return [self._number(key, item) for item in value]

    def positives(self, key: str, count: int) -> list[float]:
        """A list of numbers above 0, of the given length."""
        values = self.numbers(key, count)
        if min(values, default=1.0) <= 0:
            raise self.error(key, f"all must be positive, found {values}")
        return values

    def all_numbers(self) -> dict[str, float]:
        """Every key of this table with its number."""
        return {key: self.number(key) for key in self.keys()}

    def texts(self, key: str, optional: bool = False) -> list[str]:
        """A list of strings."""
        if optional and not self.has(key):
            return []
        value = self._get(key)
        if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
            raise self.error(key, f"expected a list of strings, found {value!r}")
        return value

    def pairs(self, key: str) -> list[tuple[str, str]]:
        """A list of pairs of strings."""
        value = self._get(key)
        if not isinstance(value, list) or not all(
            isinstance(item, list) and len(item) == 2 for item in value
        ):
            raise self.error(key, "expected a list of pairs of strings")
        return [(str(a), str(b)) for a, b in value]

    def table(self, key: str, optional: bool = False) -> Table:
        """A table inside this one."""
        value = {} if optional and not self.has(key) else self._get(key)
        if not isinstance(value, dict):
            raise self.error(key, f"expected a table, found {value!r}")
        return self._child(value, f"{self.place}: [{key}]")

    def tables(self, key: str) -> list[Table]:
        """An array of tables (`[[key]]`), empty where there is none."""
        if not self.has(key):
            return []
        value = self._get(key)
        if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
            raise self.error(key, "expected an array of tables")
        return [
            self._child(item, f"{self.place}: [[{key}]] {item.get('name', number + 1)}")
            for number, item in enumerate(value)
        ]

    def _child(self, data: Mapping[str, Any], place: str) -> Table:
        child = Table(data, place)
        self._children.append(child)
        return child

    def finish(self) -> None:
        """Refuse keys that nobody asked for: most are misspelt."""
        for key in self._data:
            if key not in self._asked:
                close = difflib.get_close_matches(key, self._asked, 1)
                raise InputError(
                    f"unknown key {key!r}",
                    place=self.place,
                    hint=f"did you mean {close[0]!r}?" if close else None,
                )
        for child in self._children:
            child.finish()
