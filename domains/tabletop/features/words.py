"""Where the letters of a word belong (paper, Benchmarking TAMP tasks, Words).

Goal positions are relative: a row of slots, `pitch` apart, along one of the axes of the
table. A block is well placed if it belongs to the largest valid sequence: blocks in the slots
of their letters in a row that has room on the table for the whole word. Each slot that is
still empty is assigned to one block with its letter; that block is misplaced, other blocks
with the same letter are not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from domains.tabletop.features.goals import LATTICE, GoalSites, turn_error
from domains.tabletop.scene.model import WordGoal
from runtime.world.poses import Floats

if TYPE_CHECKING:
    from domains.tabletop.features.arrangement import Arrangement
    from domains.tabletop.world import TabletopWorld

Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]

ALIGNED = 0.05
"""Radians by which a block of the row may be turned against the table."""

NEAR = 0.25
"""Metres around an empty slot within which a block may be in the hand's way."""

DIRECTIONS = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])


@dataclass(frozen=True, eq=False)
class Blocks:
    """The blocks on the table: their indices (b,), where they are in its frame (b, 2), whether
    they are aligned with it (b,), and whether they have the letter of each slot (w, b)."""

    indices: list[int]
    xy: Floats
    aligned: Bools
    fitting: Bools


class WordGoals:
    """Assigns blocks to slots for one scene."""

    def __init__(self, world: TabletopWorld, goal: WordGoal) -> None:
        self.world = world
        self.goal = goal
        self.ground = world.grounds[goal.support]
        self.letters = [thing.letter for thing in world.scene.objects]
        self.pitches = goal.pitch * np.arange(len(goal.word))
        self.inset = max(item.inner_radius for item in world.items)
        self.symmetry = min(
            item.symmetry
            for item, letter in zip(world.items, self.letters, strict=True)
            if letter in set(goal.word)
        )

    def assign(self, arrangement: Arrangement) -> dict[int, GoalSites]:
        """Goal sites of every block that has a place in the best row of an arrangement."""
        slots, filled = self._best_row(self._blocks(arrangement))
        goals: dict[int, GoalSites] = {}
        used = set(filled.values())
        for number, letter in enumerate(self.goal.word):
            index = filled.get(number)
            if index is None:
                index = self._block_for(letter, used, arrangement)
            if index is not None:
                used.add(index)
                goals[index] = self._sites(slots[number])
        return goals

    def fewest_moves(self, arrangement: Arrangement) -> int:
        """Blocks that have to be moved before the word lies somewhere, at least: of those that
        stay where they are, one is in the row, and the others are as far from the slots beside it
        as two tolerances, its own and theirs."""
        blocks = self._blocks(arrangement)
        at, numbers = np.nonzero(blocks.aligned[:, None] & blocks.fitting.T)
        if not len(at):
            return len(self.goal.word)
        rows = self._through(blocks.xy[at], numbers)
        away = np.linalg.norm(rows[:, :, None] - blocks.xy, axis=-1)
        stay = (away <= 2 * self.goal.tolerance) & blocks.aligned & blocks.fitting
        return len(self.goal.word) - int(stay.any(axis=2).sum(axis=1).max())

    def _blocks(self, arrangement: Arrangement) -> Blocks:
        indices, xy, aligned = [], [], []
        for index, placement in enumerate(arrangement.placements):
            if placement is not None and placement.support == self.goal.support:
                x, y, yaw = placement.pose
                indices.append(index)
                xy.append(self.ground.local(x, y))
                aligned.append(turn_error(yaw - self.ground.yaw, self.symmetry) < ALIGNED)
        letters = [self.letters[index] for index in indices]
        fitting = [[letter == own for own in letters] for letter in self.goal.word]
        return Blocks(
            indices,
            np.array(xy, dtype=np.float64).reshape(-1, 2),
            np.array(aligned, dtype=np.bool_),
            np.array(fitting, dtype=np.bool_),
        )

    def _best_row(self, blocks: Blocks) -> tuple[Floats, dict[int, int]]:
        """The slots (w, 2) of the row with the largest valid sequence, and the blocks in them;
        among equals the one whose empty slots the fewest blocks stand in, then the least crowded
        one: what is near bars the hand's way. The last word has where it lies, and not which
        block it was found by: it must not turn round when one more block is in it."""
        rows = self._rows(blocks)
        assert len(rows), "the loader refuses words that are longer than their table"
        places = np.rint(1000 * rows.reshape(len(rows), -1)).T[::-1]
        number = len(blocks.indices)
        if not number:
            return rows[np.lexsort(places)[0]], {}
        away = np.linalg.norm(rows[:, :, None] - blocks.xy, axis=-1)  # (r, w, b)
        inside = (away <= self.goal.tolerance) & blocks.aligned & blocks.fitting
        filled = inside.any(axis=2)
        chosen = number - 1 - np.argmax(inside[:, :, ::-1], axis=2)
        # Of blocks that are in a slot together one is in its place, the others stand in the way.
        placed = (filled[:, :, None] & (chosen[:, :, None] == np.arange(number))).any(axis=1)
        to_empty = np.where(filled[:, :, None], np.inf, away).min(axis=1)
        to_empty[placed] = np.inf
        blockers = (to_empty < self.goal.pitch * 0.9).sum(axis=1)
        crowded = np.maximum(0.0, np.rint(1000 * (NEAR - to_empty))).sum(axis=1)
        best = int(np.lexsort((*places, crowded, blockers, -filled.sum(axis=1)))[0])
        slots = np.flatnonzero(filled[best]).tolist()
        return rows[best], {slot: blocks.indices[chosen[best, slot]] for slot in slots}

    def _rows(self, blocks: Blocks) -> Floats:
        """Slots (r, w, 2) of rows through a block that is aligned; of rows anywhere if none of
        them has room."""
        through = blocks.aligned[:, None] & blocks.fitting.T
        at, numbers = np.nonzero(through)
        fitting = self._fitting(blocks.xy[at], numbers)
        if len(fitting):
            return fitting
        points = self.ground.lattice(LATTICE, 0.05)
        anywhere = np.array([self.ground.local(x, y) for x, y in points])
        return self._fitting(anywhere.reshape(-1, 2), np.zeros(len(anywhere), dtype=np.int64))

    def _fitting(self, xy: Floats, numbers: Ints) -> Floats:
        """Slots (r, w, 2) of the rows, in each direction, whose slots of these numbers (k,) are at
        positions (k, 2), as far as they have room."""
        rows = self._through(xy, numbers)
        room = np.array(self.ground.half) - self.inset
        fits: Floats = rows[(np.abs(rows) <= room).all(axis=(1, 2))]
        return fits

    def _through(self, xy: Floats, numbers: Ints) -> Floats:
        """The same, whether or not they have room."""
        along = self.pitches - self.goal.pitch * numbers[:, None]  # (k, w)
        steps = along[:, None, :, None] * DIRECTIONS[None, :, None]  # (k, 4, w, 2)
        rows: Floats = (xy[:, None, None] + steps).reshape(-1, len(self.pitches), 2)
        return rows

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

    def _sites(self, slot: Floats) -> GoalSites:
        x, y = self.ground.outside(*slot.tolist())
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
