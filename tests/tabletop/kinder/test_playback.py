"""Plans played back in a KinDER of few lines: steps are bounded, refused ones divided."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from domains.tabletop.kinder.observed import Observation, Thing
from domains.tabletop.kinder.playback import GAP, Player
from domains.tabletop.kinder.problem import Problem
from domains.tabletop.kinder.slim import NEAR, away_from, gap_between
from domains.tabletop.kinder.way import (
    DENSE,
    RISE,
    dense,
    furthest,
    gone_aside,
    stopped_above,
    stretches,
)
from domains.tabletop.scene.furniture import AIR
from runtime.motion.motion import ArmMove, Attach, BaseMove, GripperMove, Release
from runtime.plan.model import Plan, PlanAction, TimedPiece
from runtime.world.body import Body, Part
from runtime.world.poses import upright
from runtime.world.quaternions import pose_of
from runtime.world.solids import Box
from runtime.world.world import Movable, World

LIMIT = 0.2
FEATURES = [f"pose_{axis}" for axis in ("x", "y", "z", "qx", "qy", "qz")]
FEATURES += [f"half_extent_{axis}" for axis in "xyz"]
ROWS = st.lists(
    st.lists(st.floats(-3, 3), min_size=10, max_size=10).map(np.array), min_size=2, max_size=5
)


class Gantry:
    """A robot whose tool is as high as its first joint says."""

    home = np.zeros(7)

    def tool_pose(self, q):
        pose = np.zeros((3, 4))
        pose[2, 3] = q[0]
        return pose


class FakeKinder:
    """Holds the robot, one thing, and the rules of a step. `wall` refuses configurations."""

    def __init__(self, wall=lambda q: False, goal=lambda self: False) -> None:
        self.q, self.z, self.held, self.off = np.zeros(10), 0.05, False, 0.0
        self.wall, self.goal = wall, goal
        self.beside: Thing | None = None
        self.actions: list[np.ndarray] = []

    @property
    def seen(self) -> Observation:
        base = self.q[:3].copy()
        base[2] = (base[2] + math.pi) % (2 * math.pi) - math.pi  # headings are wrapped there
        features = dict.fromkeys(FEATURES, 0.0) | {"pose_z": self.z}
        thing = Thing("cube", "c", {**features, "half_extent_z": 0.05, "grasp_active": self.held})
        things = {"cube": thing} | ({"beside": self.beside} if self.beside else {})
        return Observation(base, self.q[3:].copy(), 0.0, self.held, things, self.goal(self), LIMIT)

    def step(self, action) -> Observation:
        action = np.array(action, dtype=np.float32).astype(float)
        assert np.abs(action[:10]).max() <= LIMIT + 1e-6
        self.actions.append(action)
        after = self.q + action[:10]
        touches = self.held and self.off + after[3] - 0.05 <= 1e-6
        if not self.wall(after) and not touches:
            self.q = after
            if self.held:
                self.z = self.off + self.q[3]
        if action[10] < -0.5 and not self.held:
            self.held, self.off = True, self.z - self.q[3]
        elif action[10] > 0.5 and self.held and self.z - 0.05 <= 0.005:
            self.held = False
        return self.seen


def player(fake: FakeKinder, air=None) -> Player:
    return Player(fake, Gantry(), fake.seen, LIMIT, Problem("", (), air=air or {}))  # type: ignore[arg-type]


def plan_of(*pieces) -> Plan:
    timed = tuple(TimedPiece(piece, np.zeros(1)) for piece in pieces)
    action = PlanAction("a", "some action", 0, timed)
    return Plan("", "", "", "", "", "", 0, ("cube",), (0.0, 0.0, 0.0), (), (action,))


def world() -> World:
    cube = Body((Part(Box((0.1, 0.1, 0.1)), upright(0, 0, 0.05, 0)),), 1.0, (0, 0, 0.05))
    return World(
        name="w", digest="", robot_start=(0, 0, 0), fixed=(), supports=(), goals=(),
        movables=(Movable("cube", cube, upright(0.0, 0.0, AIR, 0.0)),),
    )  # fmt: skip


def arm(*heights: float) -> ArmMove:
    rows = np.zeros((len(heights), 7))
    rows[:, 0] = heights
    return ArmMove(rows, "free")


def release(z: float) -> GripperMove:
    pose = pose_of(upright(0.0, 0.0, z, 0.0))
    return GripperMove(0.1, release=Release("cube", "table", pose))


def block(name: str, x: float, y: float, **more: float) -> Thing:
    """A cube of 4 cm."""
    at = dict.fromkeys(FEATURES, 0.0) | dict.fromkeys(FEATURES[-3:], 0.02)
    return Thing(name, "c", at | {"pose_x": x, "pose_y": y, "pose_z": 0.02} | more)


@pytest.mark.parametrize(
    ("others", "aside"),
    [
        ([(0.0401, 0.0)], (NEAR - 0.0001, 0.0)),
        ([(0.043, 0.0)], (0.0, 0.0)),
        ([(0.01, -0.041)], (0.0, NEAR - 0.001)),
        ([(0.041, 0.0), (-0.041, 0.0)], (0.0, 0.0)),
        ([(-0.041, 0.0), (-0.042, 0.01), (0.0, 0.04)], (NEAR - 0.001, -NEAR)),
    ],
)
def test_what_nearly_touches_is_gone_aside_of(others, aside) -> None:
    thing = block("a", 0.0, 0.0)
    around = [block(f"b{i}", x, y) for i, (x, y) in enumerate(others)]
    found = away_from(thing, [*around, thing, Thing("triangle", "t", block("", 0, 0).features)])
    assert np.abs(found) == pytest.approx(np.abs(aside))
    for (x, y), before in zip(others, around, strict=True):
        moved = block("a", *found)
        if any(aside):
            assert gap_between(moved, before) == pytest.approx(
                max(abs(x), abs(y)) - 0.04 + abs(found[int(abs(y) > abs(x))]), abs=1e-9
            )
    turned = [block(f"b{i}", x, y, pose_qz=0.1) for i, (x, y) in enumerate(others)]
    assert away_from(thing, turned) == (0.0, 0.0)


@given(ROWS, st.floats(-0.01, 0.01))
def test_only_the_low_part_of_a_way_is_gone_aside(rows, y) -> None:
    way = np.array(rows)
    heights = np.linspace(0.0, 2.5 * RISE, len(way))
    found = gone_aside(way, heights, (0.002, y))
    assert np.array_equal(found[0], way[0])
    low = int((heights <= RISE).sum())
    assert len(found) == len(way) + 1
    assert np.array_equal(found[1 + low :], way[low:])
    difference = found[1 : 1 + low] - way[:low]
    assert np.allclose(difference, [0.002, y, *np.zeros(8)], atol=1e-12)


def test_a_thing_that_touches_another_is_lifted_aside_of_it() -> None:
    """A wall on its left: straight up it does not come past."""

    def tight(q) -> bool:
        return bool(1e-6 < q[3] < 0.03 and q[0] > -0.001)

    fake = FakeKinder(wall=tight)
    fake.beside = block("wall", 0.0401, 0.0, half_extent_x=0.04, pose_z=0.05)
    rows = np.zeros((3, 7))
    rows[:, :2] = (0.0, 0.0), (0.02, 0.1), (0.3, 0.1)  # a corner: no step leads past it
    pieces = [GripperMove(0.1, Attach("cube", None)), ArmMove(rows, "lift")]
    played = player(fake).play(world(), plan_of(*pieces))
    assert played.reason == "the plan was carried out, and the goal was not reached"
    assert fake.q[3] == pytest.approx(0.3)
    assert np.abs(fake.q[:3]).max() < 1e-6


def test_things_are_let_go_a_little_above_what_they_are_put_on() -> None:
    """Twice in a row: what was too high the first time is not so twice."""
    fake = FakeKinder()
    take, low = GripperMove(0.1, Attach("cube", None)), AIR
    put = [arm(0.3, 0.0), take, arm(0.0, 0.3, 0.0), release(low)]
    played = player(fake).play(world(), plan_of(*put, *put, arm(0.0, 0.3)))
    assert not fake.held
    assert played.refused == 0
    assert fake.z - 0.05 == pytest.approx(GAP, abs=1e-6)
    assert played.reason is not None
    assert "goal was not reached" in played.reason


def test_what_is_not_let_go_is_said() -> None:
    fake = FakeKinder()
    take = GripperMove(0.1, Attach("cube", None))
    played = player(fake).play(world(), plan_of(take, arm(0.0, 0.3), release(0.3)))
    assert played.reason == "some action: it is not let go"


def test_steps_are_divided_where_one_is_refused() -> None:
    """Of the ends of steps some are refused, but not the way as such."""
    fake = FakeKinder(wall=lambda q: 0.19 < q[3] < 0.21, goal=lambda self: self.q[3] > 0.99)
    played = player(fake).play(world(), plan_of(arm(0.0, 1.0)))
    assert played.terminated
    assert played.refused > 0
    blocked = FakeKinder(wall=lambda q: q[3] > 0.5)
    played = player(blocked).play(world(), plan_of(arm(0.0, 1.0)))
    assert not played.terminated
    assert played.reason == "some action: a step is refused"


def test_headings_go_on_where_a_piece_counts_turns_anew() -> None:
    turn = 2 * math.pi
    pieces = [
        BaseMove(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 3.0]])),
        BaseMove(np.array([[0.0, 0.0, 3.0 - turn], [1.0, 0.0, 3.5 - turn]])),
    ]
    (stretch,) = stretches(plan_of(*pieces), np.zeros(10))
    assert np.abs(np.diff(stretch.way, axis=0)).max() <= DENSE + 1e-9
    assert stretch.way[-1][:3] == pytest.approx([1.0, 0.0, 3.5])
    fake = FakeKinder()
    player(fake).play(world(), plan_of(*pieces))
    assert fake.q[:3] == pytest.approx([1.0, 0.0, 3.5], abs=1e-4)
    assert len(fake.actions) < 30


@settings(deadline=None, max_examples=40)
@given(ROWS)
def test_dense_ways_are_the_same_ways(rows) -> None:
    way = dense(rows)
    assert np.abs(np.diff(way, axis=0)).max(initial=0.0) <= DENSE + 1e-9
    for row in rows:
        assert np.abs(way - row).max(axis=1).min() < 1e-6
    index = 0
    while index < len(way) - 1:  # every step is bounded and leads on
        ahead = furthest(way, index, LIMIT)
        assert ahead > index
        assert np.abs(way[ahead] - way[index]).max() <= LIMIT + 1e-9
        between = np.linspace(way[index], way[ahead], 20)
        away = np.abs(between[:, None] - way[None, index : ahead + 1]).max(axis=2).min(axis=1)
        assert away.max() <= 0.02 + DENSE
        index = ahead


@settings(deadline=None, max_examples=40)
@given(st.floats(0.0, 0.02), st.floats(0.03, 0.3))
def test_ways_down_stop_above_their_end(above, start) -> None:
    heights = np.linspace(start, 0.0, 40)
    way = np.zeros((40, 10))
    way[:, 3] = heights
    cut = stopped_above(way, heights, above)
    assert cut[-1, 3] == pytest.approx(above, abs=1e-9)
    assert (np.diff(cut[:, 3]) <= 1e-12).all()
