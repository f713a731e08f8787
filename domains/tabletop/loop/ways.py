"""Where the arm can go from where it is, among what is seen now, whether that stands or lies.

While nothing went wrong the arm follows its plan, and none of this is asked.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from domains.tabletop.actions.executability import REACH
from domains.tabletop.loop.sensing import LOOKS, Seen, Senses
from domains.tabletop.scene.model import Scene, UprightBox
from runtime.kernels.boxes import to_base_frame
from runtime.motion import rrt
from runtime.motion.arm_context import CONTACT_MARGIN, ArmContext
from runtime.motion.timing import time_path
from runtime.robot.model import Floats, RobotModel
from runtime.trace.model import WORLD, Trace
from runtime.trace.track import Track, TrackBuilder
from runtime.world.body import Part
from runtime.world.poses import compose
from runtime.world.quaternions import matrix
from runtime.world.solids import smaller

SAMPLE = 0.05
"""Seconds between the configurations of a trace that are tested; in between, collision tests
bound how far the arm moves."""

SAME_OPENING = 1e-4
"""Metres by which the fingers' opening changes where it counts as constant."""

RESTING = 0.004
"""Metres by which a held object is taken for smaller: it may still stand on its table."""

TURNS = 4
"""Configurations on the way back from which a new way home is sought, the furthest first."""

WIDER = (0.02, 0.01, 0.0)
"""Metres by which empty fingers may open further before the arm goes back."""


class Ways:
    """Ways of the arm of one robot, standing where it is, in one scene."""

    def __init__(self, robot: RobotModel, scene: Scene, senses: Senses, seed: int) -> None:
        self.robot, self.scene, self.senses, self.seed = robot, scene, senses, seed
        self.physics = senses.physics

    def on_is_free(self, trace: Trace, start: float, end: float) -> bool:
        """Whether the arm can go on with a trace from a time to another."""
        times = _times(start, end)
        joints, openings = trace.joints.at(times)[0], trace.opening.at(times)[0][:, 0]
        seen, handled = self.senses.look(LOOKS), self._handled(trace, start, end)
        # Fingers move, and grip or let go, while the arm stands still: one test for each opening.
        changes = np.flatnonzero(np.abs(np.diff(openings)) > SAME_OPENING) + 1
        for stretch in np.split(np.arange(len(times)), changes):
            opening, middle = float(openings[stretch[0]]), float(times[stretch[len(stretch) // 2]])
            context = self._later(trace, seen, handled, middle, opening)
            if not context.path_is_free(joints[stretch], CONTACT_MARGIN):
                return False
        return True

    def _handled(self, trace: Trace, start: float, end: float) -> int | None:
        """The object that is gripped or put down between two times of a trace, or held."""
        if self.physics.held is not None:
            return self.physics.held
        names = [thing.name for thing in self.scene.objects]
        gripped = [names.index(g.object) for g in trace.grips if start < g.time <= end]
        return gripped[0] if gripped else None

    def _later(
        self, trace: Trace, seen: Seen, handled: int | None, time: float, opening: float
    ) -> ArmContext:
        """Collision tests at a time of a trace: what the arm handles is where the trace will
        have it, everything else where it is seen now."""
        held = self._held(seen)
        if handled is not None:
            span = trace.span(handled, time)
            if span.frame != WORLD and not held:
                held = self._in_tool(handled, matrix(span.at(time)))
                seen = replace(seen, held=handled)
            elif span.frame == WORLD and held:
                objects = list(seen.objects)
                objects[handled] = span.at(time)
                held, seen = (), replace(seen, held=None, objects=tuple(objects))
        return self._context(seen, opening, held)

    def home(self, trace: Trace, start: float, end: float) -> tuple[float, Track] | None:
        """A way from where the arm is at `end` of a trace to its home posture, where it was at
        `start`, and the opening of the fingers (m) for it; None where there is none.

        Back the way it came is best, with the fingers, if empty, as wide as there is room.
        Where that is barred, it goes back as far as is free and from there a new way.
        """
        back = _joints(trace, start, end)[::-1]
        seen = self.senses.look(LOOKS)
        held = self._held(seen)
        tests = [(o, self._context(seen, o, held)) for o in self._openings()]
        for opening, context in tests:
            if _free_points(context, back) == len(back):
                return opening, _reversed(trace, start, end)
        for opening, context in tests:
            path = self._anew(context, back)
            if path is not None:
                return opening, self._timed(path)
        return None

    def _openings(self) -> list[float]:
        now = self.physics.opening()
        if self.physics.held is not None:
            return [now]
        return [min(now + more, self.robot.gripper.max_opening) for more in WIDER]

    def _anew(self, context: ArmContext, back: Floats) -> Floats | None:
        """Back along a way (k, n) as far as is free, or less, and home from there."""
        free = _free_points(context, back)
        if not free:
            return None
        turns = {(free - 1) * k // (TURNS - 1) for k in range(TURNS)}
        for turn in sorted(turns, reverse=True):
            found = rrt.plan(context, back[turn], self.robot.home, self.seed)
            if found is not None:
                return np.vstack([back[: turn + 1], found[1:]])
        return None

    def _timed(self, path: Floats) -> Track:
        points, times = time_path(path, self.robot.velocity, self.robot.acceleration)
        builder = TrackBuilder(points[0])
        builder.through(points, times)
        return builder.track()

    def _context(self, seen: Seen, opening: float, held: Sequence[Part]) -> ArmContext:
        """Collision tests among what is seen, with the fingers `opening` metres apart."""
        rows = to_base_frame(seen_rows(self.scene, seen), *map(float, seen.base), REACH)
        return ArmContext(self.robot, self.robot.body(opening, held), rows)

    def _held(self, seen: Seen) -> tuple[Part, ...]:
        """The solids of what the gripper holds now, in the tool frame."""
        if seen.held is None:
            return ()
        tool = np.linalg.inv(self.physics.tool_matrix())
        return self._in_tool(seen.held, tool @ matrix(seen.objects[seen.held]))

    def _in_tool(self, index: int, pose: Floats) -> tuple[Part, ...]:
        """The solids of an object in the tool frame, by the pose (4, 4) of its body there."""
        parts = self.scene.world.movables[index].body.parts
        return tuple(Part(smaller(p.solid, RESTING), compose(pose[:3], p.pose)) for p in parts)


def _joints(trace: Trace, start: float, end: float) -> Floats:
    """Planning joints (k, n) of a trace from a time to another."""
    return trace.joints.at(_times(start, end))[0]


def _times(start: float, end: float) -> Floats:
    return np.linspace(start, end, max(2, math.ceil((end - start) / SAMPLE)))


def _free_points(context: ArmContext, path: Floats) -> int:
    """How many configurations of a path (k, n) can be reached along it."""
    if context.collides(path[0], CONTACT_MARGIN):
        return 0
    for index in range(len(path) - 1):
        if not context.path_is_free(path[index : index + 2], CONTACT_MARGIN):
            return index + 1
    return len(path)


def _reversed(trace: Trace, start: float, end: float) -> Track:
    """The planning joints of a trace from `end` back to `start`, from rest to rest."""
    times = _times(start, end)
    values, speeds = trace.joints.at(times)
    speeds[[0, -1]] = 0.0
    return Track((end - times)[::-1], values[::-1], -speeds[::-1])


def seen_rows(scene: Scene, seen: Seen) -> Floats:
    """Boxes (k, 8) in the world around everything that is seen and not held: obstacles, and
    objects however they stand or lie."""
    boxes = [
        enclosing_box(matrix(pose), scene.objects[index].size).row()
        for index, pose in enumerate(seen.objects)
        if index != seen.held
    ]
    return np.vstack([scene.obstacle_rows, *boxes])


def enclosing_box(pose: Floats, size: tuple[float, float, float]) -> UprightBox:
    """The smallest upright box around a box of a size, by the pose (4, 4) of its bottom, with
    a heading of one of the box's own axes: of a box that stands or lies, the box itself."""
    half = np.array(size) / 2
    turn = pose[:3, :3]
    x, y, z = pose[:3, 3] + half[2] * turn[:, 2]
    found = []
    for axis in turn.T:
        if np.hypot(axis[0], axis[1]) < 0.1:  # no heading to speak of
            continue
        yaw = math.atan2(axis[1], axis[0])
        c, s = math.cos(yaw), math.sin(yaw)
        around = 2 * np.abs(np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) @ turn) @ half
        found.append(UprightBox((x, y, z), (around[0], around[1], around[2]), yaw))
    return min(found, key=lambda box: math.prod(box.size))
