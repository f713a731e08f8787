"""A task file with another state at the start."""

from __future__ import annotations

from domains.pddl.state import State, atom_texts
from domains.pddl.syntax.lists import Item, List, Reader


def started_from(state: State) -> str:
    """The text of a task whose start is this state: what actions may change is written anew in
    `:init`, all else stays as it is."""
    pddl = state.task.pddl
    text, changing = pddl.source.text, pddl.domain.changing()
    (whole,) = Reader(pddl.source).lists()
    sections = [part for part in whole.items if isinstance(part, List)]
    inits = [part for part in sections if part.head() == ":init"]
    kept = [
        text[fact.span.start : fact.span.end]
        for init in inits
        for fact in init.items[1:]
        if _predicate(fact) not in changing
    ]
    lines = "".join(f"\n    {atom}" for atom in (*atom_texts(state), *kept))
    # Before the goal, which every task has; what stood there is cut out, the last part first.
    goal = next(part for part in sections if part.head() == ":goal")
    for part in sorted([*inits, goal], key=lambda part: -part.span.start):
        start, end = part.span.start, part.span.end
        if part is goal:
            text = f"{text[:start]}(:init{lines})\n  {text[start:]}"
        else:
            text = text[:start] + text[end:].lstrip(" \n")
    return text


def _predicate(fact: Item) -> str:
    """The predicate of a fact, which may be negated."""
    if not isinstance(fact, List):
        return ""
    return _predicate(fact.items[1]) if fact.head() == "not" else fact.head()
