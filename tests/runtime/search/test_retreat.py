"""Runs that get stuck go back some subgoals; what is hopeless is not tried over and over."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.search.guide import Subgoal
from runtime.search.limits import HASTE, Limits
from runtime.search.planners import PLANNERS, SEARCHES
from runtime.search.problem import Rejection
from runtime.search.siw_r import End, Outcome, Progress, Retreat, eager, subgoals
from sketchlang.compile import CompiledSketch, compile_sketch
from sketchlang.domain import Domain, Nat
from sketchlang.loader import load_text
from sketchlang.source import Source

ROOMS = 12
KEYS = 3
"""Keys that may lie in a room; one of each row of samples is found."""

TRAP = 7
"""A key with which no rule applies any more."""

State = tuple[int, ...]
"""The keys that were taken, one in each room that was left behind."""

BOTH = pytest.mark.parametrize("planner", sorted(SEARCHES))


@cache
def sketch() -> CompiledSketch:
    """One room nearer to the end with each subgoal."""
    domain = Domain("rooms")

    @domain.function
    def rooms_left(state) -> Nat:
        return ROOMS - len(state)

    @domain.function
    def trapped(state) -> bool:
        return TRAP in state

    @domain.atom
    def taken(state) -> Iterator[State]:
        yield state

    text = (
        "sketch rooms\nuse rooms\nfeature n : nat = rooms_left()\n"
        "feature t : bool = trapped()\natoms taken\n"
        "goal { n = 0 }\nrule go { !t, n > 0 } -> { n--, t? }\n"
    )
    loaded = load_text(Source("rooms.sketch", text), {"rooms": domain})
    assert loaded.ok, loaded.diagnostics
    return compile_sketch(loaded.checked)


@dataclass
class Corridor:
    """Rooms in a row. The door of some rooms opens only to those who took a certain key in an
    earlier one: `locks` has that room and the key. Each attempt sees some keys of a room, or all
    of them where `seen` is None."""

    locks: dict[int, tuple[int, int]]
    keys: int = KEYS
    seen: int | None = 1
    asked: list[State] = field(default_factory=list)
    initial: State = ()

    def subproblem(self, state: State, attempt: int, rng: np.random.Generator) -> Room:
        if self.seen is None:
            return Room(self, state, list(range(self.keys)))
        return Sampled(self, state, rng.permutation(self.keys)[: self.seen].tolist())


@dataclass
class Room:
    corridor: Corridor
    start: State
    keys: list[int]

    def actions(self, state: State) -> list[tuple[int, State]]:
        return [(key, (*state, key)) for key in self.keys] if state == self.start else []

    def execute(self, state: State, action: int) -> str | Rejection:
        self.corridor.asked.append(state)
        lock = self.corridor.locks.get(len(state))
        if lock is None or state[lock[0] : lock[0] + 1] == (lock[1],):
            return "walk"
        return Rejection("locked")


class Sampled(Room):
    sampled = True


def run(
    corridor: Corridor,
    planner: str,
    limits: Limits | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Outcome:
    rng = np.random.default_rng(seed)
    return PLANNERS[planner](sketch(), corridor, limits or Limits(), rng, progress)


def rooms_of(outcome: Outcome) -> list[State]:
    return [state for subgoal in outcome.subgoals for state in subgoal.states]


@BOTH
@given(lock=st.integers(1, ROOMS - 1), behind=st.integers(1, 3), seed=st.integers(0, 50))
def test_a_run_that_took_the_wrong_thing_goes_back_for_another(planner, lock, behind, seed) -> None:
    locks = {lock: (max(0, lock - behind), 0)}
    once = run(Corridor(locks), planner, Limits(retreats=0), seed)
    outcome = run(Corridor(locks), planner, Limits(retreats=30), seed)
    if once.solved:
        assert outcome.subgoals == once.subgoals
        assert not outcome.retreats
        return
    if outcome.solved:
        rooms = rooms_of(outcome)
        assert [len(state) for state in rooms] == list(range(1, ROOMS + 1))
        assert all(rooms[-1][: len(state)] == state for state in rooms)
        assert rooms[-1][locks[lock][0]] == 0
    # One, 2, 4, ... subgoals, until the key, or all the way.
    steps = [retreat.stuck - retreat.back for retreat in outcome.retreats]
    assert steps == [min(2**i, lock) for i in range(len(steps))]
    assert outcome.solved or outcome.retreats[-1].back == 0


@BOTH
def test_most_wrong_turns_are_mended_and_the_same_seed_mends_them_alike(planner) -> None:
    locks, seeds = {4: (3, 0), 9: (7, 0)}, range(40)
    once = [run(Corridor(locks), planner, Limits(retreats=0), seed) for seed in seeds]
    found = [run(Corridor(locks), planner, None, seed) for seed in seeds]
    again = [run(Corridor(locks), planner, None, seed) for seed in seeds]
    # A third of the keys is the right one, and two have to be.
    assert sum(one.solved for one in once) < 12
    assert sum(one.solved for one in found) > 18
    assert [one.subgoals for one in found] == [one.subgoals for one in again]


@BOTH
def test_who_comes_further_begins_with_one_subgoal_again(planner) -> None:
    locks, further = {4: (2, 0), 9: (8, -1)}, 0
    for seed in range(20):
        furthest, step = 0, 1
        for retreat in run(Corridor(locks), planner, Limits(retreats=20), seed).retreats:
            step = 1 if retreat.stuck > furthest else 2 * step
            further += 0 < furthest < retreat.stuck
            furthest = max(furthest, retreat.stuck)
            assert retreat.back == max(0, retreat.stuck - step)
    assert further > 5


@BOTH
def test_where_no_rule_applies_others_may_have_led_elsewhere(planner) -> None:
    runs = [(Limits(retreats=most), seed) for most in (0, 6) for seed in range(20)]
    found = [run(Corridor({}, keys=TRAP + 1), planner, limits, seed) for limits, seed in runs]
    once, found = found[:20], found[20:]
    assert any(one.end is End.NO_RULE for one in once)
    assert sum(one.solved for one in found) > sum(one.solved for one in once)


@BOTH
def test_what_is_hopeless_ends_soon_and_as_it_did_without_going_back(planner) -> None:
    nobody = {8: (7, -1)}
    alone, corridor = (Corridor(nobody, keys=400, seen=300) for _ in range(2))
    once = run(alone, planner, Limits(retreats=0))
    outcome = run(corridor, planner)
    assert outcome.end is End.NO_SUBGOAL
    for name in ("end", "reason", "stuck", "state", "subgoals", "rejections"):
        assert getattr(outcome, name) == getattr(once, name)
    assert outcome.retreats == [Retreat(8, 7), Retreat(8, 6), Retreat(8, 4), Retreat(8, 0)]
    assert outcome.effort.generated > once.effort.generated
    few = run(Corridor(nobody, keys=400, seen=300), planner, Limits(retreats=2))
    assert few.retreats == [Retreat(8, 7), Retreat(8, 0)]
    refused = [sum(len(state) == 8 for state in one.asked) for one in (alone, corridor)]
    most = Limits().rejections
    assert refused == [most, most + len(outcome.retreats) * most // HASTE]


@BOTH
def test_nobody_goes_back_where_samples_are_not_at_fault(planner) -> None:
    """All actions were known, or there is nothing to go back to."""
    known, first = Corridor({8: (7, -1)}, seen=None), Corridor({0: (0, -1)})
    for corridor in (known, first):
        outcome = run(corridor, planner)
        assert outcome.end is End.NO_SUBGOAL
        assert not outcome.retreats


@BOTH
def test_time_that_ends_while_going_back_leaves_the_reason_as_it_was(planner) -> None:
    corridor = Corridor({8: (7, -1)})
    limits = Limits(timeout=1e6)

    def over(step: Subgoal | Retreat, seconds: float) -> None:
        if isinstance(step, Retreat):
            limits.start -= 2e6

    outcome = run(corridor, planner, limits, progress=over)
    assert outcome.end is End.NO_SUBGOAL
    assert len(outcome.retreats) == 1


@BOTH
def test_each_step_is_told(planner) -> None:
    told: list[Subgoal | Retreat] = []
    outcome = run(
        Corridor({5: (3, 0)}),
        planner,
        seed=unlucky(planner),
        progress=lambda step, _: told.append(step),
    )
    assert [step for step in told if isinstance(step, Retreat)] == outcome.retreats != []
    reached: list[Subgoal] = []
    for step in told:
        if isinstance(step, Retreat):
            assert len(reached) == step.stuck
            reached = reached[: step.back]
        else:
            reached.append(step)
    assert outcome.solved
    assert reached == outcome.subgoals


def unlucky(planner: str) -> int:
    """A seed with which a run has to go back, and comes through then."""
    runs = ((seed, run(Corridor({5: (3, 0)}), planner, None, seed)) for seed in range(100))
    return next(seed for seed, one in runs if one.retreats and one.solved)


class Loop(Corridor):
    """Rooms that lead 0, 1, 2, 1, 2, ...: the state tells where one is and nothing of the past."""

    def subproblem(self, state: State, attempt: int, rng: np.random.Generator) -> Room:
        onwards = Room(self, state, [])
        onwards.actions = lambda at: [("on", LOOP[at])] if at == state else []  # type: ignore
        return onwards


LOOP = {(): (0,), (0,): (0, 0), (0, 0): (0,)}


def test_a_run_that_goes_on_knows_where_it_has_been() -> None:
    """A circle is one at the first state that comes again, those before going back included."""
    domain = Domain("rooms")

    @domain.function
    def place(state) -> Nat:
        return len(state)

    @domain.function
    def ended(state) -> bool:
        return False

    @domain.atom
    def there(state) -> Iterator[State]:
        yield state

    text = (
        "sketch s\nuse rooms\nfeature n : nat = place()\nfeature e : bool = ended()\n"
        "atoms there\ngoal { e }\nrule go { !e } -> { n? }\n"
    )
    loaded = load_text(Source("s.sketch", text), {"rooms": domain})
    assert loaded.ok, loaded.diagnostics
    two, loop = Outcome(state=()), Loop({})
    args = (eager, compile_sketch(loaded.checked), loop, Limits(), np.random.default_rng(0))
    found = subgoals(*args, two)
    next(found), next(found)
    rest = Outcome(state=two.state, subgoals=two.subgoals[:])
    assert len(list(subgoals(*args, rest))) == 1
    assert (rest.end, rest.returned_to) == (End.CIRCLE, 1)
