"""States and actions of the delivery domain."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

Cell = tuple[int, int]
"""Column and row, both from 0."""

_MOVES = {"east": (1, 0), "west": (-1, 0), "south": (0, 1), "north": (0, -1)}


class Action(NamedTuple):
    """`move DIRECTION`, `pick PACKAGE` or `drop PACKAGE`."""

    name: str
    argument: str

    def __str__(self) -> str:
        return f"{self.name} {self.argument}"


class Package(NamedTuple):
    """A package; `number` is its place in `State.cells`."""

    number: int
    name: str


@dataclass(frozen=True, eq=False)
class Grid:
    """What does not change: the cells that can be entered, the target, the packages."""

    free: frozenset[Cell]
    target: Cell
    packages: tuple[Package, ...]
    _steps: dict[Cell, dict[Cell, int]] = field(default_factory=dict, repr=False)

    def neighbours(self, cell: Cell) -> Iterator[tuple[str, Cell]]:
        """The moves that are possible in a cell, with the cells they lead to."""
        for name, (dx, dy) in _MOVES.items():
            other = cell[0] + dx, cell[1] + dy
            if other in self.free:
                yield name, other

    def steps(self, goal: Cell, start: Cell) -> int:
        """Fewest moves between two cells; the number of cells if there is no way."""
        found = self._steps.get(goal)
        if found is None:
            found = self._steps[goal] = {goal: 0}
            frontier = [goal]
            while frontier:
                reached = []
                for cell in frontier:
                    for _, other in self.neighbours(cell):
                        if other not in found:
                            found[other] = found[cell] + 1
                            reached.append(other)
                frontier = reached
        return found.get(start, len(self.free))


@dataclass(frozen=True, slots=True)
class State:
    """`held` is the number of the package that the agent carries, `cells[i]` the cell of
    package i, None while it is carried."""

    grid: Grid = field(repr=False)
    agent: Cell
    held: int | None
    cells: tuple[Cell | None, ...]


@dataclass(frozen=True)
class DeliveryProblem:
    """Carry every package to the target cell."""

    initial: State

    def successors(self, state: State) -> Iterator[tuple[Action, State]]:
        """Move to a free neighbour; pick up a package here; drop the one that is carried."""
        grid, agent = state.grid, state.agent
        for name, cell in grid.neighbours(agent):
            yield Action("move", name), State(grid, cell, state.held, state.cells)
        if state.held is not None:
            name = grid.packages[state.held].name
            yield (
                Action("drop", name),
                State(grid, agent, None, _put(state.cells, state.held, agent)),
            )
            return
        for package in grid.packages:
            if state.cells[package.number] == agent:
                cells = _put(state.cells, package.number, None)
                yield Action("pick", package.name), State(grid, agent, package.number, cells)

    def scene(self, state: State) -> str | None:
        """The state as a scene file; None if a map cannot draw it: something is carried, or two
        things are in one cell."""
        cells = [state.agent, state.grid.target, *state.cells]
        if state.held is not None or len(set(cells)) < len(cells):
            return None
        *rows, _, _ = self.picture(state)
        return "\n".join(["map = '''", *rows, "'''", ""])

    def picture(self, state: State) -> Iterator[str]:
        """The map as scene files draw it: `A` is the agent, above all else, `T` the target."""
        grid = state.grid
        signs = dict.fromkeys(grid.free, ".") | {grid.target: "T"}
        for package in grid.packages:
            cell = state.cells[package.number]
            if cell is not None:
                signs[cell] = package.name
        signs[state.agent] = "A"
        columns, rows = (1 + max(cell[i] for cell in grid.free) for i in (0, 1))
        for row in range(rows):
            yield " ".join(signs.get((column, row), "#") for column in range(columns))
        at_target = [p.name for p in grid.packages if state.cells[p.number] == grid.target]
        yield f"carried: {'nothing' if state.held is None else grid.packages[state.held].name}"
        yield f"delivered: {' '.join(at_target) or 'nothing'}"


def _put(cells: tuple[Cell | None, ...], number: int, cell: Cell | None) -> tuple[Cell | None, ...]:
    return (*cells[:number], cell, *cells[number + 1 :])
