"""Whether an arm on a fixed base can stand where a scene puts it."""

from __future__ import annotations

import numpy as np

from domains.tabletop.scene.model import Scene
from runtime.kernels.arm import body_collides
from runtime.kernels.convex import boxes_only
from runtime.robot.model import BOLTED, RobotModel
from runtime.world.packed import upright_row
from runtime.world.poses import compose, upright


def sunk_into(scene: Scene, robot: RobotModel) -> list[str]:
    """The fixed things that the foot of a fixed robot is in, deeper than what it is bolted to
    explains: the planner never looks at the foot, which does not move."""
    x, y, heading = scene.robot_start
    start = upright(x, y, BOLTED, heading)
    body = robot.body(robot.gripper.max_opening)
    foot = np.flatnonzero(body.frame == 0)
    body = body._replace(
        frame=body.frame[foot],
        pose=body.pose[foot],
        half=body.half[foot],
        radius=body.radius[foot],
        shape=body.shape[foot],
    )
    placed = np.array([compose(start, pose) for pose in body.pose]).reshape(-1, 3, 4)
    found = []
    for thing in scene.world.fixed:
        rows = [upright_row(p.solid, compose(thing.pose, p.pose)) for p in thing.body.parts]
        if body_collides(body, placed, boxes_only(np.array(rows)), 0.0):
            found.append(thing.name)
    return found
