"""Words: which blocks count as well placed, and which are misplaced."""

from __future__ import annotations

import math
import random
from dataclasses import replace

import pytest

from domains.tabletop.bound import execution_bound
from domains.tabletop.features.functions import arrangement, misplaced
from domains.tabletop.features.words import NEAR
from domains.tabletop.problem import load_problem
from domains.tabletop.state import Placement, State
from domains.tabletop.world import TabletopWorld
from sketchlang.domain import LoadOptions
from sketchlang.library import find_scene

PITCH = 0.07
DIRECTIONS = [(1, 0), (0, 1), (-1, 0), (0, -1)]


@pytest.fixture(scope="module", params=["words/tamp", "words/robot"])
def task(request) -> TabletopWorld:
    return load_problem(str(find_scene(request.param)[0]), LoadOptions(request.param)).world


def index_of(task: TabletopWorld, letter: str, number: int = 0) -> int:
    found = [i for i, thing in enumerate(task.scene.objects) if thing.letter == letter]
    return found[number]


def spelled(
    task: TabletopWorld, count: int, direction: tuple[int, int], turn: float = 0.0
) -> State:
    """The scene with all blocks away from one another but the first `count` letters of the
    word in a row from the middle of the table."""
    word = task.scene.word
    assert word is not None
    ground = task.grounds[word.support]
    used: dict[str, int] = {}
    placements: list[Placement | None] = list(task.initial.placements)
    for number, letter in enumerate(word.word[:count]):
        index = index_of(task, letter, used.get(letter, 0))
        used[letter] = used.get(letter, 0) + 1
        start = -PITCH * (len(word.word) - 1) / 2
        x, y = ground.outside(
            (start + number * PITCH) * direction[0], (start + number * PITCH) * direction[1]
        )
        yaw = ground.yaw + (turn if number == count - 1 else 0.0)
        placements[index] = Placement.of(x, y, yaw, word.support)
    return replace(task.initial, placements=tuple(placements))


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("turn", [0.0, math.pi / 2])
def test_letters_in_a_row_are_well_placed(task, direction, turn) -> None:
    word = task.scene.word.word
    for count in range(2, len(word) + 1):
        state = spelled(task, count, direction, turn)
        assert len(misplaced(state)) == len(word) - count


def test_the_whole_word_reaches_the_goal_and_spare_letters_do_not_matter(task) -> None:
    state = spelled(task, len(task.scene.word.word), (0, 1))
    assert not misplaced(state)


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_of_a_word_the_letters_that_are_away_have_to_be_moved(task, direction) -> None:
    word, words = task.scene.word.word, task.words
    for count in range(len(word) + 1):
        state = spelled(task, count, direction)
        fewest = words.fewest_moves(arrangement(task, state.placements))
        assert fewest <= len(misplaced(state))
        if count > 1:
            assert fewest == len(word) - count
            grips = 2 * task.robot.gripper.time * fewest
            assert execution_bound(task, state) == pytest.approx(grips)


def test_letters_within_two_tolerances_may_stay(task) -> None:
    """Between two letters, each just too far from its slot beside the other, a row of a third
    one may hold both."""
    word = task.scene.word
    state = spelled(task, 2, (0, 1))
    index = index_of(task, word.word[0])
    at = state.placements[index].pose
    for away, more in ((1.5, 0), (2.5, 1)):
        beside = Placement.of(at[0] + away * word.tolerance, *at[1:], word.support)
        placements = (*state.placements[:index], beside, *state.placements[index + 1 :])
        fewest = task.words.fewest_moves(arrangement(task, placements))
        assert fewest == len(word.word) - 2 + more


def test_a_block_that_is_turned_against_the_row_is_misplaced(task) -> None:
    word = task.scene.word.word
    state = spelled(task, len(word), (0, 1), turn=math.pi / 4)
    assert len(misplaced(state)) == 1


def test_as_many_blocks_are_misplaced_as_slots_are_empty(task) -> None:
    """A slot wants one block, however many have its letter."""
    word = task.scene.word.word
    wrong = misplaced(task.initial)
    assert len(wrong) <= len(word)
    letters = [task.scene.objects[i].letter for i in wrong]
    assert all(letters.count(letter) <= word.count(letter) for letter in letters)


def test_a_row_without_room_for_the_whole_word_does_not_count(task) -> None:
    word = task.scene.word
    ground = task.grounds[word.support]
    placements: list[Placement | None] = list(task.initial.placements)
    # The first two letters at the very end of the table, reading outwards.
    edge = ground.half[0] - 0.03
    for number, letter in enumerate(word.word[:2]):
        x, y = ground.outside(edge - PITCH + number * PITCH, 0.0)
        index = index_of(task, letter)
        placements[index] = Placement.of(x, y, ground.yaw, word.support)
    state = replace(task.initial, placements=tuple(placements))
    here = arrangement(task, state.placements)
    first, second = (index_of(task, letter) for letter in word.word[:2])
    goals = task.letters(here)
    both = all(i in goals and goals[i].holds(state.placements[i]) for i in (first, second))
    assert not both


def row_of(task: TabletopWorld, state: State) -> list[tuple[float, ...]]:
    """Where the letters of the word belong, in the order of the word, where that is still asked."""
    words = task.words
    assert words is not None
    row, _ = words._best_row(words._blocks(arrangement(task, state.placements)))
    return [tuple(round(value, 3) for value in slot) for slot in row.tolist()]


@pytest.mark.parametrize("seed", range(8))
def test_a_row_stays_where_it_is_while_the_word_is_spelled(task, seed) -> None:
    """Also if one half of the word mirrors the other: it does not turn round for one more."""
    choose = random.Random(seed).choice
    state = task.initial
    first = row_of(task, state)
    while misplaced(state):
        goals = task.words.assign(arrangement(task, state.placements))
        index = choose(sorted(misplaced(state)))
        x, y = goals[index].xy[0]
        placed = Placement.of(x, y, task.grounds[task.scene.word.support].yaw, goals[index].support)
        placements = (*state.placements[:index], placed, *state.placements[index + 1 :])
        state = replace(state, placements=placements)
        assert row_of(task, state) == first


def test_a_row_is_not_laid_where_blocks_crowd(task) -> None:
    """The same table with all blocks that are not in the chosen row packed around it: another row
    is chosen, if it is as good otherwise."""
    words = task.words
    blocks = words._blocks(arrangement(task, task.initial.placements))
    chosen, filled = words._best_row(blocks)
    crowd = {}
    word, letters = task.scene.word, words.letters
    for row in words._rows(blocks).tolist():
        now = {
            number: index
            for number, slot in enumerate(row)
            for index, at, aligned in zip(blocks.indices, blocks.xy, blocks.aligned, strict=True)
            if aligned
            and letters[index] == word.word[number]
            and math.dist(at, slot) <= word.tolerance
        }
        empty = [slot for number, slot in enumerate(row) if number not in now]
        others = [
            at
            for index, at in zip(blocks.indices, blocks.xy, strict=True)
            if index not in now.values()
        ]
        near = [min(math.dist(at, slot) for slot in empty) for at in others]
        if len(now) == len(filled) and min(near) >= 0.9 * word.pitch:
            crowd[str(row)] = sum(max(0.0, NEAR - distance) for distance in near)
    best = crowd[str(chosen.tolist())]
    assert best <= min(crowd.values()) + 0.001 * len(blocks.indices)
    assert max(crowd.values()) > best
