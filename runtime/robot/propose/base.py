"""How a robot gets about: what the joints and names of its URDF give away."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from runtime.robot.urdf import MOVING, Joint, Urdf

ROLLERS = ("mecanum", "omni", "swerve", "caster_drive", "steer")
"""Words in names of wheels that also go sideways."""


@dataclass(frozen=True)
class ProposedBase:
    """The kind of base, the link that it is described by, and why."""

    type: str
    link: str
    reason: str


def propose_base(urdf: Urdf, tool_link: str) -> ProposedBase:
    """The base of a robot: joints in the plane at the root make it holonomic, wheels make it
    drive, and else it stands."""
    chain = urdf.chain(tool_link)
    leading = _in_the_plane(chain)
    if leading is not None:
        return ProposedBase("holonomic", leading.child, "joints that move it in the plane")
    on_arm = {joint.name for joint in chain}
    wheels = [
        joint
        for joint in urdf.joints.values()
        if joint.name not in on_arm
        and joint.type == "continuous"
        and ("wheel" in joint.name.lower() or "wheel" in joint.child.lower())
    ]
    if wheels:
        names = " ".join(f"{joint.name} {joint.child}".lower() for joint in wheels)
        sideways = any(word in names for word in ROLLERS)
        kind = "holonomic" if sideways else "differential"
        return ProposedBase(kind, urdf.root, f"{len(wheels)} wheels, as {wheels[0].name!r}")
    still = next((link for link in urdf.shapes if "wheel" in link.lower()), None)
    reason = "no wheels and no joints in the plane"
    if still is not None:
        reason = f"its wheels, as {still!r}, do not turn in this URDF: --base says how it drives"
    return ProposedBase("fixed", urdf.root, reason)


def _in_the_plane(chain: list[Joint]) -> Joint | None:
    """The last of the joints at the root that together move the rest in the plane."""
    slides: list[np.ndarray] = []
    turns = 0
    for joint in chain:
        if joint.type == "planar":
            return joint
        if joint.type not in MOVING:
            continue
        level = abs(joint.axis[2]) < 0.01
        if joint.type == "prismatic" and level and len(slides) < 2:
            slides.append(joint.axis)
        elif joint.type != "prismatic" and not level and turns == 0:
            turns += 1
        else:
            return None
        if len(slides) == 2 and turns == 1:
            crossed = abs(float(np.cross(slides[0], slides[1])[2])) > 0.5
            return joint if crossed else None
    return None
