"""Writes a proposal: a folder with the robot file, the URDF and small meshes."""

from __future__ import annotations

import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

import numpy as np

from runtime.robot.file import gripper_path
from runtime.robot.propose.proposal import Proposal
from runtime.robot.propose.reduced import reduced, rpy_of
from runtime.toml_text import inline
from runtime.world.poses import Pose
from sketchlang.errors import InputError


def write_proposal(proposal: Proposal, folder: Path) -> Path:
    """Write a proposal to a new folder; returns the path of the robot file.

    All is written beside it under another name, and renamed.

    Raises:
        InputError: the folder exists and holds something, or cannot be written.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError("exists already", place=str(folder), hint="name a new folder")
    name = proposal.file.name
    urdf, files = reduced(proposal.urdf)
    files |= {f"{name}.urdf": urdf, f"{name}.toml": robot_toml(proposal)}
    if proposal.mount is not None and proposal.mount.urdf.endswith(".urdf"):
        from runtime.robot.urdf import read_urdf

        text, meshes = reduced(read_urdf(gripper_path(proposal.mount.urdf)))
        own = Path(proposal.mount.urdf).name
        files |= {own if own != f"{name}.urdf" else f"gripper_{own}": text, **meshes}
    try:
        parent = folder.absolute().parent
        temporary = Path(tempfile.mkdtemp(prefix=f".{folder.name[:40]}.", dir=parent))
        try:
            for path, text in files.items():
                target = temporary / path
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_text(text, encoding="utf-8")
            temporary.chmod(0o755)
            with suppress(FileNotFoundError):
                folder.rmdir()
            temporary.rename(folder)
        except BaseException:
            shutil.rmtree(temporary, ignore_errors=True)
            raise
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"cannot be written: {reason}", place=str(folder)) from None
    return folder / f"{name}.toml"


def robot_toml(proposal: Proposal) -> str:
    """The text of the robot file."""
    file, mount = proposal.file, proposal.mount
    assert file.joints is not None
    assert file.base is not None
    lines = [
        f"# {file.name}: proposed by `sketchlang robot import`; try `sketchlang robot check`.",
        f"name = {inline(file.name)}",
        f"urdf = {inline(file.name + '.urdf')}",
        f"base_link = {inline(proposal.base_link)}",
    ]
    if proposal.tool is None:
        lines.append(f"tool_link = {inline(proposal.tool_link)}")
    lines += [
        "",
        f"joints = {inline(file.joints)}",
        "# Full speed in half a second: URDFs do not say. rad/s^2, m/s^2 for sliding joints.",
        f"acceleration = {list(file.acceleration)}",
        "# The posture in which the robot drives, or waits.",
        f"home = {list(file.home)}",
        "",
        "# Neighbours, the parts of the gripper, and links that touch in nearly all postures.",
        "ignored_collisions = [",
        *(f"  [{inline(a)}, {inline(b)}]," for a, b in file.ignored),
        "]",
    ]
    if proposal.tool is not None:
        lines += [
            "",
            "[tool]  # x: approach, y: the fingers close, origin: grasp centre",
            f"link = {inline(proposal.tool_link)}",
            *_pose(proposal.tool),
        ]
    if mount is not None:
        urdf = mount.urdf
        if urdf.endswith(".urdf"):
            urdf = Path(urdf).name
            urdf = urdf if urdf != f"{file.name}.urdf" else f"gripper_{urdf}"
        lines += [
            "",
            "[[attach]]  # the gripper",
            f"urdf = {inline(urdf)}",
            f"link = {inline(mount.link)}",
            *_pose(mount.pose),
        ]
    for name, limits in proposal.limits.items():
        lines += ["", f"[limits.{inline(name)}]"]
        lines += [f"{key} = {value:g}" for key, value in limits.items()]
    if file.fixed:
        lines += ["", "[fixed_joints]"]
        lines += [f"{inline(name)} = {value:g}" for name, value in file.fixed.items()]
    if file.gripper is not None:
        lines += [
            "",
            "[gripper]",
            f"finger_joints = {inline(file.gripper.fingers)}",
            f"links = {inline(file.gripper.links)}",
            f"clearance = {file.gripper.clearance:g}  # metres beside the object while approaching",
            f"time = {file.gripper.time:g}  # seconds to open or close",
            *(['opens = "fully"'] if file.gripper.opens_fully else []),
            "# Where they are known: max_force (N), max_torque (N m), payload (kg).",
        ]
    lines += ["", "[base]", f"type = {inline(file.base.type)}"]
    if proposal.height:
        lines.append(f"height = {proposal.height:g}  # metres of its root above the floor")
    if file.base.type != "fixed":
        lines += [
            f"{key} = {getattr(file.base, key):g}"
            for key in ("velocity", "acceleration", "angular_velocity", "angular_acceleration")
        ]
    for each in file.controllers or ():
        lines += ["", f"[controllers.{inline(each.name)}]", f"type = {inline(each.type)}"]
        if each.joints:
            lines.append(f"joints = {inline(each.joints)}")
    return "\n".join(lines) + "\n"


def _pose(pose: Pose) -> list[str]:
    rpy = rpy_of(pose[:, :3])
    return [
        f"xyz = {(np.round(pose[:, 3], 6) + 0.0).tolist()}",
        f"rpy = {(np.round(rpy, 9) + 0.0).tolist()}",
    ]
