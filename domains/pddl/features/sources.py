"""Where the bits of a predicate are: in the state, or fixed by task or goal."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from domains.pddl.features.images import image_of
from domains.pddl.features.rows import Image, Mask, bits_of, of_pairs, strided
from domains.pddl.ground.layout import Box
from domains.pddl.ground.reach import Values
from domains.pddl.ground.task import GroundTask

NARROW = 64
"""Where the last of two arguments can be at most so many, what the first can be is computed of all
rows at once ..."""

MANY_ROWS = 32
"""... if there are more of them than this."""


@dataclass(frozen=True)
class Changing:
    """A predicate that actions change. All methods take the state's bits."""

    box: Box

    @property
    def mask(self) -> Mask:
        """The bits of a state that it looks at."""
        return self.box.mask

    def holds(self, bits: int, values: Values) -> bool:
        """Whether an atom is true."""
        bit = self.box.bit(values)
        return bit is not None and bool(bits >> bit & 1)

    def tuples(self, bits: int) -> Iterable[Values]:
        """The atoms that are true."""
        values = self.box.values
        return [values(bit) for bit in bits_of(bits & self.box.mask)]

    def rows(self, bits: int) -> dict[int, Mask]:
        """Those of two arguments, as rows."""
        box = self.box
        (low, columns), width = box.lows, box.widths[1]
        block = bits >> box.offset & (1 << box.size) - 1
        full = (1 << width) - 1
        rows = {}
        while block:
            place = ((block & -block).bit_length() - 1) // width
            row = block >> place * width & full
            rows[low + place] = row << columns
            block ^= row << place * width
        return rows

    @cached_property
    def _firsts(self) -> Mask:
        """Of two arguments: the first place of every row."""
        height, width = self.box.widths
        return sum(1 << row * width for row in range(height))

    def first_arguments(self, bits: int, places: Mask) -> Mask:
        """Of two arguments: what the first can be where the last is at one of some places of a
        row."""
        box, found = self.box, 0
        block = bits >> box.offset
        for place in bits_of(places):
            found |= block >> place & self._firsts
        return strided(found, box.widths[1]) << box.lows[0]

    def last(self, bits: int, values: Values) -> Mask:
        """What the last argument can be after given ones."""
        box = self.box
        place = box.offset
        for value, low, width, stride in zip(
            values, box.lows, box.widths, box.strides, strict=False
        ):
            if not 0 <= value - low < width:
                return 0
            place += (value - low) * stride
        return (bits >> place & (1 << box.widths[-1]) - 1) << box.lows[-1]


@dataclass(frozen=True)
class Fixed:
    """A predicate that never changes, or what the goal says of one."""

    atoms: frozenset[Values]

    mask: Mask = 0

    @cached_property
    def _rows(self) -> dict[int, Mask]:
        return of_pairs((values[0], values[1]) for values in self.atoms)

    @cached_property
    def _last(self) -> dict[Values, Mask]:
        found: dict[Values, Mask] = {}
        for values in self.atoms:
            found[values[:-1]] = found.get(values[:-1], 0) | 1 << values[-1]
        return found

    @cached_property
    def columns(self) -> dict[int, Mask]:
        """Of two arguments: what the first can be, by the last."""
        return of_pairs((values[1], values[0]) for values in self.atoms)

    @cached_property
    def image(self) -> Image:
        """Of two arguments: what a set is related to, ..."""
        return image_of(self._rows)

    @cached_property
    def preimage(self) -> Image:
        """... and what is related to a set."""
        return image_of(self.columns)

    @cached_property
    def symmetric(self) -> bool:
        """Whether two arguments can be exchanged."""
        return self._rows == self.columns

    def holds(self, _bits: int, values: Values) -> bool:
        """Whether an atom is true."""
        return values in self.atoms

    def tuples(self, _bits: int) -> Iterable[Values]:
        """The atoms that are true."""
        return self.atoms

    def rows(self, _bits: int) -> dict[int, Mask]:
        """Those of two arguments, as rows."""
        return self._rows

    def last(self, _bits: int, values: Values) -> Mask:
        """What the last argument can be after given ones."""
        return self._last.get(values, 0)


Source = Changing | Fixed


@dataclass(frozen=True)
class WantedRows:
    """The atoms `q(x, y)` for all `p(x, y)` of a `p` that never changes: their bits are `mask`.
    `never` is the set of the x that want an atom which can never be true."""

    source: Changing
    never: Mask
    mask: Mask

    def lacking(self, bits: int) -> Mask:
        """The x of which an atom is not true."""
        missing, box = self.mask & ~bits, self.source.box
        if missing.bit_count() > MANY_ROWS and box.widths[1] <= NARROW:
            return self.never | self.source.first_arguments(missing, (1 << box.widths[1]) - 1)
        found = self.never
        for bit in bits_of(missing):
            found |= 1 << box.lows[0] + (bit - box.offset) // box.widths[1]
        return found


def wanted_rows(first: Fixed, second: Changing) -> WantedRows:
    """What `p(x, _) <= q(x, _)` asks for."""
    never = mask = 0
    for values in first.atoms:
        place = second.box.bit(values)
        if place is None:
            never |= 1 << values[0]
        else:
            mask |= 1 << place
    return WantedRows(second, never, mask)


def source(task: GroundTask, predicate: str, goal: bool) -> Source:
    """The bits of a predicate in states of a task, or of what its goal says."""
    if goal:
        return Fixed(task.goal_atoms.get(predicate, frozenset()))
    if predicate in task.static:
        return Fixed(task.static[predicate])
    box = task.layout.boxes.get(predicate)
    # A predicate that changes, but in this task can never be true.
    return Fixed(frozenset()) if box is None else Changing(box)
