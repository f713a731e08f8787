"""X: from a ground action to a motion, in three steps, cheapest first (paper, X and N).

InArmWorkspace tests all candidates of a node at once; InverseKinematics finds a
collision-free reach; MotionPlan joins it to the home posture by RRT-Connect, and plans the
way of the base. A candidate that fails knows at which step.
"""

from __future__ import annotations

import zlib
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from domains.tabletop.actions.reach import Hand, Reach, ReachSolver, held_box, object_pose
from domains.tabletop.state import (
    UNIT,
    Action,
    BasePose,
    Grasp,
    MoveBase,
    Pick,
    Place,
    Placement,
    State,
)
from domains.tabletop.world import Task
from runtime.kernels.boxes import to_base_frame
from runtime.motion import rrt
from runtime.motion.arm_context import ArmContext
from runtime.motion.base import BaseRoads, drive, footprint
from runtime.motion.motion import ArmMove, Attach, BaseMove, GripperMove, Motion, Release
from runtime.robot.model import Body, Floats
from runtime.search.profile import Profile
from runtime.world.poses import invert, upright
from runtime.world.quaternions import pose_of

REACH = 1.3
"""Metres around the base axis within which boxes matter to the arm."""

REMEMBERED = 2000
"""Answers about manipulations that are kept."""

Answer = TypeVar("Answer", "Reach | None", "Motion | None")

Target = tuple[int, Placement, Grasp]
"""An object, where it stands or is to stand, and the grasp."""


@dataclass(frozen=True, eq=False)
class _Question:
    """All that a manipulation depends on: where the robot stands, what it reaches for, and the
    boxes around without and with that object, (w, 8) in the base frame."""

    base: BasePose
    target: Target
    others: Floats
    with_object: Floats

    @cached_property
    def key(self) -> object:
        """Equal for the same question; another one as soon as something in reach has moved."""
        return self.base, self.target, self.others.tobytes()


class Executor:
    """Executability of the actions of one task; counts and times every step."""

    def __init__(self, task: Task, seed: int, profile: Profile | None = None) -> None:
        self.task = task
        self.seed = seed
        self.profile = profile or Profile()
        self.solver = ReachSolver(task.robot)
        self._roads: dict[object, BaseRoads] = {}
        self._latest: tuple[State, Pick | Place, _Question] | None = None
        self._answers: OrderedDict[object, Reach | Motion | None] = OrderedDict()

    # -- step 1 --------------------------------------------------------------------------

    def in_arm_workspace(self, base: BasePose, targets: Sequence[Target]) -> list[Target]:
        """The targets that are within the arm's reach from a base pose."""
        if not targets:
            return []
        step = self.profile.in_arm_workspace
        with step.timed():
            workspace = self.task.robot.annulus
            x, y, yaw = base.pose
            c, s = np.cos(yaw), np.sin(yaw)
            cx, cy = workspace.centre
            shoulder = (x + c * cx - s * cy, y + s * cx + c * cy)
            pose = np.array([(p.x, p.y, p.yaw + g.angle) for _, p, g in targets]) * UNIT
            dx = pose[:, 0] - workspace.wrist_offset * np.cos(pose[:, 2]) - shoulder[0]
            dy = pose[:, 1] - workspace.wrist_offset * np.sin(pose[:, 2]) - shoulder[1]
            distance = np.hypot(dx, dy)
            inside = (distance >= workspace.inner) & (distance <= workspace.outer)
        step.record(int(inside.sum()), len(targets))
        return [target for target, ok in zip(targets, inside, strict=True) if ok]

    # -- step 2 --------------------------------------------------------------------------

    def inverse_kinematics(self, state: State, action: Pick | Place, seeds: int) -> Reach | None:
        """A collision-free reach for a pick or place action, or None."""
        step = self.profile.inverse_kinematics
        with step.timed():
            question = self._question(state, action)
            reach = self._known(
                ("reach", seeds, question.key), lambda: self._reach(question, seeds)
            )
        step.record(reach is not None)
        return reach

    def _question(self, state: State, action: Pick | Place) -> _Question:
        """Mostly that of the step before: the boxes around are gathered once for both steps."""
        if self._latest is None or self._latest[0] is not state or self._latest[1] is not action:
            self._latest = state, action, self._new_question(state, action)
        return self._latest[2]

    def _new_question(self, state: State, action: Pick | Place) -> _Question:
        task = self.task
        target = target_of(state, action)
        index, placement, _ = target
        x, y, yaw = state.base.pose
        others = to_base_frame(task.world_rows(state, without=index), x, y, yaw, REACH)
        row = task.object_row(index, placement)
        own = to_base_frame(row[None], x, y, yaw, np.inf)
        return _Question(state.base, target, others, np.vstack([others, own]))

    def _known(self, key: object, compute: Callable[[], Answer]) -> Answer:
        """The answer to a question that was asked before, or what `compute` gives."""
        if key in self._answers:
            self._answers.move_to_end(key)
        else:
            self._answers[key] = compute()
            if len(self._answers) > REMEMBERED:
                self._answers.popitem(last=False)
        return cast("Answer", self._answers[key])

    def _reach(self, question: _Question, seeds: int) -> Reach | None:
        task = self.task
        index, placement, grasp = question.target
        shape = task.shapes[index]
        hand = Hand.of(task.robot, shape, grasp)
        if hand is None:
            return None
        x, y, yaw = question.base.pose
        px, py, pyaw = placement.pose
        c, s = np.cos(yaw), np.sin(yaw)
        dx, dy = px - x, py - y
        rest = task.scene.surfaces[placement.surface].rest
        bottom = object_pose(c * dx + s * dy, c * dy - s * dx, pyaw - yaw, rest)
        rng = np.random.default_rng(self._seed(question.base, placement, grasp))
        return self.solver.solve(
            shape, hand, bottom, question.others, question.with_object, rng, seeds
        )

    def _seed(self, *parts: object) -> int:
        """A seed that depends on the question asked, not on what was asked before."""
        return zlib.crc32(repr((self.seed, parts)).encode())

    # -- step 3 --------------------------------------------------------------------------

    def motion_plan(self, state: State, action: Action, reach: Reach | None) -> Motion | None:
        """The complete motion of an action, or None."""
        step = self.profile.motion_plan
        with step.timed():
            if isinstance(action, MoveBase):
                motion = self._drive(state, action)
            else:
                assert reach is not None
                question, picks = self._question(state, action), isinstance(action, Pick)
                key = ("motion", picks, reach.approach[-1].tobytes(), question.key)
                motion = self._known(key, lambda: self._manipulate(question, reach, picks))
        step.record(motion is not None)
        return motion

    def _drive(self, state: State, action: MoveBase) -> Motion | None:
        start, goal = state.base.pose, action.target.pose
        route = self._roads_for(state).route(start[:2], goal[:2])
        if route is None:
            return None
        return (BaseMove(drive(route, start[2], goal[2])),)

    def _roads_for(self, state: State) -> BaseRoads:
        """Roads among everything that stands; those of the static scene where no standing
        object narrows them, which is the rule: tables keep the base further away."""
        key = (state.placements, state.grasp)
        if key not in self._roads:
            self._roads[key] = self._new_roads(state)
        return self._roads[key]

    def _new_roads(self, state: State) -> BaseRoads:
        task = self.task
        body = self._carried(state)
        rings = task.footprint if body is None else footprint(task.robot, body)
        rows = task.world_rows(state)
        clearance = rings.clearances(rows)
        fixed = len(task.statics)
        free = _dominated(rows[fixed:], clearance[fixed:], rows[:fixed], clearance[:fixed])
        narrow = fixed + np.flatnonzero((clearance[fixed:] > 0) & ~free)
        if not len(narrow) and np.array_equal(clearance[:fixed], task.clearance):
            return task.roads
        chosen = np.r_[np.arange(fixed), narrow]
        return BaseRoads(rows[chosen], clearance[chosen])

    def _carried(self, state: State) -> Body | None:
        """The robot's boxes with the object that it carries, or None where it carries none."""
        if state.held is None or state.grasp is None:
            return None
        shape = self.task.shapes[state.held]
        hand = Hand.of(self.task.robot, shape, state.grasp)
        assert hand is not None, "a held object fits the gripper"
        return self.task.robot.body(hand.closed, held_box(shape, hand.tool_in_object))

    def _manipulate(self, question: _Question, reach: Reach, picks: bool) -> Motion | None:
        robot = self.task.robot
        index, placement, grasp = question.target
        name = self.task.scene.objects[index].name
        surface = self.task.scene.surfaces[placement.surface]
        x, y, yaw = placement.pose
        stands = pose_of(upright(x, y, surface.rest, yaw))
        box = held_box(self.task.shapes[index], invert(reach.grasp))
        empty = ArmContext(robot, robot.body(reach.opening), question.with_object)
        full = ArmContext(robot, robot.body(reach.closed, box), question.others)
        seed = self._seed(question.base, placement, grasp, "motion")
        there = rrt.plan(empty, robot.home, reach.approach[0], seed)
        if there is None:
            return None
        back = rrt.plan(full, reach.retreat[-1], robot.home, seed + 1)
        if back is None:
            return None
        if picks:
            return (
                GripperMove(reach.opening),
                ArmMove(there, "free"),
                ArmMove(reach.approach, "approach"),
                GripperMove(reach.closed, Attach(name, robot.urdf_tool)),
                ArmMove(reach.lift, "lift"),
                ArmMove(reach.retreat, "retreat"),
                ArmMove(back, "free"),
            )
        return (
            ArmMove(back[::-1].copy(), "free"),
            ArmMove(reach.retreat[::-1].copy(), "approach"),
            ArmMove(reach.lift[::-1].copy(), "lower"),
            GripperMove(reach.opening, release=Release(name, surface.name, stands)),
            ArmMove(reach.approach[::-1].copy(), "retreat"),
            ArmMove(there[::-1].copy(), "free"),
        )


def target_of(state: State, action: Pick | Place) -> Target:
    """What a manipulation reaches for."""
    if isinstance(action, Pick):
        placement = state.placements[action.object]
        assert placement is not None, "only standing objects are picked"
        return action.object, placement, action.grasp
    assert state.grasp is not None, "only held objects are placed"
    return action.object, action.placement, state.grasp


def _dominated(
    rows: Floats, clearance: Floats, statics: Floats, static_clearance: Floats
) -> NDArray[np.bool_]:
    """For each box (n, 8): whether some static box keeps the base away from it anyway."""
    reach = np.hypot(rows[:, 3], rows[:, 4])[:, None]
    dx = rows[:, 0, None] - statics[:, 0]
    dy = rows[:, 1, None] - statics[:, 1]
    lx = np.abs(statics[:, 6] * dx + statics[:, 7] * dy) + reach
    ly = np.abs(statics[:, 6] * dy - statics[:, 7] * dx) + reach
    slack = np.minimum(statics[:, 3] - lx, statics[:, 4] - ly)
    dominated: NDArray[np.bool_] = np.any(
        (slack >= 0) & (clearance[:, None] <= static_clearance + slack), axis=1
    )
    return dominated
