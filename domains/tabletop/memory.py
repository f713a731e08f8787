"""What a world remembers of questions that it was asked; it could forget all of it at any time."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterable
from typing import Any, TypeVar

T = TypeVar("T")


class Memory:
    """Answers by question. Every table has a name and a bound: the answers that were asked for
    least lately go first."""

    BOUND = 20_000

    def __init__(self) -> None:
        self._tables: dict[str, OrderedDict[Hashable, Any]] = {}

    def table(self, name: str) -> OrderedDict[Hashable, Any]:
        """The answers to questions of one name, the latest last."""
        found = self._tables.get(name)
        if found is None:
            found = self._tables[name] = OrderedDict()
        return found

    def of_tables(self, names: Iterable[str]) -> Memory:
        """A memory that begins with some of the tables of this one, and shares them."""
        other = Memory()
        for name in names:
            other._tables[name] = self.table(name)
        return other

    def answer(self, name: str, question: Hashable, compute: Callable[[], T]) -> T:
        """The answer that is remembered, or what `compute` gives."""
        table = self.table(name)
        if question in table:
            found: T = table[question]
            return found
        answer = compute()
        self.keep(name, question, answer)
        return answer

    def keep(self, name: str, question: Hashable, answer: object) -> None:
        """Remember an answer."""
        table = self.table(name)
        table[question] = answer
        if len(table) > self.BOUND:
            table.popitem(last=False)
