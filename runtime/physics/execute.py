"""Execute a trace as it is, open loop, and judge where everything ended."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from runtime.judge.goals import unmet
from runtime.physics.follow import Follower, Slip, Touch
from runtime.physics.materials import Materials
from runtime.physics.recorder import Recorder
from runtime.physics.settling import drop
from runtime.physics.simulation import Physics
from runtime.physics.tracking import Tracking
from runtime.robot.model import Floats
from runtime.trace.kinematics import Tree, links_at, object_at
from runtime.trace.model import Trace
from runtime.world.quaternions import matrix
from runtime.world.world import World

SETTLE = 1.0
"""Seconds that objects are given to come to rest, before and after."""

NEAR = 0.01
"""Metres within which an object has ended where the plan has it."""

UPRIGHT = math.radians(10.0)
"""Lean beyond which an object counts as fallen."""

SETTLED = 0.02
"""Metres by which the bottom of an object may miss its height and still be on a support."""

LOOSE = 0.005
"""Metres in the gripper beyond which an object has slipped."""


@dataclass(frozen=True)
class FinalPose:
    """Where an object ended: `error` (m), `turn` about the vertical and `lean` (rad), all from
    the plan."""

    object: str
    error: float
    turn: float
    lean: float

    @property
    def near(self) -> bool:
        """Whether it stands where the plan has it."""
        return self.error <= NEAR and self.lean <= UPRIGHT


@dataclass(frozen=True)
class Report:
    """What came of an execution. `unmet` is what the goal still lacks."""

    duration: float
    tracking: Tracking
    slips: tuple[Slip, ...]
    touches: tuple[Touch, ...]
    objects: tuple[FinalPose, ...]
    unmet: tuple[str, ...]

    @property
    def goal_reached(self) -> bool:
        """Whether the scene's goals hold."""
        return not self.unmet

    @property
    def success(self) -> bool:
        """Goal reached, and every object where the plan has it."""
        return self.goal_reached and all(pose.near for pose in self.objects)


def execute(
    trace: Trace, gui: bool = False, materials: Materials | None = None
) -> tuple[Report, Trace]:
    """Execute a trace under physics; the report, and the trace of what happened.

    Raises:
        InputError: PyBullet is not installed.
    """
    physics = Physics(trace.world, trace.robot, gui, materials)
    try:
        recorder = Recorder(physics)
        follower = Follower(physics, recorder)
        follower.wait(SETTLE)
        follower.follow(trace)
        follower.wait(SETTLE)
        report = _report(trace, physics, follower)
        return report, recorder.trace(trace)
    finally:
        physics.close()


def _report(trace: Trace, physics: Physics, follower: Follower) -> Report:
    poses = [physics.object_pose(index) for index in range(len(physics.objects))]
    links = links_at(trace, Tree(trace.robot), trace.duration)
    carried = {index for index in range(len(poses)) if trace.held_at(index, trace.duration)}
    stand = {
        index: object_at(trace, links, index, trace.duration)
        for index in range(len(poses))
        if index not in carried
    }
    sinks = [drop(trace.world, stand, i) if i in stand else 0.0 for i in range(len(poses))]
    finals = []
    for index, pose in enumerate(poses):
        planned = object_at(trace, links, index, trace.duration)
        finals.append(_final(trace.world.movables[index].name, planned, sinks[index], pose))
    slips = real_slips(follower.slips)
    held = [] if physics.held is None else [trace.world.movables[physics.held].name]
    return Report(
        duration=physics.time,
        tracking=follower.tracking,
        slips=tuple(slips),
        touches=tuple(follower.touches),
        objects=tuple(finals),
        unmet=tuple(lacking(trace.world, poses, held)),
    )


def _final(name: str, planned: Floats, sink: float, pose: Floats) -> FinalPose:
    """Where an object ended that was planned to be at a pose (4, 4), and sinks from there."""
    is_at = matrix(pose)
    target = planned[:3, 3] - [0.0, 0.0, sink]
    turn = is_at[:3, :3] @ planned[:3, :3].T
    # How far from upright in the plan: things may lie or lean.
    return FinalPose(
        name,
        float(np.linalg.norm(pose[:3] - target)),
        abs(math.atan2(turn[1, 0], turn[0, 0])),
        lean(turn),
    )


def lean(pose: Floats) -> float:
    """Radians between the z axis of a pose (4, 4) and the vertical."""
    return math.acos(max(-1.0, min(1.0, float(pose[2, 2]))))


def real_slips(slips: Sequence[Slip]) -> list[Slip]:
    """Slips without objects that were carried and moved in the gripper by next to nothing."""
    return [slip for slip in slips if slip.what != "carried" or slip.moved > LOOSE]


def lacking(world: World, poses: list[Floats], held: Collection[str] = ()) -> list[str]:
    """What the goals of a world lack with bodies at world poses (7,), and some held."""
    standing = {
        i: matrix(pose) for i, pose in enumerate(poses) if world.movables[i].name not in held
    }
    return unmet(world, standing, held, rest=SETTLED)


def to_json(report: Report, trace: Trace) -> dict[str, Any]:
    """The report as plain data; lengths in metres, angles in radians, seconds."""
    names = ["base_x", "base_y", "base_heading", *trace.robot.joints]
    tracking = report.tracking
    return {
        "scene": trace.world.name,
        "seed": trace.seed,
        "success": report.success,
        "goal_reached": report.goal_reached,
        "unmet": list(report.unmet),
        "duration_s": round(report.duration, 3),
        "tracking": {
            name: {"rms": round(float(rms), 6), "max": round(float(top), 6)}
            for name, rms, top in zip(names, tracking.rms, tracking.largest, strict=True)
        },
        "slips": [
            {
                "time": round(s.time, 3),
                "object": s.object,
                "what": s.what,
                "moved": round(s.moved, 5),
            }
            for s in report.slips
        ],
        "touches": [
            {"time": round(t.time, 3), "link": t.link, "thing": t.thing} for t in report.touches
        ],
        "objects": [
            {
                "object": pose.object,
                "error_m": round(pose.error, 5),
                "turn_rad": round(pose.turn, 5),
                "lean_rad": round(pose.lean, 5),
            }
            for pose in report.objects
        ],
    }
