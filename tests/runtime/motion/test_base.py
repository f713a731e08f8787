"""Base motions: free of contact in exact geometry, and what a differential drive can do."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from domains.tabletop.scene.model import Scene
from runtime.angles import wrap
from runtime.judge.contacts import Exact, Track
from runtime.judge.skeleton import Skeleton
from runtime.motion.base import MARGIN, BaseRoads, drive, footprint
from runtime.motion.room import room_around
from runtime.robot.model import RobotModel
from runtime.robot.urdf import Box
from tests.runtime.reference import (
    Floats,
    along,
    placed_boxes,
    solid_box,
    upright_pose,
    upright_row,
)

WIDE = Box("held", np.eye(3, 4), np.array([0.15, 0.02, 0.1]))
"""An object that sticks out of the gripper."""


def tracks(robot: RobotModel, base: Floats, held: Box | None) -> list[Track]:
    """The robot's boxes in its home posture along base poses (N, 3)."""
    skeleton = Skeleton(robot)
    q = np.tile(robot.home, (len(base), 1))
    links = skeleton.transforms(base, q, robot.gripper.max_opening)
    found = skeleton.tracks(links)
    if held is not None:
        pose = np.vstack([held.pose, [0, 0, 0, 1]])
        found.append(Track("held", solid_box(held.half), links[robot.urdf_tool] @ pose))
    return found


def hits(robot: RobotModel, base: Floats, boxes: Floats, held: Box | None) -> bool:
    world = []
    for row in boxes:
        pose = np.vstack([upright_pose(row), [0, 0, 0, 1]])
        world.append(Track("obstacle", solid_box(row[3:6]), pose[None]))
    pairs = [(a, b) for a in tracks(robot, base, held) for b in world]
    return Exact().first_hit(pairs) is not None


def roads_of(robot: RobotModel, boxes: Floats, held: Box | None = None) -> BaseRoads:
    rings = footprint(robot, robot.body(robot.gripper.max_opening, held))
    return BaseRoads(boxes, rings.clearances(boxes))


def random_obstacles(rng: np.random.Generator) -> Floats:
    """Tables, low walls and shelves in the air, around the origin."""
    rows = []
    for _ in range(6):
        x, y = rng.uniform(-2.5, 2.5, 2)
        low = float(rng.choice([0.0, 0.0, 0.5, 1.0]))
        height = rng.uniform(0.1, 0.8)
        half = np.array([*rng.uniform(0.05, 0.5, 2), height / 2])
        rows.append(
            upright_row(np.array([x, y, low + height / 2]), half, rng.uniform(-math.pi, math.pi))
        )
    return np.array(rows)


@pytest.mark.parametrize("held", [None, WIDE], ids=["empty", "carrying"])
def test_drives_touch_nothing_in_exact_geometry(robot, held, rng) -> None:
    checked = bends = 0
    while checked < 8:
        boxes = random_obstacles(rng)
        roads = roads_of(robot, boxes, held)
        start, goal = rng.uniform(-3, 3, 2), rng.uniform(-3, 3, 2)
        route = roads.route(tuple(start), tuple(goal))
        if route is None:
            continue
        checked += 1
        bends += len(route) > 2
        poses = drive(route, rng.uniform(-3, 3), rng.uniform(-3, 3))
        assert not hits(robot, along(poses, 60), boxes, held)
    assert bends


def test_a_clear_position_is_safe_in_every_heading(robot, rng) -> None:
    checked = 0
    while checked < 10:
        boxes = random_obstacles(rng)
        x, y = rng.uniform(-2, 2, 2)
        if not roads_of(robot, boxes).is_clear(x, y):
            continue
        checked += 1
        turns = np.array([[x, y, yaw] for yaw in np.linspace(0, 2 * math.pi, 90)])
        assert not hits(robot, turns, boxes, None)


def test_clearances_are_no_larger_than_the_rings_need(robot) -> None:
    """A table at arm's height needs the widest ring at its height, and nothing more."""
    body = robot.body(robot.gripper.max_opening)
    placed = placed_boxes(robot.chain, body, robot.home)
    rings = footprint(robot, body)
    table = upright_row(np.array([2.0, 0.0, 0.05]), np.array([0.3, 0.3, 0.05]), 0.0)
    low = [
        np.hypot(*(signs * half @ pose[:, :3].T + pose[:, 3])[:2])
        for pose, half in zip(placed, body.half, strict=True)
        for signs in map(np.array, itertools.product((-1, 1), repeat=3))
        if pose[2, 3] - half[2] < 0.1
    ]
    assert rings.clearances(table[None])[0] == pytest.approx(max(low) + MARGIN, abs=1e-6)


def test_what_hangs_above_the_robot_is_in_nobodys_way(robot) -> None:
    lamp = upright_row(np.array([0.0, 0.0, 3.0]), np.array([0.5, 0.5, 0.1]), 0.0)
    roads = roads_of(robot, lamp[None])
    route = roads.route((-2.0, 0.0), (2.0, 0.0))
    assert route is not None
    assert route.tolist() == [[-2.0, 0.0], [2.0, 0.0]]


def test_routes_join_start_and_goal_and_are_at_least_as_long_as_the_line(robot, rng) -> None:
    for _ in range(20):
        roads = roads_of(robot, random_obstacles(rng))
        start, goal = tuple(rng.uniform(-3, 3, 2)), tuple(rng.uniform(-3, 3, 2))
        route = roads.route(start, goal)
        if route is not None:
            assert tuple(route[0]) == start
            assert tuple(route[-1]) == goal
            length = np.linalg.norm(np.diff(route, axis=0), axis=1).sum()
            assert length >= math.dist(start, goal) - 1e-9


def test_no_route_leads_through_a_closed_fence(robot, sticks: Scene) -> None:
    roads = roads_of(robot, sticks.obstacle_rows)
    assert roads.route((0.0, 0.0), (5.0, 0.0)) is None
    assert roads.route((5.0, 0.0), (0.0, 0.0)) is None


def test_no_route_starts_or_ends_in_a_table(robot, sticks: Scene) -> None:
    roads = roads_of(robot, sticks.obstacle_rows)
    table = sticks.surfaces[0].table.centre[:2]
    assert roads.route((0.0, 0.0), table) is None
    assert roads.route(table, (0.0, 0.0)) is None


def test_the_way_around_a_table_is_found(robot) -> None:
    table = upright_row(np.array([0.0, 0.0, 0.4]), np.array([0.5, 0.5, 0.4]), 0.0)
    route = roads_of(robot, table[None]).route((-2.0, 0.0), (2.0, 0.0))
    assert route is not None
    assert len(route) > 2
    assert np.linalg.norm(np.diff(route, axis=0), axis=1).sum() < 6.0


def random_route(rng: np.random.Generator) -> Floats:
    return rng.uniform(-1, 1, (int(rng.integers(2, 6)), 2)) * rng.choice([0.1, 1.0])


def test_a_drive_turns_or_drives_but_never_both(rng) -> None:
    for _ in range(200):
        poses = drive(random_route(rng), rng.uniform(-7, 7), rng.uniform(-7, 7))
        for a, b in itertools.pairwise(poses):
            moved, turned = math.dist(a[:2], b[:2]), abs(b[2] - a[2])
            assert moved < 1e-9 or turned < 1e-9
            if moved > 1e-9:
                off = wrap(math.atan2(b[1] - a[1], b[0] - a[0]) - a[2])
                assert min(abs(off), math.pi - abs(off)) < 1e-6


def test_a_drive_visits_its_way_points_and_ends_as_wanted(rng) -> None:
    for _ in range(100):
        route, start, goal = random_route(rng), rng.uniform(-7, 7), rng.uniform(-7, 7)
        poses = drive(route, start, goal)
        assert poses[0] == pytest.approx([*route[0], start])
        assert poses[-1, :2] == pytest.approx(route[-1])
        assert wrap(poses[-1, 2] - goal) == pytest.approx(0.0, abs=1e-9)
        for point in route:
            assert np.linalg.norm(poses[:, :2] - point, axis=1).min() < 1e-9


def test_turns_take_the_shorter_way(rng) -> None:
    for _ in range(100):
        poses = drive(random_route(rng), rng.uniform(-7, 7), rng.uniform(-7, 7))
        assert np.abs(np.diff(poses[:, 2])).max() <= math.pi + 1e-9


def test_a_drive_to_where_the_robot_stands_is_two_equal_poses() -> None:
    poses = drive(np.array([[1.0, 2.0], [1.0, 2.0]]), 0.5, 0.5)
    assert poses.tolist() == [[1.0, 2.0, 0.5], [1.0, 2.0, 0.5]]


def test_the_room_ends_at_the_fence(robot, sticks: Scene) -> None:
    clearance = footprint(robot, robot.body(0.0)).clearances(sticks.obstacle_rows)
    room = room_around(sticks.obstacle_rows, clearance, 0.0, 0.0)
    assert room.contains(0.0, 0.0)
    assert not room.contains(4.0, 0.0)
    assert not room.contains(*sticks.surfaces[0].table.centre[:2])
    outside = room_around(sticks.obstacle_rows, clearance, 4.0, 0.0)
    assert outside.contains(4.0, 0.0)
    assert not outside.contains(0.0, 0.0)


def test_wherever_a_route_leads_is_in_the_room(robot, rng) -> None:
    for _ in range(5):
        boxes = random_obstacles(rng)
        roads = roads_of(robot, boxes)
        start = (3.4, 3.4)
        room = room_around(boxes, roads.clearance, *start)
        for goal in rng.uniform(-3, 3, (40, 2)):
            if roads.route(start, tuple(goal)) is not None:
                assert room.contains(*goal)
