"""IW(k) tests novelty again among siblings: the first that is executable takes the atom."""

from __future__ import annotations

from types import SimpleNamespace

from runtime.search.iw import iw
from runtime.search.limits import Limits
from runtime.search.query import Query


class Twins:
    """Two actions that make the same atom true, and a goal that is never reached."""

    def __init__(self) -> None:
        self.executed: list[str] = []

    def actions(self, state: str) -> list[tuple[str, str]]:
        return [("first", "one"), ("second", "two")] if state == "start" else []

    def execute(self, state: str, action: str) -> str:
        self.executed.append(action)
        return action


def test_a_sibling_with_nothing_new_is_not_even_executed() -> None:
    guide = SimpleNamespace(
        atoms=lambda state: ("start",) if state == "start" else ("same",),
        values=lambda state: (0,),
        fired=lambda *_: None,
        hopeful=False,
    )
    twins = Twins()
    query = Query(guide, twins, "start", (0,), 1, Limits())
    assert iw(query) is None
    assert twins.executed == ["first"]
    assert query.effort.expanded == 2
