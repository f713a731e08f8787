"""Arms of others, brought in as they are, sort a desk; the judge agrees."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from sketchlang.cli import cli

ARMS = [
    ("franka_panda/panda.urdf", ["--tool", "panda_grasptarget"]),
    ("kuka_iiwa/model.urdf", ["--tool", "lbr_iiwa_link_7", "--gripper", "two_finger"]),
]


def done(*arguments: object) -> None:
    result = CliRunner().invoke(cli, [str(argument) for argument in arguments])
    assert result.exit_code == 0, result.output


@pytest.mark.slow
@pytest.mark.parametrize(("urdf", "options"), ARMS, ids=["panda", "kuka"])
def test_it_sorts_a_desk(tmp_path, urdf, options) -> None:
    data = pytest.importorskip("pybullet_data")
    robot, plan = tmp_path / "arm" / "arm.toml", tmp_path / "plan.json"
    source = Path(data.getDataPath()) / urdf
    done(
        "robot", "import", source, *options, "--height", 0.75, "--name", "arm", "--out",
        robot.parent,
    )  # fmt: skip
    done("robot", "check", robot)
    done("run", "pick_and_place", "desk/sort", "--robot", robot, "--seed", 3, "--timeout", 20,
         "--out", plan)  # fmt: skip
    done("validate", plan, "--robot", robot)
