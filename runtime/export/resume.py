"""From where a robot is to where a step goes, for one that stopped on the way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from runtime.export.goals import UNMOVED, Goal, message_of
from runtime.export.steps import Step
from runtime.robot.model import Floats
from runtime.trace.model import Trace
from runtime.trace.track import Track
from sketchlang.errors import InputError

AT_START = 0.02
"""rad or m: a joint that is closer to where a step starts is there."""

ON_THE_WAY = 0.05
"""rad or m: a robot whose joints are closer to the path of a step has stopped on it."""

SAME_OPENING = 1e-3
"""rad or m: finger joints that are closer to where they should be are there."""

SAMPLING = 0.01
"""Seconds between the points of a path that are looked at."""

SPEEDING_UP = 1.0
"""Seconds from rest to the speed that the step has where the robot goes on."""

BLEND = 0.05
"""Seconds between points while it speeds up."""


@dataclass(frozen=True)
class Off:
    """A joint that is not where it should be: values in rad or m."""

    joint: str
    found: float
    wanted: float


def resumed(trace: Trace, step: Step, found: Mapping[str, float], frame: str) -> Step:
    """A step for a robot whose joints have some values: as it is where it stands at its start,
    or the rest of it where it stopped on the way. Fingers may be anywhere, for what they hold
    keeps them there: they go on from where they are.

    Raises:
        InputError: it is somewhere else, or a joint is not known.
    """
    start = _wanted(trace, step, 0.0)
    missing = [name for name in start if name not in found]
    if missing:
        raise InputError(f"the robot does not say where its joint {missing[0]!r} is")
    if _worst(found, start) is None:
        fingers = [_fingers_from(trace, goal, found, frame) for goal in step.goals]
        return replace(step, goals=tuple(fingers))
    time, off = _nearest(trace, step, found)
    if off is not None:
        here = _worst(found, start) or off
        raise InputError(
            f"the robot is not where step {step.number} starts: {here.joint} is at "
            f"{here.found:.3f}, not {here.wanted:.3f}",
            hint="bring it there, or begin with the step at whose start it is",
        )
    if any(goal.controller.moves_base for goal in step.goals):
        raise InputError(
            f"step {step.number} moves base and arm at once, and the robot stopped within it",
            hint="plan anew from where it is",
        )
    goals = [_rest(trace, goal, time, found, frame) for goal in step.goals]
    return replace(step, goals=tuple(goal for goal in goals if goal is not None))


def _wanted(trace: Trace, step: Step, since: float) -> dict[str, float]:
    """Where the planned joints should be some time after the start of a step."""
    values = trace.joints.at(np.array([step.start + since]))[0][0]
    return dict(zip(trace.robot.joints, values.tolist(), strict=True))


def _worst(
    found: Mapping[str, float], wanted: Mapping[str, float], within: float = AT_START
) -> Off | None:
    """The joint that is furthest off, if it is further than allowed."""
    name = max(wanted, key=lambda each: abs(found[each] - wanted[each]))
    off = abs(found[name] - wanted[name])
    return Off(name, found[name], wanted[name]) if off > within else None


def _nearest(trace: Trace, step: Step, found: Mapping[str, float]) -> tuple[float, Off | None]:
    """The time after the start of a step at which it passes nearest to the robot, and which
    joint is off there, if one is."""
    times = np.arange(0.0, step.duration + SAMPLING / 2, SAMPLING)
    values = trace.joints.at(step.start + times)[0]
    here = np.array([found[name] for name in trace.robot.joints])
    best = float(times[np.abs(values - here).max(axis=1).argmin()])
    return best, _worst(found, _wanted(trace, step, best), ON_THE_WAY)


def _rest(
    trace: Trace, goal: Goal, since: float, found: Mapping[str, float], frame: str
) -> Goal | None:
    """What is left of a goal, from rest where the joints are; None if that is nothing."""
    names = goal.controller.joints
    if not set(names) <= set(trace.robot.joints):
        return _fingers_from(trace, goal, found, frame)
    motion = from_rest(goal.motion, since, np.array([found[name] for name in names]))
    if np.abs(motion.values - motion.values[0]).max() <= UNMOVED:
        return None
    return _with_motion(trace, goal, motion, frame)


def _fingers_from(trace: Trace, goal: Goal, found: Mapping[str, float], frame: str) -> Goal:
    """A goal for fingers from where they are, where they say so; other goals as they are."""
    names = goal.controller.joints
    if not names or not set(names) <= set(trace.robot.fingers) & set(found):
        return goal
    here = np.array([found[name] for name in names])
    if np.abs(goal.motion.values[0] - here).max() <= SAME_OPENING:
        return goal
    times = np.arange(0.0, goal.motion.times[-1] + SAMPLING / 2, SAMPLING)
    nearest = times[np.abs(goal.motion.at(times)[0] - here).max(axis=1).argmin()]
    return _with_motion(trace, goal, from_rest(goal.motion, float(nearest), here), frame)


def _with_motion(trace: Trace, goal: Goal, motion: Track, frame: str) -> Goal:
    message = message_of(goal.controller, motion, trace.robot, frame)
    return replace(goal, motion=motion, message=message)


def from_rest(motion: Track, since: float, here: Floats) -> Track:
    """The rest of a motion from a time on, for joints that rest at `here`, near to it.

    Its time runs slowly at first: t(s) = since + s^2 / 2T for s up to T, then as before. By then
    the joints have come onto the path from beside it.
    """
    end, ramp = float(motion.times[-1]), SPEEDING_UP
    ramp = min(ramp, 2.0 * max(end - since, BLEND))
    slow = np.linspace(0.0, ramp, max(2, round(ramp / BLEND) + 1))
    share = slow / ramp
    values, velocities = motion.at(np.minimum(since + slow**2 / (2 * ramp), end))
    aside = here - values[0]
    fading = 1 - share**2 * (3 - 2 * share)
    values = values + fading[:, None] * aside
    velocities = velocities * share[:, None]
    velocities += (-6 * share * (1 - share) / ramp)[:, None] * aside
    left = motion.times > since + ramp / 2 + 1e-6
    times = np.concatenate([slow, motion.times[left] - since + ramp / 2])
    values = np.vstack([values, motion.values[left]])
    velocities = np.vstack([velocities, motion.velocities[left]])
    velocities[[0, -1]] = 0.0
    return Track(times, values, velocities)
