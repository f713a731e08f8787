"""How fast feature values are computed: `python -m benchmarks.evaluators`.

Compares, in microseconds a state, the compiled sketch, the naive interpreter of the tests, and
Python written by hand for the same features, which looks at no result and so is a lower bound.
"""

from __future__ import annotations

import timeit
from collections.abc import Callable
from typing import Any

from sketchlang.compile import compile_sketch
from sketchlang.domain import Domain, Nat
from sketchlang.loader import load_source, load_text
from tests.language.naive import Interpreter

OBJECTS = 8
domain = Domain("tabletop")


@domain.sort
class Object:
    """An object on a table."""


@domain.sort
class Placement:
    """A place for one."""


ALL = tuple(Object() for _ in range(OBJECTS))
PLACES = tuple(Placement() for _ in range(OBJECTS))


class State:
    """A state with tables for everything, so that looking things up costs next to nothing."""

    def __init__(self, held: Object | None) -> None:
        self.held = held
        self.misplaced = set(ALL[1:])
        self.obstructions = {o: i % 3 for i, o in enumerate(ALL)}
        self.disturbances = {o: i % 2 for i, o in enumerate(ALL)}


@domain.function
def objects(state: State) -> tuple[Object, ...]:
    return ALL


@domain.function
def held(state: State, o: Object) -> bool:
    return state.held is o


@domain.function
def misplaced(state: State, o: Object) -> bool:
    return o in state.misplaced


@domain.function
def goal_placements(state: State, o: Object) -> tuple[Placement, ...]:
    return PLACES


@domain.function
def disturbed_by(state: State, o: Object, p: Placement) -> Nat:
    return 1


@domain.function
def obstructions(state: State, o: Object) -> Nat:
    return state.obstructions[o]


@domain.function
def disturbances(state: State, o: Object) -> Nat:
    return state.disturbances[o]


for name in ("robot_at", "object_at"):
    domain.atoms[name] = lambda state: ()


def by_hand(state: State) -> tuple[int, ...]:
    """The five features of the sketch, as one would write them without a language."""
    everything = objects(state)
    held_ones = [o for o in everything if held(state, o)]
    free_goal = any(
        disturbed_by(state, o, p) == 0 for o in held_ones for p in goal_placements(state, o)
    )
    wrong = [o for o in everything if misplaced(state, o)]
    in_the_way = [obstructions(state, o) for o in wrong]
    least = min(
        (a + disturbances(state, o) for a, o in zip(in_the_way, wrong, strict=True)), default=0
    )
    return int(bool(held_ones)), int(free_goal), len(wrong), least, sum(in_the_way)


def microseconds(function: Callable[[Any], object], state: State) -> float:
    """Best of many runs."""
    return min(timeit.repeat(lambda: function(state), number=500, repeat=20)) / 500 * 1e6


def main() -> None:
    loaded = load_text(load_source("pick_and_place"), {"tabletop": domain})
    assert loaded.ok, [found.message for found in loaded.diagnostics]
    sketch = compile_sketch(loaded.checked)
    print(f"pick_and_place, {OBJECTS} objects, microseconds a state")
    for title, state in (("hand empty", State(None)), ("hand full", State(ALL[-1]))):
        naive = Interpreter(loaded.tree, domain, state)
        assert sketch.evaluate(state) == naive.values() == by_hand(state)
        for _ in range(20):
            sketch.evaluate(state)
        compiled = microseconds(sketch.evaluate, state)
        slow = microseconds(naive.values_of, state)
        hand = microseconds(by_hand, state)
        print(
            f"{title:12} compiled {compiled:6.1f}   naive {slow:6.1f} ({slow / compiled:.1f} x)"
            f"   by hand, unchecked {hand:6.1f} ({hand / compiled:.2f} x)"
        )


if __name__ == "__main__":
    main()
