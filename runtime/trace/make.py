"""From a plan, its scene, its robot and its sketch to a trace."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from runtime.angles import wrap
from runtime.judge.footing import above
from runtime.motion.motion import ArmMove, BaseMove, Carried, GripperMove, Together
from runtime.motion.timing import FINGER_RAMP
from runtime.plan.model import Plan, PlanAction, TimedPiece
from runtime.robot.model import Floats, RobotModel
from runtime.trace.kinematics import Tree
from runtime.trace.model import (
    WORLD,
    Event,
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
from runtime.world.world import World
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
    world: World,
    robot: RobotModel,
    sketch: TraceSketch,
    start: Start | None = None,
) -> Trace:
    """The trace of a plan.

    Raises:
        InputError: the plan is of another scene, robot or sketch, or does not hang together.
    """
    _check(plan, world, robot, sketch)
    off = np.array(plan.base_start) - np.array(world.robot_start)
    off[2] = wrap(float(off[2]))
    if start is None and np.abs(off).max() > 1e-4:
        raise InputError(
            "the plan does not start where the robot stands in the scene",
            place=f"{plan.path}: base_start",
        )
    return _Maker(plan, world, trace_robot(robot), robot, sketch, start).make()


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
        max_force=robot.gripper.max_force,
        controllers=robot.controllers,
    )


def _check(plan: Plan, world: World, robot: RobotModel, sketch: TraceSketch) -> None:
    if plan.scene_digest != world.digest:
        raise InputError(
            f"the plan was made for another version of the scene {world.name}",
            place=f"{plan.path}: scene.digest",
            hint="plan the scene again, or name its file with --scene",
        )
    if plan.robot_digest != robot.digest:
        raise InputError(
            f"the plan was made for another version of the robot {robot.name}",
            place=f"{plan.path}: robot.digest",
            hint="plan the scene again, or name the robot's file with --robot",
        )
    if plan.objects != tuple(thing.name for thing in world.movables):
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
        world: World,
        robot: TraceRobot,
        model: RobotModel,
        sketch: TraceSketch,
        start: Start | None,
    ) -> None:
        self.plan, self.world, self.robot, self.sketch = plan, world, robot, sketch
        self.model = model
        self.tree = Tree(robot)
        self.now = 0.0
        self.base = TrackBuilder(np.array(plan.base_start))
        self.joints = TrackBuilder(robot.home)
        self.opening = TrackBuilder(np.array([robot.max_opening]))
        self.moving: list[tuple[Floats, Floats]] = []  # times and rows since the last rest
        self.grips: list[Grip] = []
        self.held: int | None = None
        self.group: list[int] = []  # what is held, and what stands on it
        self.objects = [[_still(0.0, WORLD, pose_of(thing.pose))] for thing in world.movables]
        self.guided: dict[str, list[Span]] = {}
        if start is not None:
            self.objects = [[_still(0.0, WORLD, pose)] for pose in start.objects]
            self.opening = TrackBuilder(np.array([start.opening]))
            if start.held is not None and start.in_tool is not None:
                self.held, self.group = start.held, [start.held]
                self.objects[start.held].append(_still(0.0, robot.tool, start.in_tool))

    def make(self) -> Trace:
        actions: list[TraceAction] = []
        for number, action in enumerate(self.plan.actions):
            start = self.now
            for i, timed in enumerate(action.pieces):
                self._piece(timed, f"actions[{number}].pieces[{i}]")
            actions.append(
                TraceAction(
                    action.name,
                    action.text,
                    action.subgoal,
                    _handled(action),
                    start,
                    self.now,
                    action.values,
                )
            )
        self._come_to_rest()
        return Trace(
            source="plan",
            tool_version=self.plan.tool_version,
            sketch=self.sketch,
            world=self.world,
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
            guided={name: tuple(spans) for name, spans in self.guided.items()},
            events=self._failure(),
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

    def _failure(self) -> tuple[Event, ...]:
        """Of a partial plan: that it ends, why, and what else is known about it."""
        failure = self.plan.failure
        if failure is None:
            return ()
        others = [finding["text"] for finding in failure.why if finding["text"] != failure.reason]
        return (
            Event(self.now, "verdict", failure.reason),
            *(Event(self.now, "finding", text) for text in others),
        )

    def _fail(self, where: str, message: str) -> InputError:
        return InputError(
            message, place=f"{self.plan.path}: {where}", hint="`sketchlang validate` says more"
        )

    def _piece(self, timed: TimedPiece, where: str) -> None:
        marks = self.now + timed.times
        if not isinstance(timed.piece, Together):
            self._come_to_rest()
        match timed.piece:
            case Together(poses, path, openings):
                self._together(poses, path, openings, marks, where)
            case BaseMove(poses, along):
                self._drive(poses, marks, where)
                self._move_along(along, marks, where)
            case ArmMove(path, _, along):
                self._reach(path, marks, where)
                self._move_along(along, marks, where)
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

    def _together(
        self, poses: Floats, path: Floats, openings: Floats, marks: Floats, where: str
    ) -> None:
        """Base, arm and fingers at once; tracks are made when the robot comes to rest."""
        if path.shape[1] != len(self.robot.joints):
            raise self._fail(
                f"{where}.path",
                f"{path.shape[1]} joint values for {len(self.robot.joints)} joints",
            )
        rows = np.hstack([poses, path, openings[:, None]])
        if self.moving:
            last = self.moving[-1][1][-1]
        else:
            last = np.concatenate([self.base.value, self.joints.value, self.opening.value])
        off = rows[0] - last
        turns = round(-off[2] / (2 * math.pi))
        off[2] = wrap(off[2])
        self._join(np.abs(off), where)
        rows[:, 2] += 2 * math.pi * turns
        self.moving.append((marks, rows))

    def _come_to_rest(self) -> None:
        """What has been moved at once becomes tracks: one motion, whatever pieces it was in."""
        if not self.moving:
            return
        marks = np.concatenate([part[0] for part in self.moving])
        rows = np.vstack([part[1] for part in self.moving])
        self.moving = []
        keep = np.concatenate([[True], np.diff(marks) > 1e-9])
        marks, rows = marks[keep], rows[keep]
        self.base.through(rows[:, :3], marks)
        self.joints.through(rows[:, 3:-1], marks)
        self.opening.through(rows[:, -1:], marks)

    def _move_along(self, along: Sequence[Carried], marks: Floats, where: str) -> None:
        for carried in along:
            span = Span(float(marks[0]), WORLD, marks, carried.poses)
            if carried.body in self.plan.objects:
                self.objects[self.plan.objects.index(carried.body)].append(span)
                continue
            fixed = [thing for thing in self.world.fixed if thing.name == carried.body]
            if not fixed or fixed[0].guide is None:
                raise self._fail(f"{where}.along", f"{carried.body} cannot be moved along")
            first = _still(0.0, WORLD, pose_of(fixed[0].pose))
            self.guided.setdefault(carried.body, [first]).append(span)

    def _grip(self, piece: GripperMove, start: float, where: str) -> None:
        if piece.attach is None and piece.release is None:
            return
        links = self.tree.links(self.base.value, self.joints.value, float(self.opening.value[0]))
        if piece.attach is not None:
            name, link = piece.attach.body, piece.attach.to or self.robot.tool
            if link not in links:
                raise self._fail(f"{where}.attach.to", f"the robot has no link {link!r}")
            if self.held is not None:
                raise self._fail(where, f"{name} is gripped while another object is held")
            self.held = self.plan.objects.index(name)
            poses = self._standing()
            self.group = [self.held, *sorted(above(self.world, poses, [self.held]))]
            for index in self.group:
                local = pose_of(np.linalg.inv(links[link]) @ poses[index])
                self.objects[index].append(_still(self.now, link, local))
        else:
            assert piece.release is not None
            name = piece.release.body
            if self.held is None or self.plan.objects[self.held] != name:
                raise self._fail(where, f"{name} is released but not held")
            for index in self.group:
                span = self.objects[index][-1]
                world = pose_of(links[span.frame] @ matrix(span.poses[-1]))
                self.objects[index].append(_still(self.now, WORLD, world))
            self.held, self.group = None, []
        self.grips.append(Grip(start, self.now, name, piece.attach is not None))

    def _standing(self) -> dict[int, Floats]:
        """World poses (4, 4) of all bodies that no link carries."""
        last = {index: spans[-1] for index, spans in enumerate(self.objects)}
        return {i: matrix(span.poses[-1]) for i, span in last.items() if span.frame == WORLD}


def _handled(action: PlanAction) -> str | None:
    """The body that an action grips or lets go; the last one, where there are more."""
    thing = None
    for timed in action.pieces:
        if isinstance(timed.piece, GripperMove):
            change = timed.piece.release or timed.piece.attach
            thing = thing if change is None else change.body
    return thing


def _still(start: float, frame: str, pose: Floats) -> Span:
    return Span(start, frame, np.array([start]), pose[None])


def _ramp(distance: float, velocity: float, acceleration: float) -> float:
    """Share of the time from rest to rest that speeding up takes (`runtime.motion.timing`)."""
    if distance * acceleration <= velocity * velocity:
        return 0.5
    up = velocity / acceleration
    return up / (distance / velocity + up)
