"""From one manipulation to the next: hand out, arm folded, base there, arm unfolded, hand in.

All of it overlaps as far as it is free. The arm folds while the base starts and unfolds while it
arrives, as early and as late as no row of the motion touches anything; where the base has a short
way the arm does not fold all the way; joints that would lose time by a detour to the driving
posture, slow lifts first, go straight to where they are needed next. Every choice is tested as a
whole, base and arm at once; what is known to be free without any overlap comes last.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runtime.kernels import follow
from runtime.motion.arm_context import CONTACT_MARGIN, FREE_MARGIN
from runtime.motion.course import (
    TICK,
    Limits,
    add,
    course,
    join,
    least_time,
    line,
    stretches,
    with_stops,
)
from runtime.motion.whole import Whole
from runtime.robot.model import Floats

Mask = NDArray[np.bool_]

DETOUR = 0.6
"""Seconds that a joint may lose by going to its driving posture in between; slower ones do not."""

STEPS = (0.0, 0.5, 1.0)
"""Shares of folding that are done before the base starts, in the order in which they are tried."""


@dataclass(frozen=True, eq=False)
class Leg:
    """What the arm does at one end of a transit: `free` (p, n) is the way between the driving
    posture and where the hand is clear of the object, `near` are the lines (p, n) from there to
    the object. Both run towards the object where the arm unfolds, away from it where it folds."""

    free: Floats
    near: tuple[Floats, ...] = ()


@dataclass(frozen=True, eq=False)
class Fingers:
    """How the fingers move in a transit: openings (k,) a tick apart, the last one kept, and the
    robot with the fingers as they are before and after."""

    openings: Floats
    before: Whole
    after: Whole


@dataclass(frozen=True, eq=False)
class Transit:
    """Rows (m, 3 + n) of base and configuration a tick apart, openings (m,), and the ticks at
    which the hand is out, and the base is where the next manipulation is."""

    rows: Floats
    openings: Floats
    out: int
    there: int

    @property
    def seconds(self) -> float:
        """How long it takes."""
        return TICK * (len(self.rows) - 1)


@dataclass(frozen=True, eq=False)
class Question:
    """From `leave` to `come`, with one of some `drives` (rows (k, 3) each, quickest first)."""

    leave: Leg
    come: Leg
    drives: Sequence[Floats]
    fingers: Fingers
    limits: Limits


def transit(asked: Question) -> Transit:
    """The quickest motion that was found to be free."""
    out = _near(asked, asked.leave.near, asked.drives[0][0], asked.fingers.before)
    into = _near(asked, asked.come.near, asked.drives[0][-1], asked.fingers.after)
    slow = _slow_choices(asked)
    choices = [*((joints, True) for joints in slow), (slow[-1], False)]
    arms: list[_Arm] = []
    for drive in asked.drives:
        for number, (joints, blended) in enumerate(choices):
            if number == len(arms):
                arms.append(_Arm.of(asked, out, into, joints, blended))
            found = _overlapped(asked, arms[number], drive)
            if found is not None:
                return found
    return _in_turn(asked, out, into)


def _near(asked: Question, lines: Sequence[Floats], stand: Floats, whole: Whole) -> Floats:
    """Rows (k, n) along the lines near an object; none where there are none."""
    if not lines:
        return np.empty((0, asked.leave.free.shape[1]))
    courses = [course(path, asked.limits) for path in lines]

    def free(rows: Floats) -> bool:
        return whole.is_free(_standing(stand, rows), CONTACT_MARGIN)

    checked = [
        rows if len(path) == 2 or free(rows) else with_stops(path, asked.limits)
        for rows, path in zip(courses, lines, strict=True)
    ]
    return join(checked, asked.limits, free)[0]


def _standing(stand: Floats, rows: Floats) -> Floats:
    whole: Floats = follow.with_base(stand[None], rows, 0)
    return whole


def _slow_choices(asked: Question) -> list[Mask]:
    """Joints that leave out the driving posture: those that would lose time, else none."""
    start, end = asked.leave.free[0], asked.come.free[-1]
    home, limits = asked.leave.free[-1], asked.limits
    rows = zip(start, home, end, limits.velocity, limits.acceleration, limits.jerk, strict=True)
    slow = np.zeros(len(home), dtype=np.bool_)
    for k, (a, h, b, *limit) in enumerate(rows):
        through = least_time(abs(h - a), *limit) + least_time(abs(b - h), *limit)
        slow[k] = through - least_time(abs(b - a), *limit) > DETOUR
    return [slow, np.zeros_like(slow)] if slow.any() else [slow]


@dataclass(frozen=True, eq=False)
class _Arm:
    """Rows of the arm that leaves and of the arm that comes; of the one the ticks at which it
    begins to fold and the hand is out, of the other those at which the hand begins to go in and
    the unfolding is over; and rows of the joints that go straight there."""

    leaving: Floats
    folds: int
    out: int
    coming: Floats
    into: int
    unfolded: int
    straight: Floats

    @classmethod
    def of(cls, asked: Question, out: Floats, into: Floats, slow: Mask, blended: bool) -> _Arm:
        """`blended` is whether corners are cut: folding may begin before the hand is out, and the
        hand may go in before the arm is unfolded."""
        fold, unfold = asked.leave.free.copy(), asked.come.free.copy()
        start, end = fold[0].copy(), unfold[-1].copy()
        fold[:, slow], unfold[:, slow] = start[slow], end[slow]
        limits = asked.limits
        folding = _smooth(fold, limits, blended)
        unfolding = _smooth(unfold, limits, blended)
        leaving, folds = _put_together(out, folding, limits, blended)
        coming, goes_in = _put_together(unfolding, into, limits, blended)
        straight = line(np.where(slow, end - start, 0.0), limits)
        return cls(
            leaving, folds, max(0, len(out) - 1), coming, goes_in, len(unfolding) - 1, straight
        )

    @property
    def folded(self) -> int:
        """Ticks that the arm takes to fold, after the hand is out."""
        return len(self.leaving) - 1 - self.out


def _smooth(path: Floats, limits: Limits, blended: bool) -> Floats:
    """Rows along a path, with a stop at each sharp corner unless they are blended."""
    parts = [course(s, limits) for s in stretches(path)]
    if not parts:
        return path[:1]
    if blended:
        return join(parts, limits)[0]
    return np.vstack([parts[0], *(part[1:] for part in parts[1:])])


def _put_together(
    first: Floats, second: Floats, limits: Limits, blended: bool
) -> tuple[Floats, int]:
    """Two motions, one after the other, and the tick at which the second begins."""
    if not len(first):
        return second, 0
    if not len(second):
        return first, len(first) - 1
    if not blended:
        return np.vstack([first, second[1:]]), len(first) - 1
    rows, starts = join([first, second], limits)
    return rows, starts[1]


def _overlapped(asked: Question, arm: _Arm, drive: Floats) -> Transit | None:
    """A transit with one drive, overlapped as far as it is free; None where it is not free."""
    late = early = 0  # how late the base starts, how early it is there: numbers of STEPS
    apart = False  # whether the arm folds all the way before it unfolds
    while True:
        made = _made(asked, arm, drive, STEPS[late], STEPS[early], apart)
        hit = _first_hit(asked, arm, made)
        if hit is None:
            return made[0]
        _, start, end, into = made
        if hit < arm.out or hit >= into:
            return None
        if len(drive) > 1 and hit < (start + end) / 2 and late < len(STEPS) - 1:
            late += 1
        elif len(drive) > 1 and hit >= (start + end) / 2 and early < len(STEPS) - 1:
            early += 1
        elif not apart:
            apart = True
        else:
            return None


_Made = tuple[Transit, int, int, int]


def _made(
    asked: Question, arm: _Arm, drive: Floats, late: float, early: float, apart: bool
) -> _Made:
    """A transit, the ticks at which the base starts and ends, and that at which the arm unfolds;
    tested for limits only."""
    start = arm.out + round(late * arm.folded)
    end = start + len(drive) - 1
    straight = arm.out + len(arm.straight) - 1
    turning = len(asked.fingers.openings) - 1
    # When the hand goes in; by then the base is there, and so are fingers and straight joints, and
    # the arm that leaves is at rest: near an object the motion is that which was tested there.
    into = max(
        end + round(early * arm.into),
        straight,
        arm.out + turning,
        arm.out + arm.into,
        len(arm.leaving) - 1,
    )
    unfolds = into - arm.into
    if apart:
        unfolds = max(unfolds, len(arm.leaving) - 1)
    arm_rows, unfolds = follow.overlaid(
        arm.leaving, arm.straight, arm.out, arm.coming, unfolds, asked.limits.packed, TICK
    )
    into = unfolds + arm.into
    count = len(arm_rows)
    openings = asked.fingers.openings
    opens = into - turning
    openings = openings[np.clip(np.arange(count) - opens, 0, turning)]
    there = max(end, min(unfolds, into))
    rows = follow.with_base(drive, arm_rows, start)
    return Transit(rows, openings, arm.out, min(max(there, arm.out), into)), start, end, into


def _first_hit(asked: Question, arm: _Arm, made: _Made) -> int | None:
    """The first row at which a transit touches something on its free way."""
    found, _, _, into = made
    rows, fingers = found.rows, asked.fingers
    last = into - arm.into + arm.unfolded + 1
    hit = _shifted(fingers.before.first_hit(rows[arm.folds : last]), arm.folds)
    if hit is not None or fingers.before is fingers.after:
        return hit
    opens = max(arm.folds, into - len(fingers.openings) + 1)
    return _shifted(fingers.after.first_hit(rows[opens:last]), opens)


def _shifted(hit: int | None, by: int) -> int | None:
    return None if hit is None else hit + by


def _in_turn(asked: Question, out: Floats, into: Floats) -> Transit:
    """One after the other, on the ways that are known to be free."""
    drive = asked.drives[-1]
    fold = _surely(asked, asked.leave.free, drive[0], asked.fingers.before)
    unfold = _surely(asked, asked.come.free, drive[-1], asked.fingers.after)
    leaving = np.vstack([out[: len(out) - 1], fold]) if len(out) else fold
    coming = np.vstack([unfold, into[1:]]) if len(into) else unfold
    turning = len(asked.fingers.openings) - 1
    start, end = len(leaving) - 1, len(leaving) + len(drive) - 2
    # The fingers move in the driving posture, before the arm unfolds.
    unfolds = max(end, start + turning)
    arm_rows = add(leaving, coming, unfolds)
    openings = asked.fingers.openings[np.clip(np.arange(len(arm_rows)) - start, 0, turning)]
    rows = follow.with_base(drive, arm_rows, start)
    return Transit(rows, openings, max(0, len(out) - 1), unfolds)


def _surely(asked: Question, path: Floats, stand: Floats, whole: Whole) -> Floats:
    """Rows along a path that is free, smooth where that is free as well."""
    parts = [course(s, asked.limits) for s in stretches(path)]
    if not parts:
        return path[:1]
    rows, _ = join(parts, asked.limits)
    if whole.is_free(_standing(stand, rows), FREE_MARGIN):
        return rows
    return with_stops(path, asked.limits)
