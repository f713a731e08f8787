"""The table `[controllers]` of robot files."""

from __future__ import annotations

import pytest

from runtime.robot.check import check_robot
from runtime.robot.file import read_robot_file
from runtime.robot.load import load_robot
from runtime.robot.propose.proposal import propose
from runtime.robot.propose.write import write_proposal
from sketchlang.errors import InputError
from tests.runtime.robot.arms import write_arm
from tests.runtime.robot.robots import TOML, write_robot

GIVEN = """
[controllers.crane]
joints = ["swing", "lift"]

[controllers.hand]
type = "GripperCommand"
joints = ["left_finger"]
action = "/hand/move"
"""


def named(tmp_path, table: str):
    return {
        each.name: each for each in read_robot_file(write_robot(tmp_path, TOML + table)).controllers
    }


def test_what_is_said_counts(tmp_path) -> None:
    found = named(tmp_path, GIVEN)
    assert found["crane"].joints == ("swing", "lift")
    assert found["crane"].action == "/crane/follow_joint_trajectory"
    assert found["hand"].action == "/hand/move"
    assert not any(each.moves_base for each in found.values())


def test_without_a_table_the_usual_grouping_counts(tmp_path) -> None:
    robot = load_robot(write_robot(tmp_path))
    groups = {each.name: each.joints for each in robot.controllers if each.joints}
    assert groups["torso_controller"] == ("lift",)
    assert groups["arm_controller"] == ("swing",)
    assert set(groups["gripper_controller"]) <= set(robot.gripper.joints)


def test_a_base_may_have_joints_of_its_own(tmp_path) -> None:
    table = '\n[controllers.wheels]\nbase = true\njoints = ["x", "y", "t"]\n'
    wheels = named(tmp_path, GIVEN + table)["wheels"]
    assert wheels.moves_base
    assert wheels.keeps_times


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ('[controllers.a]\ntype = "Follow"\njoints = ["lift"]', "no type 'Follow'"),
        ("[controllers.a]\njoints = []", "one joint at least"),
        ("[controllers.a]", "'joints' is missing"),
        ('[controllers.a]\ntype = "FollowPath"\njoints = ["lift"]', "no joints"),
        ('[controllers.a]\ntype = "GripperCommand"\njoints = ["lift", "swing"]', "one joint"),
        ('[controllers.a]\nbase = true\njoints = ["x"]', "has three"),
        ('[controllers.a]\nbase = 1\njoints = ["x"]', "true or false"),
        ('[controllers.a]\njoints = ["lift"]\nactoin = "/x"', "unknown key 'actoin'"),
        ('[controllers.a]\njoints = ["lfit"]', "no joint 'lfit'"),
        ('[controllers.a]\njoints = ["lift", "lift"]', "belongs to 'a'"),
    ],
)
def test_mistakes_are_named(tmp_path, table, said) -> None:
    with pytest.raises(InputError, match=said) as caught:
        load_robot(write_robot(tmp_path, f"{TOML}\n{table}\n"))
    assert "controllers" in str(caught.value)


def test_check_names_what_nothing_moves(tmp_path) -> None:
    found, _ = check_robot(write_robot(tmp_path, TOML + GIVEN.replace('"swing", ', "")))
    messages = [each.message for each in found if each.code == "controller-joints"]
    assert any("'swing'" in message for message in messages)


def test_what_is_proposed_is_written_and_read(tmp_path) -> None:
    proposal = propose(write_arm(tmp_path), "palm")
    path = write_proposal(proposal, tmp_path / "out")
    assert read_robot_file(path).controllers == proposal.file.controllers
    joints = [name for each in load_robot(path).controllers for name in each.joints]
    assert joints[: len(proposal.file.joints)] == list(proposal.file.joints)
