"""The goal of a benchmark problem, from its PDDL: for each object, where it may end.

Predicates are `on-surface` (an object, a surface or a mark on one) and `on` (an object, what it is
put on). `or` is understood where the alternatives are those of single objects.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Collection
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from domains.pddl.syntax.lists import Item, List, PddlError, Reader, Word
from domains.tabletop.tmp_benchmark.allowed import allowed, domain_beside, facts_of
from domains.tabletop.tmp_benchmark.names import candidates
from sketchlang.source import Source, Span

PREDICATES = ("on-surface", "on")
MOST = 10_000
"""Alternatives of a goal that are multiplied out, at most."""

MOST_MISSING = 3
"""Parentheses that a file may lack at its end."""

Conjunction = frozenset[tuple[str, str]]
"""Pairs of an object and what it is to be on."""


@dataclass(frozen=True)
class Wanted:
    """Names of things: for each object what it may end on, what it starts on by the PDDL, and what
    alone it may ever be put on, where the actions of that say so."""

    goals: dict[str, list[str]]
    start: dict[str, str]
    only_on: dict[str, list[str]] = field(default_factory=dict)


def read_wanted(source: Source, things: Collection[str], domain: Source | None = None) -> Wanted:
    """The goal and the start of a PDDL problem, and what its domain keeps objects to.

    Raises:
        PddlError: there is no goal, a name stands for no thing or for several, or the goal says
            what a scene cannot say.
    """
    reader = _Wanted(source, things)
    goal = reader.section(":goal")
    if goal is None or len(goal.items) != 2:
        raise reader.error("no goal is given", goal or reader.all)
    start = reader.section(":init")
    facts = () if start is None else start.items[1:]
    begins = {}
    for fact in facts:
        if isinstance(fact, List) and fact.head() in PREDICATES:
            # The XML says where things are: what the PDDL says of others does no harm.
            with suppress(PddlError):
                name, place = reader.fact(fact)
                begins[name] = place
    only_on = {} if domain is None else reader.kept_to(domain, start)
    return Wanted(reader.alternatives(goal), begins, only_on)


class _Wanted(Reader):
    def __init__(self, source: Source, things: Collection[str]) -> None:
        super().__init__(source)
        self.things = things
        lists = self.lists()
        self.all = lists[0] if lists else List((), Span(0, 0))

    def section(self, head: str) -> List | None:
        found = [item for item in self.all if isinstance(item, List) and item.head() == head]
        return found[0] if found else None

    def thing(self, word: Item) -> str:
        if not isinstance(word, Word):
            raise self.error("expected a name", word)
        found = candidates(word.text, self.things)
        if not found:
            raise self.error(f"nothing in the XML file is called like `{word.text}`", word)
        if len(found) > 1:
            shown = ", ".join(found[:4])
            raise self.error(f"`{word.text}` can stand for several things: {shown}", word)
        return found[0]

    def fact(self, item: List) -> tuple[str, str]:
        if len(item.items) != 3:
            raise self.error(f"`{item.head()}` takes an object and what it is on", item)
        return self.thing(item.items[1]), self.thing(item.items[2])

    def kept_to(self, domain: Source, start: List | None) -> dict[str, list[str]]:
        """What alone each object may be put on, where the actions of a domain say so."""
        found: dict[str, list[str]] = {}
        facts = facts_of(start)
        for predicate in PREDICATES:
            for names in sorted(allowed(domain, facts, predicate) or ()):
                things = [candidates(name, self.things) for name in names]
                if all(len(each) == 1 for each in things):
                    (one,), (other,) = things
                    found.setdefault(one, []).append(other)
        return found

    def alternatives(self, goal: List) -> dict[str, list[str]]:
        """What each object may end on, if the objects can be told apart."""
        ways = self._ways(goal.items[1])
        found: dict[str, list[str]] = {}
        for way in ways:
            if len({name for name, _ in way}) < len(way):
                raise self.error("an object is to be on two things at once", goal)
            for name, place in sorted(way):
                places = found.setdefault(name, [])
                if place not in places:
                    places.append(place)
        objects = {frozenset(name for name, _ in way) for way in ways}
        if len(objects) > 1 or len(set(ways)) != math.prod(map(len, found.values())):
            raise self.error(
                "the alternatives of this goal hang together: only a choice for each object by "
                "itself is supported",
                goal,
            )
        return found

    def _ways(self, item: Item) -> list[Conjunction]:
        if not isinstance(item, List):
            raise self.error("expected a formula", item)
        match item.head():
            case "and":
                parts = [self._ways(part) for part in item.items[1:]]
                if math.prod(map(len, parts)) > MOST:
                    raise self.error(f"has more than {MOST} alternatives", item)
                return [frozenset().union(*way) for way in itertools.product(*parts)]
            case "or":
                return [way for part in item.items[1:] for way in self._ways(part)]
            case "on-surface" | "on":
                return [frozenset([self.fact(item)])]
            case head:
                known = ", ".join(f"`{name}`" for name in PREDICATES)
                hint = f"a scene can want {known}, joined by `and` and `or`"
                raise self.error(f"`{head}` is not supported in a goal", item, hint)


def read_wanted_file(path: Path, things: Collection[str]) -> tuple[Wanted, list[str]]:
    """The same for a file, and notes on it.

    The benchmark's own files lack their last parenthesis.
    """
    from domains.pddl.syntax.read import load

    source = load(path)
    whole, missing = _closed(source)
    wanted = read_wanted(whole, things, domain_beside(whole, lambda found: _closed(found)[0]))
    if not missing:
        return wanted, []
    lacks = "1 parenthesis is" if missing == 1 else f"{missing} parentheses are"
    return wanted, [f"{path.name}: {lacks} never closed: closed at its end"]


def _closed(source: Source) -> tuple[Source, int]:
    """A text with the few parentheses that it lacks at its end, and how many these are."""
    code = re.sub(r";[^\n]*", "", source.text)
    missing = code.count("(") - code.count(")")
    if not 0 < missing <= MOST_MISSING:
        return source, 0
    return Source(source.name, source.text + "\n" + ")" * missing), missing
