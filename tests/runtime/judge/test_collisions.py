"""What a fixed robot stands on, and what it must not stand in."""

from __future__ import annotations

import numpy as np
import pytest

from runtime.judge.collisions import Crowd, first_collision
from runtime.judge.contacts import Exact, Track
from runtime.judge.extents import homogeneous, lowest
from runtime.judge.skeleton import Skeleton
from runtime.robot.load import load_robot
from runtime.robot.model import BOLTED
from runtime.world.poses import upright
from runtime.world.solids import Box


def hit(name: str, hand: bool, depth: float) -> bool:
    """Whether a robot at home hits a slab of which the top is `depth` metres above the lowest
    point of its hand, or of the parts that never move."""
    robot = load_robot(name)
    skeleton = Skeleton(robot)
    links = skeleton.transforms(np.zeros((1, 3)), robot.home[None], robot.gripper.min_opening)
    tracks = skeleton.tracks(links)
    parts = robot.gripper.links if hand else {n for n, group in skeleton.rigid.items() if not group}
    there = [track for track in tracks if track.owner in parts]
    track = min(there, key=lambda t: float(lowest(t.solid, t.poses)[0]))
    top = float(lowest(track.solid, track.poses)[0]) + depth
    pose = homogeneous(upright(*track.poses[0, :2, 3], top - 0.01, 0.0))
    slab = Track("slab", Box((0.15, 0.15, 0.02)), pose[None])
    crowd = Crowd(robot=tracks, held=[], resting=[], guided=[], standing=[slab])
    return first_collision(Exact(), skeleton, robot.gripper.links, crowd) is not None


@pytest.mark.parametrize(
    ("depth", "refused"),
    [(-BOLTED, False), (0.5 * BOLTED, False), (2 * BOLTED, True), (5 * BOLTED, True)],
)
def test_a_foot_may_touch_what_it_is_bolted_to_but_not_stand_in_it(depth, refused) -> None:
    assert hit("ur5e_desk", False, depth) == refused


@pytest.mark.parametrize(("name", "hand"), [("ur5e_desk", True), ("tiago", False)])
def test_what_moves_or_drives_is_not_bolted_to_anything(name, hand) -> None:
    assert hit(name, hand, 0.5 * BOLTED)
    assert not hit(name, hand, -0.5 * BOLTED)
