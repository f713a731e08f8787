"""From a plan, its scene, its robot and its sketch to a trace."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from domains.tabletop.scene.model import Scene
from runtime.angles import wrap
from runtime.motion.motion import ArmMove, BaseMove, GripperMove
from runtime.motion.timing import FINGER_RAMP
from runtime.plan.model import Plan, PlanAction, TimedPiece
from runtime.robot.model import Floats, RobotModel
from runtime.trace.kinematics import Tree
from runtime.trace.model import (
    WORLD,
    Grip,
    Span,
    Trace,
    TraceAction,
    TraceRobot,
    TraceSketch,
    TraceSubgoal,
)
from runtime.trace.track import TrackBuilder
from runtime.world.quaternions import matrix, pose_of
from sketchlang.errors import InputError

JOIN = 1e-3
"""Radians or metres by which a piece may start away from where the one before it ended."""


@dataclass(frozen=True, eq=False)
class Start:
    """Where a plan starts that does not start where its scene does: the base's pose is the
    plan's; poses (7,) of the objects' bottoms in the world; of a held one, its pose (7,) in
    the tool frame, and the opening of the gripper."""

    objects: tuple[Floats, ...]
    held: int | None
    in_tool: Floats | None
    opening: float


def trace_of_plan(
    plan: Plan,
    scene: Scene,
    robot: RobotModel,
    sketch: TraceSketch,
    start: Start | None = None,
) -> Trace:
    """The trace of a plan.

    Raises:
        InputError: the plan is of another scene, robot or sketch, or does not hang together.
    """
    _check(plan, scene, robot, sketch)
    if start is None and not np.allclose(plan.base_start, scene.robot_start, atol=1e-4):
        raise InputError(
            "the plan does not start where the robot stands in the scene",
            place=f"{plan.path}: base_start",
        )
    return _Maker(plan, scene, trace_robot(robot), robot, sketch, start).make()


def trace_robot(robot: RobotModel) -> TraceRobot:
    """The part of a robot that traces keep."""
    return TraceRobot(
        name=robot.name,
        digest=robot.digest,
        urdf=robot.urdf,
        joints=robot.joints,
        fingers=robot.gripper.joints,
        fixed=dict(robot.fixed),
        home=robot.home,
        tool=robot.urdf_tool,
        gripper_links=tuple(sorted(robot.gripper.links)),
        max_opening=robot.gripper.max_opening,
        openings=robot.gripper.openings,
        finger_table=robot.gripper.values,
    )


def start_pose(scene: Scene, index: int) -> Floats:
    """Where an object's bottom is at the start (7,)."""
    thing = scene.objects[index]
    x, y, yaw = thing.start
    rest = scene.surfaces[thing.surface].rest
    return np.array([x, y, rest, 0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)])


def _check(plan: Plan, scene: Scene, robot: RobotModel, sketch: TraceSketch) -> None:
    if plan.scene_digest != scene.digest:
        raise InputError(
            f"the plan was made for another version of the scene {scene.name}",
            place=f"{plan.path}: scene.digest",
            hint="plan the scene again, or name its file with --scene",
        )
    if plan.robot_digest != robot.digest:
        raise InputError(
            f"the plan was made for another version of the robot {robot.name}",
            place=f"{plan.path}: robot.digest",
            hint="plan the scene again, or name the robot's file with --robot",
        )
    if plan.objects != tuple(thing.name for thing in scene.objects):
        raise InputError("these are not the objects of the scene", place=f"{plan.path}: objects")
    rules = {rule.name for rule in sketch.rules} | {"goal"}
    features = [name for name, _ in sketch.features]
    for number, subgoal in enumerate(plan.subgoals):
        for key, values in (("before", subgoal.before), ("after", subgoal.after)):
            missing = [name for name in features if name not in values]
            if missing:
                raise InputError(
                    f"there is no value of the feature {missing[0]!r}",
                    place=f"{plan.path}: subgoals[{number}].{key}",
                )
        if subgoal.rule not in rules:
            raise InputError(
                f"the sketch {sketch.name} has no rule {subgoal.rule!r}",
                place=f"{plan.path}: subgoals[{number}].rule",
                hint="name the sketch that the plan was made with: --sketch FILE",
            )


class _Maker:
    def __init__(
        self,
        plan: Plan,
        scene: Scene,
        robot: TraceRobot,
        model: RobotModel,
        sketch: TraceSketch,
        start: Start | None,
    ) -> None:
        self.plan, self.scene, self.robot, self.sketch = plan, scene, robot, sketch
        self.model = model
        self.tree = Tree(robot)
        self.now = 0.0
        self.base = TrackBuilder(np.array(plan.base_start))
        self.joints = TrackBuilder(robot.home)
        self.opening = TrackBuilder(np.array([robot.max_opening]))
        self.grips: list[Grip] = []
        self.held: int | None = None
        self.objects = [
            [_still(0.0, WORLD, start_pose(scene, index))] for index in range(len(scene.objects))
        ]
        if start is not None:
            self.objects = [[_still(0.0, WORLD, pose)] for pose in start.objects]
            self.opening = TrackBuilder(np.array([start.opening]))
            if start.held is not None and start.in_tool is not None:
                self.held = start.held
                self.objects[start.held].append(_still(0.0, robot.tool, start.in_tool))

    def make(self) -> Trace:
        actions: list[TraceAction] = []
        for number, action in enumerate(self.plan.actions):
            start = self.now
            for i, timed in enumerate(action.pieces):
                self._piece(timed, f"actions[{number}].pieces[{i}]")
            actions.append(
                TraceAction(action.name, action.subgoal, *_handled(action), start, self.now)
            )
        return Trace(
            source="plan",
            tool_version=self.plan.tool_version,
            sketch=self.sketch,
            scene=self.scene,
            robot=self.robot,
            planner=self.plan.planner,
            seed=self.plan.seed,
            duration=self.now,
            subgoals=self._subgoals(actions),
            actions=tuple(actions),
            base=self.base.track(),
            joints=self.joints.track(),
            opening=self.opening.track(),
            grips=tuple(self.grips),
            objects=tuple(map(tuple, self.objects)),
        )

    def _subgoals(self, actions: list[TraceAction]) -> tuple[TraceSubgoal, ...]:
        found = []
        time = 0.0
        for number, subgoal in enumerate(self.plan.subgoals):
            own = [action for action in actions if action.subgoal == number]
            if len(own) != subgoal.actions:
                raise self._fail(
                    f"subgoals[{number}].actions",
                    f"the subgoal has {subgoal.actions} actions, {len(own)} are there",
                )
            start, time = time, own[-1].end if own else time
            found.append(
                TraceSubgoal(
                    subgoal.rule,
                    start,
                    time,
                    dict(subgoal.before),
                    dict(subgoal.after),
                    subgoal.expanded,
                    subgoal.generated,
                    subgoal.attempt,
                    subgoal.width,
                    dict(subgoal.rejected),
                )
            )
        return tuple(found)

    def _fail(self, where: str, message: str) -> InputError:
        return InputError(
            message, place=f"{self.plan.path}: {where}", hint="`sketchlang validate` says more"
        )

    def _piece(self, timed: TimedPiece, where: str) -> None:
        marks = self.now + timed.times
        match timed.piece:
            case BaseMove(poses, _):
                self._drive(poses, marks, where)
            case ArmMove(path, _, _):
                self._reach(path, marks, where)
            case GripperMove() as piece:
                opening = np.array([piece.opening])
                self.opening.line(float(marks[0]), float(marks[-1]), opening, FINGER_RAMP)
                start, self.now = self.now, float(marks[-1])
                self._grip(piece, start, where)
        self.now = float(marks[-1])

    def _join(self, jump: Floats, where: str) -> None:
        if jump.max() > JOIN:
            raise self._fail(where, f"starts {jump.max():.4f} (m or rad) from where the robot is")

    def _drive(self, poses: Floats, marks: Floats, where: str) -> None:
        off = poses[0] - self.base.value
        self._join(np.abs([off[0], off[1], wrap(off[2])]), where)
        # Headings are not wrapped within a piece; from piece to piece they may be.
        turns = round(-off[2] / (2 * math.pi))
        poses = poses + np.array([0.0, 0.0, 2 * math.pi * turns])
        for i in range(1, len(poses)):
            ramp = self._base_ramp(poses[i - 1], poses[i])
            self.base.line(float(marks[i - 1]), float(marks[i]), poses[i], ramp)

    def _base_ramp(self, a: Floats, b: Floats) -> float:
        base = self.model.base
        distance, turn = math.hypot(b[0] - a[0], b[1] - a[1]), abs(b[2] - a[2])
        if distance > turn:
            return _ramp(distance, base.velocity, base.acceleration)
        return _ramp(turn, base.angular_velocity, base.angular_acceleration)

    def _reach(self, path: Floats, marks: Floats, where: str) -> None:
        if path.shape[1] != len(self.robot.joints):
            raise self._fail(
                f"{where}.path",
                f"{path.shape[1]} joint values for {len(self.robot.joints)} joints",
            )
        self._join(np.abs(path[0] - self.joints.value), where)
        self.joints.through(path, marks)

    def _grip(self, piece: GripperMove, start: float, where: str) -> None:
        if piece.attach is None and piece.release is None:
            return
        links = self.tree.links(self.base.value, self.joints.value, float(self.opening.value[0]))
        tool = links[self.robot.tool]
        names = self.plan.objects
        if piece.attach is not None:
            name = piece.attach.body
            if self.held is not None:
                raise self._fail(where, f"{name} is gripped while another object is held")
            self.held = names.index(name)
            world = matrix(self.objects[self.held][-1].poses[0])
            in_tool = pose_of(np.linalg.inv(tool) @ world)
            self.objects[self.held].append(_still(self.now, self.robot.tool, in_tool))
        else:
            assert piece.release is not None
            name = piece.release.body
            if self.held is None or names[self.held] != name:
                raise self._fail(where, f"{name} is released but not held")
            in_tool = matrix(self.objects[self.held][-1].poses[0])
            self.objects[self.held].append(_still(self.now, WORLD, pose_of(tool @ in_tool)))
            self.held = None
        self.grips.append(Grip(start, self.now, name, piece.attach is not None))


def _handled(
    action: PlanAction,
) -> tuple[str | None, tuple[float, float, float, float] | None]:
    """The body that an action grips or lets go, and where it is put."""
    thing = placement = None
    for timed in action.pieces:
        piece = timed.piece
        if isinstance(piece, GripperMove) and piece.attach is not None:
            thing = piece.attach.body
        if isinstance(piece, GripperMove) and piece.release is not None:
            thing = piece.release.body
            x, y, z = piece.release.pose[:3].tolist()
            turn = matrix(piece.release.pose)
            placement = (x, y, z, math.atan2(turn[1, 0], turn[0, 0]))
    return thing, placement


def _still(start: float, frame: str, pose: Floats) -> Span:
    return Span(start, frame, np.array([start]), pose[None])


def _ramp(distance: float, velocity: float, acceleration: float) -> float:
    """Share of the time from rest to rest that speeding up takes (`runtime.motion.timing`)."""
    if distance * acceleration <= velocity * velocity:
        return 0.5
    up = velocity / acceleration
    return up / (distance / velocity + up)
