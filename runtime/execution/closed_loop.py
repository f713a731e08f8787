"""Sense, plan one subgoal, carry it out, and again: a sketch as a policy.

A sketch is a function of the state, so planning can start from wherever the world is: nothing
is repaired, the next subplan is just that of the state that was sensed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from runtime.execution.disturb import Disturber
from runtime.execution.execute import SETTLE, lacking
from runtime.execution.follow import CHECK, Follower, Slip, Touch
from runtime.execution.physics import Physics
from runtime.execution.recorder import Recorder
from runtime.execution.sensing import LOOKS, LostError, Seen, Senses, state_of
from runtime.execution.subplan import next_subgoal, plan_of
from runtime.kernels.boxes import to_base_frame
from runtime.motion.arm_context import ArmContext
from runtime.pick_place.executability import REACH
from runtime.pick_place.problem import PickPlaceProblem
from runtime.pick_place.state import Grasp, Pick, State
from runtime.pick_place.task import Task
from runtime.robot.model import RobotModel
from runtime.scene.model import Obstacle, Scene, UprightBox
from runtime.search.guide import Guide
from runtime.search.limits import Limits
from runtime.trace.kinematics import pose_of
from runtime.trace.make import Start, trace_of_plan, trace_robot
from runtime.trace.model import Trace, TraceSketch
from sketchlang.compile import CompiledSketch

ROUNDS = 200
"""Subplans after which an execution that does not come to an end is given up."""

MOVED = 0.015
"""Metres from where it was planned with, beyond which an object counts as moved."""


@dataclass(frozen=True)
class Verdict:
    """How a closed-loop execution ended: `reason` says why where the goal was not reached."""

    goal_reached: bool
    reason: str | None
    subplans: int
    broken_off: int
    duration: float
    slips: tuple[Slip, ...]
    touches: tuple[Touch, ...]


class ClosedLoop:
    """One execution of a sketch in a scene."""

    def __init__(
        self,
        compiled: CompiledSketch,
        text: TraceSketch,
        scene: Scene,
        robot: RobotModel,
        seed: int,
        disturbance: str = "none",
        gui: bool = False,
    ) -> None:
        self.compiled, self.text, self.robot, self.seed = compiled, text, robot, seed
        self.physics = Physics(scene, trace_robot(robot), gui)
        self.recorder = Recorder(self.physics)
        self.follower = Follower(self.physics, self.recorder)
        self.disturber = Disturber(disturbance, seed, self.follower)
        self.follower.grasp_fails = self.disturber.grasp_fails
        self.senses = Senses(self.physics, self.disturber)
        self.rng = np.random.default_rng(seed)
        self.grasp: Grasp | None = None
        self.broken_off = 0
        self._know(scene)

    def _know(self, scene: Scene) -> None:
        """Take a scene for what is there."""
        self.scene = scene
        self.problem = PickPlaceProblem(Task(scene, self.robot), self.seed)
        self.guide = Guide(self.compiled, self.problem)

    def run(self) -> tuple[Verdict, Trace | None]:
        """Execute until the goal, or until nothing more can be done; the verdict, and the
        trace of what happened (None where nothing did)."""
        try:
            self.problem.warm_up()
            self.follower.wait(SETTLE)
            like, reason = self._rounds()
            self.follower.wait(SETTLE)
            poses = [self.physics.object_pose(i) for i in range(len(self.physics.objects))]
            missing = lacking(self.scene, poses)
            if reason is None and missing:
                reason = f"the robot believes to be done, but {missing[0]}"
            carried = [s for s in self.follower.slips if s.what != "carried"]
            verdict = Verdict(
                reason is None,
                reason,
                len(self.recorder.subgoals),
                self.broken_off,
                self.physics.time,
                tuple(carried),
                tuple(self.follower.touches),
            )
            self.recorder.event("verdict", reason or "goal reached")
            return verdict, None if like is None else self.recorder.trace(like)
        finally:
            self.physics.close()

    def _rounds(self) -> tuple[Trace | None, str | None]:
        like: Trace | None = None
        for _ in range(ROUNDS):
            seen = self.senses.look(LOOKS)
            try:
                state = state_of(self.problem.task, seen, self.grasp)
            except LostError as error:
                return like, str(error)
            if self.guide.is_goal(self.guide.values(state)):
                return like, None
            limits = Limits(timeout=60.0)
            subgoal = next_subgoal(self.guide, self.problem, state, limits, self.rng)
            if subgoal is None:
                return like, "no subgoal was found from what was sensed"
            picks = [action for action in subgoal.actions if isinstance(action, Pick)]
            grasp = picks[-1].grasp if picks else self.grasp
            plan = plan_of(self.problem, self.guide, state, subgoal)
            like = trace_of_plan(plan, self.scene, self.robot, self.text, self._start(seen))
            reason = self._carry_out(like, seen, state)
            self.grasp = grasp if self.physics.held is not None else None
            if reason is not None:
                return like, reason
        return like, f"not done after {ROUNDS} subplans"

    def _start(self, seen: Seen) -> Start:
        in_tool = None
        if seen.held is not None:
            tool = self.physics.tool_matrix()
            in_tool = pose_of(np.linalg.inv(tool) @ self.follower.held_pose())
        return Start(seen.objects, seen.held, in_tool, self.physics.opening())

    # -- one subplan ---------------------------------------------------------------------------

    def _carry_out(self, trace: Trace, seen: Seen, state: State) -> str | None:
        """Follow a subplan as long as the world is as it was when it was planned. A reason
        where the robot cannot even go home."""
        for number, action in enumerate(trace.actions):
            watcher = _Watcher(self, trace, number, seen)
            end = self.follower.follow(trace, watcher, action.start, action.end)
            if watcher.surprise is not None and watcher.back:
                if not watcher.way_is_free(action.start, end):
                    return f"the arm can go neither on nor back: {watcher.surprise}"
                self.follower.go_back(trace, action.start, end)
            if watcher.surprise is not None:
                self.broken_off += 1
                self.recorder.event("replan", watcher.surprise)
                break
            if action.name in {"pick", "place"}:
                seen = self.senses.look()  # from now on the object is elsewhere, as planned
        self._look_around()
        return None

    def _look_around(self) -> None:
        """Add obstacles that came into view to what is known."""
        known = {obstacle.name for obstacle in self.scene.obstacles}
        new = tuple(
            Obstacle(name, UprightBox((x, y, size[2] / 2), size))
            for name, size, x, y in self.disturber.obstacles
            if name not in known
        )
        if new:
            self._know(replace(self.scene, obstacles=self.scene.obstacles + new))


class _Watcher:
    """Looks at the world while an action is carried out."""

    def __init__(self, loop: ClosedLoop, trace: Trace, number: int, seen: Seen) -> None:
        self.loop, self.trace, self.number, self.seen = loop, trace, number, seen
        self.action = trace.actions[number]
        self.surprise: str | None = None
        self.back = False  # the arm must go back, as its way on is barred

    def __call__(self, time: float) -> str | None:
        loop = self.loop
        loop.disturber.act(loop.scene, self.trace, self.number, time)
        if self.surprise is None:
            self.surprise = self._surprise(time)
            if self.surprise is None:
                return None
        if self.action.name == "move_base":
            return self.surprise
        # The arm ends its action, and so comes home, unless something now is in its way.
        self.back = not self.way_is_free(time, self.action.end)
        return self.surprise if self.back else None

    def _surprise(self, time: float) -> str | None:
        loop, names = self.loop, [thing.name for thing in self.loop.scene.objects]
        known = {obstacle.name for obstacle in loop.scene.obstacles}
        for name, *_ in loop.disturber.obstacles:
            if name not in known:
                return f"{name} is in view"
        now = loop.senses.look(LOOKS)
        own = names.index(self.action.object) if self.action.object is not None else None
        span = None if own is None else self.trace.span(own, time)
        letting_go = any(g.start <= time <= g.time and not g.attach for g in self.trace.grips)
        if own is not None and span is not None and span.frame != "world" and not letting_go:
            closing = any(0 <= time - g.time <= CHECK for g in self.trace.grips)
            if now.held != own and not closing:
                return f"{names[own]} is not in the gripper"
        if self.seen.held is not None and now.held is None and own is None:
            return f"{names[self.seen.held]} is no longer in the gripper"
        for index, (before, after) in enumerate(zip(self.seen.objects, now.objects, strict=True)):
            if index in {own, now.held, self.seen.held}:
                continue
            if np.linalg.norm(before[:3] - after[:3]) > MOVED + 4 * loop.disturber.noise / 3:
                return f"{names[index]} has moved"
        return None

    def way_is_free(self, start: float, end: float) -> bool:
        """Whether the arm's way in a stretch of the trace touches nothing that stands, as it is
        seen now; with the fingers as they are."""
        loop = self.loop
        now = loop.senses.look(LOOKS)
        try:
            state = state_of(loop.problem.task, now, loop.grasp)
        except LostError:
            return True  # it lies under the arm, which goes up and home; the round after tells
        x, y, yaw = now.base
        rows = to_base_frame(loop.problem.task.world_rows(state), x, y, yaw, REACH)
        context = ArmContext(loop.robot, loop.robot.body(loop.physics.opening()), rows)
        path = self.trace.joints.at(np.arange(start, end, 0.05))[0]
        return not any(context.collides(q, 0.0) for q in path)
