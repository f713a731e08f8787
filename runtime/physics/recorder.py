"""What happened in a simulation, sampled, as a trace."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from runtime.physics.simulation import Physics
from runtime.robot.model import Floats
from runtime.trace.model import WORLD, Event, Grip, Span, Trace, TraceAction, TraceSubgoal
from runtime.trace.track import Track

PERIOD = 0.05
"""Seconds between samples."""

STILL = 2e-4
"""Metres (and quaternion units) below which an object has not moved since its last sample."""


class Recorder:
    """Samples a simulation, and collects what was done in it."""

    def __init__(self, physics: Physics) -> None:
        self.physics = physics
        self.times: list[float] = []
        self.values: list[Floats] = []
        self.velocities: list[Floats] = []
        self.openings: list[float] = []
        self.subgoals: list[TraceSubgoal] = []
        self.actions: list[TraceAction] = []
        self.grips: list[Grip] = []
        self.events: list[Event] = []
        count = len(physics.objects)
        self._object_times: list[list[float]] = [[] for _ in range(count)]
        self._object_poses: list[list[Floats]] = [[] for _ in range(count)]
        self._seen = [0.0] * count
        self._entered: Trace | None = None  # the trace of the last subgoals

    def event(self, kind: str, text: str) -> None:
        """Note that something happened now."""
        self.events.append(Event(self.physics.time, kind, text))

    def sample(self) -> None:
        """Take a sample, unless the last one was a moment ago."""
        now = self.physics.time
        if self.times and now - self.times[-1] < PERIOD - 1e-9:
            return
        values, velocities = self.physics.robot_state()
        self.times.append(now)
        self.values.append(values)
        self.velocities.append(velocities)
        self.openings.append(self.physics.opening())
        for index in range(len(self.physics.objects)):
            self._sample_object(index, now)

    def _sample_object(self, index: int, now: float) -> None:
        times, poses = self._object_times[index], self._object_poses[index]
        pose = self.physics.object_pose(index)
        if not poses or np.abs(pose - poses[-1]).max() > STILL:
            if poses and self._seen[index] > times[-1]:  # it stood until the last sample
                times.append(self._seen[index])
                poses.append(poses[-1])
            times.append(now)
            poses.append(pose)
        self._seen[index] = now

    def enter(
        self, trace: Trace, marks: list[tuple[float, float]], start: float, end: float
    ) -> None:
        """Enter what was done of a trace from `start` to `end`, at the times at which it was;
        `marks` are pairs of a time in the trace and the time at which it was reached."""
        known, real = np.array(marks).T

        def when(time: float) -> float:
            return float(np.interp(min(time, end), known, real))

        if trace is not self._entered and trace.subgoals:
            self._entered = trace
            self.subgoals += [replace(s, start=when(s.start)) for s in trace.subgoals]
        first = len(self.subgoals) - len(trace.subgoals)
        for number, subgoal in enumerate(trace.subgoals, first):
            if subgoal.end > start:  # one that is followed action by action ends with the last
                self.subgoals[number] = replace(self.subgoals[number], end=when(subgoal.end))
        self.actions += [
            replace(
                action,
                start=when(action.start),
                end=when(action.end),
                subgoal=first + action.subgoal,
            )
            for action in trace.actions
            if start <= action.start < end
        ]
        self.grips += [
            replace(grip, start=when(grip.start), time=when(grip.time))
            for grip in trace.grips
            if start < grip.time <= end
        ]

    def reached(self, values: Mapping[str, int]) -> None:
        """Note the feature values that were sensed where the last subplan ended: other ones
        than planned where it was broken off."""
        if self.subgoals:
            self.subgoals[-1] = replace(self.subgoals[-1], after=dict(values))

    def trace(self, like: Trace) -> Trace:
        """Everything so far, with the sketch, scene and robot of another trace."""
        times = np.array(self.times)
        values, velocities = np.array(self.values), np.array(self.velocities)
        openings = np.array(self.openings)[:, None]
        spans = tuple(
            (Span(0.0, WORLD, np.array(times), np.array(poses)),)
            for times, poses in zip(self._object_times, self._object_poses, strict=True)
        )
        return replace(
            like,
            source="execution",
            duration=float(times[-1]),
            subgoals=tuple(self.subgoals),
            actions=tuple(self.actions),
            base=Track(times, values[:, :3], velocities[:, :3]),
            joints=Track(times, values[:, 3:], velocities[:, 3:]),
            opening=Track(times, openings, np.gradient(openings, times, axis=0)),
            grips=tuple(self.grips),
            objects=spans,
            events=tuple(self.events),
        )
