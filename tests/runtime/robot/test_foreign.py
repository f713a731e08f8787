"""Robots as others write them: two arms, long chains, flanges that point another way, prefixes
that nobody declares, feet that are a little deep."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from domains.tabletop.foot import sunk_into
from domains.tabletop.scene.load import load_scene
from runtime.robot.load import load_robot
from runtime.robot.model import BOLTED
from runtime.robot.propose.held import other_arms
from runtime.robot.propose.pairs import touching
from runtime.robot.tree import link_poses
from runtime.robot.urdf import read_urdf
from runtime.world.poses import compose, invert
from sketchlang.cli import cli
from sketchlang.library import find_scene
from tests.runtime.robot.arms import HAND, LINKS, arm_urdf, coarse_grid, write_arm


def run(*arguments: object):
    return CliRunner().invoke(cli, [str(argument) for argument in arguments])


@pytest.fixture(autouse=True, scope="module")
def quick(tmp_path_factory):
    with coarse_grid(tmp_path_factory.mktemp("cache")):
        yield


def brought_in(folder: Path, urdf: str, *options: object):
    done = run("robot", "import", write_arm(folder, urdf), "--out", folder / "out", *options)
    assert done.exit_code in {0, 1}, done.output
    return done, load_robot(folder / "out" / "arm.toml")


def two_arms(apart: float = 0.35) -> str:
    """The arm twice, beside each other on one foot, the second one with names of its own."""
    text = arm_urdf()
    body = text[text.index("</link>") + len("</link>") : text.rindex("</robot>")]
    second = re.sub(r'\b(name|link|joint)="(?!foot")([^"]*)"', r'\1="other_\2"', body)
    place = f"0 {-apart / 2} 0.1"
    one = body.replace('xyz="0 0 0.1"', f'xyz="{place}"', 1)
    two = second.replace('xyz="0 0 0.1"', f'xyz="{place.replace("-", "")}"', 1)
    return text[: text.index("</link>") + len("</link>")] + one + two + "</robot>"


class TestTwoArms:
    def test_the_other_one_is_found_by_its_hand(self, tmp_path) -> None:
        urdf = read_urdf(write_arm(tmp_path, two_arms()))
        assert other_arms(urdf, "palm") == ["other_flange"]
        assert other_arms(urdf, "other_palm") == ["flange"]
        assert other_arms(read_urdf(write_arm(tmp_path)), "palm") == []

    def test_the_other_one_is_parked_on_its_own_side(self, tmp_path) -> None:
        done, robot = brought_in(tmp_path, two_arms(), "--tool", "palm")
        assert "the arm to 'other_flange' is held out of the way" in done.output
        assert len(robot.joints) == len(LINKS)
        assert set(robot.fixed) >= {f"other_{name}_joint" for name, *_ in LINKS}
        assert not touching(robot, robot.home[None])
        poses = link_poses(robot.urdf, robot.fixed)
        for name, *_ in LINKS:
            assert poses[f"other_{name}"][1, 3] > 0
        # Stretched out as at 0, the hand would be over a metre up.
        assert poses["other_palm"][2, 3] < 0.8


class TestLongChains:
    COLUMN = "".join(
        f'<link name="torso{k}"><collision><geometry><box size="0.1 0.1 0.02"/></geometry>'
        f'</collision></link><joint name="waist{k}" type="{kind}"><parent link="{before}"/>'
        f'<child link="torso{k}"/><origin xyz="0 0 0.05"/><axis xyz="{axis}"/>'
        '<limit lower="0" upper="0.5" velocity="1"/></joint>'
        for k, kind, before, axis in (
            (1, "revolute", "foot", "0 1 0"),
            (2, "prismatic", "torso1", "0 0 1"),
            (3, "revolute", "torso2", "0 0 1"),
            (4, "revolute", "torso3", "0 1 0"),
        )
    )

    def test_joints_of_the_torso_are_held_but_a_lift(self, tmp_path) -> None:
        urdf = arm_urdf(hand=HAND + self.COLUMN).replace(
            '<parent link="foot"/><child link="turret"/>',
            '<parent link="torso4"/><child link="turret"/>',
        )
        done, robot = brought_in(tmp_path, urdf, "--tool", "palm")
        held = {name for name in robot.fixed if name.startswith("waist")}
        assert held == {"waist1", "waist3"}
        assert robot.joints[:2] == ("waist2", "waist4")
        assert len(robot.joints) == 8
        assert "held, as 8 joints at most are planned for: waist1, waist3" in done.output


class TestFlanges:
    @pytest.mark.parametrize(
        ("rpy", "outwards"),
        [("0 0 0", 2), ("0 -1.5707963 0", 0), ("1.5707963 0 0", 1), ("0 3.1415926 0", 2)],
        ids=["z", "x", "y", "-z"],
    )
    def test_a_gripper_points_away_from_the_wrist(self, tmp_path, rpy, outwards) -> None:
        """Whichever axis of the flange that is, where it lies off the last joint."""
        flange = (
            '<link name="end"/><joint name="end" type="fixed"><parent link="flange"/>'
            f'<child link="end"/><origin xyz="0 0 0.03" rpy="{rpy}"/></joint>'
        )
        urdf = arm_urdf(hand=flange)
        done, robot = brought_in(tmp_path, urdf, "--tool", "end", "--gripper", "two_finger")
        assert done.exit_code == 0, done.output
        poses = link_poses(robot.urdf, {})
        seen = compose(invert(poses["flange"]), poses[robot.urdf_tool])
        assert seen[:, 0] == pytest.approx([0, 0, 1], abs=1e-5)
        assert seen[2, 3] > 0.1
        assert abs(compose(invert(poses["flange"]), poses["end"])[2, outwards]) > 0.99


class TestWhatIsWritten:
    def test_prefixes_that_nobody_declares_are_read_over(self, tmp_path) -> None:
        extra = '<sensor:camera name="c"/><gazebo><plugin:x a:b="1"/></gazebo></robot>'
        plain = read_urdf(write_arm(tmp_path))
        odd = read_urdf(write_arm(tmp_path, arm_urdf().replace("</robot>", extra)))
        assert odd.joints.keys() == plain.joints.keys()

    def test_macros_are_still_named(self, tmp_path) -> None:
        text = arm_urdf().replace("</robot>", '<xacro:include filename="a"/></robot>')
        done = run("robot", "import", write_arm(tmp_path, text), "--tool", "palm",
                   "--out", tmp_path / "out")  # fmt: skip
        assert done.exit_code == 2
        assert "macros of xacro" in done.output

    def test_fingers_without_a_range_are_named(self, tmp_path) -> None:
        text = arm_urdf(hand=HAND.replace('upper="0.045"', 'upper="0"'))
        done = run("robot", "import", write_arm(tmp_path, text), "--tool", "palm",
                      "--out", tmp_path / "out")  # fmt: skip
        assert done.exit_code == 1
        assert "'slide_left' has no range: 0 is its only value [limits-absent]" in done.output

    def test_links_without_a_shape_are_one_finding(self, tmp_path) -> None:
        bare = "".join(
            f'<link name="bare{k}"><visual><geometry><box size="0.01 0.01 0.01"/></geometry>'
            f'</visual></link><joint name="bare{k}" type="fixed"><parent link="foot"/>'
            f'<child link="bare{k}"/></joint>'
            for k in range(9)
        )
        text = arm_urdf(hand=HAND + bare)
        done, _ = brought_in(tmp_path, text, "--tool", "palm")
        assert done.output.count("[shape-missing]") == 1
        assert "'bare5' and 3 more can be seen" in done.output

    def test_wheels_that_do_not_turn_are_told(self, tmp_path) -> None:
        wheel = (
            '<link name="wheel_1"/><joint name="w" type="fixed"><parent link="foot"/>'
            '<child link="wheel_1"/></joint>'
        )
        done, _ = brought_in(tmp_path, arm_urdf(hand=HAND + wheel), "--tool", "palm")
        assert "its wheels, as 'wheel_1', do not turn in this URDF" in done.output


class TestFeet:
    """The arm's foot is 0.2 x 0.2 m wide and begins at its root's height."""

    @pytest.mark.parametrize(
        ("deep", "where"), [(0.0, []), (0.9 * BOLTED, []), (1.1 * BOLTED, ["desk"])]
    )
    def test_they_may_be_as_deep_as_what_they_are_bolted_to(self, tmp_path, deep, where) -> None:
        scene = load_scene(*find_scene("desk/sort"))
        desk = next(thing for thing in scene.world.fixed if thing.name == "desk")
        top = desk.pose[2, 3] + max(
            part.pose[2, 3] + part.solid.half[2] for part in desk.body.parts
        )
        _, robot = brought_in(tmp_path, arm_urdf(), "--tool", "palm", "--height", top - deep)
        assert sunk_into(scene, robot) == where

    def test_deeper_is_an_error_with_a_hint(self, tmp_path) -> None:
        brought_in(tmp_path, arm_urdf(), "--tool", "palm", "--height", 0.7)
        robot = tmp_path / "out" / "arm.toml"
        done = run("run", "pick_and_place", "desk/sort", "--robot", robot)
        assert done.exit_code == 2
        assert "the foot of arm at (0, 0) would be in desk" in done.output
        assert "`height` under [base]" in done.output
