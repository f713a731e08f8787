"""Tables of a TOML file that go on after a mistake, so that one run tells all of them.

A value that is not as it should be is noted as a problem, and a harmless one stands in for it;
whoever builds something of an entry asks first whether the entry is `sound`.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from runtime.lines import lines_of
from sketchlang.errors import CollectedInputError, InputError
from sketchlang.reading import read_text, read_toml


class Document:
    """A TOML file, and the problems that were found in it so far."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.data = read_toml(path)
        self.lines = lines_of(read_text(path))
        self._problems: list[tuple[int, int, InputError]] = []
        self._entries: list[Entry] = []
        self.root = Entry(self, self.data, "", 0, "")

    def note(self, line: int | None, where: str, message: str, hint: str | None) -> None:
        """Remember a problem at a line, in the table shown as `where`."""
        place = str(self.path) if line is None else f"{self.path}:{line}"
        error = InputError(message, place=f"{place}: {where}" if where else place, hint=hint)
        if any(str(error) == str(known) for _, _, known in self._problems):
            return  # what stands above several tables is looked at with each of them
        self._problems.append((line or 0, len(self._problems), error))

    def add(self, entry: Entry) -> None:
        """Remember an entry, whose unknown keys are told at the end."""
        self._entries.append(entry)

    @property
    def sound(self) -> bool:
        """Whether nothing was found so far."""
        return not self._problems

    def finish(self) -> None:
        """Tell everything that was found, and keys that nobody asked for: most are misspelt.

        Raises:
            InputError: the problem; `CollectedInputError` of several, in the order of their lines.
        """
        for entry in self._entries:
            entry.refuse_unknown()
        found = [error for _, _, error in sorted(self._problems, key=lambda p: p[:2])]
        if len(found) == 1:
            raise found[0]
        if found:
            raise CollectedInputError(found)


class Entry:
    """One table of the file: `[[kind]]`, the number-th of its kind."""

    def __init__(
        self, document: Document, data: Mapping[str, Any], kind: str, number: int, where: str
    ) -> None:
        self.document, self.data, self.kind, self.order = document, data, kind, number
        self.where = where
        self.sound = True
        self._asked: dict[str, None] = {}
        document.add(self)

    # -- problems ---------------------------------------------------------------------------

    def problem(self, key: str | None, message: str, hint: str | None = None) -> None:
        """Note what is wrong with a key, or with the whole table."""
        self.sound = False
        line = self.document.lines.of(self.kind, self.order, key)
        text = message if key is None else f"{key}: {message}"
        self.document.note(line, self.where, text, hint)

    def refuse_unknown(self) -> None:
        """Note every key that nobody asked for."""
        for key in self.data:
            if key not in self._asked:
                close = difflib.get_close_matches(key, list(self._asked), 1, 0.7)
                hint = f"did you mean {close[0]!r}?" if close else f"keys: {', '.join(self._asked)}"
                line = self.document.lines.of(self.kind, self.order, key)
                self.document.note(line, self.where, f"unknown key {key!r}", hint)

    def refuse(self, keys: Iterable[str], why: str) -> None:
        """Note each of some keys that is given and makes no sense here."""
        for key in keys:
            if self.has(key):
                self.problem(key, why)

    def ignore(self, keys: Iterable[str]) -> None:
        """Let keys pass that mean nothing while another one is wrong."""
        self._asked.update(dict.fromkeys(keys))

    # -- values -----------------------------------------------------------------------------

    def has(self, key: str) -> bool:
        """Whether a key is given."""
        self._asked[key] = None
        return key in self.data

    def text(self, key: str, default: str | None = None) -> str:
        """A string that is not empty."""
        value: object = self._value(key, default, "")
        if not isinstance(value, str):
            self.problem(key, f"expected a string, found {_short(value)}")
            return ""
        if not value and key in self.data:
            self.problem(key, "is empty")
        return value

    def flag(self, key: str, default: bool) -> bool:
        """A truth value."""
        value = self._value(key, default, default)
        if not isinstance(value, bool):
            self.problem(key, f"expected true or false, found {_short(value)}")
            return default
        return value

    def number(self, key: str, default: float | None = None) -> float:
        """A finite number."""
        return self._number(key, self._value(key, default, 1.0))

    def positive(self, key: str, default: float | None = None) -> float:
        """A number above 0."""
        value = self.number(key, default)
        if value <= 0:
            self.problem(key, f"must be positive, found {value:g}")
            return 1.0
        return value

    def numbers(
        self, key: str, count: int | None, default: Sequence[float] | None = None
    ) -> list[float]:
        """A list of numbers, `count` of them where that is given."""
        stand_in = [1.0] * (count or 1)
        value = self._value(key, None if default is None else list(default), stand_in)
        if not isinstance(value, list) or (count is not None and len(value) != count):
            wanted = "a list of numbers" if count is None else f"a list of {count} numbers"
            self.problem(key, f"expected {wanted}, found {_short(value)}")
            return stand_in
        return [self._number(key, item) for item in value]

    def positives(self, key: str, count: int | None) -> list[float]:
        """A list of numbers above 0."""
        values = self.numbers(key, count)
        if min(values, default=1.0) <= 0:
            self.problem(key, f"all must be positive, found {_short(values)}")
            return [1.0] * len(values)
        return values

    def one_of(self, key: str, options: Sequence[str], default: str) -> str:
        """One of some words."""
        value = self.text(key, default)
        if value not in options and value:
            self.problem(key, f"there is no {key} {value!r}", known(f"{key}s", value, options))
            return default
        return value or default

    def names(self, key: str) -> list[str]:
        """A string, or a list of them."""
        value = self._value(key, None, [])
        values = value if isinstance(value, list) else [value]
        if not all(isinstance(item, str) and item for item in values):
            self.problem(key, f"expected a name or a list of names, found {_short(value)}")
            return []
        if not values and key in self.data:
            self.problem(key, "is empty")
        return values

    def tables(self, key: str) -> list[Entry]:
        """The tables of an array (`[[key]]`), none where it is not given."""
        value = self._value(key, [], [])
        if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
            self.problem(key, "expected an array of tables", f"write [[{key}]] above each")
            return []
        return [
            Entry(self.document, item, key, number, f"[[{key}]] {item.get('name', number + 1)}")
            for number, item in enumerate(value)
        ]

    def table(self, key: str) -> Entry:
        """A table (`[key]`) that is given."""
        value = self._value(key, None, {})
        if not isinstance(value, dict):
            self.problem(key, f"expected a table, found {_short(value)}")
            value = {}
        return Entry(self.document, value, key, 0, f"[{key}]")

    def inside(self, key: str) -> list[Entry]:
        """The tables of a list that is written in this one (`key = [{...}, ...]`)."""
        value = self._value(key, [], [])
        if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
            self.problem(key, "expected a list of tables", f"for example: {key} = [{{...}}, ...]")
            return []
        return [_Inside(self, item, key, number) for number, item in enumerate(value)]

    def _value(self, key: str, default: Any, stand_in: Any) -> Any:
        self._asked[key] = None
        if key in self.data:
            return self.data[key]
        if default is not None:
            return default
        close = difflib.get_close_matches(key, [k for k in self.data if k not in self._asked], 1)
        self._asked.update(dict.fromkeys(close))
        hint = f"is {close[0]!r} a slip for it?" if close else None
        self.problem(close[0] if close else None, f"the key {key!r} is missing", hint)
        return stand_in

    def _number(self, key: str, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.problem(key, f"expected a number, found {_short(value)}")
            return 1.0
        if not abs(value) < 1e6:
            self.problem(key, f"expected a number of sensible size, found {_short(value)}")
            return 1.0
        return float(value)


class _Inside(Entry):
    """A table inside another one: its problems are at the line of the key that holds it."""

    def __init__(self, outer: Entry, data: Mapping[str, Any], key: str, number: int) -> None:
        super().__init__(
            outer.document, data, outer.kind, outer.order, f"{outer.where}: {key} {number + 1}"
        )
        self.outer, self.key = outer, key

    def problem(self, key: str | None, message: str, hint: str | None = None) -> None:
        self.sound = False
        line = self.document.lines.of(self.kind, self.order, self.key)
        text = message if key is None else f"{key}: {message}"
        self.document.note(line, self.where, text, hint)


def known(what: str, name: str, names: Iterable[str]) -> str:
    """A hint for a name that nothing has."""
    found = sorted(set(names))
    close = difflib.get_close_matches(name, found, 1)
    shown = ", ".join(found[:20]) + (", ..." if len(found) > 20 else "")
    return f"did you mean {close[0]!r}?" if close else f"{what}: {shown or 'none'}"


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
