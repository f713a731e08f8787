"""A plan for MoveIt: the planning scene at its start, one trajectory a step, and what grasps and
releases change in the scene. Messages of `moveit_msgs`, as plain data."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from runtime.export.goals import joint_track, path_message, sliced
from runtime.export.messages import joint_trajectory, stamp
from runtime.export.shapes import lifted, mesh_dict, pose_dict, primitives
from runtime.export.steps import STILL, Step
from runtime.robot.model import Floats
from runtime.trace.kinematics import Tree, guided_at, links_at, object_at
from runtime.trace.model import WORLD, Trace
from runtime.trace.track import Track
from runtime.trace.write_world import rounded
from runtime.world.body import Body
from runtime.world.quaternions import pose_of

ADD, REMOVE = 0, 1
"""Operations of `moveit_msgs/msg/CollisionObject`."""

BASE_JOINT = "world_joint"
"""The virtual joint, planar, that puts the base into the scene's frame."""


def moveit(trace: Trace, steps: Sequence[Step], frame: str = "map") -> dict[str, Any]:
    """The planning scene at the start, and for each step its trajectory and the differences of
    the scene at its end."""
    return {
        "planning_scene": planning_scene(trace, frame),
        "steps": [
            {
                "step": step.number,
                "text": step.text,
                "trajectory": robot_trajectory(trace, step, frame),
                "scene_diffs": scene_diffs(trace, step, frame),
            }
            for step in steps
        ],
    }


def planning_scene(trace: Trace, frame: str, time: float = 0.0) -> dict[str, Any]:
    """`moveit_msgs/msg/PlanningScene` at a time: everything around the robot as collision
    objects, what it holds as attached ones, and its state."""
    links = links_at(trace, Tree(trace.robot), time)
    objects = [
        collision_object(thing.name, thing.body, guided_at(trace, thing.name, time), frame)
        for thing in trace.world.fixed
    ]
    held = []
    for index, thing in enumerate(trace.world.movables):
        if trace.held_at(index, time):
            held.append(_attached(trace, index, time))
            continue
        pose = object_at(trace, links, index, time)
        objects.append(collision_object(thing.name, thing.body, pose, frame))
    return {
        "name": trace.world.name,
        "robot_state": {**robot_state(trace, time, frame), "attached_collision_objects": held},
        "robot_model_name": trace.robot.name,
        "world": {"collision_objects": objects},
        "is_diff": False,
    }


def robot_state(trace: Trace, time: float, frame: str) -> dict[str, Any]:
    """`moveit_msgs/msg/RobotState`: all joints that can move, and the base."""
    names = moving_joints(trace)
    now = np.array([time])
    values = [float(joint_track(trace, name).at(now)[0][0, 0]) for name in names]
    header = {"stamp": stamp(time), "frame_id": frame}
    return {
        "joint_state": {
            "header": header,
            "name": list(names),
            "position": rounded(np.array(values)),
        },
        "multi_dof_joint_state": {
            "header": header,
            "joint_names": [BASE_JOINT],
            "transforms": [_transform(_base_pose(trace, time))],
        },
        "is_diff": False,
    }


def moving_joints(trace: Trace) -> tuple[str, ...]:
    """The joints of arm and lift, the fingers, and those that are held at a value."""
    robot = trace.robot
    held = [name for name in robot.fixed if name not in (*robot.joints, *robot.fingers)]
    return (*robot.joints, *robot.fingers, *held)


def robot_trajectory(trace: Trace, step: Step, frame: str) -> dict[str, Any]:
    """`moveit_msgs/msg/RobotTrajectory` of a step: the joints that some controller moves in it,
    and the base where that drives."""
    parts = [goal for goal in step.goals if not goal.controller.moves_base]
    names = tuple(name for goal in parts for name in goal.controller.joints)
    found: dict[str, Any] = {"joint_trajectory": {}, "multi_dof_joint_trajectory": {}}
    if parts:
        times = np.unique(np.concatenate([goal.motion.times for goal in parts]))
        both = [goal.motion.at(times) for goal in parts]
        track = Track(times, np.hstack([p for p, _ in both]), np.hstack([v for _, v in both]))
        track.velocities[[0, -1]] = 0.0
        found["joint_trajectory"] = joint_trajectory(names, track)
    if any(goal.controller.moves_base for goal in step.goals):
        path = path_message(sliced(trace.base, step.start, step.end), frame)
        found["multi_dof_joint_trajectory"] = {
            "header": path["header"],
            "joint_names": [BASE_JOINT],
            "points": [
                {
                    "transforms": [
                        {
                            "translation": each["pose"]["position"],
                            "rotation": each["pose"]["orientation"],
                        }
                    ],
                    "time_from_start": each["header"]["stamp"],
                }
                for each in path["poses"]
            ],
        }
    return found


def scene_diffs(trace: Trace, step: Step, frame: str) -> list[dict[str, Any]]:
    """What is different in the scene at the end of a step, as planning scenes that are
    differences: what is gripped leaves the world and hangs on a link, with all that stands on
    it; what is let go comes back."""
    changed: list[dict[str, Any]] = []
    for index, thing in enumerate(trace.world.movables):
        before, after = (trace.span(index, time) for time in (step.start + STILL, step.end))
        if before.frame == after.frame:
            continue
        if after.frame != WORLD:
            attached = _attached(trace, index, step.end)
            objects = [{"id": thing.name, "operation": REMOVE}]
        else:
            attached = {
                "link_name": before.frame,
                "object": {"id": thing.name, "operation": REMOVE},
            }
            links = links_at(trace, Tree(trace.robot), step.end)
            pose = object_at(trace, links, index, step.end)
            objects = [collision_object(thing.name, thing.body, pose, frame)]
        changed.append(
            {
                "robot_state": {"attached_collision_objects": [attached], "is_diff": True},
                "world": {"collision_objects": objects},
                "is_diff": True,
            }
        )
    return changed


def _attached(trace: Trace, index: int, time: float) -> dict[str, Any]:
    """`moveit_msgs/msg/AttachedCollisionObject`: it may touch the gripper."""
    thing, span = trace.world.movables[index], trace.span(index, time)
    pose = span.at(time)
    return {
        "link_name": span.frame,
        "object": _object(thing.name, thing.body, pose_dict(pose), span.frame),
        "touch_links": list(trace.robot.gripper_links),
        "weight": round(thing.body.mass, 6),
    }


def collision_object(name: str, body: Body, pose: Floats, frame: str) -> dict[str, Any]:
    """`moveit_msgs/msg/CollisionObject` of a body at a pose (4, 4)."""
    return _object(name, body, pose_dict(pose_of(pose)), frame)


def _object(name: str, body: Body, pose: dict[str, Any], frame: str) -> dict[str, Any]:
    simple = list(_primitives(body))
    hulls = [part for part in body.parts if not primitives(part.solid)]
    return {
        "header": {"frame_id": frame},
        "pose": pose,
        "id": name,
        "primitives": [shape for shape, _ in simple],
        "primitive_poses": [where for _, where in simple],
        "meshes": [mesh_dict(part.solid) for part in hulls],
        "mesh_poses": [pose_dict(pose_of(part.pose)) for part in hulls],
        "operation": ADD,
    }


def _primitives(body: Body) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    for part in body.parts:
        for kind, dimensions, height in primitives(part.solid):
            shape = {"type": kind, "dimensions": rounded(np.array(dimensions))}
            yield shape, pose_dict(lifted(part.pose, height))


def _base_pose(trace: Trace, time: float) -> dict[str, Any]:
    x, y, heading = trace.base.at(np.array([time]))[0][0].tolist()
    turn = [0.0, 0.0, np.sin(heading / 2), np.cos(heading / 2)]
    return pose_dict(np.array([x, y, 0.0, *turn]))


def _transform(pose: dict[str, Any]) -> dict[str, Any]:
    return {"translation": pose["position"], "rotation": pose["orientation"]}
