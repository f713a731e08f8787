"""Delivery scenes: a TOML file with a map.

    map = '''
    A . a
    . # T
    b . .
    '''

`A` is the agent, `T` the target cell, `#` a wall, and every small letter a package.
"""

from __future__ import annotations

from pathlib import Path

from domains.delivery.problem import Cell, DeliveryProblem, Grid, Package, State
from sketchlang.domain import SceneError
from sketchlang.errors import InputError
from sketchlang.reading import read_toml


def read(path: str | Path) -> DeliveryProblem:
    """The problem of a scene file; raises `SceneError` with what is wrong in it."""
    try:
        values = read_toml(path)
    except InputError as error:
        raise SceneError(str(error)) from error
    unknown = sorted(values.keys() - {"map", "summary"})
    if unknown:
        raise SceneError(f"{path}: unknown key {unknown[0]!r} (known: map, summary)")
    text = values.get("map")
    if not isinstance(text, str):
        raise SceneError(f"{path}: `map` is missing or no text")
    try:
        return of_map(text)
    except ValueError as error:
        raise SceneError(f"{path}: {error}") from None


def of_map(text: str) -> DeliveryProblem:
    """The problem that a map draws; raises `ValueError` with what is wrong in it."""
    free: set[Cell] = set()
    places: dict[str, Cell] = {}
    for row, line in enumerate(text.split("\n")):
        for column, sign in enumerate(line.split()):
            cell = column, row
            if sign == "#":
                continue
            free.add(cell)
            if sign == ".":
                continue
            if sign not in ("A", "T") and not (len(sign) == 1 and "a" <= sign <= "z"):
                apart = "" if len(sign) == 1 else "; signs are set apart by blanks"
                raise ValueError(f"{sign!r} in the map means nothing (A T # . a-z{apart})")
            if sign in places:
                raise ValueError(f"{sign!r} is twice in the map")
            places[sign] = cell
    for sign, what in (("A", "agent"), ("T", "target")):
        if sign not in places:
            raise ValueError(f"the map has no {what} ({sign!r})")
    target, agent = places.pop("T"), places.pop("A")
    names = sorted(places)
    packages = tuple(Package(number, name) for number, name in enumerate(names))
    grid = Grid(frozenset(free), target, packages)
    return DeliveryProblem(State(grid, agent, None, tuple(places[name] for name in names)))
