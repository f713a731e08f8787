"""Sense, plan one subgoal, carry it out, and again: a sketch as a policy.

A sketch is a function of the state, so planning can start from wherever the world is: nothing
is repaired, the next subplan is just that of the state that was sensed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from domains.tabletop.actions.actions import Pick
from domains.tabletop.loop.beliefs import Beliefs
from domains.tabletop.loop.disturb import Disturber
from domains.tabletop.loop.sensing import LOOKS, LostError, Seen, Senses, state_of
from domains.tabletop.loop.subplan import next_subgoal, plan_of
from domains.tabletop.loop.watch import Watcher
from domains.tabletop.loop.ways import Ways
from domains.tabletop.problem import TabletopProblem
from domains.tabletop.scene.model import Obstacle, Scene, UprightBox
from domains.tabletop.state import Grasp
from domains.tabletop.world import TabletopWorld
from runtime.physics.execute import SETTLE, lacking, real_slips
from runtime.physics.follow import CHECK, Follower, Slip, Touch
from runtime.physics.recorder import Recorder
from runtime.physics.simulation import Physics
from runtime.robot.model import RobotModel
from runtime.search.guide import Guide
from runtime.search.limits import Limits
from runtime.trace.make import Start, trace_of_plan, trace_robot
from runtime.trace.model import Trace, TraceAction, TraceSketch
from runtime.world.quaternions import pose_of
from sketchlang.compile import CompiledSketch

PLANNING = 60.0
"""Seconds after which the search for one subgoal is given up."""

ROUNDS = 200
"""Subplans after which an execution that does not come to an end is given up."""

RESTED = 0.001
"""Metres that an object may move between two looks and count as at rest."""

PATIENCE = 3.0
"""Seconds after which a robot that waits for objects to come to rest goes on."""


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
        self.physics = Physics(scene.world, trace_robot(robot), gui)
        self.recorder = Recorder(self.physics)
        self.follower = Follower(self.physics, self.recorder, robot.acceleration)
        self.disturber = Disturber(disturbance, seed, self.follower)
        self.follower.grasp_fails = self.disturber.grasp_fails
        self.follower.meanwhile = self.disturber.go_on
        self.senses = Senses(self.physics, self.disturber)
        self.rng = np.random.default_rng(seed)
        self.beliefs = Beliefs(scene.world, self.disturber.noise)
        self.grasp: Grasp | None = None
        self.broken_off = 0
        self._know(TabletopWorld.of(scene, robot))

    def _know(self, world: TabletopWorld) -> None:
        """Take a world for what is there."""
        self.scene = world.scene
        self.problem = TabletopProblem(world, self.seed)
        self.guide = Guide(self.compiled)

    def run(self) -> tuple[Verdict, Trace | None]:
        """Execute until the goal, or until nothing more can be done; the verdict, and the
        trace of what happened (None where nothing did)."""
        try:
            self.problem.reporting.warm_up()
            self.follower.wait(SETTLE)
            like, reason = self._rounds()
            self.follower.wait(SETTLE)
            poses = [self.physics.object_pose(i) for i in range(len(self.physics.objects))]
            missing = lacking(self.scene.world, poses)
            if reason is None and missing:
                reason = f"the robot believes to be done, but {missing[0]}"
            verdict = Verdict(
                reason is None,
                reason,
                len(self.recorder.subgoals),
                self.broken_off,
                self.physics.time,
                tuple(real_slips(self.follower.slips)),
                tuple(self.follower.touches),
            )
            self.recorder.event("verdict", reason or "goal reached")
            if like is None:
                return verdict, None
            return verdict, self.recorder.trace(replace(like, world=self.scene.world))
        finally:
            self.physics.close()

    def _rounds(self) -> tuple[Trace | None, str | None]:
        like: Trace | None = None
        for _ in range(ROUNDS):
            seen = self.senses.look(LOOKS)
            try:
                state = state_of(self.problem.world, self.beliefs.of(seen), self.grasp)
            except LostError as error:
                return like, str(error)
            values = self.guide.values(state)
            names = (feature.name for feature in self.guide.model.features)
            self.recorder.reached(dict(zip(names, values, strict=True)))
            if self.guide.is_goal(values, state):
                return like, None
            limits = Limits(timeout=PLANNING)
            subgoal = next_subgoal(self.guide, self.problem, state, limits, self.rng)
            if subgoal is None:
                return like, "no subgoal was found from what was sensed"
            picks = [action for action in subgoal.actions if isinstance(action, Pick)]
            grasp = picks[-1].grasp if picks else self.grasp
            plan = plan_of(self.problem, self.guide, state, subgoal)
            like = trace_of_plan(plan, self.scene.world, self.robot, self.text, self._start(seen))
            reason = self._carry_out(like, seen)
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

    def _carry_out(self, trace: Trace, seen: Seen) -> str | None:
        """Follow a subplan as long as the world is as it was when it was planned. A reason
        where the arm cannot even go home."""
        for number, action in enumerate(trace.actions):
            ways = None if action.name == "move_base" else self._ways()
            watcher = Watcher(trace, number, seen, self.scene, self.disturber, self.senses, ways)
            end = self.follower.follow(trace, watcher, action.start, action.end)
            surprise = watcher.surprise
            if self.follower.lost is not None:
                surprise = f"{self.follower.names[self.follower.lost]} is not in the gripper"
            if surprise is not None:
                if not self._come_home(trace, action, end):
                    return f"the arm finds no way home: {surprise}"
                self.broken_off += 1
                self.recorder.event("replan", surprise)
                self._wait_for_rest()
                break
            if action.object is not None:
                seen = self.senses.look()  # from now on the object is elsewhere, as planned
                index = self.follower.names.index(action.object)
                self.beliefs.expect(index, trace.span(index, action.end).at(action.end))
        self._look_around()
        return None

    def _come_home(self, trace: Trace, action: TraceAction, end: float) -> bool:
        """Bring the arm home from where an action stopped, once everything has come to rest;
        False where no way is free."""
        if self.follower.lost is not None:
            self._wait_for_rest()
        self.follower.let_fall()
        if action.name == "move_base" or end >= action.end:
            return True
        way = self._ways().home(trace, action.start, end)
        if way is None:
            return False
        opening, joints = way
        self.follower.move_fingers(opening)
        self.follower.move_arm(trace, joints)
        return True

    def _wait_for_rest(self) -> None:
        """Wait until objects are seen where they were a moment ago."""
        least = RESTED + 4 * self.disturber.noise / 3
        before = self.senses.look(LOOKS)
        for _ in range(round(PATIENCE / CHECK)):
            self.follower.wait(CHECK)
            now = self.senses.look(LOOKS)
            pairs = zip(before.objects, now.objects, strict=True)
            if all(np.linalg.norm(a[:3] - b[:3]) < least for a, b in pairs):
                return
            before = now

    def _ways(self) -> Ways:
        return Ways(self.robot, self.scene, self.senses, self.seed)

    def _look_around(self) -> None:
        """Add obstacles that came into view to what is known."""
        known = {obstacle.name for obstacle in self.scene.obstacles}
        new = tuple(
            Obstacle(name, UprightBox((x, y, size[2] / 2), size))
            for name, size, x, y in self.disturber.obstacles
            if name not in known
        )
        if new:
            world = self.problem.world
            self._know(TabletopWorld.of(self.scene.with_boxes(new), self.robot, world))
