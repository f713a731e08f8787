"""The robot of KinDER's kinematic 3D environments: a robot file made of what the package has.

A Kinova Gen3 with a two-finger gripper on a holonomic base that is a box. Its fingers are open or
closed on something: a release opens them fully, and nothing asks for a width in between.
"""

from __future__ import annotations

import tempfile
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

from runtime.robot.propose.proposal import propose
from runtime.robot.propose.write import write_proposal
from sketchlang.errors import InputError

NAME = "tidybot"
HOME = (0.0, -0.35, -3.1415926, -2.5, 0.0, -0.87, 1.5707963)
"""The posture in which every episode starts."""

MOUNT = "0.1199 0 0.3948"
BASE = (0.548, 0.508, 0.365)
"""Metres of the box that is the base."""

FREE = ("joint_1", "joint_3", "joint_5", "joint_7")
"""Joints that turn freely; a turn on either side of the middle is enough."""

ARM = Path("kortex_description/gen3_7dof.urdf")


def make_robot(assets: Path, folder: Path) -> Path:
    """Write the robot to a new folder, from the folder `urdf` of the package's assets; returns
    the path of the robot file.

    Raises:
        InputError: something is not as version 0.2.5 has it, or the folder cannot be written.
    """
    with tempfile.TemporaryDirectory() as temporary:
        path = Path(temporary) / f"{NAME}.urdf"
        path.write_text(_urdf(assets), encoding="utf-8")
        proposal = propose(path, "tool_frame", name=NAME, base="holonomic")
    if proposal.file.gripper is None:
        raise InputError("no gripper was found on the arm", place=str(assets / ARM))
    gripper = replace(proposal.file.gripper, opens_fully=True)
    file = replace(proposal.file, home=HOME, gripper=gripper)
    limits = {**proposal.limits, **{name: {"lower": -6.28, "upper": 6.28} for name in FREE}}
    return write_proposal(replace(proposal, file=file, limits=limits), folder)


def _urdf(assets: Path) -> str:
    """The arm on the box of its base."""
    try:
        root = ET.parse(assets / ARM).getroot()
    except (OSError, ET.ParseError) as error:
        raise InputError(str(error), place=str(assets / ARM)) from None
    for mesh in root.iter("mesh"):
        mesh.set("filename", mesh.get("filename", "").replace("package://", f"{assets}/"))
    for element in list(root):
        if element.get("name") in {"world", "world_to_root"}:
            root.remove(element)
    size = " ".join(f"{value:g}" for value in BASE)
    body = f'<origin xyz="0 0 {BASE[2] / 2:g}"/><geometry><box size="{size}"/></geometry>'
    link = f'<link name="base_root"><collision>{body}</collision><visual>{body}</visual></link>'
    joint = (
        '<joint name="arm_mount" type="fixed"><parent link="base_root"/>'
        f'<child link="base_link"/><origin xyz="{MOUNT}"/></joint>'
    )
    root.extend([ET.fromstring(link), ET.fromstring(joint)])
    return ET.tostring(root, encoding="unicode")
