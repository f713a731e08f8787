"""States and actions of the blocks domain."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

TABLE = -1
HAND = -2


class Action(NamedTuple):
    """`pick BLOCK`, `stack BLOCK on BLOCK` or `put BLOCK on table`."""

    name: str
    block: str
    onto: str | None = None

    def __str__(self) -> str:
        return f"{self.name} {self.block}" + (f" on {self.onto}" if self.onto else "")


class Block(NamedTuple):
    """A block; `number` is its place in `State.below`."""

    number: int
    name: str


@dataclass(frozen=True, eq=False)
class Task:
    """What does not change. `goal[i]` is the block that block i belongs on, None for the
    table; `to_clear` are blocks on which nothing shall lie."""

    blocks: tuple[Block, ...]
    goal: tuple[int | None, ...]
    to_clear: frozenset[int]


@dataclass(frozen=True, slots=True)
class State:
    """`below[i]` is the block on which block i lies, `TABLE`, or `HAND`."""

    task: Task = field(repr=False)
    below: tuple[int, ...]

    @property
    def held(self) -> int | None:
        """The block in the hand."""
        return self.below.index(HAND) if HAND in self.below else None

    def on(self, number: int) -> int | None:
        """The block that lies directly on one."""
        return self.below.index(number) if number in self.below else None

    def above(self, number: int) -> int:
        """How many blocks lie above one."""
        count = 0
        top = self.on(number)
        while top is not None:
            count += 1
            top = self.on(top)
        return count

    def in_place(self, number: int) -> bool:
        """Whether a block and all those below it are as in the goal towers."""
        while True:
            below, wanted = self.below[number], self.task.goal[number]
            if wanted is None:
                return below == TABLE
            if below != wanted:
                return False
            number = wanted


@dataclass(frozen=True)
class BlocksProblem:
    """Build the goal towers."""

    initial: State

    def successors(self, state: State) -> Iterator[tuple[Action, State]]:
        """Pick up a block on which nothing lies; put the held one on such a block, or down."""
        task, below = state.task, state.below
        covered = set(below)
        held = state.held
        if held is None:
            for block in task.blocks:
                if block.number not in covered:
                    yield Action("pick", block.name), _moved(state, block.number, HAND)
            return
        name = task.blocks[held].name
        yield Action("put", name, "table"), _moved(state, held, TABLE)
        for block in task.blocks:
            if block.number != held and block.number not in covered:
                yield Action("stack", name, block.name), _moved(state, held, block.number)

    def scene(self, state: State) -> str | None:
        """The state as a scene file, which has no word for a block in the hand: then None."""
        if state.held is not None:
            return None
        task = state.task
        towers = [" ".join(tower) for tower in _towers(task, state.below)]
        goal = [" ".join(tower) for tower in _towers(task, task.goal) if len(tower) > 1]
        clear = [task.blocks[number].name for number in sorted(task.to_clear)]
        given = {"towers": towers, "goal": goal, "clear": clear}
        return "".join(f"{key} = {json.dumps(value)}\n" for key, value in given.items() if value)

    def picture(self, state: State) -> Iterator[str]:
        """Towers, each from above to below, what is in the hand, and what is wanted."""
        names = [block.name for block in state.task.blocks]
        for tower in _towers(state.task, state.below):
            yield f"tower: {' '.join(reversed(tower))}"
        yield f"hand: {'empty' if state.held is None else names[state.held]}"
        for number, wanted in enumerate(state.task.goal):
            if wanted is not None:
                yield f"goal: {names[number]} on {names[wanted]}"
        for number in sorted(state.task.to_clear):
            yield f"goal: nothing on {names[number]}"


def _towers(task: Task, below: Sequence[int | None]) -> Iterator[list[str]]:
    """The names of the blocks of each tower, the lowest first."""
    above = {under: number for number, under in enumerate(below)}
    for number, under in enumerate(below):
        if under is None or under == TABLE:
            tower = [number]
            while (top := above.get(tower[-1])) is not None:
                tower.append(top)
            yield [task.blocks[block].name for block in tower]


def _moved(state: State, number: int, below: int) -> State:
    return State(state.task, (*state.below[:number], below, *state.below[number + 1 :]))
