"""A plan as steps for the controllers of a robot.

A step starts and ends where the whole robot rests, and belongs to one action; within it, each
controller that has something to do gets one goal, and all of them start together. Nothing else
is known of how motions overlap: it follows from the trace.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from runtime.export.goals import Goal, goal_of
from runtime.robot.controllers import unmoved
from runtime.robot.model import Floats
from runtime.trace.model import Grip, Trace
from runtime.trace.track import Track
from sketchlang.analysis.words import counted
from sketchlang.errors import InputError

STILL = 1e-5
"""rad/s, m/s: slower is at rest; and rad, m: less is no motion."""

SAME = 1e-7
"""Seconds: times that are closer are one."""


@dataclass(frozen=True, eq=False)
class Step:
    """One step: from rest to rest.

    `actions` are the indices of its actions: more than one where the robot goes from one to the
    next without a rest. `text` says them in one line, `rule` is that of the first one's subgoal;
    `start` and `end` are times of the trace; `grip` is what the fingers close on or let go at its
    end.
    """

    number: int
    actions: tuple[int, ...]
    text: str
    rule: str
    start: float
    end: float
    goals: tuple[Goal, ...]
    grip: Grip | None

    @property
    def duration(self) -> float:
        """Seconds that it takes."""
        return self.end - self.start

    @property
    def untimed(self) -> str | None:
        """The controller of the base, where it keeps no times and that matters, for base and arm
        move at once; None if that is not so."""
        if len({goal.controller.moves_base for goal in self.goals}) == 1:
            return None
        bases = (goal.controller for goal in self.goals if goal.controller.moves_base)
        return next((base.name for base in bases if not base.keeps_times), None)


@dataclass(frozen=True)
class _Stretch:
    start: float
    end: float
    actions: tuple[int, ...]
    moving: frozenset[str]
    grip: Grip | None


def steps_of(trace: Trace, frame: str = "map") -> tuple[Step, ...]:
    """The steps of a plan; `frame` is the frame of base poses, that of the scene.

    Raises:
        InputError: it was measured and not planned, or a controller is missing.
    """
    if trace.source != "plan":
        raise InputError(
            "what was measured is nothing to send to controllers",
            hint="give the plan, or the trace of the plan",
        )
    _check_controllers(trace)
    return tuple(
        Step(
            number,
            stretch.actions,
            "; ".join(trace.actions[action].text for action in stretch.actions),
            trace.subgoals[trace.actions[stretch.actions[0]].subgoal].rule,
            stretch.start,
            stretch.end,
            tuple(_goals(trace, stretch, frame)),
            stretch.grip,
        )
        for number, stretch in enumerate(_joined(_stretches(trace)))
    )


def _check_controllers(trace: Trace) -> None:
    tracks = ((trace.robot.joints, trace.joints), (trace.robot.fingers[:1], trace.opening))
    moved = [name for names, track in tracks if changes(track) for name in names]
    owned = {name for each in trace.robot.controllers for name in each.joints}
    # Where fingers mimic each other, one of them is enough.
    if owned & set(trace.robot.fingers):
        moved = [name for name in moved if name not in trace.robot.fingers]
    for message, hint in unmoved(trace.robot.controllers, moved, changes(trace.base)):
        raise InputError(f"robot {trace.robot.name}: {message}", hint=hint)


def _tracks(trace: Trace) -> dict[str, Track]:
    return {"base": trace.base, "joints": trace.joints, "opening": trace.opening}


def rests(trace: Trace) -> Floats:
    """The times (k,) at which knots lie or actions begin and the whole robot rests."""
    tracks = _tracks(trace).values()
    marks = [track.times for track in tracks]
    marks.append(np.array([0.0, trace.duration, *(action.start for action in trace.actions)]))
    times = np.unique(np.concatenate(marks))
    times = times[np.diff(times, prepend=-1.0) > SAME]
    still = np.ones(len(times), dtype=bool)
    for track in tracks:
        still &= np.abs(track.at(times)[1]).max(axis=1) < STILL
    return times[still]


def _stretches(trace: Trace) -> Iterator[_Stretch]:
    """From rest to rest, where something moves."""
    times = rests(trace)
    for start, end in zip(times[:-1].tolist(), times[1:].tolist(), strict=True):
        moving = frozenset(n for n, track in _tracks(trace).items() if moves(track, start, end))
        if moving:
            actions = tuple(
                i
                for i, action in enumerate(trace.actions)
                if action.start < end - SAME and action.end > start + SAME
            )
            grips = [g for g in trace.grips if start + SAME < g.time <= end + SAME]
            yield _Stretch(start, end, actions, moving, grips[-1] if grips else None)


def changes(track: Track) -> bool:
    """Whether a track has more than one value, ever."""
    return bool(np.abs(track.values - track.values[0]).max() > STILL)


def moves(track: Track, start: float, end: float) -> bool:
    """Whether a track changes between two times at which it rests."""
    inside = track.times[(track.times > start) & (track.times < end)]
    values = track.at(np.array([start, *inside, end]))[0]
    return bool(np.abs(values - values[0]).max() > STILL)


def _joined(stretches: Iterator[_Stretch]) -> Iterator[_Stretch]:
    """Stretches of one action in which the same things move follow each other in one step, but
    not beyond a grasp or a release."""
    last: _Stretch | None = None
    for stretch in stretches:
        if (
            last is not None
            and last.grip is None
            and (last.actions, last.moving) == (stretch.actions, stretch.moving)
            and abs(last.end - stretch.start) < SAME
        ):
            last = _Stretch(last.start, stretch.end, last.actions, last.moving, stretch.grip)
            continue
        if last is not None:
            yield last
        last = stretch
    if last is not None:
        yield last


def _goals(trace: Trace, stretch: _Stretch, frame: str) -> Iterator[Goal]:
    for controller in trace.robot.controllers:
        goal = goal_of(trace, controller, stretch.start, stretch.end, frame)
        if goal is not None:
            yield goal


def summary(steps: Sequence[Step]) -> str:
    """How many steps there are, and how long they take, in one line."""
    controllers = {goal.controller.name for step in steps for goal in step.goals}
    took = sum(step.duration for step in steps)
    return (
        f"{counted(len(steps), 'step')} for {counted(len(controllers), 'controller')}, {took:.0f} s"
    )
