"""The judge: accepts good plans, and rejects every kind of bad one with its reason."""

from __future__ import annotations

import dataclasses
import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from domains.tabletop.scene.load import load_scene
from domains.tabletop.scene.model import Obstacle, Scene, UprightBox
from runtime.judge.certify import Certificate, certify
from runtime.judge.skeleton import Skeleton
from runtime.kernels import ik
from runtime.kernels.boxes import to_base_frame
from runtime.plan.read import read_plan
from runtime.robot.load import load_robot
from runtime.robot.model import RobotModel
from sketchlang.cli.run import command as run
from sketchlang.library import find_scene
from tests.runtime.plans import Json, actions, changed, parse, pieces, released
from tests.runtime.reference import along, arm_touches
from tests.tabletop.scene.texts import SCENE, write_scene


@pytest.fixture
def judge(tmp_path: Path, sticks: Scene, robot: RobotModel) -> Any:
    def verdict(data: Json) -> Certificate:
        return certify(parse(tmp_path, data), sticks.world, robot)

    return verdict


def rejected(certificate: Certificate, *words: str) -> None:
    """The plan is not valid, and one of the words is in what was found first."""
    assert not certificate.valid
    message = certificate.findings[0].message
    assert any(word in message for word in words), message


def test_a_produced_plan_is_valid(judge, plain_data) -> None:
    certificate = judge(plain_data)
    assert certificate.valid, certificate.findings
    assert certificate.samples > 1000
    assert certificate.actions == len(plain_data["actions"])


# -- geometry ----------------------------------------------------------------------------------


def test_a_way_point_of_the_arm_in_a_table_is_a_collision(judge, plain_data, robot) -> None:
    """At the end of the approach the hand goes on, 15 cm down: into the table, or into what it
    was about to take and that stands there."""
    number, _, piece = next(p for p in pieces(plain_data, "arm") if p[2]["kind"] == "approach")
    q = np.array(piece["path"][-1])
    target = robot.tool_pose(q)
    target[2, 3] -= 0.15
    arguments = (*robot.chain, robot.lower, robot.upper, robot.tool, target, q, 300, robot.ease)
    assert ik.solve(*arguments)
    piece["path"].insert(-1, q.tolist())
    piece["times"].insert(-1, piece["times"][-1])
    piece["times"] = [60.0 * i for i in range(len(piece["times"]))]
    certificate = judge(plain_data)
    rejected(certificate, "hits table", "hits stick")
    assert certificate.findings[0].action == number


def test_a_base_pose_in_a_table_is_a_collision(judge, plain_data, sticks) -> None:
    x, y, _ = sticks.surfaces[0].table.centre
    _, _, piece = next(pieces(plain_data, "base"))
    sx, sy, yaw = piece["poses"][0]
    heading = yaw + math.remainder(math.atan2(y - sy, x - sx) - yaw, 2 * math.pi)
    piece["poses"] = [[sx, sy, yaw], [sx, sy, heading], [x, y, heading]]
    piece["times"] = [0.0, 60.0, 120.0]
    rejected(judge(plain_data), "hits table1")


def test_every_large_change_of_an_arm_way_point_is_found(judge, plain_data) -> None:
    rng = np.random.default_rng(1)
    for number, j, piece in list(pieces(plain_data, "arm")):
        k = int(rng.integers(len(piece["path"])))
        data = changed(plain_data)
        path = data["actions"][number]["pieces"][j]["path"]
        path[k] = (np.array(path[k]) + rng.choice([-1.0, 1.0], len(path[k]))).tolist()
        assert not judge(data).valid, (number, j, k)


def test_every_large_change_of_a_base_way_point_is_found(judge, plain_data) -> None:
    changes = itertools.cycle([[0.5, 0.0, 0.0], [0.0, -0.5, 0.0], [0.0, 0.0, 1.0]])
    for number, j, piece in list(pieces(plain_data, "base")):
        for k in range(len(piece["poses"])):
            data = changed(plain_data)
            poses = data["actions"][number]["pieces"][j]["poses"]
            poses[k] = (np.array(poses[k]) + next(changes)).tolist()
            assert not judge(data).valid, (number, j, k)


@pytest.mark.slow
def test_way_points_moved_within_the_limits_are_found_or_harmless(
    judge, plain_data, sticks, robot
) -> None:
    """What the judge still accepts touches nothing by the plain twins either."""
    rng = np.random.default_rng(2)
    found = harmless = 0
    for number, j, piece in list(pieces(plain_data, "arm")):
        for k in range(len(piece["path"])):
            data = changed(plain_data)
            path = data["actions"][number]["pieces"][j]["path"]
            moved = np.array(path[k]) + rng.choice([-1.0, 1.0], len(path[k]))
            moved[0] = path[k][0]  # the lift
            path[k] = np.clip(moved, robot.lower, robot.upper).tolist()
            if not judge(data).valid:
                found += 1
                continue
            harmless += 1
            world = world_of_action(data, sticks, number)
            body = robot.body(robot.gripper.max_opening / 2)
            around = np.array(path[max(0, k - 1) : k + 2])
            for q in along(around, 25):
                assert not arm_touches(robot.chain, body, world, q), (number, j, k)
    assert found > 10 * harmless


def world_of_action(data: Json, scene: Scene, number: int) -> np.ndarray:
    """Boxes (w, 8) in the base frame of an action, its own object left out."""
    poses = {thing.name: thing.start for thing in scene.objects}
    base = data["base_start"]
    for action in data["actions"][:number]:
        if action["name"] == "move_base":
            base = action["pieces"][-1]["poses"][-1]
        elif action["name"] == "place":
            x, y, _, _, _, sine, cosine = released(action)["pose"]
            poses[action["arguments"]["object"]] = x, y, 2 * math.atan2(sine, cosine)
    rows = list(scene.obstacle_rows)
    for thing in scene.objects:
        if thing.name != data["actions"][number]["arguments"].get("object"):
            x, y, yaw = poses[thing.name]
            rest = float(scene.supports[thing.rests.support].pose[2, 3])
            rows.append(UprightBox((x, y, rest + thing.size[2] / 2), thing.size, yaw).row())
    return to_base_frame(np.array(rows), *base, math.inf)


def test_fingers_stay_closed_while_they_carry(judge, plain_data, robot) -> None:
    number = actions(plain_data, "place")[0]
    wide = {"type": "gripper", "times": [0, 1], "opening": robot.gripper.max_opening}
    plain_data["actions"][number]["pieces"].insert(0, wide)
    rejected(judge(plain_data), "while it holds")


def test_fingers_do_not_open_into_what_stands_beside_them(
    tmp_path, plain_data, sticks, robot
) -> None:
    """After the stick is let go the hand opens wide, where the wall was 1 mm away."""
    number = actions(plain_data, "place")[-1]
    parts = plain_data["actions"][number]["pieces"]
    release = next(j for j, part in enumerate(parts) if part.get("release"))
    wide = {"type": "gripper", "times": [0, 1], "opening": robot.gripper.max_opening}
    parts[release + 1 :] = [wide]
    # Where the left finger is then, and how far it still goes.
    base = plain_data["actions"][number - 1]["pieces"][-1]["poses"][-1]
    q = parts[release - 1]["path"][-1]
    links = Skeleton(robot).transforms(
        np.array([base]), np.array([q]), np.array([robot.gripper.max_opening])
    )
    finger = robot.gripper.links - {"gripper_link"}
    x, y, z = next(links[link][0] @ [0.11, 0.0, 0.0, 1.0] for link in sorted(finger))[:3]
    pebble = Obstacle("pebble", UprightBox((x, y, z), (0.004, 0.004, 0.004)))
    scene = sticks.with_boxes([pebble])
    rejected(certify(parse(tmp_path, plain_data), scene.world, robot), "hits pebble")


def with_neighbour() -> str:
    """The scene of the plan, with one more stick."""
    path, _ = find_scene("sorting/3t-02")
    return path.read_text(encoding="utf-8").replace(
        "[[goal]]",
        '[[object]]\nname = "more"\nsize = [0.04, 0.04, 0.2]\nat = [1.0, 0.3]\n\n[[goal]]',
        1,
    )


def test_an_arm_that_folds_into_itself_is_named(plain_data, tmp_path, sticks, robot, rng) -> None:
    """In the middle of the room, slowly, to postures in which FCL finds parts that touch."""
    body, nothing = robot.body(robot.gripper.max_opening), np.zeros((0, 8))
    action = plain_data["actions"][0]
    tried = [rng.uniform(robot.lower, robot.upper) for _ in range(150)]
    folded = [q for q in tried if arm_touches(robot.chain, body, nothing, q)][:5]
    assert len(folded) == 5
    named = 0
    for q in folded:
        path = [robot.home.tolist(), q.tolist(), robot.home.tolist()]
        action["pieces"] = [{"type": "arm", "kind": "free", "times": [0, 90, 180], "path": path}]
        certificate = certify(parse(tmp_path, plain_data), sticks.world, robot)
        rejected(certificate, "hits")
        words = certificate.findings[0].message.split()
        named += sum(word.endswith("_link") for word in words) == 2
    assert named >= 3


# -- continuity and limits ---------------------------------------------------------------------


def test_a_joint_beyond_its_limit_is_named(judge, plain_data, robot) -> None:
    number, _, piece = next(p for p in pieces(plain_data, "arm") if len(p[2]["path"]) > 2)
    joint = len(robot.joints) - 1
    piece["path"][1][joint] = float(robot.upper[joint]) + 0.01
    certificate = judge(plain_data)
    rejected(certificate, f"{robot.joints[joint]} leaves its limits")
    assert certificate.findings[0].action == number


def test_a_motion_that_starts_elsewhere_is_a_jump(judge, plain_data) -> None:
    _, _, piece = next(pieces(plain_data, "arm"))
    piece["path"][0][3] += 0.01
    rejected(judge(plain_data), "jumps")


def test_a_base_that_starts_elsewhere_is_a_jump(judge, plain_data) -> None:
    _, _, piece = list(pieces(plain_data, "base"))[1]
    piece["poses"][0][0] += 0.01
    rejected(judge(plain_data), "the base jumps")


def test_a_heading_one_turn_further_is_the_same_heading(judge, plain_data) -> None:
    for pose in next(pieces(plain_data, "base"))[2]["poses"]:
        pose[2] += 2 * math.pi
    assert judge(plain_data).valid


def test_an_arm_that_is_too_fast_is_named(judge, plain_data) -> None:
    _, _, piece = next(p for p in pieces(plain_data, "arm") if p[2]["kind"] == "free")
    piece["times"] = [0.2 * seconds for seconds in piece["times"]]
    rejected(judge(plain_data), "faster than its limit")


def test_a_base_that_is_too_fast_is_named(judge, plain_data) -> None:
    _, _, piece = next(pieces(plain_data, "base"))
    piece["times"] = [0.2 * seconds for seconds in piece["times"]]
    rejected(judge(plain_data), "the base is faster than its limit")


def test_a_base_does_not_move_sideways(judge, plain_data) -> None:
    _, _, piece = next(pieces(plain_data, "base"))
    x, y, yaw = piece["poses"][0]
    aside = [x - 0.1 * math.sin(yaw), y + 0.1 * math.cos(yaw), yaw]
    piece["poses"] = [[x, y, yaw], aside, [x, y, yaw], *piece["poses"][1:]]
    piece["times"] = [0.0, 10.0, *(20.0 + seconds for seconds in piece["times"])]
    piece["times"] = piece["times"][: len(piece["poses"])]
    rejected(judge(plain_data), "sideways")


def test_a_base_does_not_turn_while_it_drives(judge, plain_data) -> None:
    _, _, piece = next(pieces(plain_data, "base"))
    x, y, yaw = piece["poses"][0]
    ahead = [x + 0.05 * math.cos(yaw), y + 0.05 * math.sin(yaw), yaw + 0.3]
    piece["poses"].insert(1, ahead)
    piece["times"] = [0.0, *(10.0 + seconds for seconds in piece["times"])]
    rejected(judge(plain_data), "drives and turns at once")


def test_the_base_drives_in_the_home_posture_only(judge, plain_data) -> None:
    number = actions(plain_data, "place")[0]
    del plain_data["actions"][number]["pieces"][-1]
    certificate = judge(plain_data)
    rejected(certificate, "home posture")
    assert certificate.findings[0].action == number + 1


def test_a_robot_that_holds_something_may_carry_it_in_another_posture(judge, plain_data) -> None:
    """It is judged as it is: the next motion of the arm has to begin in that posture."""
    number = actions(plain_data, "pick")[0]
    del plain_data["actions"][number]["pieces"][-1]
    certificate = judge(plain_data)
    assert all("home posture" not in finding.message for finding in certificate.findings)
    assert certificate.findings


def test_a_plan_for_other_joints_is_refused(judge, plain_data) -> None:
    plain_data["robot"]["joints"].reverse()
    rejected(judge(plain_data), "planning joints")


# -- objects -----------------------------------------------------------------------------------


def test_every_action_that_is_left_out_is_missed(judge, plain_data) -> None:
    for number in range(len(plain_data["actions"])):
        data = changed(plain_data)
        del data["actions"][number]
        rejected(judge(data), "actions are missing")


def test_left_out_actions_are_missed_even_where_the_subgoals_agree(judge, plain_data) -> None:
    for number in range(len(plain_data["actions"])):
        data = changed(plain_data)
        subgoal = data["actions"].pop(number)["subgoal"]
        data["subgoals"][subgoal]["actions"] -= 1
        assert not judge(data).valid, number


def test_a_placement_that_is_not_where_the_object_ends_is_named(judge, plain_data) -> None:
    number = actions(plain_data, "place")[0]
    released(plain_data["actions"][number])["pose"][0] += 0.05
    certificate = judge(plain_data)
    rejected(certificate, "from where the plan says")
    assert certificate.findings[0].action == number


def test_a_scene_in_which_an_object_was_moved_is_another_scene(tmp_path, plain_data, robot) -> None:
    path = write_scene(tmp_path, with_neighbour())
    scene = load_scene(path, "sorting/3t-02")
    rejected(
        certify(parse(tmp_path, plain_data), scene.world, robot), "another version of the scene"
    )


def test_an_object_moved_under_an_unchanged_digest_is_not_gripped(
    tmp_path, plain_data, sticks, robot
) -> None:
    first = next(i for i in actions(plain_data, "pick"))
    index = [o.name for o in sticks.objects].index(
        plain_data["actions"][first]["arguments"]["object"]
    )
    things = list(sticks.world.movables)
    pose = things[index].pose.copy()
    pose[0, 3] -= 0.15
    things[index] = dataclasses.replace(things[index], pose=pose)
    world = dataclasses.replace(sticks.world, movables=tuple(things))
    rejected(certify(parse(tmp_path, plain_data), world, robot), "not between the fingers", "hits")


def test_a_grip_that_never_closes_is_missed(judge, plain_data) -> None:
    number = actions(plain_data, "pick")[0]
    for piece in plain_data["actions"][number]["pieces"]:
        piece.pop("attach", None)
    assert not judge(plain_data).valid


def test_an_object_that_is_never_let_go_is_missed(judge, plain_data) -> None:
    number = actions(plain_data, "place")[-1]
    parts = plain_data["actions"][number]["pieces"]
    plain_data["actions"][number]["pieces"] = [part for part in parts if not part.get("release")]
    rejected(judge(plain_data), "still held", "hits")


def test_an_object_released_high_is_not_placed(judge, plain_data) -> None:
    """Without the last way points of lowering, the stick is let go in the air."""
    number = actions(plain_data, "place")[0]
    parts = plain_data["actions"][number]["pieces"]
    lower = next(part for part in parts if part.get("kind") == "lower")
    lower["path"], lower["times"] = lower["path"][:1], lower["times"][:1]
    rejected(judge(plain_data), "from where the plan says")
    released(plain_data["actions"][number])["pose"][2] += 0.03
    rejected(judge(plain_data), "30.0 mm too high")


def test_fingers_that_close_too_far_do_not_fit(judge, plain_data) -> None:
    number = actions(plain_data, "pick")[0]
    grip = next(p for p in plain_data["actions"][number]["pieces"] if p.get("attach"))
    grip["opening"] -= 0.01
    rejected(judge(plain_data), "do not fit")


def test_fingers_do_not_open_further_than_they_can(judge, plain_data, robot) -> None:
    _, _, piece = next(pieces(plain_data, "gripper"))
    piece["opening"] = robot.gripper.max_opening + 0.01
    rejected(judge(plain_data), "cannot open")


def test_an_object_gripped_far_away_is_not_gripped(judge, plain_data) -> None:
    """The grip is closed before the hand has come near."""
    number = actions(plain_data, "pick")[0]
    parts = plain_data["actions"][number]["pieces"]
    grip = next(j for j, part in enumerate(parts) if part.get("attach"))
    parts.insert(1, parts.pop(grip))
    rejected(judge(plain_data), "not between the fingers")


def test_a_plan_that_stops_early_has_not_reached_the_goal(judge, plain_data) -> None:
    """The last two subgoals (pick and place of the second stick) are cut off."""
    keep = len(plain_data["subgoals"]) - 2
    plain_data["subgoals"] = plain_data["subgoals"][:keep]
    plain_data["actions"] = [a for a in plain_data["actions"] if a["subgoal"] < keep]
    rejected(judge(plain_data), "goal not reached")


def test_a_plan_that_ends_holding_is_not_finished(judge, plain_data) -> None:
    keep = len(plain_data["subgoals"]) - 1
    plain_data["subgoals"] = plain_data["subgoals"][:keep]
    plain_data["actions"] = [a for a in plain_data["actions"] if a["subgoal"] < keep]
    rejected(judge(plain_data), "still held")


# -- what the plan was made for ----------------------------------------------------------------


def test_a_plan_for_another_robot_is_refused(tmp_path, plain_data, sticks, robot) -> None:
    other = dataclasses.replace(robot, digest="0" * 64)
    rejected(certify(parse(tmp_path, plain_data), sticks.world, other), "version of the robot")


@pytest.mark.parametrize("coordinate", range(3))
def test_a_plan_from_another_start_is_refused(judge, plain_data, coordinate) -> None:
    plain_data["base_start"][coordinate] += 0.2
    rejected(judge(plain_data), "does not start where the robot stands")


def test_objects_in_another_order_are_refused(judge, plain_data) -> None:
    plain_data["objects"].reverse()
    rejected(judge(plain_data), "objects are not those of the scene")


@pytest.mark.parametrize("heading", ["-90.0", "360.0"])
def test_any_way_to_write_the_start_s_heading_gives_valid_plans(tmp_path, heading) -> None:
    text = SCENE.replace("[-0.5, 0.0, 0.0]", f"[-0.5, 0.0, {heading}]")
    scene, plan = write_scene(tmp_path, text), tmp_path / "plan.json"
    done = CliRunner().invoke(run, ["pick_and_place", str(scene), "--out", str(plan)])
    assert done.exit_code == 0, done.stderr
    certificate = certify(read_plan(plan), load_scene(scene).world, load_robot("tiago"))
    assert certificate.valid, certificate.findings
