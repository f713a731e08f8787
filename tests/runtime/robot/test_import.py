"""`robot import`: what is proposed for a URDF, and that it stands up to `robot check`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from runtime.robot.check import check_robot
from runtime.robot.load import load_robot
from runtime.robot.propose.pairs import touching
from runtime.robot.tree import link_poses, with_mimics
from runtime.robot.urdf import read_urdf
from runtime.world.poses import compose, invert
from sketchlang.cli.robot import command
from tests.runtime.robot.arms import HAND, arm_urdf, coarse_grid, write_arm


def run(*arguments: object):
    return CliRunner().invoke(command, [str(argument) for argument in arguments])


@pytest.fixture(autouse=True, scope="module")
def quick(tmp_path_factory):
    with coarse_grid(tmp_path_factory.mktemp("cache")):
        yield


@pytest.fixture(scope="module")
def imported(tmp_path_factory) -> Path:
    """The arm, brought in by its palm; the original is out of the way afterwards."""
    folder = tmp_path_factory.mktemp("arm")
    urdf = write_arm(folder)
    done = run("import", urdf, "--tool", "palm", "--out", folder / "out")
    assert done.exit_code == 0, done.output
    urdf.unlink()
    (folder / "meshes" / "tube.stl").unlink()
    return folder / "out" / "arm.toml"


def test_an_arm_is_brought_in_clean(imported) -> None:
    robot = load_robot(imported)
    assert len(robot.joints) == 6
    assert robot.base.type == "fixed"
    assert robot.gripper.joints == ("slide_left", "slide_right")
    assert robot.gripper.max_opening == pytest.approx(0.09)
    assert not touching(robot, robot.home[None])
    assert run("check", imported).exit_code == 0


def test_the_tool_frame_is_between_the_tips_and_looks_along_the_fingers(imported) -> None:
    robot = load_robot(imported)
    poses = link_poses(robot.urdf, with_mimics(robot.urdf, {}))
    tool = compose(invert(poses["palm"]), poses[robot.urdf_tool])
    assert tool[:, 0] == pytest.approx([0, 0, 1], abs=1e-6)
    assert abs(tool[1, 1]) == pytest.approx(1.0, abs=1e-6)
    assert tool[:, 3] == pytest.approx([0.0, 0.0, 0.1], abs=1e-6)  # 15 mm behind the tips


@pytest.mark.parametrize("link", ["flange", "left"])
def test_any_link_of_the_hand_will_do_but_a_finger(tmp_path, link) -> None:
    done = run("import", write_arm(tmp_path), "--tool", link, "--out", tmp_path / "out")
    assert done.exit_code == (0 if link == "flange" else 1), done.output
    if link == "flange":
        robot = load_robot(tmp_path / "out" / "arm.toml")
        poses = link_poses(robot.urdf, {})
        tool = compose(invert(poses["palm"]), poses[robot.urdf_tool])
        assert tool[:, 3] == pytest.approx([0.0, 0.0, 0.1], abs=1e-6)
        assert abs(tool[1, 1]) == pytest.approx(1.0, abs=1e-6)


def test_a_tool_link_well_behind_the_tips_is_not_where_things_are_held(tmp_path) -> None:
    """And names of the URDF that are those of our own frames are no clash."""
    frame = (
        '<link name="tool_frame"/><joint name="tool" type="fixed"><parent link="palm"/>'
        '<child link="tool_frame"/><origin xyz="0 0 0.07"/></joint>'
        '<link name="floor_under_base"/><joint name="plate" type="fixed"><parent link="foot"/>'
        '<child link="floor_under_base"/></joint></robot>'
    )
    urdf = write_arm(tmp_path, arm_urdf().replace("</robot>", frame))
    out = tmp_path / "out"
    done = run("import", urdf, "--tool", "tool_frame", "--height", 0.4, "--out", out)
    assert done.exit_code == 0, done.output
    robot = load_robot(out / "arm.toml")
    poses = link_poses(robot.urdf, {})
    tool = compose(invert(poses["palm"]), poses[robot.urdf_tool])
    assert tool[:, 3] == pytest.approx([0.0, 0.0, 0.1], abs=1e-6)  # 15 mm behind the tips
    assert run("check", out / "arm.toml").exit_code == 0


def test_what_is_written_moves_as_the_original_does(imported, tmp_path, rng) -> None:
    first, second = read_urdf(write_arm(tmp_path)), load_robot(imported).urdf
    names = [joint.name for joint in first.joints.values() if joint.type != "fixed"]
    for _ in range(5):
        values = dict(zip(names, rng.uniform(-1, 1, len(names)).tolist(), strict=True))
        a, b = link_poses(first, values), link_poses(second, values)
        assert all(np.allclose(a[link], b[link], atol=1e-8) for link in a)
    assert {link: len(shapes) for link, shapes in first.shapes.items()} == {
        link: len(second.shapes[link]) for link in first.shapes
    }


def test_an_arm_without_a_gripper_is_told_and_given_one(tmp_path) -> None:
    urdf = write_arm(tmp_path, arm_urdf(hand=""))
    done = run("import", urdf, "--tool", "flange", "--out", tmp_path / "bare")
    assert done.exit_code == 1
    assert "gripper-missing" in done.output
    done = run(
        "import", urdf, "--tool", "flange", "--gripper", "two_finger", "--out", tmp_path / "full"
    )
    assert done.exit_code == 0, done.output
    robot = load_robot(tmp_path / "full" / "arm.toml")
    assert robot.gripper.max_opening == pytest.approx(0.11)
    # On top of the flange, which ends 2 cm above its frame.
    poses = link_poses(robot.urdf, {})
    assert compose(invert(poses["flange"]), poses["two_finger_body"])[:, 3] == pytest.approx(
        [0, 0, 0.02]
    )


def test_limits_that_are_absent_are_assumed_and_said(tmp_path) -> None:
    urdf = write_arm(tmp_path, arm_urdf(limit=""))
    done = run("import", urdf, "--tool", "palm", "--out", tmp_path / "out")
    assert done.exit_code == 0, done.output
    assert "turret_joint" in done.output
    robot = load_robot(tmp_path / "out" / "arm.toml")
    assert robot.velocity == pytest.approx(np.ones(6))
    assert robot.upper == pytest.approx(np.full(6, 3.1416))


WHEELS = "".join(
    f'<link name="wheel{k}"/><joint name="wheel{k}_joint" type="continuous"><parent link="foot"/>'
    f'<child link="wheel{k}"/><axis xyz="0 1 0"/></joint>'
    for k in range(2)
)
SLIDING = (
    '<link name="world"/><link name="x"/><link name="y"/>'
    '<joint name="x" type="prismatic"><parent link="world"/><child link="x"/><axis xyz="1 0 0"/>'
    '<limit lower="-9" upper="9" velocity="1"/></joint>'
    '<joint name="y" type="prismatic"><parent link="x"/><child link="y"/><axis xyz="0 1 0"/>'
    '<limit lower="-9" upper="9" velocity="1"/></joint>'
    '<joint name="turn" type="continuous"><parent link="y"/><child link="foot"/>'
    '<axis xyz="0 0 1"/></joint>'
)


@pytest.mark.parametrize(
    ("more", "options", "kind"),
    [
        (WHEELS, [], "differential"),
        (WHEELS.replace("wheel", "mecanum_wheel"), [], "holonomic"),
        (SLIDING, [], "holonomic"),
        ("", ["--base", "holonomic", "--height", "0.5"], "holonomic"),
    ],
    ids=["wheels", "mecanum", "joints", "asked"],
)
def test_bases_are_found_by_their_joints(tmp_path, more, options, kind) -> None:
    urdf = write_arm(tmp_path, arm_urdf(hand=HAND + more))
    done = run("import", urdf, "--tool", "palm", "--out", tmp_path / "out", *options)
    assert done.exit_code == 0, done.output
    robot = load_robot(tmp_path / "out" / "arm.toml")
    assert robot.base.type == kind
    assert robot.base.velocity > 0
    assert len(robot.joints) == 6
    foot = link_poses(robot.urdf, {})["foot"]
    assert foot[2, 3] == pytest.approx(0.5 if options else 0.0)


def test_an_srdf_is_taken_over(tmp_path) -> None:
    srdf = tmp_path / "arm.srdf"
    joints = "".join(
        f'<joint name="{name}_joint" value="{value}"/>'
        for name, value in zip(
            ("turret", "upper", "fore", "roll", "pitch", "flange"),
            (0.1, -1.0, 1.8, 0.0, 0.9, 0.0),
            strict=True,
        )
    )
    srdf.write_text(
        f'<robot name="arm"><group_state name="home" group="arm">{joints}</group_state>'
        '<disable_collisions link1="foot" link2="fore" reason="Never"/></robot>'
    )
    urdf = write_arm(tmp_path)
    done = run("import", urdf, "--tool", "palm", "--srdf", srdf, "--out", tmp_path / "out")
    assert done.exit_code == 0, done.output
    robot = load_robot(tmp_path / "out" / "arm.toml")
    assert robot.home == pytest.approx([0.1, -1.0, 1.8, 0.0, 0.9, 0.0])
    assert frozenset(("foot", "fore")) in robot.ignored


def test_bad_input_ends_with_2_and_writes_nothing(tmp_path) -> None:
    urdf, out = write_arm(tmp_path), tmp_path / "out"
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "file").write_text("mine")
    for arguments, word in (
        ([tmp_path / "none.urdf", "--tool", "palm", "--out", out], "no such file"),
        ([urdf, "--tool", "plam", "--out", out], "palm"),
        ([urdf, "--tool", "palm", "--out", tmp_path / "full"], "exists"),
        ([urdf, "--tool", "palm", "--out", tmp_path / "no" / "out"], "written"),
        ([urdf, "--tool", "palm", "--out", out, "--srdf", tmp_path / "none"], "no such file"),
        ([urdf, "--tool", "palm", "--out", out, "--gripper", "three"], "two_finger"),
        ([urdf, "--tool", "palm", "--out", out, "--name", "a/b"], "name"),
    ):
        done = run("import", *arguments)
        assert done.exit_code == 2, done.output
        assert word in done.output
        assert not out.exists()
    assert (tmp_path / "full" / "file").read_text() == "mine"
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(".")]


# -- check -------------------------------------------------------------------------------------


def changed(text: str, **lines: str) -> str:
    """The robot file with the values of some keys replaced."""
    out = []
    for line in text.splitlines():
        key = line.split(" = ")[0]
        out.append(f"{key} = {lines[key]}" if key in lines else line)
    return "\n".join(out) + "\n"


FINDINGS = {
    "home-in-collision": {"home": "[0.0, 2.5, 2.5, 0.0, 2.5, 0.0]"},
    "home-outside-limits": {"home": "[0.0, 0.0, 0.0, 9.0, 0.0, 0.0]"},
    "chain-does-not-reach-tool": {"joints": '["turret_joint"]'},
    "unknown-name": {"finger_joints": '["thumb"]'},
    "fingers-do-not-close": {"rpy": "[1.5708, 0.0, 0.0]"},
    "tool-axis": {"rpy": "[0.0, 0.0, 0.0]"},
    "always-in-collision": {"ignored_collisions": '[["left", "right"]]\nunused = ['},
}


@pytest.mark.parametrize(("code", "lines"), FINDINGS.items(), ids=FINDINGS)
def test_findings_have_names(imported, tmp_path, code, lines) -> None:
    text = changed(imported.read_text(), **lines)
    if code == "always-in-collision":
        start, end = text.index("unused = ["), text.index("\n]\n") + 3
        text = text[:start] + text[end:]
    path = imported.parent / f"{code}.toml"
    path.write_text(text)
    done = run("check", path)
    assert done.exit_code == 1, done.output
    assert f"[{code}]" in done.output


def test_a_home_in_collision_comes_with_its_pair(imported) -> None:
    path = imported.parent / "home.toml"
    path.write_text(changed(imported.read_text(), **FINDINGS["home-in-collision"]))
    found, _ = check_robot(path)
    pairs = [finding.message for finding in found if finding.code == "home-in-collision"]
    assert any("foot" in message or "turret" in message for message in pairs)


@pytest.mark.parametrize("table", ["gripper", "base"])
def test_a_missing_table_is_a_finding(imported, table) -> None:
    text = imported.read_text()
    start = text.index(f"[{table}]")
    end = text.find("\n\n", start)
    path = imported.parent / f"no_{table}.toml"
    path.write_text(text[:start] + (text[end:] if end > 0 else ""))
    done = run("check", path)
    assert done.exit_code == 1, done.output
    assert f"{table}-missing" in done.output


def test_absent_limits_are_a_finding(tmp_path, imported) -> None:
    out = tmp_path / "out"
    assert run("import", write_arm(tmp_path), "--tool", "palm", "--out", out).exit_code == 0
    urdf = (out / "arm.urdf").read_text()
    (out / "arm.urdf").write_text(urdf.replace('lower="-2.6" upper="2.6" velocity="2"', "", 1))
    done = run("check", out / "arm.toml")
    assert done.exit_code == 1
    assert "[limits-absent]" in done.output
    assert "turret_joint" in done.output


def test_a_workspace_below_the_floor_is_a_finding(imported) -> None:
    path = imported.parent / "sunk.toml"
    path.write_text(imported.read_text().replace("[base]", "[base]\nheight = -3.0"))
    done = run("check", path)
    assert done.exit_code == 1
    assert "[workspace-unreachable]" in done.output
    assert "below the floor" in done.output


@pytest.mark.parametrize("content", [None, "not toml =", 'name = "x"', "\x00"])
def test_what_cannot_be_read_ends_with_2(tmp_path, content) -> None:
    path = tmp_path / "robot.toml"
    if content is not None:
        path.write_text(content)
    assert run("check", path).exit_code == 2


# -- the robots of PyBullet's data -------------------------------------------------------------


@pytest.mark.parametrize(
    ("urdf", "options"),
    [
        pytest.param(
            "franka_panda/panda.urdf", ["--tool", "panda_grasptarget"], marks=pytest.mark.slow
        ),
        ("kuka_iiwa/model.urdf", ["--tool", "lbr_iiwa_link_7", "--gripper", "two_finger"]),
    ],
)
def test_robots_of_pybullet_are_brought_in_unmodified(tmp_path, urdf, options) -> None:
    data = pytest.importorskip("pybullet_data")
    path = Path(data.getDataPath()) / urdf
    done = run(
        "import", path, *options, "--height", "0.75", "--out", tmp_path / "out", "--name", "it"
    )
    assert done.exit_code == 0, done.output
    robot = load_robot(tmp_path / "out" / "it.toml")
    assert len(robot.joints) == 7
    for family, height in (("SIDE", 1.0), ("TOP", 0.85)):
        inner, outer, _ = robot.workspace(
            type(next(iter(robot.derived.workspaces)))[family], height
        )
        assert outer - inner > 0.2
