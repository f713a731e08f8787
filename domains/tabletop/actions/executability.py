"""X: from a ground action to a motion, in three steps, cheapest first (paper, X and N).

InArmWorkspace tests all candidates of a node at once; InverseKinematics finds a
collision-free reach; MotionPlan joins it to the home posture by RRT-Connect, and plans the
way of the base. A candidate that fails knows at which step.
"""

from __future__ import annotations

import math
import zlib
from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from domains.tabletop.actions.arm import Arm
from domains.tabletop.actions.reach import Grip, Reach, ReachSolver, grip_of, grip_on, held_parts
from domains.tabletop.state import UNIT, BasePose, Grasp, Placement, State
from domains.tabletop.world import TabletopWorld
from runtime.kernels.convex import Obstacles, join, seen_from
from runtime.motion import level, rrt
from runtime.motion.arm_context import FLOOR, ArmContext
from runtime.motion.carry import carrying
from runtime.motion.motion import ArmMove, Attach, BaseMove, GripperMove, Motion, Release
from runtime.motion.roads import Roads
from runtime.robot.model import Body
from runtime.search.problem import Rejection
from runtime.search.profile import Profile
from runtime.world.body import Part
from runtime.world.poses import Floats, Pose, compose, heading, invert, upright
from runtime.world.quaternions import pose_of

REACH = 1.3
"""Metres around the base axis within which boxes matter to the arm."""

REMEMBERED = 2000
"""Answers about manipulations that are kept."""

PACE = 0.5
"""Share of the arm's speed that is used where something stands on what it carries."""

POSTURES = 24
"""Starting points of inverse kinematics where several postures are looked for."""

FURTHER = 3
"""Further postures at a grasp that are tried where the first has no simple way from home, ..."""

SEARCHED = 2
"""... and the postures for which a way is searched where none of them has."""

SEEDS, MAX_SEEDS = 12, 48
"""Starting points for inverse kinematics at a first attempt, and at most."""

CHECKS_A_SEED = 125
"""Configurations that a search for a way may test, for each seed more than at a first attempt: then
another candidate, with a simple way, is cheaper than a search."""

Answer = TypeVar("Answer", "Reach | None", "Motion | Rejection")

Target = tuple[int, Placement, Grasp]
"""An object, where it rests or is to rest, and the grasp."""


@dataclass(frozen=True, eq=False)
class Manipulation:
    """All that a manipulation depends on: where the robot stands, the target and the pose of
    its standing frame in the world, the grasp with which the object was or is taken, and the
    obstacles around without and with that object, in the base frame. `riders` are solids in the
    standing frame that go with it."""

    base: BasePose
    target: Target
    standing: Pose
    taken: Grasp
    others: Obstacles
    with_object: Obstacles
    riders: tuple[Part, ...] = ()

    @property
    def key(self) -> object:
        """Equal for the same question; another one as soon as something in reach has moved."""
        riders = tuple((part.solid, part.pose.tobytes()) for part in self.riders)
        return (
            self.base,
            self.target,
            self.taken,
            self.others.rows.tobytes(),
            self.others.pose.tobytes(),
            riders,
        )


def seeds_at(attempt: int) -> int:
    """Starting points for inverse kinematics: twice as many after each attempt that failed."""
    return min(MAX_SEEDS, SEEDS << attempt)


class Executor:
    """Executability of the actions of one task; counts and times every step."""

    def __init__(self, world: TabletopWorld, seed: int, profile: Profile | None = None) -> None:
        self.world = world
        self.seed = seed
        self.profile = profile or Profile()
        self.solver = ReachSolver(world.robot)
        self._roads: dict[object, Roads] = {}
        self._answers: OrderedDict[object, Reach | Motion | Rejection | None] = OrderedDict()

    # -- step 1 --------------------------------------------------------------------------

    def in_arm_workspace(
        self, state: State, base: BasePose, targets: Sequence[Target]
    ) -> list[Target]:
        """The targets that are within the arm's reach from a base pose."""
        if not targets:
            return []
        step = self.profile.in_arm_workspace
        with step.timed():
            inside = within_reach(self.world, state, base, targets)
        step.record(int(inside.sum()), len(targets))
        return [target for target, ok in zip(targets, inside, strict=True) if ok]

    def arm(self, state: State, seeds: int, *about: object) -> Arm:
        """The arm where the robot stands in a state; `about` tells questions apart."""
        return Arm(self.world, self.solver, state, seeds, self._seed(state.base, *about))

    # -- steps 2 and 3 --------------------------------------------------------------------

    def manipulate(
        self,
        state: State,
        index: int,
        placement: Placement,
        grasp: Grasp,
        picks: bool,
        seeds: int,
    ) -> Motion | Rejection:
        """The motion of picking an object up where it rests, or of putting it down there; `grasp`
        is seen from the face on which it stands there."""
        world = self.world
        name = world.items[index].name
        at = world.rests_at(state.placements, index, placement)
        if at is None:
            return Rejection("in_arm_workspace", name)
        taken = state.grasp if state.grasp is not None and state.held == index else grasp
        asked = self._question(state, (index, placement, grasp), upright(*at), taken)
        step = self.profile.inverse_kinematics
        with step.timed():
            reach = self._known(
                ("reach", seeds, asked.key), lambda: next(self._reaches(asked, seeds), None)
            )
        step.record(reach is not None)
        if reach is None:
            return Rejection("inverse_kinematics", name)
        step = self.profile.motion_plan
        with step.timed():
            after = state.picked(index, grasp) if picks else state.placed(index, placement)
            motion: Motion | Rejection = Rejection("motion_plan", name)
            if self.can_leave(after):
                key = ("motion", picks, reach.approach[-1].tobytes(), asked.key)
                motion = self._known(key, lambda: self._motion(asked, reach, picks, 0))
                if isinstance(motion, Rejection):
                    key = ("further", picks, seeds, asked.key)
                    motion = self._known(key, lambda: self._further(asked, seeds, picks))
        step.record(not isinstance(motion, Rejection))
        return motion

    def _question(self, state: State, target: Target, standing: Pose, taken: Grasp) -> Manipulation:
        world = self.world
        index, placement, _ = target
        x, y, yaw = state.base.pose
        riders = world.riders(state.placements, index)
        without = {index, *riders}
        others = seen_from(world.obstacles(state.placements, without), x, y, yaw, REACH)
        others = join(others, FLOOR)
        at = world.rests_at(state.placements, index, placement)
        assert at is not None
        own = [seen_from(world.object_at(index, at, placement.face), x, y, yaw, np.inf)]
        for rider in riders:
            there, on = world.rests_on(state.placements, rider, index), state.placements[rider]
            assert on is not None
            pose = compose(standing, there)
            stands = (*pose[:, 3].tolist(), heading(pose))
            own.append(seen_from(world.object_at(rider, stands, on.face), x, y, yaw, np.inf))
        parts = world.rider_parts(state.placements, index)
        return Manipulation(state.base, target, standing, taken, others, join(others, *own), parts)

    def _known(self, key: object, compute: Callable[[], Answer]) -> Answer:
        """The answer to a question that was asked before, or what `compute` gives."""
        if key in self._answers:
            self._answers.move_to_end(key)
        else:
            self._answers[key] = compute()
            if len(self._answers) > REMEMBERED:
                self._answers.popitem(last=False)
        return cast("Answer", self._answers[key])

    def _held(self, asked: Manipulation) -> tuple[Part, ...]:
        """The solids of the object, and of what rests on it, in the tool frame."""
        index, placement, grasp = asked.target
        standing = invert(grasp.tool)
        riders = tuple(Part(p.solid, compose(standing, p.pose)) for p in asked.riders)
        return held_parts(self.world.item(index, placement.face), grasp.tool) + riders

    def _reaches(self, asked: Manipulation, seeds: int) -> Iterator[Reach]:
        """Reaches with different postures; the same ones in the same order at every call."""
        world = self.world
        index, placement, grasp = asked.target
        grip = self._grip(index, asked.taken)
        if grip is None:
            return iter(())
        if asked.taken.face != placement.face:
            grip = grip_on(grip, world.item(index, placement.face), grasp)
        x, y, z = asked.standing[:, 3].tolist()
        peg = world.peg_over(placement.support, (x, y, z, 0.0))
        grip = grip if peg is None else grip.off(peg, grasp.family)
        base = upright(*asked.base.pose[:2], 0.0, asked.base.pose[2])
        target = compose(invert(base), compose(asked.standing, grasp.tool))
        rng = np.random.default_rng(self._seed(asked.base, placement, grasp))
        held = self._held(asked)
        return self.solver.reaches(held, grip, target, asked.others, asked.with_object, rng, seeds)

    def _grip(self, index: int, grasp: Grasp) -> Grip | None:
        """How the fingers grip an object, None where they do not."""
        world = self.world
        return world.memory.answer(
            "grips",
            (world.kinds[index], grasp),
            lambda: grip_of(world.item(index, grasp.face), world.hand, grasp),
        )

    def _further(self, asked: Manipulation, seeds: int, picks: bool) -> Motion | Rejection:
        """The motion where the first posture has no simple way: with another one that has, else,
        after a first attempt, by searching for one. A posture costs a tenth of a search."""
        found: list[Reach] = []
        for reach in islice(self._reaches(asked, seeds), 1 + FURTHER):
            found.append(reach)
            motion = self._motion(asked, reach, picks, 0) if len(found) > 1 else None
            if motion is not None and not isinstance(motion, Rejection):
                return motion
        checks = min(rrt.MAX_CHECKS, CHECKS_A_SEED * max(0, seeds - SEEDS))
        for reach in found[:SEARCHED] if checks else ():
            motion = self._motion(asked, reach, picks, checks)
            if not isinstance(motion, Rejection):
                return motion
        return Rejection("motion_plan", self.world.items[asked.target[0]].name)

    def another(
        self, state: State, target: Target, taken: Grasp, picks: bool, number: int
    ) -> Motion | Rejection:
        """The motion of a manipulation, as for `manipulate`, with the arm in another posture, the
        first that is found is number 0, and simple ways to it. Whether the robot can drive off then
        is not asked."""
        index, placement, _ = target
        at = self.world.rests_at(state.placements, index, placement)
        found = None
        if at is not None:
            asked = self._question(state, target, upright(*at), taken)
            found = next(islice(self._reaches(asked, POSTURES), number, None), None)
        if found is None:
            return Rejection("inverse_kinematics", self.world.items[index].name)
        return self._motion(asked, found, picks, 0)

    def _seed(self, *parts: object) -> int:
        """A seed that depends on the question asked, not on what was asked before."""
        return zlib.crc32(repr((self.seed, parts)).encode())

    def _motion(
        self, asked: Manipulation, reach: Reach, picks: bool, checks: int
    ) -> Motion | Rejection:
        """The motion with a reach, or none; its free ways are simple ones, or searched for by so
        many tests of configurations."""
        world, robot = self.world, self.world.robot
        index, placement, grasp = asked.target
        item = world.item(index, placement.face)
        empty = ArmContext(robot, robot.body(reach.opening), asked.with_object)
        full = ArmContext(robot, robot.body(reach.closed, self._held(asked)), asked.others)
        seed = self._seed(asked.base, placement, grasp, "motion")
        carrying = self._carrying(index, asked.taken, full.body, asked.riders)
        if carrying is None:
            return Rejection("motion_plan", item.name)
        there = rrt.plan(empty, robot.home, reach.approach[0], seed, checks)
        if there is None:
            return Rejection("motion_plan", item.name)
        if asked.riders:
            rounds = level.ROUNDS if checks else 1
            up = asked.taken.up
            back = level.plan(full, reach.retreat[-1], carrying, up, seed + 1, rounds)
        else:
            back = rrt.plan(full, reach.retreat[-1], carrying, seed + 1, checks)
        if back is None:
            return Rejection("motion_plan", item.name)
        pace = PACE if asked.riders else 1.0
        if picks:
            return (
                GripperMove(reach.opening),
                ArmMove(there, "free"),
                ArmMove(reach.approach, "approach"),
                GripperMove(reach.closed, Attach(item.name, robot.urdf_tool)),
                ArmMove(reach.lift, "lift", pace=pace),
                ArmMove(reach.retreat, "retreat", pace=pace),
                ArmMove(back, "free", pace=pace),
            )
        ground = world.grounds[placement.support]
        stands = pose_of(compose(asked.standing, item.standing))
        return (
            ArmMove(back[::-1].copy(), "free", pace=pace),
            ArmMove(reach.retreat[::-1].copy(), "approach", pace=pace),
            ArmMove(reach.lift[::-1].copy(), "lower", pace=pace),
            GripperMove(reach.opening, release=Release(item.name, ground.name, stands)),
            ArmMove(reach.approach[::-1].copy(), "retreat"),
            ArmMove(there[::-1].copy(), "free"),
        )

    # -- the base -------------------------------------------------------------------------

    def drive(self, state: State, target: BasePose) -> Motion | Rejection:
        """The drive to a base pose."""
        step = self.profile.motion_plan
        with step.timed():
            motion: Motion | Rejection = Rejection("motion_plan", "base")
            poses = self.roads_for(state).route(state.base.pose, target.pose)
            if poses is not None:
                motion = (BaseMove(poses),)
        step.record(not isinstance(motion, Rejection))
        return motion

    def can_leave(self, state: State) -> bool:
        """Whether the robot, with what it holds then, can drive off from where it stands."""
        return self.world.is_fixed or self.roads_for(state).can_leave(state.base.pose)

    def roads_for(self, state: State) -> Roads:
        """Roads among everything that stands; those of the static scene where no standing
        object narrows them, which is the rule: tables keep the base further away."""
        key = (state.placements, state.grasp)
        if key not in self._roads:
            if len(self._roads) > REMEMBERED:
                self._roads.clear()
            world = self.world
            standing = world.obstacles(state.placements, ()).rows[len(world.statics) :]
            body, posture = self.carried(state)
            self._roads[key] = world.roads.among(standing, body, posture)
        return self._roads[key]

    def _carrying(
        self, index: int, grasp: Grasp, body: Body, riders: Sequence[Part]
    ) -> Floats | None:
        """The posture in which the robot, its body with all that it holds, carries an object;
        level where something stands on that."""
        load = tuple((part.solid, part.pose.tobytes()) for part in riders)
        key = (self.world.kinds[index], grasp, load)
        robot, memory, seed = self.world.robot, self.world.memory, self._seed("carrying", grasp)
        if not riders:
            return memory.answer("carrying", key, lambda: carrying(robot, body, seed))
        up = grasp.up.round(6)
        among = memory.answer("level", up.tobytes(), lambda: level.postures(robot, up))
        return memory.answer("carrying", key, lambda: carrying(robot, body, seed, among))

    def carried(self, state: State) -> tuple[Body | None, Floats | None]:
        """The robot's boxes with the object that it carries, and its posture; None where it
        carries none."""
        if state.held is None or state.grasp is None:
            return None, None
        world = self.world
        item = world.item(state.held, state.grasp.face)
        grip = self._grip(state.held, state.grasp)
        assert grip is not None, "a held object fits the gripper"
        standing = invert(state.grasp.tool)
        riders = world.rider_parts(state.placements, state.held)
        parts = tuple(Part(p.solid, compose(standing, p.pose)) for p in riders)
        body = world.robot.body(grip.closed, held_parts(item, state.grasp.tool) + parts)
        return body, self._carrying(state.held, state.grasp, body, riders)


def within_reach(
    world: TabletopWorld, state: State, base: BasePose, targets: Sequence[Target]
) -> NDArray[np.bool_]:
    """Which targets (k,) have their wrist between the arm's inner and outer reach for a robot
    that stands at a base pose."""
    x, y, yaw = base.pose
    c, s = math.cos(yaw), math.sin(yaw)
    cx, cy = world.shoulder
    hx, hy = x + c * cx - s * cy, y + s * cx + c * cy
    inside = np.zeros(len(targets), dtype=np.bool_)
    for i, (index, placement, grasp) in enumerate(targets):
        at = world.rests_at(state.placements, index, placement)
        if at is None:
            continue
        found = world.hand.workspace(grasp.family, at[2] + grasp.height * UNIT)
        if found is None:
            continue
        wrist, inner, outer = found
        heading = at[3] + grasp.heading
        c, s = math.cos(heading), math.sin(heading)
        along, aside = grasp.along * UNIT - wrist, grasp.aside * UNIT
        dx, dy = at[0] + c * along - s * aside - hx, at[1] + s * along + c * aside - hy
        inside[i] = inner <= math.hypot(dx, dy) <= outer
    return inside
