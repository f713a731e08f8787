"""Plan files: written and read again, and refused where they are damaged."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import runtime
from runtime.motion.motion import (
    ArmMove,
    Attach,
    BaseMove,
    Carried,
    GripperMove,
    Release,
    Together,
)
from runtime.plan.model import Plan, PlanAction, PlanSubgoal, TimedPiece
from runtime.plan.read import read_plan
from runtime.plan.write import to_json, write_plan
from sketchlang.cli.validate import command as validate
from sketchlang.errors import InputError
from tests.runtime.plans import Json, parse, pieces


def small_plan() -> Plan:
    """Every kind of action and piece, with values that survive six places."""
    drive = TimedPiece(BaseMove(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])), np.array([0, 1.5]))
    path = np.array([[0.1, 0.2], [0.3, 0.4]])
    both = TimedPiece(
        Together(np.array([[1.0, 0, 0], [1, 0, 1e-3]]), path, np.array([0.05, 0.04])),
        np.array([0.0, 0.05]),
    )
    reach = TimedPiece(ArmMove(path, "free"), np.array([0.0, 2.25]))
    door = Carried("door", np.array([[0.0, 0, 0, 0, 0, 0, 1], [1.0, 0, 0, 0, 0, 0, 1]]))
    pull = TimedPiece(ArmMove(path[::-1], "pull", (door,)), np.array([0.0, 1.0]))
    grip = TimedPiece(GripperMove(0.04, Attach("tea pot ☕", "hand")), np.array([0.0, 0.5]))
    stands = Release("tea pot ☕", "table", np.array([1.0, 2.0, 0.767, 0.0, 0.0, 0.6, 0.8]))
    release = TimedPiece(GripperMove(0.05, release=stands), np.array([0.0, 0.5]))
    return Plan(
        sketch="small",
        scene="scene",
        scene_digest="abc",
        robot="crane",
        robot_digest="def",
        planner="siw-r",
        seed=7,
        objects=("cup", "tea pot ☕"),
        base_start=(0.5, -0.25, 3.0),
        subgoals=(PlanSubgoal("take", {"H": 0}, {"H": 1}, 3, 10, 20, 1, 2, {"motion_plan": 4}),),
        actions=(
            PlanAction("move_base", "drive", 0, (drive, both), {"base": [1, 0, 0]}),
            PlanAction("pick", "pick the tea pot", 0, (reach, grip), {"object": "tea pot ☕"}),
            PlanAction("place", "put it down", 0, (reach, release, pull)),
        ),
        joints=("lift", "elbow"),
        tool_version="0.1.0",
    )


def test_what_is_written_is_read_again(tmp_path) -> None:
    path = tmp_path / "plan.json"
    write_plan(small_plan(), path)
    found = read_plan(path)
    assert to_json(found) == to_json(small_plan())
    grip = found.actions[1].pieces[1].piece
    assert isinstance(grip, GripperMove)
    assert (grip.attach, grip.release) == (Attach("tea pot ☕", "hand"), None)
    letting = found.actions[2].pieces[1].piece
    assert isinstance(letting, GripperMove)
    assert letting.release is not None
    assert letting.release.on == "table"
    assert letting.release.pose == pytest.approx([1.0, 2.0, 0.767, 0.0, 0.0, 0.6, 0.8])
    pull = found.actions[2].pieces[2].piece
    assert isinstance(pull, ArmMove)
    assert pull.along[0].body == "door"
    both = found.actions[0].pieces[1].piece
    assert isinstance(both, Together)
    assert both.openings == pytest.approx([0.05, 0.04])


def test_execution_time_is_the_sum_of_the_pieces() -> None:
    assert small_plan().execution_time == pytest.approx(1.5 + 0.05 + 2 * 2.25 + 2 * 0.5 + 1.0)


def test_a_produced_plan_survives_reading_and_writing(plan_file, tmp_path) -> None:
    copy = tmp_path / "copy.json"
    write_plan(read_plan(plan_file), copy)
    assert copy.read_bytes() == plan_file.read_bytes()


def test_writing_into_a_missing_folder_is_an_input_error(tmp_path) -> None:
    with pytest.raises(InputError, match="cannot be written"):
        write_plan(small_plan(), tmp_path / "missing" / "plan.json")


def test_a_failed_write_leaves_nothing_behind(tmp_path) -> None:
    (tmp_path / "plan.json").mkdir()
    with pytest.raises(InputError):
        write_plan(small_plan(), tmp_path / "plan.json")
    assert [path.name for path in tmp_path.iterdir()] == ["plan.json"]


# -- the format as documented ------------------------------------------------------------------

PAGE = Path(runtime.__path__[0]).parent / "docs" / "plan-format.md"


def documented(heading: str) -> set[str]:
    """The keys in the first column of the table under a heading."""
    section = re.split(r"^#+ ", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    text = next(part for part in section if part.startswith(heading))
    cells = re.findall(r"^\| (`[^|]*)\|", text, flags=re.MULTILINE)
    return {key for cell in cells for key in re.findall(r"`\"?(\w+)\"?`", cell)}


def test_a_produced_plan_has_the_documented_keys(plan_data) -> None:
    assert set(plan_data) == documented("Plan files") - {"failure"}  # of partial plans only
    assert all(set(subgoal) == documented("Subgoals") for subgoal in plan_data["subgoals"])
    assert all(set(action) == documented("Actions") for action in plan_data["actions"])


@pytest.mark.parametrize("which", ["plan_data", "plain_data"])
def test_pieces_of_a_produced_plan_are_as_documented(which, request) -> None:
    plan_data = request.getfixturevalue(which)
    extras = {"type", "along", "attach", "release"}
    assert documented("Pieces") - extras == {"base", "arm", "gripper", "together"}
    keys = {
        "together": {"type", "times", "poses", "path", "openings"},
        "base": {"type", "times", "poses"},
        "arm": {"type", "times", "path", "kind"},
        "gripper": {"type", "times", "opening"},
    }
    kinds = set()
    for action in plan_data["actions"]:
        for piece in action["pieces"]:
            extra = set(piece) - keys[piece["type"]]
            assert extra <= ({"attach", "release"} if piece["type"] == "gripper" else set())
            kinds.add(piece.get("kind"))
            page = PAGE.read_text(encoding="utf-8")
            assert all(f"`{key}`" in page for key in piece)
    assert all(f'`"{kind}"`' in PAGE.read_text(encoding="utf-8") for kind in kinds if kind)


def test_units_and_frames_of_a_produced_plan_are_as_documented(plan_data, robot, sticks) -> None:
    """Metres, radians, seconds, the scene's frame: releases on the wanted tables."""
    supports = {support.name: support for support in sticks.world.supports}
    for _, _, piece in pieces(plan_data, "gripper"):
        if "release" in piece:
            x, y, z = piece["release"]["pose"][:3]
            support = supports[piece["release"]["on"]]
            assert z == pytest.approx(support.pose[2, 3])
            assert np.hypot(*(support.pose[:2, 3] - [x, y])) < np.hypot(*support.half)
        if "attach" in piece:
            assert piece["attach"]["to"] == robot.urdf_tool
    assert plan_data["robot"]["joints"] == list(robot.joints)
    for _, _, piece in pieces(plan_data, "together"):
        count = len(piece["times"])
        assert np.shape(piece["path"]) == (count, len(robot.joints))
        assert np.shape(piece["poses"]) == (count, 3)
        assert np.shape(piece["openings"]) == (count,)
        assert np.diff(piece["times"]) == pytest.approx(0.05)
    first = next(pieces(plan_data, "together"))[2]
    assert first["poses"][0] == pytest.approx(plan_data["base_start"])
    assert plan_data["base_start"] == pytest.approx(sticks.robot_start)


def test_subgoals_count_their_actions(plan_data) -> None:
    for number, subgoal in enumerate(plan_data["subgoals"]):
        mine = [action for action in plan_data["actions"] if action["subgoal"] == number]
        assert len(mine) == subgoal["actions"]


def test_feature_values_go_on_from_subgoal_to_subgoal(plan_data) -> None:
    subgoals = plan_data["subgoals"]
    for before, after in pairwise(subgoals):
        assert before["after"] == after["before"]


# -- damage ------------------------------------------------------------------------------------


def test_a_plan_cut_off_anywhere_is_refused(tmp_path) -> None:
    text = json.dumps(to_json(small_plan()))
    path = tmp_path / "plan.json"
    for length in range(len(text)):
        path.write_text(text[:length], encoding="utf-8")
        with pytest.raises(InputError) as caught:
            read_plan(path)
        assert caught.value.place is not None
        assert caught.value.place.startswith(str(path))


def test_a_cut_off_plan_is_called_so(tmp_path, plan_file) -> None:
    path = tmp_path / "plan.json"
    path.write_bytes(plan_file.read_bytes()[:3000])
    with pytest.raises(InputError) as caught:
        read_plan(path)
    assert "cut off" in (caught.value.hint or "")


Change = Callable[[Json], Any]
DAMAGE: dict[str, tuple[Change, str]] = {
    "older version": (lambda d: d.update(version=0), "version"),
    "newer version": (lambda d: d.update(version=4), "version"),
    "version as text": (lambda d: d.update(version="1"), "version"),
    "another format": (lambda d: d.update(format="sketchlang-actions"), "format"),
    "no format": (lambda d: d.pop("format"), "format"),
    "no actions": (lambda d: d.pop("actions"), "actions"),
    "actions as object": (lambda d: d.update(actions={}), "actions"),
    "scene as text": (lambda d: d.update(scene="sorting/3t-02"), "scene"),
    "seed with a fraction": (lambda d: d.update(seed=1.5), "seed"),
    "seed as truth value": (lambda d: d.update(seed=True), "seed"),
    "start of two numbers": (lambda d: d.update(base_start=[0, 1]), "base_start"),
    "start as text": (lambda d: d.update(base_start=["0", "1", "2"]), "base_start"),
    "start that is infinite": (lambda d: d.update(base_start=[0, 1, 1e400]), "base_start"),
    "objects that are numbers": (lambda d: d.update(objects=[1, 2]), "objects"),
    "name that is a number": (lambda d: d["actions"][0].update(name=1), "actions[0].name"),
    "unknown key": (lambda d: d["actions"][0].update(peices=[]), "actions[0]: unknown key"),
    "unknown key of a grip": (
        lambda d: d["actions"][1]["pieces"][1].update(atach={}),
        "actions[1].pieces[1]: unknown key 'atach'",
    ),
    "joint twice": (lambda d: d["robot"]["joints"].append("lift"), "robot.joints[2]"),
    "object twice": (lambda d: d["objects"].append("cup"), "objects[2]"),
    "action that is a number": (lambda d: d["actions"].insert(0, 3), "actions[0]"),
    "unknown object": (
        lambda d: d["actions"][1]["pieces"][1]["attach"].update(body="pan"),
        "actions[1].pieces[1].attach.body",
    ),
    "no object": (lambda d: d["actions"][1]["pieces"][1]["attach"].pop("body"), "attach"),
    "pose of three": (
        lambda d: d["actions"][2]["pieces"][1]["release"].update(pose=[1, 2, 3]),
        "release.pose",
    ),
    "pose that is no rotation": (
        lambda d: d["actions"][2]["pieces"][1]["release"].update(pose=[1, 2, 3, 0, 0, 0, 2]),
        "release.pose",
    ),
    "carried poses that are too few": (
        lambda d: d["actions"][2]["pieces"][2]["along"][0]["poses"].pop(),
        "along[0].poses",
    ),
    "subgoal that is not there": (lambda d: d["actions"][0].update(subgoal=1), "subgoal"),
    "negative subgoal": (lambda d: d["actions"][0].update(subgoal=-1), "subgoal"),
    "feature value with a fraction": (
        lambda d: d["subgoals"][0]["before"].update(H=0.5),
        "subgoals[0].before",
    ),
    "unknown piece": (lambda d: d["actions"][0]["pieces"][0].update(type="leap"), "type"),
    "times that fall": (lambda d: d["actions"][0]["pieces"][0].update(times=[0, -1]), "times"),
    "times that start late": (lambda d: d["actions"][0]["pieces"][0].update(times=[1, 2]), "times"),
    "too few times": (lambda d: d["actions"][0]["pieces"][0].update(times=[0]), "poses"),
    "no times": (lambda d: d["actions"][0]["pieces"][0].update(times=[]), "times"),
    "poses of two numbers": (
        lambda d: d["actions"][0]["pieces"][0].update(poses=[[0, 0], [1, 1]]),
        "poses",
    ),
    "poses out of this world": (
        lambda d: d["actions"][0]["pieces"][0].update(poses=[[0, 0, 0], [1e9, 0, 0]]),
        "poses",
    ),
    "ragged path": (lambda d: d["actions"][1]["pieces"][0].update(path=[[0, 0], [1]]), "path"),
    "path with nothing": (
        lambda d: d["actions"][1]["pieces"][0].update(path=[[0, None], [1, 1]]),
        "path",
    ),
    "path with nan": (
        lambda d: d["actions"][1]["pieces"][0].update(path=[[0, float("nan")], [1, 1]]),
        "path",
    ),
    "path with an enormous whole number": (
        lambda d: d["actions"][1]["pieces"][0].update(path=[[0, 10**400], [1, 1]]),
        "path",
    ),
    "opening as text": (lambda d: d["actions"][1]["pieces"][1].update(opening="wide"), "opening"),
    "opening that is nan": (
        lambda d: d["actions"][1]["pieces"][1].update(opening=float("nan")),
        "opening",
    ),
    "an enormous opening": (
        lambda d: d["actions"][1]["pieces"][1].update(opening=10**400),
        "opening",
    ),
    "attach as text": (lambda d: d["actions"][1]["pieces"][1].update(attach="no"), "attach"),
    "attach and release": (
        lambda d: d["actions"][1]["pieces"][1].update(
            release={"body": "cup", "on": None, "pose": [0, 0, 0, 0, 0, 0, 1]}
        ),
        "pieces[1]",
    ),
}


@pytest.mark.parametrize(("change", "place"), DAMAGE.values(), ids=DAMAGE)
def test_damage_is_named_with_its_place(tmp_path, change, place) -> None:
    data = json.loads(json.dumps(to_json(small_plan())))
    change(data)
    with pytest.raises(InputError) as caught:
        parse(tmp_path, data)
    assert str(tmp_path / "plan.json") in (caught.value.place or "")
    assert place in str(caught.value).replace(str(tmp_path), "")


def test_an_older_plan_asks_to_be_planned_again(tmp_path) -> None:
    data = to_json(small_plan())
    data["version"] = 0
    with pytest.raises(InputError, match="version 0") as caught:
        parse(tmp_path, data)
    assert "older" in (caught.value.hint or "")


TEXTS = {
    "empty": b"",
    "another file": b"robot_start = [0, 0, 0]\n",
    "a list": b"[]",
    "a number": b"3",
    "null": b"null",
    "not utf-8": b'{"format": "\xff"}',
    "nested too deeply": b"[" * 200_000,
    "thousands of digits": b'{"seed": 1' + b"0" * 5000 + b"}",
    "twice": b"{}{}",
    "a key twice": b'{"format": "sketchlang-plan", "format": "sketchlang-plan"}',
}


@pytest.mark.parametrize("content", TEXTS.values(), ids=TEXTS)
def test_files_that_are_no_plans_end_the_command_with_two(tmp_path, content) -> None:
    path = tmp_path / "plan.json"
    path.write_bytes(content)
    done = CliRunner().invoke(validate, [str(path)])
    assert done.exit_code == 2
    assert str(path) in done.stderr
    assert not done.stdout


def test_missing_files_and_folders_end_the_command_with_two(tmp_path) -> None:
    for path in (tmp_path, tmp_path / "missing.json"):
        done = CliRunner().invoke(validate, [str(path)])
        assert done.exit_code == 2
        assert str(path) in done.stderr


SCRAPS = st.sampled_from([None, True, 0, -1, 10**30, 1e308, "", "x", [], [[]], {}, {"name": 1}])


@settings(
    max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_any_value_replaced_gives_a_plan_or_an_input_error(
    tmp_path: Path, data: st.DataObject
) -> None:
    plan = json.loads(json.dumps(to_json(small_plan())))
    node: Any = plan
    while True:
        keys = list(node) if isinstance(node, dict) else list(range(len(node)))
        key = data.draw(st.sampled_from(keys))
        child = node[key]
        if not isinstance(child, dict | list) or not child or data.draw(st.booleans()):
            node[key] = data.draw(SCRAPS)
            break
        node = child
    place = None
    try:
        assert isinstance(parse(tmp_path, plan), Plan)
    except InputError as error:
        place = error.place or ""
    assert place is None or str(tmp_path) in place
