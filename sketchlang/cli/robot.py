"""`sketchlang robot`: bring in a robot of one's own, and look its file over."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sketchlang.analysis.words import counted
from sketchlang.cli import names
from sketchlang.cli.common import fail, interruptible, say

if TYPE_CHECKING:
    from runtime.robot.findings import Finding
    from runtime.robot.model import RobotModel


@click.group("robot")
def command() -> None:
    """Bring in a robot, and look its file over.

    \b
    Examples:
      sketchlang robot import panda.urdf --tool panda_grasptarget --out panda
      sketchlang robot check panda/panda.toml
    """


@command.command("import")
@click.argument("urdf", type=click.Path(path_type=Path))
@click.option("--tool", required=True, metavar="LINK", help="A link of the hand, or the flange.")
@click.option(
    "--out",
    required=True,
    metavar="FOLDER",
    type=click.Path(path_type=Path),
    help="A new folder for the robot file, the URDF and its meshes.",
)
@click.option("--srdf", type=click.Path(path_type=Path), help="Pairs that may touch, postures.")
@click.option("--name", metavar="N", help="The robot's name.  [default: the URDF's]")
@click.option(
    "--base",
    type=click.Choice(["fixed", "holonomic", "differential"]),
    help="How it gets about.  [default: as its joints and wheels say]",
)
@click.option(
    "--height",
    type=click.FloatRange(0.0, 3.0),
    default=0.0,
    metavar="M",
    help="Metres of its root above the floor, for one that stands on something.",
)
@click.option(
    "--gripper",
    metavar="NAME|FILE",
    help="A gripper to fit to the tool link: `two_finger`, or a URDF.",
)
@interruptible
def import_(
    urdf: Path,
    tool: str,
    out: Path,
    srdf: Path | None,
    name: str | None,
    base: str | None,
    height: float,
    gripper: str | None,
) -> None:
    """Propose a robot file for URDF: chain, tool frame, fingers, home posture, pairs that may
    touch. Meshes are written anew as small hulls.

    Exit 0: written and nothing found. 1: written, with findings. 2: bad input.
    """
    from runtime.robot.check import check_robot
    from runtime.robot.propose.proposal import propose
    from runtime.robot.propose.srdf import read_srdf
    from runtime.robot.propose.write import write_proposal
    from sketchlang.errors import InputError

    try:
        if name is not None and (not name.strip() or not _is_file_name(name)):
            raise InputError(f"--name: {name!r} cannot be the name of a file")
        proposal = propose(
            urdf,
            tool,
            name=name,
            srdf=None if srdf is None else read_srdf(srdf),
            base=base,
            height=height,
            gripper=gripper,
        )
        path = write_proposal(proposal, out)
        found, robot = check_robot(path)
    except InputError as error:
        fail(error)
    say(f"wrote {path}")
    for note in proposal.notes:
        say(f"  {note}")
    if robot is not None:
        _describe(robot)
    _say(found)
    raise SystemExit(1 if found else 0)


@command.command("check")
@click.argument("file", type=click.Path(path_type=Path), shell_complete=names.robots)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@interruptible
def check(file: Path, as_json: bool) -> None:
    """Look over a robot FILE (.toml), or a built-in robot by its name.

    Exit 0: clean. 1: findings. 2: it cannot be read.
    """
    from runtime.robot.check import check_robot
    from runtime.robot.load import robot_path
    from sketchlang.errors import InputError

    try:
        found, robot = check_robot(robot_path(file))
    except InputError as error:
        fail(error)
    if as_json:
        data = {"file": str(file), "findings": [vars(finding) for finding in found]}
        say(json.dumps(data, indent=1))
    else:
        if robot is not None:
            _describe(robot)
        _say(found)
    raise SystemExit(1 if found else 0)


def _is_file_name(name: str) -> bool:
    return name == Path(name).name and name not in {".", ".."} and name.isprintable()


def _describe(robot: RobotModel) -> None:
    from runtime.robot.approach import USUAL

    gripper, base = robot.gripper, robot.base
    say(f"{robot.name}: {counted(len(robot.joints), 'joint')}, {base.type} base")
    opens = f"{1000 * gripper.min_opening:.0f} to {1000 * gripper.max_opening:.0f} mm"
    say(f"  gripper: {opens}, {counted(len(gripper.joints), 'finger joint')}")
    for family in USUAL:
        reaches = robot.derived.workspaces[family].reaches
        text = (
            "nowhere"
            if reaches is None
            else f"at heights of {reaches[0]:.1f} to {reaches[1]:.1f} m"
        )
        say(f"  grasps, {family.value}: {text}")


def _say(found: list[Finding]) -> None:
    for finding in found:
        say(f"{finding.place}: {finding.message} [{finding.code}]")
        if finding.hint:
            say(f"  hint: {finding.hint}")
    count = len(found)
    say("nothing found" if not count else f"{count} finding{'s' if count > 1 else ''}")
