"""Blocks scenes: a TOML file with towers, each from its lowest block to its highest.

    towers = ["a b c", "d"]
    goal = ["d c", "b a"]      # where the blocks shall be in the end, or
    clear = ["a"]              # what nothing shall lie on

Blocks that `goal` does not name belong on the table.
"""

from __future__ import annotations

from pathlib import Path

from domains.blocks.problem import TABLE, Block, BlocksProblem, State, Task
from sketchlang.domain import SceneError
from sketchlang.errors import InputError
from sketchlang.reading import read_toml


def read(path: str | Path) -> BlocksProblem:
    """The problem of a scene file; raises `SceneError` with what is wrong in it."""
    try:
        values = read_toml(path)
    except InputError as error:
        raise SceneError(str(error)) from error
    unknown = sorted(values.keys() - {"towers", "goal", "clear", "summary"})
    if unknown:
        known = "towers, goal, clear, summary"
        raise SceneError(f"{path}: unknown key {unknown[0]!r} (known: {known})")
    try:
        towers, goal, clear = (
            _texts(values.get(key, []), key) for key in ("towers", "goal", "clear")
        )
        return of_towers(towers, goal, clear)
    except ValueError as error:
        raise SceneError(f"{path}: {error}") from None


def _texts(value: object, key: str) -> list[str]:
    if not isinstance(value, list) or not all(isinstance(text, str) for text in value):
        raise ValueError(f"`{key}` is no list of texts")
    return value


def of_towers(
    towers: list[str], goal: list[str], clear: list[str] | tuple[str, ...] = ()
) -> BlocksProblem:
    """The problem of some towers; raises `ValueError` with what is wrong in them."""
    now = _supports(towers, "towers")
    names = sorted(now)
    if not names:
        raise ValueError("there are no blocks (`towers`)")
    wanted = _supports(goal, "goal")
    for key, given in (("goal", wanted), ("clear", clear)):
        for name in given:
            if name not in now:
                raise ValueError(f"`{key}` names block {name!r}, which `towers` does not have")
    number = {name: i for i, name in enumerate(names)}
    blocks = tuple(Block(i, name) for name, i in number.items())
    supports = [wanted.get(name) for name in names]
    task = Task(
        blocks,
        tuple(None if support is None else number[support] for support in supports),
        frozenset(number[name] for name in clear),
    )
    lower = [now[name] for name in names]
    below = tuple(TABLE if support is None else number[support] for support in lower)
    return BlocksProblem(State(task, below))


def _supports(towers: list[str], key: str) -> dict[str, str | None]:
    """What every block lies on, None for the table."""
    supports: dict[str, str | None] = {}
    for tower in towers:
        support = None
        for name in tower.split():
            if name in supports:
                raise ValueError(f"block {name!r} is twice in `{key}`")
            supports[name] = support
            support = name
    return supports
