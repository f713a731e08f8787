"""What goes wrong in a closed-loop execution: by kind, and drawn from a seed.

Disturbances act on the simulation only; what the robot learns of them, it learns by sensing.
"""

from __future__ import annotations

import math

import numpy as np

from domains.tabletop.scene.model import Scene
from runtime.physics.follow import Follower
from runtime.trace.model import Trace

KINDS = ("none", "pushed", "failed-grasp", "dropped", "obstacle", "noise")

PUSHES = 3
FAILED_GRASPS = 2
DROPS = 1

PUSHED = (0.03, 0.08)
"""Metres that an object is pushed."""

PUSH_STEP = 0.01
"""Metres of a push at a time, ten times a second."""

ROOM = 0.09
"""Metres between the middles of a pushed object and any other, and to the table's edge."""

OBSTACLE = (0.25, 0.25, 0.6)
AHEAD = 1.3
"""Metres at which an obstacle appears: the robot needs 0.6 m to stop."""

CLEAR_END = 0.8
"""Metres that an obstacle keeps from the end of a drive, and from tables."""

NOISE = 0.003
"""Standard deviation, in metres, of one measured position; ten times that in radians."""


class Disturber:
    """Disturbs one execution."""

    def __init__(self, kind: str, seed: int, follower: Follower) -> None:
        self.kind, self.follower = kind, follower
        self.physics, self.recorder = follower.physics, follower.recorder
        self.rng = np.random.default_rng([seed, KINDS.index(kind)])
        self.obstacles: list[tuple[str, tuple[float, float, float], float, float]] = []
        counts = {"pushed": PUSHES, "failed-grasp": FAILED_GRASPS, "dropped": DROPS, "obstacle": 1}
        self.left = counts.get(kind, 0)
        self._drop_height = 0.0
        self._push: tuple[int, np.ndarray, float] | None = None
        self._tried: set[int] = set()

    @property
    def noise(self) -> float:
        """Standard deviation of a measured position, metres."""
        return NOISE if self.kind == "noise" else 0.0

    def grasp_fails(self) -> bool:
        """Whether the gripper does not close this time."""
        if self.kind != "failed-grasp" or not self.left or self.rng.random() > 0.5:
            return False
        self.left -= 1
        self.recorder.event("disturbance", "the gripper does not close")
        return True

    def act(self, scene: Scene, trace: Trace, number: int, time: float) -> None:
        """Disturb, perhaps, at a time of a trace, in its action of a number."""
        action = trace.actions[number]
        moving = bool(trace.base.at(np.array([time]))[1].any())
        driving = action.name == "move_base" and moving
        if self.kind == "pushed":
            self._pushes(scene, driving and self.physics.held is None)
        elif self.kind == "dropped" and action.name == "pick":
            self._drops()
        elif self.kind == "obstacle" and driving and self.left:
            self._blocks(scene, trace, action.end, time)

    # -- kinds ---------------------------------------------------------------------------------

    def _pushes(self, scene: Scene, may_start: bool) -> None:
        if self._push is not None or not (self.left and may_start) or self.rng.random() > 0.15:
            return
        poses = [self.physics.object_pose(i) for i in range(len(self.physics.objects))]
        index = int(self.rng.integers(len(poses)))
        bearing, way = self.rng.uniform(0, 2 * math.pi), self.rng.uniform(*PUSHED)
        direction = np.array([math.cos(bearing), math.sin(bearing), 0.0])
        goal = poses[index][:3] + way * direction
        others = [pose for i, pose in enumerate(poses) if i != index]
        clear = all(math.dist(goal[:2], other[:2]) > ROOM for other in others)
        if not clear or not any(s.contains(goal[0], goal[1], ROOM) for s in scene.surfaces):
            return
        self.left -= 1
        name = scene.objects[index].name
        self.recorder.event("disturbance", f"{name} is pushed by {1000 * way:.0f} mm")
        self._push = (index, direction, way)

    def go_on(self) -> None:
        """Go on with what has begun, ten times a second."""
        if self._push is None:
            return
        index, direction, way = self._push
        self.physics.shift(index, min(way, PUSH_STEP) * direction)
        self._push = (index, direction, way - PUSH_STEP) if way > PUSH_STEP else None

    def _drops(self) -> None:
        held = self.physics.held
        if held is None or not self.left:
            return
        if not self._drop_height:
            table = self.physics.object_pose(held)[2]
            self._drop_height = table + self.rng.uniform(0.005, 0.02)
        if self.physics.object_pose(held)[2] > self._drop_height:
            self.left -= 1
            name = self.physics.world.movables[held].name
            self.recorder.event("disturbance", f"{name} drops out of the gripper")
            self.follower.lose_grip()

    def _blocks(self, scene: Scene, trace: Trace, end: float, time: float) -> None:
        route = trace.base.at(np.arange(time, end, 0.05))[0][:, :2]
        if len(route) < 2:
            return
        gone = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(route, axis=0), axis=1))])
        for ahead in np.arange(AHEAD, gone[-1] - CLEAR_END, 0.1):
            x, y = route[int(np.searchsorted(gone, ahead))]
            near = np.hypot(*(route[0] - [x, y])) < AHEAD
            local = [s.table.local(x, y) for s in scene.surfaces]
            sizes = [s.table.size for s in scene.surfaces]
            gaps = [
                math.hypot(max(0.0, abs(lx) - a / 2), max(0.0, abs(ly) - b / 2))
                for (lx, ly), (a, b, _) in zip(local, sizes, strict=True)
            ]
            if near or min(gaps) < CLEAR_END:
                continue
            name = f"obstacle{len(self.obstacles) + 1}"
            self.left -= 1
            self.obstacles.append((name, OBSTACLE, float(x), float(y)))
            self.physics.add_obstacle(name, OBSTACLE, float(x), float(y))
            self.recorder.event("disturbance", f"{name} appears at ({x:.2f}, {y:.2f})")
            return
