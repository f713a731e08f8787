"""Where a plan starts: where the robot stands, or the nearest place that it can drive off from.

Some episodes begin with the base inside a table's outline, or a few millimetres from a cube: our
planner keeps a distance from both, KinDER does not test the base at all.
"""

from __future__ import annotations

import math

import numpy as np

from domains.tabletop.scene.model import Scene
from domains.tabletop.world import fixed_rows
from runtime.motion.roads import Roads, Stand
from runtime.robot.model import RobotModel
from runtime.world.packed import upright_row
from runtime.world.poses import compose

STEP, FURTHEST = 0.02, 0.7
"""Metres between places that are tried, and the furthest of them."""

BEARINGS = (math.pi, 3 * math.pi / 4, -3 * math.pi / 4, math.pi / 2, -math.pi / 2, 0.0)
"""Directions that are tried at each distance, from the robot's heading: backwards first."""


def free_start(scene: Scene, robot: RobotModel) -> Stand:
    """The nearest place from which a robot can drive off with its heading kept; that of the scene
    where there is none."""
    roads = Roads.of(robot, robot.body(robot.gripper.max_opening), fixed_rows(scene.world))
    standing = [
        upright_row(part.solid, compose(thing.pose, part.pose))
        for thing in scene.world.movables
        for part in thing.body.parts
    ]
    roads = roads.among(np.array(standing).reshape(-1, 8), None)
    x, y, heading = scene.robot_start
    for away in np.arange(0.0, FURTHEST + STEP / 2, STEP).tolist():
        for bearing in BEARINGS if away else (0.0,):
            there = (
                x + away * math.cos(heading + bearing),
                y + away * math.sin(heading + bearing),
                heading,
            )
            if roads.can_leave(there):
                return there
    return scene.robot_start
