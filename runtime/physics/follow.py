"""Follow a trace in a simulation: motors are sent where the trace has the robot."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from runtime.physics.recorder import Recorder
from runtime.physics.simulation import STEP, Physics
from runtime.physics.tracking import Tracking
from runtime.robot.model import Floats
from runtime.trace.model import Grip, Trace
from runtime.trace.track import Track
from runtime.world.quaternions import matrix

GRASP_PATIENCE = 0.5
"""Seconds that the fingers are given to reach the object."""

BRAKING = 1.4
"""Seconds from full speed to rest, along the path, where a drive is broken off."""

ARM_BRAKING = 0.5
"""The same for the arm, at most: it brakes as hard as its joints can."""

LEAST_BRAKING = 0.05
"""Seconds that braking takes at least, however slow the arm is."""

CHECK = 0.1
"""Seconds between looks at contacts, and at what a watcher sees."""

SPRUNG = 0.008
"""Metres by which fingers open that lose their grip: as far as they were before it."""

FINGER_TIME = 0.5
"""Seconds in which the fingers open when they are told to outside of a trace."""

Watcher = Callable[[float], "str | None"]
"""Asked every `CHECK` seconds with the time in the trace; a reason to stop, or None."""


@dataclass(frozen=True)
class Slip:
    """An object that was not gripped, fell, or moved in the gripper by `moved` metres."""

    time: float
    object: str
    what: str
    moved: float = 0.0


@dataclass(frozen=True)
class Touch:
    """The robot touched something that it was not gripping."""

    time: float
    link: str
    thing: str


class Follower:
    """Follows traces one after the other in one simulation, and keeps the books.

    `acceleration` (n,) of the planning joints says how hard the arm can brake.
    """

    def __init__(
        self, physics: Physics, recorder: Recorder, acceleration: Floats | None = None
    ) -> None:
        self.physics, self.recorder, self.acceleration = physics, recorder, acceleration
        self.tracking = Tracking()
        self.slips: list[Slip] = []
        self.touches: list[Touch] = []
        self.names = [thing.name for thing in physics.world.movables]
        self.grasp_fails: Callable[[], bool] = lambda: False
        """Asked when the fingers close; true where a disturbance keeps them open."""
        self.meanwhile: Callable[[], None] = lambda: None
        """Called every `CHECK` seconds, whatever the robot does: what others do."""
        self.lost: int | None = None
        """What the fingers should hold and do not, until somebody has dealt with it."""
        self._target = np.concatenate([physics.world.robot_start, physics.robot.home])
        self._opening = physics.robot.max_opening
        self._in_tool: Floats | None = None
        self._kept: float | None = None  # the opening of fingers that a disturbance stops
        self._letting: int | None = None  # what the fingers are just opening around
        self._touching: set[tuple[str, str]] = set()

    def wait(self, seconds: float) -> None:
        """Stand still."""
        for _ in range(round(seconds / STEP)):
            self._step(self._target, np.zeros(len(self._target)), None)

    def follow(
        self,
        trace: Trace,
        watch: Watcher | None = None,
        start: float = 0.0,
        stop: float | None = None,
    ) -> float:
        """Follow a trace from a time to another; returns the time in the trace where it ended.

        That is earlier than wanted where the watcher had it stopped, or where it is watched
        and a grasp was lost: fingers feel that at once, and the robot stops by reflex.
        """
        stop = trace.duration if stop is None else stop
        steps = max(1, math.ceil((stop - start) / STEP))
        times = np.minimum(start + np.arange(steps + 1) * STEP, stop)
        base, base_speed = trace.base.at(times)
        joints, joint_speed = trace.joints.at(times)
        target, speed = np.hstack([base, joints]), np.hstack([base_speed, joint_speed])
        opening = trace.opening.at(times)[0][:, 0]
        # Headings of a trace are not wrapped; the motor's may be off by whole turns.
        target[:, 2] += 2 * math.pi * round((self._target[2] - target[0, 2]) / (2 * math.pi))
        grips = [grip for grip in trace.grips if start + 1e-9 < grip.time <= stop + 1e-9]
        clock, rate, braking, checked = 0.0, 1.0, 0.0, -1.0
        marks = [(start, self.physics.time)]
        while clock < steps and rate > 0:
            now = start + clock * STEP
            if grips and self._handle(grips[0], now, marks):
                grips.pop(0)
            if watch is not None and not braking:
                stops = False
                if self.physics.time - checked >= CHECK:
                    checked = self.physics.time
                    stops = watch(now) is not None
                if stops or self.lost is not None:
                    braking = self._braking(speed[min(int(clock), steps)])
            if braking:
                rate = max(0.0, rate - STEP / braking)
            clock = min(float(steps), clock + rate)
            whole = min(int(clock), steps - 1)
            share = clock - whole
            goal = target[whole] + share * (target[whole + 1] - target[whole])
            self._opening = float(opening[whole + 1]) if self._kept is None else self._kept
            self._step(goal, rate * speed[whole + 1], grips[0] if grips else None)
        end = min(start + clock * STEP, stop)
        if grips and rate > 0 and self._handle(grips[0], end + STEP, marks):
            grips.pop(0)
        marks.append((end, self.physics.time))
        if end >= stop:
            self._kept = None
        self.recorder.enter(trace, marks, start, end)
        return end

    def _braking(self, speed: Floats) -> float:
        """Seconds from a speed (3 + n,) of base and joints to rest."""
        if speed[:3].any():
            return BRAKING
        if self.acceleration is None:
            return ARM_BRAKING
        hardest = float((np.abs(speed[3:]) / self.acceleration).max())
        return min(ARM_BRAKING, max(LEAST_BRAKING, hardest))

    def _step(self, target: Floats, speed: Floats, grip: Grip | None) -> None:
        physics = self.physics
        self._target = target
        physics.drive(target, speed, self._opening)
        held = physics.held
        if not physics.step() and held is not None:
            self._slipped(held, "the grasp broke")
            self.lost = held
        count = round(physics.time / STEP)
        if self._letting is not None and not physics.touching_sides(self._letting):
            self._letting = None
        if count % 4 == 0:
            self.tracking.add(physics.robot_state()[0] - target)
        if count % round(CHECK / STEP) == 0:
            gripping = None if grip is None else self.names.index(grip.object)
            self._look(gripping if self._letting is None else self._letting)
            self.meanwhile()
        self.recorder.sample()

    def _look(self, gripping: int | None) -> None:
        physics = self.physics
        contacts = physics.contacts(physics.held if physics.held is not None else gripping)
        now = {(contact.link, contact.thing) for contact in contacts}
        for link, thing in sorted(now - self._touching):
            self.touches.append(Touch(physics.time, link, thing))
            self.recorder.event("touch", f"{link} touches {thing}")
        self._touching = now

    def held_pose(self) -> Floats:
        """World pose (4, 4) of the held object's bottom."""
        assert self.physics.held is not None
        return matrix(self.physics.object_pose(self.physics.held))

    # -- outside of plans ----------------------------------------------------------------------

    def move_arm(self, trace: Trace, joints: Track) -> None:
        """Move the planning joints from time 0 of a track to its end; base and fingers stay."""
        still = np.array([0.0])
        self._kept = self._opening if self.physics.held is None else self.physics.opening()
        self.follow(
            replace(
                trace,
                duration=float(joints.times[-1]),
                subgoals=(),
                actions=(),
                grips=(),
                base=Track(still, self._target[None, :3], np.zeros((1, 3))),
                joints=joints,
                opening=Track(still, np.array([[self._kept]]), np.zeros((1, 1))),
            )
        )

    def let_fall(self) -> None:
        """What was lost has come to rest: from now on fingers that touch it touch it."""
        if self.lost is not None:
            self.lost = self._letting = None

    def move_fingers(self, opening: float) -> None:
        """Move the fingers, metres apart, and nothing else."""
        self.physics.squeezing = False  # a grasp that was broken off
        begin = self.physics.opening()
        for share in np.linspace(0.0, 1.0, round(FINGER_TIME / STEP)):
            self._opening = float(begin + share * (opening - begin))
            self._step(self._target, np.zeros(len(self._target)), None)

    # -- grips ---------------------------------------------------------------------------------

    def _handle(self, grip: Grip, now: float, marks: list[tuple[float, float]]) -> bool:
        """What a grip asks for at a time; whether it is done with."""
        index, physics = self.names.index(grip.object), self.physics
        if not grip.attach:
            if now < grip.start:
                return False
            self.let_go()
            return True
        waiting = physics.held is None and not physics.squeezing and self._kept is None
        if now >= grip.start and waiting:
            physics.squeezing = not self.grasp_fails()
            self._kept = None if physics.squeezing else self._opening
        # Fingers stop where both touch, before they turn what they hold across its corners.
        if physics.squeezing and physics.held is None:
            physics.grasp(index)
        if now < grip.time:
            return False
        marks.append((now, physics.time))
        for _ in range(round(GRASP_PATIENCE / STEP)):
            if physics.held is not None or not physics.squeezing or physics.grasp(index):
                break
            self._step(self._target, np.zeros(len(self._target)), grip)
        marks.append((now, physics.time))
        if physics.held is None:
            physics.release()
            self._slipped(index, "the fingers did not hold it")
            self.lost = index
        else:
            self._in_tool = np.linalg.inv(physics.tool_matrix()) @ matrix(
                physics.object_pose(index)
            )
        return True

    def let_go(self) -> None:
        """Release what is held, and measure how far it had moved in the gripper."""
        physics = self.physics
        if physics.held is not None and self._in_tool is not None:
            pose = physics.tool_matrix() @ self._in_tool
            moved = float(np.linalg.norm(pose[:3, 3] - physics.object_pose(physics.held)[:3]))
            self.slips.append(Slip(physics.time, self.names[physics.held], "carried", moved))
        self._in_tool = None
        self._letting = physics.held
        physics.release()

    def lose_grip(self) -> None:
        """Open the fingers a little, as nobody asked for, until the end of the action."""
        self._kept = self.physics.opening() + SPRUNG
        self._letting = self.lost = self.physics.held
        self._in_tool = None
        self.physics.release()

    def _slipped(self, index: int, what: str) -> None:
        name = self.names[index]
        self.slips.append(Slip(self.physics.time, name, what))
        self.recorder.event("slip", f"{name}: {what}")
        self._in_tool = None
