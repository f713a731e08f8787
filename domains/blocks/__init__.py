"""Blocks: towers of blocks on a table, and a hand that moves one block at a time."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import TYPE_CHECKING

from domains.blocks.problem import Block, BlocksProblem, State
from sketchlang.domain import Domain, LoadOptions, Nat

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["Block", "BlocksProblem", "State", "domain"]

domain = Domain("blocks", summary="Towers of blocks on a table, moved one block at a time")
domain.sort(Block)


@domain.function
def blocks(state: State) -> tuple[Block, ...]:
    """All blocks."""
    return state.task.blocks


@domain.function
def held(state: State, b: Block) -> bool:
    """The hand holds the block."""
    return state.held == b.number


@domain.function
def on(state: State) -> frozenset[tuple[Block, Block]]:
    """The pairs of a block and the one that it lies on."""
    blocks, below = state.task.blocks, state.below
    return frozenset((b, blocks[below[b.number]]) for b in blocks if below[b.number] >= 0)


@domain.goal("on")
def wanted(state: State) -> frozenset[tuple[Block, Block]]:
    """The pairs of a block and the one that it shall lie on."""
    return frozenset(
        (b, state.task.blocks[wanted])
        for b, wanted in zip(state.task.blocks, state.task.goal, strict=True)
        if wanted is not None
    )


@domain.function
def above(state: State, b: Block) -> Nat:
    """How many blocks lie above the block."""
    return state.above(b.number)


@domain.function
def to_clear(state: State, b: Block) -> bool:
    """The scene wants nothing to lie on the block."""
    return b.number in state.task.to_clear


@domain.function
def misplaced(state: State, b: Block) -> bool:
    """The block, or one below it, is not where the goal towers have it."""
    return not state.in_place(b.number)


@domain.function
def ready(state: State, b: Block) -> bool:
    """The block is misplaced, and what it belongs on is in its place."""
    if state.in_place(b.number):
        return False
    support = state.task.goal[b.number]
    return support is None or state.in_place(support)


@domain.function
def covering(state: State, b: Block) -> Nat:
    """How many blocks lie above the block and above what it belongs on."""
    support = state.task.goal[b.number]
    return state.above(b.number) + (0 if support is None else state.above(support))


def supports(state: State) -> Iterable[Hashable]:
    """What every block lies on: a block, the table, or the hand."""
    yield from (("on", number, below) for number, below in enumerate(state.below))


domain.atoms["on"] = supports


@domain.scenes
def load(path: str | Path, _options: LoadOptions) -> BlocksProblem:
    """The problem of a scene file; raises `SceneError` with what is wrong in it."""
    from domains.blocks.scene import read

    return read(path)


domain.schemas |= {
    "pick(block)": "The hand takes a block on which nothing lies.",
    "put(block)": "It puts the block on the table.",
    "stack(block, block)": "It puts the block on another one on which nothing lies.",
}
