"""A smallest set of things to take away so that something becomes possible.

Implicit hitting sets (Ignatiev, Previti, Liffiton & Marques-Silva, Smallest MUS extraction with
minimal hitting set dualization, CP 2015, turned round): what is impossible without a set S is so
without any subset of S, so that of what a largest such S leaves, something has to go. A smallest
set that hits all of these is either possible, and then a smallest one, or gives another of them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Generic, TypeVar

T = TypeVar("T", bound=Hashable)


@dataclass(frozen=True)
class Smallest(Generic[T]):
    """Things without which it is possible: `proved` tells whether it is known that no fewer do."""

    things: tuple[T, ...]
    proved: bool


class _TimeIsOverError(Exception):
    pass


def smallest(
    things: Sequence[T], possible: Callable[[frozenset[T]], bool], seconds: float
) -> Smallest[T] | None:
    """A smallest set of things without which it is possible, as far as that is found out in time;
    None if it is possible with all of them, not even without all, or nothing was found in time.

    `possible(gone)` must stay true when more is gone.
    """
    return _Search(things, possible, seconds).run()


class _Search(Generic[T]):
    def __init__(
        self, things: Sequence[T], possible: Callable[[frozenset[T]], bool], seconds: float
    ) -> None:
        self.things = tuple(things)
        self.ask = possible
        self.deadline = time.process_time() + seconds
        self.known: dict[frozenset[T], bool] = {}
        self.best: tuple[T, ...] | None = None

    def run(self) -> Smallest[T] | None:
        try:
            return self._run()
        except _TimeIsOverError:
            return None if self.best is None else Smallest(self.best, False)

    def _run(self) -> Smallest[T] | None:
        if self._possible(frozenset()) or not self._possible(frozenset(self.things)):
            return None
        self.best = self._irreducible()
        if len(self.best) == 1:
            return Smallest(self.best, True)
        cores: list[frozenset[T]] = []
        while True:
            chosen = _hitting(self.things, cores)
            if len(chosen) >= len(self.best):
                return Smallest(self.best, True)
            if self._possible(frozenset(chosen)):
                return Smallest(chosen, True)
            cores.append(frozenset(self.things) - self._grown(frozenset(chosen)))

    def _possible(self, gone: frozenset[T]) -> bool:
        found = self.known.get(gone)
        if found is None:
            if time.process_time() > self.deadline:
                raise _TimeIsOverError
            found = self.known[gone] = self.ask(gone)
        return found

    def _irreducible(self) -> tuple[T, ...]:
        """A set of which nothing can stay: halves of what is left are put back while they can."""
        gone, size = list(self.things), len(self.things)
        while size := size // 2 or (1 if size > 1 else 0):
            start = 0
            while start < len(gone):
                rest = gone[:start] + gone[start + size :]
                if self._possible(frozenset(rest)):
                    gone = rest
                    self.best = tuple(gone)
                else:
                    start += size
        return tuple(gone)

    def _grown(self, gone: frozenset[T]) -> frozenset[T]:
        """A largest set around `gone` without which it is still impossible."""
        pending = [[thing for thing in self.things if thing not in gone]]
        while pending:
            part = pending.pop()
            if not part:
                continue
            if not self._possible(gone | frozenset(part)):
                gone |= frozenset(part)
            elif len(part) > 1:
                pending += [part[len(part) // 2 :], part[: len(part) // 2]]
        return gone


def _hitting(things: Sequence[T], cores: Sequence[frozenset[T]]) -> tuple[T, ...]:
    """A smallest set with something of each core."""
    useful = [thing for thing in things if any(thing in core for core in cores)]
    for size in range(len(useful) + 1):
        for chosen in combinations(useful, size):
            if all(not core.isdisjoint(chosen) for core in cores):
                return chosen
    raise AssertionError("every core has a thing")
