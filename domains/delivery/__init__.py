"""Delivery: an agent on a grid carries packages, one at a time, to a target cell.

The running example of Bonet and Geffner, "General Policies, Representations, and Planning
Width" (AAAI 2021).
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import TYPE_CHECKING

from domains.delivery.problem import DeliveryProblem, Package, State
from sketchlang.domain import Domain, LoadOptions, Nat

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["DeliveryProblem", "Package", "State", "domain"]

domain = Domain("delivery", summary="Packages on a grid, carried one at a time to a target cell")
domain.sort(Package)


@domain.function
def packages(state: State) -> tuple[Package, ...]:
    """All packages."""
    return state.grid.packages


@domain.function
def held(state: State, x: Package) -> bool:
    """The agent carries the package."""
    return state.held == x.number


@domain.function
def delivered(state: State, x: Package) -> bool:
    """The package lies on the target cell."""
    return state.cells[x.number] == state.grid.target


@domain.function
def distance(state: State, x: Package) -> Nat:
    """Steps from the agent to the package; 0 if the agent carries it."""
    cell = state.cells[x.number]
    return 0 if cell is None else state.grid.steps(cell, state.agent)


@domain.function
def target_distance(state: State) -> Nat:
    """Steps from the agent to the target cell."""
    return state.grid.steps(state.grid.target, state.agent)


@domain.atom
def agent_at(state: State) -> Iterable[Hashable]:
    """The agent's cell."""
    yield ("agent_at", state.agent)


@domain.atom
def package_at(state: State) -> Iterable[Hashable]:
    """The cell of every package that lies on one."""
    for number, cell in enumerate(state.cells):
        if cell is not None:
            yield ("package_at", number, cell)


@domain.atom
def holding(state: State) -> Iterable[Hashable]:
    """The package that the agent carries, or that it carries none."""
    yield ("holding", state.held)


@domain.scenes
def load(path: str | Path, _options: LoadOptions) -> DeliveryProblem:
    """The problem of a scene file; raises `SceneError` with what is wrong in it."""
    from domains.delivery.scene import read

    return read(path)


domain.schemas |= {
    "move(direction)": "The agent goes to a free cell beside its own.",
    "pick(package)": "It picks up a package from its cell.",
    "drop(package)": "It puts down the package that it carries.",
}
