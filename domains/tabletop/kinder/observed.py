"""What KinDER lets an agent see. Metres, radians, its own world frame."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from runtime.world.poses import Floats

CYLINDER = 1.0
"""The `object_type` of cuboids that are cylinders."""

RIGHT = 1.0
"""The `triangle_type` of triangles with a right angle; else they are equilateral."""


@dataclass(frozen=True)
class Thing:
    """One object: its features by name."""

    name: str
    type: str
    features: Mapping[str, float]

    def __getitem__(self, feature: str) -> float:
        return self.features[feature]

    @property
    def position(self) -> tuple[float, float, float]:
        """Of its origin."""
        return self["pose_x"], self["pose_y"], self["pose_z"]

    @property
    def yaw(self) -> float:
        """Its heading; things start upright."""
        return 2 * math.atan2(self["pose_qz"], self["pose_qw"])

    @property
    def half(self) -> tuple[float, float, float]:
        """Half extents of a cuboid."""
        return self["half_extent_x"], self["half_extent_y"], self["half_extent_z"]

    @property
    def bottom(self) -> float:
        """The height of its bottom as it stands at the start, of a triangle that of its slab."""
        return self["pose_z"] - (self["depth"] / 2 if "depth" in self.features else self.half[2])

    @property
    def held(self) -> bool:
        """Whether it is grasped."""
        return self["grasp_active"] > 0.5


@dataclass(frozen=True, eq=False)
class Observation:
    """Base (x, y, heading), joints (7,) and fingers of the robot, whether it has grasped
    something, everything else by name, and whether the goal is reached. `limit` is the largest
    change of a coordinate in a step, known at the start of an episode."""

    base: Floats
    joints: Floats
    fingers: float
    grasping: bool
    things: Mapping[str, Thing]
    terminated: bool
    limit: float | None = None

    @classmethod
    def of(cls, answer: Mapping[str, Any]) -> Observation:
        """What an answer of the other process says."""
        things, robot = {}, None
        for name, told in answer["state"].items():
            features = {key: value for key, value in told.items() if key != "type"}
            if name == "robot":
                robot = features
            else:
                things[name] = Thing(name, told["type"], features)
        assert robot is not None, "every environment has one"
        return cls(
            np.array([robot["pos_base_x"], robot["pos_base_y"], robot["pos_base_rot"]]),
            np.array([robot[f"joint_{i}"] for i in range(1, 8)]),
            robot["finger_state"],
            robot["grasp_active"] > 0.5,
            things,
            answer["terminated"],
            answer.get("limit"),
        )

    def named(self, prefix: str) -> list[Thing]:
        """Everything whose name begins like that."""
        return [thing for name, thing in self.things.items() if name.startswith(prefix)]
