"""When the robot does what: the motions of a plan's actions put together in time.

X gives each action a motion of its own, from the driving posture and back to it. What the robot
carries out is one motion from manipulation to manipulation (`runtime/motion/transit.py`): the way
home of the one, the drive, and the way from home of the other overlap. Motions of actions that
a domain adds are left as they are, and the arm is in the driving posture before and after them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from domains.tabletop.actions.actions import Action
from domains.tabletop.actions.executability import Executor
from domains.tabletop.state import State
from runtime.kernels.convex import NO_SHAPES, Obstacles, boxes_only
from runtime.motion import timing
from runtime.motion.course import TICK, arm_limits
from runtime.motion.drives import drives
from runtime.motion.motion import ArmMove, BaseMove, GripperMove, Motion, Together
from runtime.motion.roads import Roads
from runtime.motion.transit import Fingers, Leg, Question, Transit, transit
from runtime.motion.whole import Whole
from runtime.plan.model import TimedPiece
from runtime.robot.model import Body, Floats, RobotModel

BULGE = 0.9
"""Metres by which a curve may leave the rectangle around the way that is known."""

AROUND = BULGE + 1.4
"""Metres around that rectangle within which things matter."""


@dataclass(frozen=True, eq=False)
class Step:
    """An action, its motion, and the states before and after it."""

    action: Action
    motion: Motion
    before: State
    after: State


@dataclass(frozen=True, eq=False)
class Handling:
    """A manipulation: the ways in and out, what the fingers do in between, and how far they are
    apart before."""

    come: Leg
    grip: GripperMove
    leave: Leg
    opening: float | None


def handling_of(motion: Motion) -> Handling | None:
    """A motion as a manipulation, where it is one: in from a driving posture, one change of
    the grip, and out to a driving posture again."""
    opening = None
    pieces = list(motion)
    if isinstance(pieces[0], GripperMove) and not _changes(pieces[0]):
        opening = pieces.pop(0).opening  # type: ignore[union-attr]
    grips = [i for i, piece in enumerate(pieces) if isinstance(piece, GripperMove)]
    if len(grips) != 1:
        return None
    grip = pieces[grips[0]]
    ways = pieces[: grips[0]], pieces[grips[0] + 1 :]
    if not isinstance(grip, GripperMove) or not _changes(grip):
        return None
    lines: list[list[ArmMove]] = []
    for way in ways:
        # What stands on what is held might not stay there in another motion than that of X.
        moves = [p for p in way if isinstance(p, ArmMove) and not p.along and p.pace == 1.0]
        if len(moves) != len(way) or len(moves) < 2:
            return None
        lines.append(moves)
    into, out = lines
    if into[0].kind != "free" or out[-1].kind != "free":
        return None
    come = Leg(into[0].path, tuple(move.path for move in into[1:]))
    leave = Leg(out[-1].path, tuple(move.path for move in out[:-1]))
    return Handling(come, grip, leave, opening)


def _changes(piece: GripperMove) -> bool:
    return piece.attach is not None or piece.release is not None


def is_drive(motion: Motion) -> bool:
    """Whether a motion moves the base and nothing else."""
    return all(isinstance(piece, BaseMove) and not piece.along for piece in motion)


@dataclass(eq=False)
class Schedule:
    """Puts the motions of steps together. `pieces[i]` are those of step i, in order, `seconds`
    what all of them take so far. Transits between the same motions among the same things are
    `known` from before, where that is given."""

    executor: Executor
    opening: float
    pieces: list[list[TimedPiece]] = field(default_factory=list)
    known: dict[object, tuple[object, Transit]] = field(default_factory=dict)
    seconds: float = 0.0
    _leave: Leg | None = None
    _left: int = 0  # the step whose hand is still at the object
    _ways: list[Floats] = field(default_factory=list)
    _drivers: list[int] = field(default_factory=list)

    @property
    def _robot(self) -> RobotModel:
        return self.executor.world.robot

    def __post_init__(self) -> None:
        self._posture = self._robot.home

    @property
    def _rest(self) -> Leg:
        """Nothing to do but to be in the driving posture."""
        return Leg(self._posture[None])

    def add(self, step: Step) -> None:
        """The next step."""
        number = len(self.pieces)
        self.pieces.append([])
        if is_drive(step.motion):
            for piece in step.motion:
                assert isinstance(piece, BaseMove)
                self._ways.append(piece.poses)
            self._drivers.append(number)
            return
        found = handling_of(step.motion)
        if found is None or not np.allclose(found.come.free[0], self._posture, atol=1e-6):
            self._go(step.before, self._rest, self.opening, number)
            pieces, self.opening = timing.timed_motion(self._robot, step.motion, self.opening)
            self.pieces[number] += pieces
            self.seconds += float(sum(piece.times[-1] for piece in pieces))
            paths = [piece.path for piece in step.motion if isinstance(piece, ArmMove)]
            self._posture = paths[-1][-1] if paths else self._posture
            return
        opening = self.opening if found.opening is None else found.opening
        self._go(step.before, found.come, opening, number)
        grip = TimedPiece(*timing.timed(self._robot, found.grip, opening))
        self.pieces[number].append(grip)
        self.seconds += float(grip.times[-1])
        self.opening = found.grip.opening
        self._leave, self._left = found.leave, number
        self._posture = found.leave.free[-1]

    def end(self, state: State) -> None:
        """The arm goes to its driving posture, and the base where it was on its way to."""
        self._go(state, self._rest, self.opening, None)

    def _go(self, state: State, come: Leg, opening: float, number: int | None) -> None:
        """From where hand and base are to where they are needed next, by step `number`, before
        which everything is as in a state (but for the base, which is there already)."""
        leave = self._leave or self._rest
        if not self._ways and len(leave.free) == 1 == len(come.free) and opening == self.opening:
            return
        found = self._known_transit(state, leave, come, opening)
        self.seconds += found.seconds
        driver = self._drivers[0] if self._drivers else number
        ends = [(self._left, 0, found.out)] if self._leave is not None else []
        start = ends[-1][2] if ends else 0
        last = len(found.rows) - 1
        if driver is None:
            ends = [(self._left, 0, last)]
        elif number is None:
            ends.append((driver, start, last))
        else:
            ends += [(driver, start, found.there), (number, found.there, last)]
        for owner, first, stop in ends:
            if stop > first:
                self.pieces[owner].append(_piece(found, first, stop))
        self.opening, self._leave = opening, None
        self._ways, self._drivers = [], []

    def _known_transit(self, state: State, leave: Leg, come: Leg, opening: float) -> Transit:
        """A transit; the same one where motions, drives and what is near by are the same."""
        known = self._known() if self._ways else np.array(state.base.pose)[None]
        around = near(
            self.executor.world.obstacles(state.placements, ()),
            known[:, :2].min(axis=0) - AROUND,
            known[:, :2].max(axis=0) + AROUND,
        )
        roads = self.executor.roads_for(state)
        paths = (leave.free, *leave.near, come.free, *come.near)
        key = (
            *map(id, (*paths, roads)), known.tobytes(), around.rows.tobytes(),
            around.pose.tobytes(), self.opening, opening, state.held, state.grasp,
        )  # fmt: skip
        if key not in self.known:
            asked = Question(
                leave,
                come,
                self._drives(known, roads),
                self._fingers(state, opening, around),
                arm_limits(self._robot),
            )
            # What has an identity is kept with the answer, so that nothing else gets it.
            self.known[key] = (paths, roads), transit(asked)
        return self.known[key][1]

    def _drives(self, known: Floats, roads: Roads) -> list[Floats]:
        """Drives along a known way, or quicker ones within what stands around that."""
        if len(known) < 2:
            return [known]
        start, goal = known[0].tolist(), known[-1].tolist()
        turns = roads.can_turn(*start[:2]) and roads.can_turn(*goal[:2])
        found = drives(
            self._robot, tuple(start), tuple(goal), known, turns, roads.boxes, roads.clearance
        )
        low, high = known[:, :2].min(axis=0) - BULGE, known[:, :2].max(axis=0) + BULGE
        return [d for d in found if (d[:, :2] > low).all() and (d[:, :2] < high).all()]

    def _known(self) -> Floats:
        """The ways of the base, one after the other, headings not wrapped."""
        joined = self._ways[0]
        for way in self._ways[1:]:
            turns = round((joined[-1, 2] - way[0, 2]) / (2 * math.pi))
            joined = np.vstack([joined, way[1:] + np.array([0.0, 0.0, 2 * math.pi * turns])])
        return joined

    def _fingers(self, state: State, opening: float, around: Obstacles) -> Fingers:
        robot = self._robot
        carried, _ = self.executor.carried(state)
        if carried is not None:
            whole = Whole(robot, carried, around)
            return Fingers(np.array([self.opening]), whole, whole)
        before = Whole(robot, _hand(robot, self.opening), around)
        if abs(opening - self.opening) < 1e-9:
            return Fingers(np.array([opening]), before, before)
        after = Whole(robot, _hand(robot, opening), around)
        return Fingers(finger_rows(robot, self.opening, opening), before, after)


def _hand(robot: RobotModel, opening: float) -> Body:
    return robot.body(opening)


def _piece(found: Transit, first: int, stop: int) -> TimedPiece:
    rows, openings = found.rows[first : stop + 1], found.openings[first : stop + 1]
    piece = Together(rows[:, :3], rows[:, 3:], openings)
    return TimedPiece(piece, np.arange(stop - first + 1, dtype=np.float64) * TICK)


def finger_rows(robot: RobotModel, before: float, after: float) -> Floats:
    """Openings (k,), a tick apart, from one to another as fast as the fingers may."""
    seconds = timing.finger_time(robot, before, after) / (1 - timing.FINGER_RAMP)
    count = max(2, math.ceil(max(seconds, robot.gripper.time) / TICK))
    while True:
        share = np.linspace(0.0, 1.0, count + 1)
        rows = before + (after - before) * share * share * (3 - 2 * share)
        slowest = max(
            timing.finger_time(robot, a, b)
            for a, b in zip(rows[:-1].tolist(), rows[1:].tolist(), strict=True)
        )
        if slowest <= TICK:
            return rows
        count = math.ceil(count * slowest / TICK) + 1


def near(obstacles: Obstacles, low: Floats, high: Floats) -> Obstacles:
    """The obstacles within a rectangle of the floor (2,), (2,)."""
    reach = np.hypot(obstacles.rows[:, 3], obstacles.rows[:, 4])[:, None]
    middle = obstacles.rows[:, :2]
    inside = np.all((middle + reach > low) & (middle - reach < high), axis=1)
    if obstacles.shapes is NO_SHAPES:
        return boxes_only(obstacles.rows[inside])
    return Obstacles(
        obstacles.rows[inside], obstacles.shape[inside], obstacles.pose[inside], obstacles.shapes
    )


def scheduled(
    executor: Executor, steps: Sequence[Step], opening: float | None = None
) -> Iterator[tuple[TimedPiece, ...]]:
    """The pieces of each step, for a robot whose arm is in its driving posture and whose fingers
    are so far apart (m; None: all the way)."""
    most = executor.world.robot.gripper.max_opening
    plan = Schedule(executor, most if opening is None else opening)
    for step in steps:
        plan.add(step)
    if steps:
        plan.end(steps[-1].after)
    return (tuple(pieces) for pieces in plan.pieces)
