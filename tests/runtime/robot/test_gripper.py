"""Fingers that slide, turn or follow: the opening is what can be measured between the pads."""

from __future__ import annotations

import numpy as np
import pytest

from domains.tabletop.hand import FAMILY, hand_of, outermost
from domains.tabletop.state import SIDE, TOP
from runtime.robot.approach import Family
from runtime.robot.load import load_robot
from runtime.robot.open_hand import finger_boxes, room_between, tools
from runtime.robot.outline import outline
from runtime.world.poses import apply, compose, invert
from sketchlang.errors import InputError
from tests.runtime.robot.robots import TOML, URDF, write_robot

MIMIC = URDF.replace(
    '<joint name="right_finger" type="prismatic">',
    '<joint name="right_finger" type="prismatic"><mimic joint="left_finger"/>',
)
SLIDE, TURN = 'lower="0" upper="0.04"', 'lower="0" upper="0.6"'
TURNING = (
    MIMIC.replace('finger" type="prismatic"', 'finger" type="revolute"')
    .replace(f'<axis xyz="0 1 0"/><limit {SLIDE}', f'<axis xyz="0 0 1"/><limit {TURN}')
    .replace(f'<axis xyz="0 -1 0"/><limit {SLIDE}', f'<axis xyz="0 0 -1"/><limit {TURN}')
    .replace('xyz="0.03 ', 'xyz="0.06 ')
    .replace('size="0.04 ', 'size="0.10 ')
    .replace('<origin xyz="0.04 0 0"/></joint>', '<origin xyz="0.10 0 0"/></joint>')
)
ALONG = URDF.replace('xyz="0 1 0"', 'xyz="1 0 0"').replace('xyz="0 -1 0"', 'xyz="1 0 0"')
ONE = TOML.replace('["left_finger", "right_finger"]', '["left_finger"]')
BACKWARDS = (
    MIMIC.replace('xyz="0 1 0"', 'xyz="0 -1 0"')
    .replace('lower="0" upper="0.04"', 'lower="-0.04" upper="0"')
    .replace('<mimic joint="left_finger"/>', '<mimic joint="left_finger" multiplier="-1"/>')
    .replace(
        '<axis xyz="0 -1 0"/><limit lower="-0.04"', '<axis xyz="0 -1 0"/><limit lower="-0.04"', 1
    )
)


def inner_faces(robot, opening: float) -> list[float]:
    """The least distance from the middle of the fingers' last two centimetres, on both sides."""
    body = robot.body(opening)
    back = invert(robot.tool)
    faces = []
    for index, side in robot.gripper.fingers:
        pose = compose(back, body.pose[index])
        cloud = apply(pose, outline(robot.parts[index].shape.solid))
        # Inside a box finger: corners alone would miss where its middle is.
        first, second = np.triu_indices(len(cloud), 1)
        share = np.linspace(0, 1, 41)[:, None, None]
        filled = (cloud[first] * share + cloud[second] * (1 - share)).reshape(-1, 3)
        front = filled[filled[:, 0] > filled[:, 0].max() - 0.02]
        faces.append(float((front[:, 1] * side).min()))
    return faces


@pytest.mark.parametrize(
    ("toml", "urdf"),
    [(TOML, URDF), (TOML, MIMIC), (ONE, MIMIC), (ONE, TURNING), (TOML, BACKWARDS)],
    ids=["two", "mimic", "driver", "turning", "backwards"],
)
def test_pads_are_as_far_apart_as_asked_for(tmp_path, toml, urdf) -> None:
    robot = load_robot(write_robot(tmp_path, toml, urdf))
    gripper = robot.gripper
    assert gripper.min_opening < 1e-3
    assert 0.05 < gripper.max_opening < 0.2
    assert gripper.joints == ("left_finger", "right_finger")
    for opening in np.linspace(gripper.min_opening, gripper.max_opening, 7):
        faces = inner_faces(robot, float(opening))
        assert sum(faces) == pytest.approx(opening, abs=3e-3)
        assert faces[0] == pytest.approx(faces[1], abs=1e-3)


def test_turning_fingers_turn(tmp_path) -> None:
    robot = load_robot(write_robot(tmp_path, ONE, TURNING))
    values = robot.gripper.joint_values(np.array([0.0, robot.gripper.max_opening]))
    assert values["left_finger"][1] > 0.5
    assert (np.diff(robot.gripper.openings) > 0).all()
    closed, opened = (robot.body(v).pose[robot.finger_parts[0].part] for v in (0.0, 0.05))
    assert np.linalg.norm(closed[:, :3] - opened[:, :3]) > 0.1


@pytest.mark.parametrize(
    ("toml", "urdf", "word"),
    [
        (ONE, URDF, "either side"),
        (TOML, ALONG, "apart"),
        (TOML.replace('["left_finger", "right_finger"]', '["tip"]'), URDF, "does not move"),
    ],
)
def test_fingers_that_do_not_close_are_refused(tmp_path, toml, urdf, word) -> None:
    with pytest.raises(InputError, match=word):
        load_robot(write_robot(tmp_path, toml, urdf))


def test_limits_of_the_gripper_are_optional(tmp_path) -> None:
    assert load_robot(write_robot(tmp_path)).gripper.payload is None
    toml = TOML.replace("time = 0.5", "time = 0.5\nmax_force = 40\nmax_torque = 2.5\npayload = 3")
    gripper = load_robot(write_robot(tmp_path, toml)).gripper
    assert (gripper.max_force, gripper.max_torque, gripper.payload) == (40.0, 2.5, 3.0)


def test_a_gripper_may_know_no_width_in_between(tmp_path) -> None:
    gripper = load_robot(write_robot(tmp_path)).gripper
    assert gripper.opening_for(0.02) == pytest.approx(0.028)
    assert gripper.opening_for(1.0) == gripper.max_opening
    fully = TOML.replace("time = 0.5", 'time = 0.5\nopens = "fully"')
    gripper = load_robot(write_robot(tmp_path, fully)).gripper
    assert gripper.opening_for(0.02) == gripper.max_opening
    with pytest.raises(InputError, match="opens 'half'"):
        load_robot(write_robot(tmp_path, fully.replace('"fully"', '"half"')))


@pytest.mark.parametrize(("toml", "urdf"), [(TOML, URDF), (ONE, TURNING)], ids=["slide", "turn"])
@pytest.mark.parametrize("fully", [False, True])
@pytest.mark.parametrize("family", [SIDE, TOP])
def test_volumes_hold_the_fingers_while_they_close(tmp_path, toml, urdf, fully, family) -> None:
    """Points of the fingers at all openings from the one before the grasp to that of the grasp, by
    the body that is tested for contact, in the approach frame."""
    if fully:
        toml = toml.replace("time = 0.5", 'time = 0.5\nopens = "fully"')
    robot = load_robot(write_robot(tmp_path, toml, urdf))
    width = 0.6 * robot.gripper.max_opening
    rows = hand_of(robot).sweeps[family]
    wider = np.where(rows[:, 6] == 1.0, width / 2, 0.0)
    low = np.column_stack([rows[:, 0], rows[:, 2] - wider, rows[:, 4]])
    high = np.column_stack([rows[:, 1], rows[:, 3] + wider, rows[:, 5]])
    tool = tools(FAMILY[family], 0.0)[0]
    for opening in np.linspace(width, robot.gripper.opening_for(width), 5).tolist():
        body = robot.body(opening)
        for index, _ in robot.gripper.fingers:
            pose = compose(tool, compose(invert(robot.tool), body.pose[index]))
            points = apply(pose, outline(robot.parts[index].shape.solid))[:, None]
            # Between two of the openings that are looked at fingers move by a few millimetres.
            inside = ((points >= low - 4e-3) & (points <= high + 4e-3)).all(axis=2)
            assert inside.any(axis=1).all()


def test_open_fingers_that_lean_take_little_room_near_their_tips(tmp_path) -> None:
    """Within a centimetre of its tips a finger of 10 cm that is open by 0.6 rad is 5 cm from where
    it is furthest out or in: boxes there leave that free."""
    robot = load_robot(write_robot(tmp_path, ONE, TURNING))
    boxes = finger_boxes(robot, Family.TOP, robot.gripper.max_opening)
    whole = float(boxes[:, 3].max() - boxes[:, 2].min())
    at_tip = boxes[boxes[:, 4] < boxes[:, 4].min() + 0.01]
    assert 0 < float(at_tip[:, 3].max() - at_tip[:, 2].min()) < 0.7 * whole
    upright = load_robot(write_robot(tmp_path))
    assert len(finger_boxes(upright, Family.TOP, 0.05)) == len(upright.finger_parts)


def test_volumes_within_others_are_left_out_and_no_more(tmp_path, rng) -> None:
    rows = np.round(rng.uniform(0.0, 1.0, (60, 7)), 1)
    rows[:, 1:6:2] = rows[:, 0:6:2] + np.round(rng.uniform(0.1, 0.5, (60, 3)), 1)
    rows[:, 6] = rng.integers(0, 2, 60)
    rows = np.unique(rows.round(6), axis=0)
    kept = outermost(rows)
    points = rng.uniform(0.0, 1.5, (4000, 1, 3))

    def hit(some):
        inside = ((points >= some[:, 0:6:2]) & (points <= some[:, 1:6:2])).all(axis=2)
        return [(inside & (some[:, 6] == kind)).any(axis=1) for kind in (0.0, 1.0)]

    assert np.array_equal(hit(kept), hit(rows))
    assert len(kept) < len(rows)


def test_knuckles_are_what_comes_between_the_pads(tmp_path) -> None:
    """A finger with a lump 15 mm deep on its inner side, from 30 to 50 mm behind the grasp."""
    lump = (
        '<collision><origin xyz="0.0 {y} 0"/><geometry><box size="0.02 0.03 0.02"/></geometry>'
        "</collision></link>"
    )
    urdf = URDF
    for side, y in (("left", "0.003"), ("right", "-0.003")):
        start = urdf.index(f'<link name="{side}">')
        end = urdf.index("</link>", start)
        urdf = urdf[:end] + lump.format(y=y) + urdf[end + len("</link>") :]
    assert room_between(load_robot(write_robot(tmp_path))) == np.inf
    robot = load_robot(write_robot(tmp_path, TOML, urdf))
    assert room_between(robot) == pytest.approx(0.03, abs=1e-6)
    assert hand_of(robot).back <= 0.03
