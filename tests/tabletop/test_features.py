"""misplaced, obstructions, disturbances: scenes where the answer is plain, and brute force."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from domains.tabletop import Object, disturbances, misplaced, obstructions
from domains.tabletop.actions.actions import MoveBase, Pick, Place
from domains.tabletop.features import swept
from domains.tabletop.features.beta import _all_far
from domains.tabletop.features.functions import arrangement
from domains.tabletop.features.swept import LEVEL, PLAY, STEP
from domains.tabletop.features.ways import place_barred
from domains.tabletop.holds import SiteHold
from domains.tabletop.items import GRASP_HEIGHT, PALM_AIR, PINCH_DEPTH
from domains.tabletop.memory import Memory
from domains.tabletop.problem import TabletopProblem
from domains.tabletop.scene.generate import sorting_scene
from domains.tabletop.scene.load import load_scene
from domains.tabletop.state import PINCH, SIDE, TOP, BasePose, Grasp, Placement, State
from domains.tabletop.world import TabletopWorld
from runtime.robot.load import load_robot
from sketchlang.compile import CompiledSketch, compile_sketch
from sketchlang.loader import load_sketch
from tests.runtime import reference
from tests.runtime.reference import HEADINGS, UNREACHABLE, headings_of
from tests.tabletop.tasks import AT, ON_RIGHT, stick, task

RING = [(0.8 + 0.07 * math.cos(a), 0.6 + 0.07 * math.sin(a)) for a in np.arange(6) * math.pi / 3]


SIZES = ((0.04, 0.04, 0.2), (0.04, 0.04, 0.04), (0.05, 0.03, 0.02))
"""A stick, a cube and a thin plate."""


def box(name: str, x: float, y: float, size: tuple[float, ...], yaw: int) -> str:
    return f'[[object]]\nname = "{name}"\nsize = {list(size)}\nat = [{x}, {y}]\nyaw = {yaw}\n'


@pytest.fixture(scope="module")
def sketch() -> CompiledSketch:
    return compile_sketch(load_sketch("pick_and_place").checked)


def features(sketch: CompiledSketch, state: State) -> dict[str, int]:
    names = [feature.name for feature in sketch.model.features]
    return dict(zip(names, sketch.evaluate(state), strict=True))


# -- scenes where the answer is plain ----------------------------------------------------------


def test_an_object_on_its_own_is_in_nobodys_way(tmp_path) -> None:
    state = task(tmp_path, stick("a", 0.8, 0.6), ON_RIGHT.format("a")).initial
    assert misplaced(state, Object(0))
    assert obstructions(state, Object(0)) == 0
    assert disturbances(state, Object(0)) == 0


def test_an_object_on_its_table_is_not_misplaced(tmp_path) -> None:
    state = task(tmp_path, stick("a", 0.8, -0.9), ON_RIGHT.format("a")).initial
    assert not misplaced(state, Object(0))


def test_an_object_without_goal_is_never_misplaced(tmp_path) -> None:
    entries = [stick("a", 0.8, 0.6), stick("b", 0.8, -0.9), ON_RIGHT.format("a")]
    state = task(tmp_path, *entries).initial
    assert not misplaced(state, Object(1))
    assert obstructions(state, Object(1)) == 0


def test_a_goal_point_has_its_tolerance(tmp_path) -> None:
    for x, wrong in ((0.904, False), (0.906, True)):
        state = task(tmp_path, stick("a", x, -0.9), AT.format("a", 0.9, -0.9)).initial
        assert misplaced(state, Object(0)) == wrong


def test_a_ring_of_sticks_obstructs_the_one_inside(tmp_path) -> None:
    ring = [stick(f"r{i}", x, y) for i, (x, y) in enumerate(RING)]
    closed = task(tmp_path, stick("a", 0.8, 0.6), *ring, ON_RIGHT.format("a")).initial
    assert obstructions(closed, Object(0)) >= 1
    opened = task(tmp_path, stick("a", 0.8, 0.6), *ring[:2], ON_RIGHT.format("a")).initial
    assert obstructions(opened, Object(0)) == 0


def test_taking_the_obstructing_sticks_away_frees_the_one_inside(tmp_path) -> None:
    """Each stick of the ring that goes obstructs no more; in the end nothing does."""
    ring = [stick(f"r{i}", x, y) for i, (x, y) in enumerate(RING)]
    state = task(tmp_path, stick("a", 0.8, 0.6), *ring, ON_RIGHT.format("a")).initial
    counts = [obstructions(state, Object(0))]
    for i in range(len(RING)):
        away = Placement.of(0.65 + 0.05 * i, -1.1, 0.0, 1)
        state = Place(1 + i, away).after(Pick(1 + i, Grasp.of(0.0, 0.12)).after(state))
        counts.append(obstructions(state, Object(0)))
    assert counts[0] > 0
    assert counts[-1] == 0
    assert counts == sorted(counts, reverse=True)


def test_something_on_the_goal_point_obstructs(tmp_path) -> None:
    entries = [stick("a", 0.8, 0.6), stick("b", 0.8, -0.9), AT.format("a", 0.8, -0.9)]
    state = task(tmp_path, *entries).initial
    assert obstructions(state, Object(0)) >= 1


def test_a_goal_point_on_another_one_disturbs(tmp_path) -> None:
    """Two sticks are wanted 1 cm from each other: whoever comes first bars the other."""
    entries = [
        stick("a", 0.8, 0.5), stick("b", 0.8, 0.8),
        AT.format("a", 0.8, -0.9), AT.format("b", 0.81, -0.9),
    ]  # fmt: skip
    state = task(tmp_path, *entries).initial
    assert disturbances(state, Object(0)) == 1
    assert disturbances(state, Object(1)) == 1


def test_goal_points_far_apart_do_not_disturb(tmp_path) -> None:
    entries = [
        stick("a", 0.8, 0.5), stick("b", 0.8, 0.8),
        AT.format("a", 0.65, -0.9), AT.format("b", 0.95, -0.9),
    ]  # fmt: skip
    state = task(tmp_path, *entries).initial
    assert [disturbances(state, Object(i)) for i in range(2)] == [0, 0]


def test_a_table_out_of_reach_is_obstructed_beyond_count(tmp_path) -> None:
    """The goal is in the middle of a table larger than the arm."""
    large = '[[table]]\nname = "large"\nat = [-8, 0]\nsize = [6, 6]\ntop = 0.765\nrest = 0.767\n'
    text = task(tmp_path, large, stick("a", 0.8, 0.6), AT.format("a", -8, 0)).initial
    assert obstructions(text, Object(0)) >= UNREACHABLE


# -- brute force -------------------------------------------------------------------------------


Bars = list[set[int]]
"""For each heading from which the robot could come, the objects that bar it."""


def row_of(the: TabletopWorld, index: int, placement: Placement) -> np.ndarray:
    x, y, yaw = placement.pose
    size = the.scene.objects[index].size
    rest = the.grounds[placement.support].height
    return reference.upright_row(np.array([x, y, rest + size[2] / 2]), np.array(size) / 2, yaw)


def box_hold(the: TabletopWorld, index: int, family: int, yaw: float) -> SiteHold | None:
    """How a hand takes a box that stands with a heading, straight from the box's size."""
    sx, sy, sz = the.scene.objects[index].size
    hand = the.hand
    widest = hand.max_opening - 2 * hand.clearance
    rows, fits = np.zeros((HEADINGS, 3)), 0
    height = {
        SIDE: min(GRASP_HEIGHT, 0.6 * sz),
        TOP: max(min(sz / 2, sz - 0.01), hand.tip + PALM_AIR, sz - hand.back + PALM_AIR),
        PINCH: sz / 2,
    }[family]
    if family == TOP and height - hand.tip > sz - 0.008:
        return None
    for k in range(HEADINGS):
        c, s = abs(math.cos(k * STEP - yaw)), abs(math.sin(k * STEP - yaw))
        across, deep = sx * s + sy * c, sx * c + sy * s
        if family == SIDE:
            along = min(0.0, hand.back - PALM_AIR - deep / 2)
            good = along > 0.01 - deep / 2 and across <= widest
        elif family == TOP:
            along, good = 0.0, across <= widest
        else:
            across, inside = sz, min(PINCH_DEPTH, deep / 2)
            along = inside - deep / 2
            good = inside <= hand.back - PALM_AIR and across <= widest
        rows[k] = across / 2, along, 0.0
        fits |= int(good) << k
    return SiteHold(rows, height, fits)


def barring(
    the: TabletopWorld, state: State, index: int, site: tuple[float, ...], family: int,
    hold: SiteHold,
) -> Bars:  # fmt: skip
    """What bars the ways to an object at a site (x, y, z)."""
    size = the.scene.objects[index].size
    own = np.array([min(size[:2]) / 2, size[2]])
    barred = {
        j: reference.barred_headings(
            np.array(site), hold.rows, hold.height, own, row_of(the, j, placement),
            the.hand.sweeps[family], PLAY, LEVEL,
        )
        for j, placement in enumerate(state.placements)
        if placement is not None and j != index
    }  # fmt: skip
    reachable = headings_of(int(the.reachable(np.array([site]), own, hold, family)[0]))
    return [{j for j in barred if k in barred[j]} for k in sorted(reachable)]


def ways_of(the: TabletopWorld, state: State, index: int, family: int) -> tuple[Bars, list[Bars]]:
    """What bars the ways to a standing object, and to each site of its goal."""
    placement, goal = state.placements[index], the.goals[index]
    assert placement is not None
    x, y, yaw = placement.pose
    hold, narrow = box_hold(the, index, family, yaw), box_hold(the, index, family, 0.0)
    if hold is None or narrow is None or not narrow.fits:
        return [], []
    best = min(headings_of(narrow.fits), key=lambda k: (narrow.rows[k, 0], k))
    put = SiteHold(np.tile(narrow.rows[best], (HEADINGS, 1)), narrow.height, swept.ALL)
    site = (x, y, the.grounds[placement.support].height)
    before = barring(the, state, index, site, family, hold)
    rest = the.grounds[goal.support].height
    after = [barring(the, state, index, (sx, sy, rest), family, put) for sx, sy in goal.xy]
    return before, after


def least_sum(the: TabletopWorld, state: State, index: int) -> int:
    """Least for picking, plus least for placing somewhere, with the same family of grasps."""
    best = 2 * UNREACHABLE
    for family in the.families:
        before, after = ways_of(the, state, index, family)
        pick = min(map(len, before), default=UNREACHABLE)
        place = min((len(b) for bars in after for b in bars), default=UNREACHABLE)
        best = min(best, pick + place)
    return best


def fewest_to_move(the: TabletopWorld, state: State, index: int) -> int:
    """alpha of a standing object whose heading at its goal does not matter: fewest objects
    that bar a heading to it or a heading to its goal, for some family of grasps."""
    best = 2 * UNREACHABLE
    for family in the.families:
        before, after = ways_of(the, state, index, family)
        # Of sets that hold another one, only the smaller matter.
        place = {frozenset(b) for bars in after for b in bars}
        best = min([best, *(len(a | b) for a in before for b in place)])
    return best


def with_families(the: TabletopWorld, families: tuple[int, ...]) -> TabletopWorld:
    """The same task for a robot that may use other approaches."""
    return replace(the, families=families, memory=Memory())


def random_sticks(rng: np.random.Generator, count: int) -> list[tuple[float, float]]:
    """Places on the left table, close to each other but apart."""
    found: list[tuple[float, float]] = []
    while len(found) < count:
        x, y = 0.8 + rng.uniform(-0.15, 0.15), 0.6 + rng.uniform(-0.15, 0.15)
        if all(math.dist((x, y), other) > 0.065 for other in found):
            found.append((round(x, 4), round(y, 4)))
    return found


@pytest.mark.parametrize("families", [(SIDE,), (SIDE, TOP), (PINCH,), (SIDE, TOP, PINCH)])
@pytest.mark.parametrize("seed", range(2))
def test_obstructions_agree_with_brute_force(tmp_path, seed, families) -> None:
    """Sticks, cubes and thin plates side by side, so that each family has its turn."""
    rng = np.random.default_rng(seed)
    entries = [
        box(f"o{i}", x, y, SIZES[int(rng.integers(3))], 15 * int(rng.integers(0, 6)))
        for i, (x, y) in enumerate(random_sticks(rng, 9))
    ]
    entries += [ON_RIGHT.format(f"o{i}") for i in range(4)]
    the = with_families(task(tmp_path, *entries), families)
    found = [min(obstructions(the.initial, Object(i)), UNREACHABLE) for i in range(4)]
    expected = [min(fewest_to_move(the, the.initial, i), UNREACHABLE) for i in range(4)]
    assert found == expected


@pytest.mark.parametrize("shift", [(0.0, 0.02), (0.015, -0.01), (-0.01, 0.005)])
def test_what_bars_both_ways_counts_once(tmp_path, shift) -> None:
    """A stick inside a ring is to move by a little: one stick of the ring bars both ways."""
    ring = [stick(f"r{i}", x, y) for i, (x, y) in enumerate(RING)]
    goal = AT.format("a", 0.8 + shift[0], 0.6 + shift[1])
    the = task(tmp_path, stick("a", 0.8, 0.6), *ring, goal)
    found = obstructions(the.initial, Object(0))
    assert found == fewest_to_move(the, the.initial, 0)
    assert found < least_sum(the, the.initial, 0)


def test_brute_force_has_seen_obstructions(tmp_path) -> None:
    """The random scenes above are no empty tables."""
    counts = set()
    for seed in range(4):
        rng = np.random.default_rng(seed)
        sticks = [stick(f"o{i}", x, y) for i, (x, y) in enumerate(random_sticks(rng, 9))]
        the = task(tmp_path, *sticks, *(ON_RIGHT.format(f"o{i}") for i in range(4)))
        counts |= {obstructions(the.initial, Object(i)) for i in range(4)}
    assert len(counts) > 1


# -- functions of the state alone --------------------------------------------------------------


def wander(the: TabletopWorld, rng: np.random.Generator, steps: int) -> list[State]:
    """States of a random walk, executable or not."""
    states = [the.initial]
    while len(states) < steps:
        state = states[-1]
        if state.held is None:
            index = int(rng.integers(len(state.placements)))
            state = Pick(index, Grasp.of(rng.uniform(0, 6), 0.12)).after(state)
        else:
            x, y = rng.uniform(-0.2, 0.2, 2)
            surface = int(rng.integers(2))
            at = Placement.of(0.8 + x, (0.6, -0.9)[surface] + y, rng.uniform(0, 6), surface)
            state = Place(state.held, at).after(state)
        states.append(MoveBase(BasePose.of(*rng.uniform(-1, 1, 2), 0.0)).after(state))
    return states


def crowded(folder: Path) -> TabletopWorld:
    rng = np.random.default_rng(7)
    entries = [stick(f"o{i}", x, y) for i, (x, y) in enumerate(random_sticks(rng, 6))]
    goals = [ON_RIGHT.format("o0"), ON_RIGHT.format("o1"), AT.format("o2", 0.9, -0.8)]
    return task(folder, *entries, *goals)


def test_features_do_not_depend_on_what_was_asked_before(tmp_path, sketch) -> None:
    the = crowded(tmp_path)
    states = wander(the, np.random.default_rng(3), 25)
    forwards = [features(sketch, state) for state in states]
    other = crowded(tmp_path)
    moved = [replace(state, world=other) for state in states]
    backwards = [features(sketch, state) for state in reversed(moved)]
    assert forwards == backwards[::-1]
    assert len({tuple(found.values()) for found in forwards}) > 3


def test_features_do_not_depend_on_where_the_robot_stands(tmp_path, sketch) -> None:
    the = crowded(tmp_path)
    for state in wander(the, np.random.default_rng(4), 10):
        elsewhere = MoveBase(BasePose.of(-1.0, 1.0, 2.0)).after(state)
        assert features(sketch, state) == features(sketch, elsewhere)


def test_features_survive_a_full_cache(tmp_path, sketch) -> None:
    the = crowded(tmp_path)
    before = features(sketch, the.initial)
    for i in range(600):
        moved = Placement.of(0.8, 0.6 + 1e-4 * i, 0.0, 0)
        arrangement(the, (moved, *the.initial.placements[1:]))
    assert features(sketch, the.initial) == before


def test_a_goal_state_has_nothing_misplaced(tmp_path, sketch) -> None:
    the = task(tmp_path, stick("a", 0.8, -0.9), ON_RIGHT.format("a"))
    assert sketch.model.is_goal(sketch.evaluate(the.initial))


def test_what_is_carried_over_is_what_would_be_computed_anew(tmp_path) -> None:
    """In a scene of many tables most objects are far from what moves."""
    path = tmp_path / "many.toml"
    path.write_text(sorting_scene(40, seed=3), encoding="utf-8")
    scene, robot = load_scene(path), load_robot("tiago")
    the, rng = TabletopWorld.of(scene, robot), np.random.default_rng(5)
    state, values = the.initial, set()
    for step in range(40):
        if state.held is None:
            index = int(rng.integers(2, len(scene.objects)))
            state = Pick(index, Grasp.of(rng.uniform(0, 6), 0.12)).after(state)
        else:
            # Around two objects that stay, so that some bar the way to others.
            beside, angle = state.placements[int(rng.integers(2))], rng.uniform(0, 6)
            assert beside is not None
            x, y = beside.pose[0] + 0.06 * math.cos(angle), beside.pose[1] + 0.06 * math.sin(angle)
            state = Place(state.held, Placement.of(x, y, angle, beside.support)).after(state)
        found = [obstructions(state, Object(i)) for i in range(len(scene.objects))]
        if step % 5 >= 3:
            fresh = TabletopWorld.of(scene, robot)
            anew = replace(state, world=fresh)
            assert found == [obstructions(anew, Object(i)) for i in range(len(scene.objects))]
        values |= set(found)
    assert len(values) > 2


@pytest.mark.parametrize(("dx", "yaw", "barred"), [(0.085, 0, True), (0.12, 0, False)])
def test_what_reaches_into_a_corner_of_a_place_is_in_the_way(tmp_path, dx, yaw, barred) -> None:
    """A long carton that has to lie straight, and a cube where one of its ends belongs."""
    carton = box("carton", 0.8, 0.6, (0.16, 0.04, 0.04), 0)
    goal = f'[[goal]]\nobject = "carton"\nat = [0.8, -0.9]\nyaw = {yaw}\n'
    cube = box("cube", 0.8 + dx, -0.9 + 0.03, (0.03, 0.03, 0.03), 0)
    the = with_families(task(tmp_path, carton, cube, goal), (TOP,))
    assert (obstructions(the.initial, Object(0)) > 0) == barred


@pytest.mark.parametrize("seed", range(3))
def test_base_poses_are_clear_of_what_stands_on_the_floor(tmp_path, seed) -> None:
    rng = np.random.default_rng(seed)
    tall = (0.05, 0.05, 0.3)
    spots = [tuple(np.round(rng.uniform((-1.6, -0.7), (-0.9, 0.7)), 3)) for _ in range(5)]
    things = [box(f"o{i}", x, y, tall, 0) + 'on = "floor"\n' for i, (x, y) in enumerate(spots)]
    entry = box("a", 0.6, 0.6, (0.04, 0.04, 0.2), 0)
    the = task(tmp_path, entry, *things, ON_RIGHT.format("a"), ON_RIGHT.format("o0"))
    problem = TabletopProblem(the, 0)
    state = the.initial
    roads = problem.executor.roads_for(state)
    found = [
        problem.sampler.bases.pose_for(state, i, state.placements[i], grasp, rng)
        for i in (0, 1)
        for a in np.arange(0.0, 6.0, 0.25)
        if (grasp := the.grasp(i, 0, SIDE, a)) is not None
    ]
    poses = [base for base in found if base is not None]
    assert len(poses) > 10
    assert all(roads.can_turn(*base.pose[:2]) for base in poses)


def test_what_is_far_from_a_goal_bars_no_way_to_it(tmp_path) -> None:
    """By circles around all its sites, beside what is found site by site; some goals are near."""
    path = tmp_path / "scene.toml"
    path.write_text(sorting_scene(60, seed=5), encoding="utf-8")
    world = TabletopWorld.of(load_scene(path, "scene"), load_robot("tiago"))
    here = arrangement(world, world.initial.placements)
    one_of = {goal.key: (index, goal) for index, goal in world.goals.items()}
    told: list[bool] = []
    for index, goal in one_of.values():
        boxes = np.vstack([world.site_boxes(*other) for other in one_of.values()])
        for family in world.families:
            ways = here.places_of(index, goal, family)
            barred = place_barred(world, ways, family, boxes).any(axis=0)
            for box, bars in zip(boxes, barred, strict=True):
                told.append(_all_far(here, ways, box[None]))
                assert not (told[-1] and bars)
    assert any(told)
    assert not all(told)
