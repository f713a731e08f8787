"""What rests where, and what falls: statics against what is known of stacks."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from runtime.judge.extents import homogeneous
from runtime.judge.footing import Poses, above, footings
from runtime.judge.polygon import clip, convex_hull, outside_by
from runtime.judge.stability import falls, fault_of_rest
from runtime.world.body import Body, Part
from runtime.world.poses import Floats, upright
from runtime.world.solids import Box, Cylinder, Solid, Sphere
from runtime.world.world import FLOOR, Fixed, Movable, Support, World

SIDE = 0.05
AIR = 0.002


def body(solid: Solid, bottom: float, mass: float = 1.0) -> Body:
    return Body((Part(solid, upright(0, 0, bottom, 0)),), mass, (0.0, 0.0, bottom))


def cubes(count: int, mass: float = 1.0) -> World:
    """Cubes with tops that bear, and a table of 40 cm that is 70 cm high."""
    cube = body(Box((SIDE, SIDE, SIDE)), SIDE / 2, mass)
    table = Fixed("table", body(Box((0.4, 0.4, 0.7)), 0.35), upright(0, 0, 0, 0))
    tops = tuple(
        Support(f"top{i}", f"cube{i}", upright(0, 0, SIDE + AIR, 0), (SIDE / 2, SIDE / 2))
        for i in range(count)
    )
    return World(
        name="cubes",
        digest="",
        robot_start=(0, 0, 0),
        fixed=(table,),
        movables=tuple(Movable(f"cube{i}", cube, upright(0, 0, 0, 0)) for i in range(count)),
        supports=(
            Support("table", "table", upright(0, 0, 0.7 + AIR, 0), (0.2, 0.2)),
            Support(FLOOR, FLOOR, upright(0, 0, AIR, 0), (10.0, 10.0)),
            *tops,
        ),
    )


def at(x: float, y: float, level: int, yaw: float = 0.0) -> Floats:
    """A cube on the table, or on others on it."""
    return homogeneous(upright(x, y, 0.7 + AIR + level * (SIDE + AIR), yaw))


def test_a_cube_is_kept_to_what_it_may_rest_on() -> None:
    world = cubes(2)
    kept = replace(world.movables[1], only_on=frozenset({"top0", FLOOR}))
    world = replace(world, movables=(world.movables[0], kept))
    below = at(0.1, 0, 0)
    assert fault_of_rest(world, {0: below, 1: at(0.1, 0, 1)}, 1, "top0") is None
    assert fault_of_rest(world, {0: below, 1: homogeneous(upright(2, 2, AIR, 0))}, 1, FLOOR) is None
    told = str(fault_of_rest(world, {0: below, 1: at(-0.1, 0, 0)}, 1, "table"))
    assert "cube1 rests on table, where it may not be put" in told
    # It is borne by the other one as well, but its middle is beside that.
    table = replace(world.supports[0], pose=upright(0, 0, 0.7 + AIR + SIDE + AIR, 0))
    high = replace(world, supports=(table, *world.supports[1:]))
    beside = at(0.1 + 0.6 * SIDE, 0, 1)
    assert "may not be put" in str(fault_of_rest(high, {0: below, 1: beside}, 1, None))


def test_a_cube_rests_on_the_table_and_on_the_floor() -> None:
    world = cubes(1)
    assert fault_of_rest(world, {0: at(0.1, 0, 0)}, 0, "table") is None
    assert fault_of_rest(world, {0: homogeneous(upright(2, 2, AIR, 1.0))}, 0, FLOOR) is None
    assert "the plan says on floor" in str(fault_of_rest(world, {0: at(0.1, 0, 0)}, 0, FLOOR))
    assert "no support" in str(fault_of_rest(world, {0: at(0.1, 0, 0)}, 0, "moon"))


def test_what_juts_hangs_in_the_air_or_leans_is_told() -> None:
    world = cubes(1)
    assert fault_of_rest(world, {0: at(0.174, 0, 0)}, 0, "table") is None
    # It may jut out as far as it stands: its middle is what counts.
    assert fault_of_rest(world, {0: at(0.193, 0, 0)}, 0, "table") is None
    assert fault_of_rest(world, {0: at(0.199, 0, 0)}, 0, "table") is None
    assert "tips over" in str(fault_of_rest(world, {0: at(0.201, 0, 0)}, 0, "table"))
    high = at(0.0, 0.0, 0)
    high[2, 3] += 0.005
    assert "5.0 mm too high for table" in str(fault_of_rest(world, {0: high}, 0, "table"))
    leaning = at(0.0, 0.0, 0)
    c, s = math.cos(0.05), math.sin(0.05)
    leaning[:3, :3] = [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    leaning[2, 3] += s * SIDE / 2
    assert "tips over" in str(fault_of_rest(world, {0: leaning}, 0, "table"))


@pytest.mark.parametrize(("shift", "stands"), [(0.0, True), (0.024, True), (0.026, False)])
def test_two_cubes_stand_up_to_half_a_side_apart(shift, stands) -> None:
    world = cubes(2)
    poses = {0: at(0, 0, 0), 1: at(shift, 0, 1)}
    assert (fault_of_rest(world, poses, 1, "top0") is None) == stands
    assert above(world, poses, [0]) == {1}


@pytest.mark.parametrize("factor", [0.98, 1.02])
def test_the_harmonic_stack_is_the_limit(factor) -> None:
    """From the top, bricks may jut by a half, a quarter, a sixth of a half length each."""
    world = cubes(4)
    shifts = [factor * SIDE / 2 / k for k in (3, 2, 1)]
    places = np.concatenate([[0.0], np.cumsum(shifts)])
    poses = {i: at(float(x), 0, i) for i, x in enumerate(places)}
    assert (falls(world, poses, [0, 1, 2, 3]) is None) == (factor < 1)


def test_a_pyramid_stands_and_a_bridge_without_a_pillar_falls() -> None:
    world = cubes(3)
    gap = SIDE * 1.2
    poses = {0: at(-gap / 2, 0, 0), 1: at(gap / 2, 0, 0), 2: at(0, 0, 1)}
    assert fault_of_rest(world, poses, 2, "top1") is None
    assert {f.support.name for f in footings(world, poses, 2)} == {"top0", "top1"}
    one = {i: pose for i, pose in poses.items() if i != 1}
    assert "falls over" in str(fault_of_rest(world, one, 2, "top0"))


def test_a_cube_put_on_the_edge_of_another_can_tip_the_other() -> None:
    """A light cube that stands with a third over the edge of one below bears nothing there."""
    world = cubes(3)
    poses = {0: at(0, 0, 0), 1: at(0.02, 0, 1)}
    assert falls(world, poses, [0, 1]) is None
    assert "falls over" in str(fault_of_rest(world, {**poses, 2: at(0.038, 0, 2)}, 2, "top1"))


def test_round_things_rest_on_a_point_or_a_line() -> None:
    world = cubes(1)
    ball = Movable("ball", body(Sphere(0.03), 0.03), upright(0, 0, 0, 0))
    can = Movable("can", body(Cylinder(0.033, 0.12), 0.06), upright(0, 0, 0, 0))
    world = World(world.name, "", (0, 0, 0), world.fixed, (ball, can), world.supports[:2])
    lying = np.eye(4)
    lying[:3, :3] = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    lying[:3, 3] = -0.06, 0.0, 0.7 + AIR + 0.033
    for index, pose in ((0, at(0, 0, 0)), (1, at(0, 0, 0)), (1, lying)):
        assert fault_of_rest(world, {index: pose}, index, "table") is None


@settings(max_examples=60, deadline=None)
@given(
    points=st.lists(st.tuples(*[st.floats(-1, 1, width=32)] * 2), min_size=1, max_size=12),
    point=st.tuples(*[st.floats(-2, 2, width=32)] * 2),
)
def test_inside_a_hull_is_a_mean_of_its_points(points, point) -> None:
    """A point lies in the hull if and only if it is a weighted mean of the corners."""
    from scipy.optimize import linprog

    corners = convex_hull(np.array(points))
    off = outside_by(corners, np.array(point))
    rows = np.vstack([np.array(points).T, np.ones(len(points))])
    mean = linprog(np.zeros(len(points)), A_eq=rows, b_eq=[*point, 1.0])
    if abs(off) > 1e-5:
        assert (mean.status == 0) == (off < 0)


def test_clipping_cuts_straight() -> None:
    square = convex_hull(np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]]))
    half = clip(square, np.array([1.0, 0.0]), 0.25)
    assert half[:, 0].max() == pytest.approx(0.25)
    assert half[:, 1].max() == 1.0
    assert len(clip(square, np.array([1.0, 0.0]), -0.1)) == 0


def poses_of(world: World) -> Poses:
    return {i: homogeneous(thing.pose) for i, thing in enumerate(world.movables)}
