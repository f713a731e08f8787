"""Whether two things keep apart on the straight line between two configurations.

A plane that is clear of both at both ends is clear of both in between as well, but for how far a
point leaves the straight line between its two places: an eighth of its largest acceleration in
unit time, which is the square of a small number (`bend`). How far things move at all, which is
what other tests go by, is a small number itself: neighbouring links, and fingers beside an object,
would have to be looked at every half millimetre.

A question has two numbers: a part, and an obstacle b or, as -1 - b, another part, of a frame that
is not further in.
"""

from __future__ import annotations

import math

import numpy as np

from runtime.kernels.arm import (
    CLOSE,
    ROUGH,
    forward,
    gap_between_parts,
    gap_to_obstacle,
    place_boxes,
)
from runtime.kernels.boxes import gap_to_pose, gap_to_upright, pose_vs_pose, pose_vs_upright
from runtime.kernels.compiled import njit

DEEP = 30
"""So often a line is halved; then it counts as touching."""


@njit(cache=True)
def gap_to_box(poses, half, radius, boxes, a, b, margin, enough):  # type: ignore[no-untyped-def]
    """A lower bound of at least the margin on the distance between part a, parts at their poses
    (m, 3, 4), and obstacle b, both as boxes; -1 where they come within the margin. Nobody asks
    for more than `enough`."""
    gap = gap_to_upright(poses[a], half[a], radius[a], boxes[b], enough)
    if gap < margin:
        if pose_vs_upright(poses[a], half[a], radius[a], boxes[b], margin):
            return -1.0
        return margin
    return gap


@njit(cache=True)
def gap_of_parts(poses, half, radius, a, b, margin, enough):  # type: ignore[no-untyped-def]
    """The same for parts a and b."""
    dx = poses[a, 0, 3] - poses[b, 0, 3]
    dy = poses[a, 1, 3] - poses[b, 1, 3]
    dz = poses[a, 2, 3] - poses[b, 2, 3]
    gap = math.sqrt(dx * dx + dy * dy + dz * dz) - radius[a] - radius[b]
    if gap >= enough:
        return gap
    gap = max(gap, gap_to_pose(poses[a], half[a], poses[b], half[b]))
    if gap < margin:
        if pose_vs_pose(poses[a], half[a], poses[b], half[b], margin):
            return -1.0
        return margin
    return gap


@njit(cache=True)
def gap_of_solids(body, obstacles, poses, a, b, margin, enough):  # type: ignore[no-untyped-def]
    """The same for the two of a question, one of which is not exactly its box."""
    if b >= 0:
        gap = gap_to_obstacle(body, a, poses[a], obstacles, b, margin, enough, ROUGH)
    else:
        gap = gap_between_parts(body, a, poses[a], -1 - b, poses[-1 - b], margin, enough, ROUGH)
    return gap if gap >= margin else -1.0


@njit(cache=True)
def bend(prismatic, sweep, first, last, start, end):  # type: ignore[no-untyped-def]
    """How far a point of frame `last`, as seen from frame `first`, is from the straight line
    between its places at two configurations (n,) while the joints go straight, at most.

    The share of joints j <= k in its acceleration is, where j turns, the velocity of the point by
    k turned by j; where j slides it is nothing.
    """
    turning = 0.0
    total = 0.0
    for k in range(first, last):
        step = abs(end[k] - start[k])
        own = 0.0 if prismatic[k] else step
        total += sweep[last, k] * step * (own + 2.0 * turning)
        turning += own
    return total / 8.0


@njit(cache=True)
def relate(poses, boxes, a, b, out):  # type: ignore[no-untyped-def]
    """Write the pose (3, 4) of one of a question in the frame of the other: of part a in that of
    the obstacle, or of the other part in that of part a."""
    if b >= 0:
        c, s = boxes[b, 6], boxes[b, 7]
        for j in range(3):
            out[0, j] = c * poses[a, 0, j] + s * poses[a, 1, j]
            out[1, j] = c * poses[a, 1, j] - s * poses[a, 0, j]
            out[2, j] = poses[a, 2, j]
        dx, dy = poses[a, 0, 3] - boxes[b, 0], poses[a, 1, 3] - boxes[b, 1]
        out[0, 3] = c * dx + s * dy
        out[1, 3] = c * dy - s * dx
        out[2, 3] = poses[a, 2, 3] - boxes[b, 2]
        return
    o = -1 - b
    dx = poses[o, 0, 3] - poses[a, 0, 3]
    dy = poses[o, 1, 3] - poses[a, 1, 3]
    dz = poses[o, 2, 3] - poses[a, 2, 3]
    for i in range(3):
        x, y, z = poses[a, 0, i], poses[a, 1, i], poses[a, 2, i]
        for j in range(3):
            out[i, j] = x * poses[o, 0, j] + y * poses[o, 1, j] + z * poses[o, 2, j]
        out[i, 3] = x * dx + y * dy + z * dz


@njit(cache=True)
def clearance(before, after, half_a, half_b):  # type: ignore[no-untyped-def]
    """The widest gap between two boxes that one plane shows at both of two poses (3, 4) of the
    second in the frame of the first: the planes are along their faces."""
    best = -np.inf
    for i in range(3):
        x, y = before[i, 3], after[i, 3]
        if x * y <= 0.0:
            continue
        gap = abs(x)
        later = abs(y)
        for j in range(3):
            gap -= half_b[j] * abs(before[i, j])
            later -= half_b[j] * abs(after[i, j])
        best = max(best, min(gap, later) - half_a[i])
    for which in range(2):
        at = before if which == 0 else after
        for c in range(3):
            ux, uy, uz = at[0, c], at[1, c], at[2, c]
            x = ux * before[0, 3] + uy * before[1, 3] + uz * before[2, 3]
            y = ux * after[0, 3] + uy * after[1, 3] + uz * after[2, 3]
            if x * y <= 0.0:
                continue
            gap = abs(x)
            later = abs(y)
            for j in range(3):
                gap -= half_b[j] * abs(ux * before[0, j] + uy * before[1, j] + uz * before[2, j])
                later -= half_b[j] * abs(ux * after[0, j] + uy * after[1, j] + uz * after[2, j])
            own = half_a[0] * abs(ux) + half_a[1] * abs(uy) + half_a[2] * abs(uz)
            best = max(best, min(gap, later) - own)
    return best


@njit(cache=True)
def ends_show(  # type: ignore[no-untyped-def]
    prismatic, sweep, half, boxes, a, b, first, last, start, end, before, after, margin, rel
):
    """Whether the two of a question certainly keep half the margin on the line between two
    configurations (n,), at which parts are at poses (m, 3, 4), by what is seen there. Joints
    from `first` to before `last` move them apart; `rel` is scratch."""
    relate(before, boxes, a, b, rel[0])
    relate(after, boxes, a, b, rel[1])
    if b >= 0:
        clear = clearance(rel[0], rel[1], boxes[b, 3:6], half[a])
    else:
        clear = clearance(rel[0], rel[1], half[a], half[-1 - b])
    return clear - bend(prismatic, sweep, first, last, start, end) >= 0.5 * margin


@njit(cache=True)
def line_is_free(  # type: ignore[no-untyped-def]
    chain, body, obstacles, sweep, a, b, first, last, start, end, before, after, margin
):
    """Whether they do, by what is seen at as many places in between as it takes."""
    half, radius, boxes = body.half, body.radius, obstacles.rows
    half_a, half_b = (boxes[b, 3:6], half[a]) if b >= 0 else (half[a], half[-1 - b])
    exact = body.shape[a] < 0 and (obstacles.shape[b] if b >= 0 else body.shape[-1 - b]) < 0
    moved = 0.0
    for j in range(first, last):
        moved += sweep[last, j] * abs(end[j] - start[j])
    bent = bend(chain.prismatic, sweep, first, last, start, end)
    frames = np.empty((start.shape[0] + 1, 3, 4))
    poses = np.empty(before.shape)
    # The next stretch is from `now`, where they are to each other as rel[0] says, to the last of
    # `ends`, where they are as rel[left] says.
    rel = np.empty((DEEP + 3, 3, 4))
    ends = np.empty(DEEP + 2)
    relate(before, boxes, a, b, rel[0])
    relate(after, boxes, a, b, rel[1])
    now = 0.0
    ends[0] = 1.0
    left = 1
    while left > 0:
        until = ends[left - 1]
        share = until - now
        bound = bent * share * share
        free = clearance(rel[0], rel[left], half_a, half_b) - bound >= 0.5 * margin
        if not free:
            middle = now + share / 2
            forward(chain.origins, chain.prismatic, start + middle * (end - start), frames)
            place_boxes(frames, body.frame, body.pose, poses)
            way = moved * share / 2
            if b >= 0:
                gap = gap_to_box(poses, half, radius, boxes, a, b, margin, way + margin)
            else:
                gap = gap_of_parts(poses, half, radius, a, -1 - b, margin, way + margin)
            if not exact and gap < CLOSE:
                gap = gap_of_solids(body, obstacles, poses, a, b, margin, way + margin)
            if gap < 0.0 or left > DEEP:
                return False
            free = gap - 0.5 * margin >= way
            if not free:
                ends[left] = middle
                left += 1
                relate(poses, boxes, a, b, rel[left])
        if free:
            now = until
            rel[0] = rel[left]
            left -= 1
    return True
