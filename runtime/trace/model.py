"""A trace in memory. Metres, radians, seconds, world frame unless said otherwise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from runtime.robot.controllers import Controller
from runtime.robot.model import Floats
from runtime.robot.urdf import Joint, Urdf
from runtime.trace.track import Track
from runtime.world.quaternions import between
from runtime.world.world import World

WORLD = "world"
"""The frame of things that no link carries."""


@dataclass(frozen=True, eq=False)
class TraceRobot:
    """A robot: its tree of links, which joints move and how, and its gripper.

    `joints` are the planning joints in chain order, `fingers` the finger joints, `fixed` the
    values of the other joints, `home` the posture in which it drives, `tool` the link whose
    frame is the grasp centre (x: approach, y: the fingers open). The finger joints have the
    values `finger_table` (k, m) at the openings (k,), and are interpolated in between.
    `max_force` is that of the fingers in newtons, where it is known. `controllers` move the real
    robot. `looks` are kept by trace files, which have no mesh files beside them: links, vertices
    and faces in their frames, colours.
    """

    name: str
    digest: str
    urdf: Urdf
    joints: tuple[str, ...]
    fingers: tuple[str, ...]
    fixed: Mapping[str, float]
    home: Floats
    tool: str
    gripper_links: tuple[str, ...]
    max_opening: float
    openings: Floats
    finger_table: Floats
    max_force: float | None = None
    controllers: tuple[Controller, ...] = ()
    looks: tuple[tuple[str, tuple[Floats, NDArray[np.int64]], tuple[float, float, float]], ...] = ()

    def finger_values(self, opening: Floats) -> Floats:
        """Values (..., m) of the finger joints for openings (...)."""
        columns = [np.interp(opening, self.openings, column) for column in self.finger_table.T]
        return np.stack(columns, axis=-1)

    def opening_of(self, values: Sequence[float]) -> float:
        """The opening at which the finger joints have some values (m,): where they do not
        belong together, the mean of what each of them says."""
        found = []
        for value, column in zip(values, self.finger_table.T, strict=True):
            rises = column[-1] > column[0]
            xs, ys = (column, self.openings) if rises else (column[::-1], self.openings[::-1])
            found.append(np.interp(value, xs, ys))
        return float(np.mean(found))

    def joint(self, name: str) -> Joint:
        """The joint of a name."""
        return next(joint for joint in self.urdf.joints.values() if joint.name == name)


@dataclass(frozen=True)
class RuleText:
    """Where a rule stands: index of the text, half-open range of characters in it."""

    name: str
    text: int
    start: int
    end: int


@dataclass(frozen=True)
class TraceSketch:
    """The sketch as it was written: texts (name, content), the main file first; its features
    as (name, `bool` or `nat`); its rules."""

    name: str
    texts: tuple[tuple[str, str], ...]
    features: tuple[tuple[str, str], ...]
    rules: tuple[RuleText, ...]


@dataclass(frozen=True)
class TraceSubgoal:
    """One subplan: its rule, when it starts and ends, feature values by name there, and the
    effort of its search; `rejected` counts candidates by the step of X that refused them."""

    rule: str
    start: float
    end: float
    before: Mapping[str, int]
    after: Mapping[str, int]
    expanded: int
    generated: int
    attempt: int
    width: int
    rejected: Mapping[str, int]


@dataclass(frozen=True)
class TraceAction:
    """One action: its name in the domain, one line for people, the body that it grips or lets
    go, if there is one, and the feature values after it by name, where they are known."""

    name: str
    text: str
    subgoal: int
    object: str | None
    start: float
    end: float
    values: Mapping[str, int] | None = None


@dataclass(frozen=True)
class Grip:
    """From `start` to `time` the fingers close on an object, or let it go."""

    start: float
    time: float
    object: str
    attach: bool


@dataclass(frozen=True)
class Event:
    """Something that happened besides the plan: a disturbance, a slip, a verdict."""

    time: float
    kind: str
    text: str


@dataclass(frozen=True, eq=False)
class Span:
    """From `start` on, an object moves with a frame (`WORLD` or a link): its poses (k, 7)
    there at times (k,), of the middle of its bottom; x, y, z and quaternion x, y, z, w."""

    start: float
    frame: str
    times: Floats
    poses: Floats

    def at(self, time: float) -> Floats:
        """The pose (7,) in the frame at a time: positions on a line, the nearer rotation."""
        if len(self.times) == 1:
            pose: Floats = self.poses[0]
            return pose
        after = int(np.clip(np.searchsorted(self.times, time), 1, len(self.times) - 1))
        before = after - 1
        span = self.times[after] - self.times[before]
        share = float(np.clip((time - self.times[before]) / span, 0.0, 1.0)) if span > 0 else 1.0
        return between(self.poses[before], self.poses[after], share)


@dataclass(frozen=True, eq=False)
class Trace:
    """What a robot did or is to do. `source` is `"plan"` or `"execution"`.

    Tracks: `base` (x, y, heading), `joints` (the planning joints), `opening` of the gripper.
    `objects` are the spans of each movable of the world, in its order; `guided` those of fixed
    things that are moved along their guides, by name.
    """

    source: str
    tool_version: str
    sketch: TraceSketch
    world: World
    robot: TraceRobot
    planner: str
    seed: int
    duration: float
    subgoals: tuple[TraceSubgoal, ...]
    actions: tuple[TraceAction, ...]
    base: Track
    joints: Track
    opening: Track
    grips: tuple[Grip, ...]
    objects: tuple[tuple[Span, ...], ...]
    events: tuple[Event, ...] = ()
    guided: Mapping[str, tuple[Span, ...]] = field(default_factory=dict)

    def span(self, index: int, time: float) -> Span:
        """What moves an object at a time."""
        return span_at(self.objects[index], time)

    def held_at(self, index: int, time: float) -> bool:
        """Whether a link carries an object at a time."""
        return self.span(index, time).frame != WORLD


def span_at(spans: Sequence[Span], time: float) -> Span:
    """The span of a time."""
    return next((span for span in reversed(spans) if span.start <= time), spans[0])
