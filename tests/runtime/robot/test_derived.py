"""Workspaces and swept volumes: derived from kinematics, and true of postures that are drawn."""

from __future__ import annotations

import json

import numpy as np
import pytest

from runtime.kernels import ik
from runtime.kernels.convex import boxes_only
from runtime.robot import derived as module
from runtime.robot.approach import Family, Workspace
from runtime.robot.derived import derive, derived_of
from runtime.robot.load import load_robot
from runtime.robot.open_hand import tools
from runtime.robot.outline import outline
from runtime.robot.reachable import (
    DISTANCE_STEP,
    HALVINGS,
    approach_frame,
    last_reached,
    shoulder_of,
    wrist_offset_of,
)
from runtime.robot.sweeps import TRAVEL
from runtime.world.poses import Pose, apply, compose, invert
from sketchlang.files import cache_folder
from tests.runtime.robot.robots import TOML, write_robot

FAMILIES = list(Family)


def solve(robot, target: Pose, rng, tries: int = 30):
    """A posture free of self-collision, or None."""
    starts = np.vstack(
        [robot.home, rng.uniform(robot.lower, robot.upper, (tries, len(robot.home)))]
    )
    found = ik.first_free(
        robot.chain, robot.lower, robot.upper, robot.tool, target, starts, 0, 60,
        robot.ease, robot.body(0.05), boxes_only(np.empty((0, 8))), 0.0,
    )  # fmt: skip
    return None if found < 0 else starts[found]


def grasp_frame(robot, family, height, distance, heading, bearing) -> Pose:
    """The approach frame for a wrist at a distance from the shoulder, looked at from it."""
    _, _, offset = robot.workspace(family, height)
    x, y = robot.centre
    wrist = np.array([x + distance * np.cos(bearing), y + distance * np.sin(bearing)])
    point = wrist + offset * np.array([np.cos(heading), np.sin(heading)])
    return approach_frame(family, *point, height, heading)


@pytest.mark.parametrize("family", FAMILIES)
def test_most_of_the_workspace_is_reached_and_far_outside_nothing(robot, family, rng) -> None:
    inside, tried, beyond = 0, 0, 0
    for height in (0.5, 0.75, 1.0):
        inner, outer, _ = robot.workspace(family, height)
        assert 0.0 < inner < outer < 1.0
        for _ in range(12):
            heading = rng.uniform(-0.5, 0.5)
            for distance in (rng.uniform(inner + 0.05, outer - 0.05), outer + 0.3):
                frame = grasp_frame(
                    robot, family, height, distance, heading, rng.uniform(-0.3, 0.3)
                )
                turn = rng.uniform(-1.5, 1.5)
                found = [
                    solve(robot, compose(frame, tool), rng, 15) is not None
                    for tool in tools(family, turn)
                ]
                if distance < outer:
                    inside, tried = inside + any(found), tried + 1
                else:
                    beyond += any(found)
    assert inside >= 0.75 * tried
    assert beyond == 0


@pytest.mark.parametrize("family", FAMILIES)
def test_the_hand_is_within_its_boxes_all_the_way_in(robot, family, rng) -> None:
    approach = robot.approach(family)
    opening = 0.05
    body = robot.body(opening)
    fingers = {finger.part for finger in robot.finger_parts}
    for back in (0.0, TRAVEL / 2, TRAVEL):
        for tool in tools(family, 0.0):
            place = compose(tool, invert(robot.tool))
            place[:, 3] -= back * tool[:, 0]
            for index, part in enumerate(robot.parts):
                if part.frame != len(robot.joints):
                    continue
                cloud = apply(compose(place, body.pose[index]), outline(part.shape.solid))
                boxes = approach.hand
                if index in fingers:
                    closing = 2 if family is Family.PINCH else 1
                    cloud[:, closing] = np.abs(cloud[:, closing]) - opening / 2
                    boxes = approach.fingers
                if family is Family.SLANT:  # in pieces: each point is in one of the boxes
                    held = [any(within(point[None], box) for box in boxes) for point in cloud]
                    assert all(held), part.link
                    continue
                held = [within(cloud, box) for box in boxes]
                assert any(held), part.link


def within(cloud, box) -> bool:
    low, high = box[::2], box[1::2]
    return bool((cloud >= low - 1e-6).all() and (cloud <= high + 1e-6).all())


def test_tiago_is_as_it_was_measured() -> None:
    """What had been measured by hand, by trying which sticks bar the way of an arm at a table, is
    found again: palm and tips from the grasp centre, how far back and how wide the arm is where
    things stand, and the annulus of the wrist (but for its inner radius: no table kept the base
    away here)."""
    robot = load_robot("tiago")
    side = robot.approach(Family.SIDE)
    assert -side.hand[:, 1].max() == pytest.approx(0.063, abs=1e-3)
    assert side.fingers[:, 1].max() == pytest.approx(0.022, abs=1e-3)
    boxes = side.hand_and_arm
    assert -boxes[:, 0].min() == pytest.approx(0.40, abs=0.05)
    assert np.abs(boxes[:, 2:4]).max() == pytest.approx(0.074, abs=0.02)
    inner, outer, offset = robot.workspace(Family.SIDE, 0.8)
    assert robot.centre == pytest.approx((0.093, 0.014), abs=1e-3)
    assert offset == pytest.approx(0.2, abs=1e-3)
    assert outer == pytest.approx(0.72, abs=0.06)
    assert inner <= 0.35


def test_wrist_and_shoulder_are_where_the_axes_are(tmp_path) -> None:
    robot = load_robot(write_robot(tmp_path))
    assert shoulder_of(robot) == pytest.approx((0.0, 0.0))
    # From the axis of the swing, its last joint but one being the lift at the same place.
    assert wrist_offset_of(robot) == pytest.approx(0.46)


def test_a_cached_robot_is_read_and_anything_else_is_derived_anew(
    tmp_path, monkeypatch, robot
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    small = load_robot(write_robot(tmp_path, TOML))
    calls = []
    monkeypatch.setattr(module, "derive", lambda r, f: calls.append(r) or derive(r, f))
    first = derived_of(small)
    (file,) = (cache_folder() / "robots").glob("*.json")
    again = derived_of(small)
    assert len(calls) == 1
    assert np.array_equal(first.workspaces[Family.SIDE].outer, again.workspaces[Family.SIDE].outer)
    assert np.array_equal(first.approaches[Family.TOP].hand, again.approaches[Family.TOP].hand)
    for content in ("", "[]", "{}", json.dumps({"centre": [0, 0], "families": {}})):
        file.write_text(content)
        derived_of(small)
    assert len(calls) == 5


def test_where_no_cache_can_be_the_robot_is_derived_all_the_same(tmp_path, monkeypatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert derived_of(load_robot(write_robot(tmp_path))).centre == pytest.approx((0.0, 0.0))


def test_workspaces_are_interpolated_and_empty_beyond_their_ends() -> None:
    heights = np.array([0.4, 0.5, 0.6, 0.7])
    space = Workspace(heights, np.array([0, 0.2, 0.3, 0]), np.array([0, 0.6, 0.8, 0]), 0.1)
    assert space.at(0.55) == pytest.approx((0.25, 0.7, 0.1))
    assert space.at(0.45) == pytest.approx((0.2, 0.6, 0.1))
    assert space.at(0.9)[:2] == (0.0, 0.0)
    assert space.reaches == (0.5, 0.6)


@pytest.mark.parametrize("way", [1, -1])
def test_the_end_of_a_reach_is_found_to_within_the_halved_step(way, rng) -> None:
    for true in rng.uniform(0.0, DISTANCE_STEP, 50):
        found = last_reached(lambda d, t=true: way * (d - 0.5) <= t, 0.5, way * DISTANCE_STEP)
        assert (
            0.0 <= way * (found - 0.5) <= true < way * (found - 0.5) + DISTANCE_STEP / 2**HALVINGS
        )


def test_the_reach_of_a_fixed_arm_ends_between_grid_points_that_of_others_on_them(robot) -> None:
    def ends(of) -> np.ndarray:
        space = derived_of(of).workspaces[Family.TOP]
        inside = space.outer > space.inner
        return np.concatenate([space.inner[inside], space.outer[inside]]) / DISTANCE_STEP

    fixed, driving = ends(load_robot("ur5e_desk")), ends(robot)
    assert driving == pytest.approx(np.round(driving))
    assert fixed * 2**HALVINGS == pytest.approx(np.round(fixed * 2**HALVINGS))
    assert (np.abs(fixed - np.round(fixed)) > 0.1).any()
