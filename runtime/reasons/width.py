"""A subgoal that IW(k) does not get to, since a state on the way has nothing new."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from typing import Any

from runtime.search.retrospect import Found

Finding = dict[str, Any]
Families = Mapping[str, Callable[[Any], Iterable[Hashable]]]


def pruned(
    found: Found, start: Any, done: str, k: int, used: Sequence[str], offered: Families
) -> Finding:
    """The finding about a subgoal of which X allows every action. `used` are the families of
    atoms that the sketch names, `offered` those of the domain."""
    more = _enough(found, start, used, offered)
    what = "the goal" if found.rule == "goal" else f"a subgoal of {found.rule}"
    text = f"{what} is there (`{done}`), but IW({k}) drops a state on the way: nothing in it is new"
    if more:
        text += f": write `atoms {', '.join([*used, more])}`"
    elif k < LARGEST:
        text += f": try --k-max {k + 1}, or a rule for a smaller step"
    return {
        "rule": found.rule,
        "cause": "width",
        "text": text,
        "actions": done,
        "atoms": more,
    }


LARGEST = 3
"""The largest k that the command line takes."""


def _enough(found: Found, start: Any, used: Sequence[str], offered: Families) -> str | None:
    """A family of atoms of which every state on the way has a new one; None if there is none."""
    for name, family in offered.items():
        if name in used:
            continue
        known = set(family(start))
        new = []
        for state in found.states[:-1]:
            atoms = set(family(state))
            new.append(bool(atoms - known))
            known |= atoms
        if all(new):
            return name
    return None
