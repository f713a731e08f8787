"""Where the letters of a word belong (paper, Benchmarking TAMP tasks, Words).

Goal positions are relative: a row of slots, `pitch` apart, along one of the axes of the
table. A block is well placed if it belongs to the largest valid sequence: blocks in the slots
of their letters in a row that has room on the table for the whole word. Each slot that is
still empty is assigned to one block with its letter; that block is misplaced, other blocks
with the same letter are not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from domains.tabletop.features.goals import LATTICE, GoalSites, turn_error
from domains.tabletop.scene.model import WordGoal

if TYPE_CHECKING:
    from domains.tabletop.features.arrangement import Arrangement
    from domains.tabletop.world import TabletopWorld

ALIGNED = 0.05
"""Radians by which a block of the row may be turned against the table."""

NEAR = 0.25
"""Metres around an empty slot within which a block may be in the hand's way."""

DIRECTIONS = ((1, 0), (0, 1), (-1, 0), (0, -1))


@dataclass(frozen=True)
class Row:
    """A row of slots on the table: positions (x, y) in the table's frame."""

    slots: tuple[tuple[float, float], ...]


class WordGoals:
    """Assigns blocks to slots for one scene."""

    def __init__(self, world: TabletopWorld, goal: WordGoal) -> None:
        self.world = world
        self.goal = goal
        self.ground = world.grounds[goal.support]
        self.letters = [thing.letter for thing in world.scene.objects]
        self.symmetry = min(
            item.symmetry
            for item, letter in zip(world.items, self.letters, strict=True)
            if letter in set(goal.word)
        )

    def assign(self, arrangement: Arrangement) -> dict[int, GoalSites]:
        """Goal sites of every block that has a place in the best row of an arrangement."""
        blocks = self._blocks(arrangement)
        best, filled = self._best_row(blocks)
        goals: dict[int, GoalSites] = {}
        used = set(filled.values())
        for number, letter in enumerate(self.goal.word):
            index = filled.get(number)
            if index is None:
                index = self._block_for(letter, used, arrangement)
            if index is not None:
                used.add(index)
                goals[index] = self._sites(best.slots[number])
        return goals

    def _blocks(self, arrangement: Arrangement) -> dict[int, tuple[float, float, bool]]:
        """Blocks on the table: position in its frame, and whether they are aligned with it."""
        blocks = {}
        for index, placement in enumerate(arrangement.placements):
            if placement is not None and placement.support == self.goal.support:
                x, y, yaw = placement.pose
                lx, ly = self.ground.local(x, y)
                aligned = turn_error(yaw - self.ground.yaw, self.symmetry) < ALIGNED
                blocks[index] = (lx, ly, aligned)
        return blocks

    def _best_row(self, blocks: dict[int, tuple[float, float, bool]]) -> tuple[Row, dict[int, int]]:
        """The row with the largest valid sequence; among equals the one whose empty slots
        the fewest blocks stand in, then the least crowded one: what is near bars the hand's way.
        The last word has where it lies, and not which block it was found by: it must not turn
        round when one more block is in it."""
        best: tuple[tuple[int, int, int, list[int]], Row, dict[int, int]] | None = None
        for row in self._rows(blocks):
            filled = self._filled(row, blocks)
            if best is not None and -len(filled) > best[0][0]:
                continue
            place = [round(1000 * value) for slot in row.slots for value in slot]
            rank = (-len(filled), *self._blockers(row, filled, blocks), place)
            if best is None or rank < best[0]:
                best = (rank, row, filled)
        assert best is not None, "the loader refuses words that are longer than their table"
        return best[1], best[2]

    def _rows(self, blocks: dict[int, tuple[float, float, bool]]) -> list[Row]:
        """Rows through a block that is aligned; rows anywhere if none of them has room."""
        rows = []
        for index, (x, y, aligned) in blocks.items():
            if aligned:
                for number, letter in enumerate(self.goal.word):
                    if letter == self.letters[index]:
                        rows += [self._row(x, y, number, direction) for direction in DIRECTIONS]
        fitting = [row for row in rows if self._fits(row)]
        if fitting:
            return fitting
        points = self.ground.lattice(LATTICE, 0.05)
        anywhere = [self.ground.local(x, y) for x, y in points]
        rows = [self._row(x, y, 0, direction) for x, y in anywhere for direction in DIRECTIONS]
        return [row for row in rows if self._fits(row)]

    def _row(self, x: float, y: float, number: int, direction: tuple[int, int]) -> Row:
        """The row in which slot `number` is at (x, y)."""
        pitch = self.goal.pitch
        return Row(
            tuple(
                (
                    x + (i - number) * pitch * direction[0],
                    y + (i - number) * pitch * direction[1],
                )
                for i in range(len(self.goal.word))
            )
        )

    def _fits(self, row: Row) -> bool:
        inset = max(item.inner_radius for item in self.world.items)
        return all(
            abs(x) <= self.ground.half[0] - inset and abs(y) <= self.ground.half[1] - inset
            for x, y in row.slots
        )

    def _filled(self, row: Row, blocks: dict[int, tuple[float, float, bool]]) -> dict[int, int]:
        """Slots of a row that hold a block with their letter."""
        filled = {}
        for number, (sx, sy) in enumerate(row.slots):
            for index, (x, y, aligned) in blocks.items():
                if (
                    aligned
                    and self.letters[index] == self.goal.word[number]
                    and math.hypot(x - sx, y - sy) <= self.goal.tolerance
                ):
                    filled[number] = index
        return filled

    def _blockers(
        self, row: Row, filled: dict[int, int], blocks: dict[int, tuple[float, float, bool]]
    ) -> tuple[int, int]:
        """Blocks that stand in empty slots of a row, and how crowded these are: millimetres by
        which others are nearer than `NEAR`, summed."""
        placed = set(filled.values())
        empty = [slot for number, slot in enumerate(row.slots) if number not in filled]
        inside = crowd = 0
        for index, (x, y, _) in blocks.items():
            if index not in placed and empty:
                nearest = min(math.hypot(x - sx, y - sy) for sx, sy in empty)
                inside += nearest < self.goal.pitch * 0.9
                crowd += max(0, round(1000 * (NEAR - nearest)))
        return inside, crowd

    def _block_for(self, letter: str, used: set[int], arrangement: Arrangement) -> int | None:
        """A block for an empty slot: the one that is away, else the easiest to pick up."""
        candidates = [
            index
            for index, other in enumerate(self.letters)
            if other == letter and index not in used
        ]
        for index in candidates:
            if arrangement.placements[index] is None:
                return index
        return min(
            candidates,
            key=lambda index: (
                min(int(picks.counts[index].min()) for picks in arrangement.picks.values()),
                index,
            ),
            default=None,
        )

    def _sites(self, slot: tuple[float, float]) -> GoalSites:
        x, y = self.ground.outside(*slot)
        xy = np.array([[round(x, 5), round(y, 5)]])
        return GoalSites(
            key=("slot", *xy[0].tolist()),
            support=self.goal.support,
            xy=xy,
            xyz=np.array([[*xy[0], self.ground.height]]),
            tolerance=self.goal.tolerance,
            yaw=self.ground.yaw,
            symmetry=self.symmetry,
        )
