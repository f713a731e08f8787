"""What may be put on what, by the actions of a benchmark problem's domain.

An action that puts an object on another thing may ask for facts that no action changes: that the
one is smaller than the other, say. Then the object is kept to those things for which they hold.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Collection, Iterator
from pathlib import Path

from domains.pddl.syntax.lists import Item, List, Reader, Word
from sketchlang.source import Source

Fact = tuple[str, ...]


def allowed(domain: Source, facts: Collection[Fact], predicate: str) -> set[tuple[str, str]] | None:
    """The pairs of names for which some action of a domain can make `predicate` true, as far as
    the facts of a problem that no action changes tell; None where they tell nothing.

    Raises:
        PddlError: parentheses do not match.
    """
    lists = Reader(domain).lists()
    actions = [item for item in (lists[0] if lists else ()) if _is(item, ":action")]
    changed = {head for action in actions for head in _changed(_section(action, ":effect"))}
    names = sorted({name for fact in facts for name in fact[1:]})
    found: set[tuple[str, str]] = set()
    for action in actions:
        for put in _atoms(_section(action, ":effect")):
            if put[0] != predicate or len(put) != 3:
                continue
            asked = [
                atom
                for atom in _atoms(_section(action, ":precondition"))
                if atom[0] not in changed and set(atom[1:]) <= set(put[1:])
            ]
            if not any(put[2] in atom for atom in asked):
                return None
            for pair in itertools.permutations(names, 2):
                told = dict(zip(put[1:], pair, strict=True))
                if all((atom[0], *(told[v] for v in atom[1:])) in facts for atom in asked):
                    found.add(pair)
    return found or None


def domain_beside(problem: Source, close: Callable[[Source], Source]) -> Source | None:
    """The file with the domain of a problem, from the problem's folder; None where it is not there.
    `close` adds parentheses that a text lacks at its end.

    Raises:
        InputError: a file cannot be read.
    """
    from domains.pddl.syntax.read import load

    named = re.search(r"\(\s*:domain\s+([^\s()]+)\s*\)", problem.text, re.IGNORECASE)
    if named is None:
        return None
    defined = re.compile(rf"\(\s*define\s*\(\s*domain\s+{re.escape(named[1])}\s*\)", re.IGNORECASE)
    own = Path(problem.name)
    for path in sorted(own.absolute().parent.glob("*.pddl")):
        source = load(path) if path != own.absolute() else None
        if source is not None and defined.search(source.text):
            return close(source)
    return None


def facts_of(section: List | None) -> set[Fact]:
    """The facts of an `:init` section, as words."""
    items = () if section is None else section.items[1:]
    return {fact for item in items for fact in _atoms(item)}


def _is(item: Item, head: str) -> bool:
    return isinstance(item, List) and item.head() == head


def _section(action: Item, keyword: str) -> Item | None:
    """What follows a keyword of an action."""
    items = action.items if isinstance(action, List) else ()
    for item, after in itertools.pairwise(items):
        if isinstance(item, Word) and item.text == keyword:
            return after
    return None


def _atoms(item: Item | None) -> Iterator[Fact]:
    """The atoms of a conjunction that are not negated."""
    if not isinstance(item, List):
        return
    if item.head() == "and":
        for part in item.items[1:]:
            yield from _atoms(part)
    elif item.head() != "not" and all(isinstance(word, Word) for word in item.items):
        yield tuple(word.text for word in item.items if isinstance(word, Word))


def _changed(effect: Item | None) -> Iterator[str]:
    """The predicates that an effect makes true or false."""
    if not isinstance(effect, List):
        return
    if effect.head() in ("and", "not", "when", "forall"):
        for part in effect.items[1:]:
            yield from _changed(part)
    else:
        yield effect.head()
