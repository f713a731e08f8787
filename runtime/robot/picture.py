"""A robot as people read it (`sketchlang.domain.Picture`)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from runtime.robot.approach import USUAL, Family
from runtime.robot.model import RobotModel
from sketchlang.escape import shown_line


@dataclass(frozen=True, eq=False)
class RobotPicture:
    """Base, chain, gripper, home posture and reach of a robot."""

    robot: RobotModel

    def text(self, width: int, colour: bool) -> list[str]:
        """A table of the planned joints, and a line for everything else."""
        data = self.data()
        base, gripper = data["base"], data["gripper"]
        moves = (
            ""
            if base["type"] == "fixed"
            else f", {base['velocity']:g} m/s and {base['angular_velocity']:g} rad/s at most"
        )
        lines = [
            f"{data['name']}: {base['type']} base{moves}",
            "",
            "planned joints, from the base to the tool",
            f"  {'joint':<22}{'kind':<8}{'limits':<20}{'speed':<12}home",
        ]
        for joint in data["joints"]:
            unit = "m" if joint["kind"] == "slides" else "rad"
            limits = f"{joint['lower']:.2f} to {joint['upper']:.2f} {unit}"
            speed = f"{joint['velocity']:.2f} {unit}/s"
            lines.append(
                f"  {joint['name']:<22}{joint['kind']:<8}{limits:<20}{speed:<12}{joint['home']:.2f}"
            )
        lines += [
            "",
            f"tool frame: {data['tool']}",
            f"gripper: pads {1000 * gripper['min_opening_m']:.0f} to "
            f"{1000 * gripper['max_opening_m']:.0f} mm apart, moved by "
            f"{', '.join(gripper['joints'])}",
        ]
        known = [
            f"{name.replace('_', ' ')} {value:g}"
            for name, value in gripper["limits"].items()
            if value is not None
        ]
        if known:
            lines.append(f"  {', '.join(known)}")
        if data["fixed_joints"]:
            held = ", ".join(f"{name} at {value:g}" for name, value in data["fixed_joints"].items())
            lines.append(f"joints that are held: {held}")
        lines.append("")
        for family, reach in data["reach"].items():
            where = (
                f"at heights of {reach['lowest_m']:.1f} to {reach['highest_m']:.1f} m, the wrist "
                f"up to {reach['farthest_m']:.2f} m from the shoulder"
                if reach
                else "nowhere"
            )
            lines.append(f"grasps, {_FAMILIES[family]}: {where}")
        return list(map(shown_line, lines))

    def svg(self) -> str | None:
        """`sketchlang replay` shows robots."""
        return None

    def data(self) -> dict[str, Any]:
        """The same as plain data: metres, radians, seconds."""
        robot, base, gripper = self.robot, self.robot.base, self.robot.gripper
        joints = {joint.name: joint for joint in robot.urdf.joints.values()}
        return {
            "name": robot.name,
            "base": {"type": base.type, **_speeds(robot)},
            "joints": [
                {
                    "name": name,
                    "kind": "slides" if robot.chain.prismatic[i] else "turns",
                    "parent": joints[name].parent,
                    "child": joints[name].child,
                    "lower": float(robot.lower[i]),
                    "upper": float(robot.upper[i]),
                    "velocity": float(robot.velocity[i]),
                    "acceleration": float(robot.acceleration[i]),
                    "home": float(robot.home[i]),
                }
                for i, name in enumerate(robot.joints)
            ],
            "tool": robot.urdf_tool,
            "gripper": {
                "joints": list(gripper.joints),
                "links": sorted(gripper.links),
                "min_opening_m": gripper.min_opening,
                "max_opening_m": gripper.max_opening,
                "limits": {
                    "force_N": gripper.max_force,
                    "torque_Nm": gripper.max_torque,
                    "payload_kg": gripper.payload,
                },
            },
            "fixed_joints": dict(robot.fixed),
            "reach": {family.value: self._reach(family) for family in USUAL},
        }

    def _reach(self, family: Family) -> dict[str, float] | None:
        space = self.robot.derived.workspaces[family]
        if space.reaches is None:
            return None
        lowest, highest = space.reaches
        return {
            "lowest_m": float(lowest),
            "highest_m": float(highest),
            "farthest_m": float(space.outer.max()),
        }


_FAMILIES = {
    "side": "from the side",
    "top": "from above",
    "pinch": "from the side with a finger above and one below",
}


def _speeds(robot: RobotModel) -> dict[str, float]:
    base = robot.base
    named = ("velocity", "acceleration", "angular_velocity", "angular_acceleration")
    return {name: getattr(base, name) for name in named if math.isfinite(getattr(base, name))}
