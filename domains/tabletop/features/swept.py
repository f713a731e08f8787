"""Which approach directions are in whose way: the geometry behind the features u, v and I.

A gripper that comes in horizontally, with heading theta, sweeps two strips in the plane:
the fingers, from behind the palm's face to past the object, and the palm, wrist and forearm
behind them. Headings are a fixed set of K = 24, one bit each, so "the headings that object
j bars for an object at site s" is one integer.

`strip` = [finger back, finger tip, arm length, arm half width, finger thickness and play]:
metres; the first three along the approach, measured from the object's centre. Boxes are
packed as in `runtime.kernels.boxes`.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from runtime.kernels.plane import in_room, point_distance, segment_distance

HEADINGS = 24
STEP = 2.0 * math.pi / HEADINGS
ALL = (1 << HEADINGS) - 1
PLAY = 0.002
"""Metres kept between objects that stand side by side."""

UNREACHABLE = 1000
"""Added to the count of a heading from which the arm cannot come at all."""


@njit(cache=True)
def barred_headings(sx, sy, grips, box, strip):  # type: ignore[no-untyped-def]
    """Bits of the headings along which an upright box bars the way to a site (sx, sy).

    `grips[k]` is half the width of the gripped object across heading k. In the frame of an
    approach the box counts as the smallest box around it.
    """
    distance = point_distance(box, sx, sy)
    if distance > strip[2] + strip[3]:
        return 0
    least = grips[0]
    for k in range(1, HEADINGS):
        least = min(least, grips[k])
    if distance < least + PLAY:
        return ALL  # it stands where the object is, or is to be
    dx = box[0] - sx
    dy = box[1] - sy
    bits = 0
    for k in range(HEADINGS):
        c = math.cos(k * STEP)
        s = math.sin(k * STEP)
        along = c * dx + s * dy
        aside = abs(c * dy - s * dx)
        # The box in the frame of the approach.
        turn_c = abs(c * box[6] + s * box[7])
        turn_s = abs(c * box[7] - s * box[6])
        half_along = box[3] * turn_c + box[4] * turn_s
        half_aside = box[3] * turn_s + box[4] * turn_c
        low = along - half_along
        high = along + half_along
        if (high > -strip[0] and low < strip[1] and aside < grips[k] + strip[4] + half_aside) or (
            high > -strip[2] and low < -strip[0] and aside < strip[3] + half_aside
        ):
            bits |= 1 << k
    return bits


@njit(cache=True)
def barred_matrix(sites, grips, boxes, strip):  # type: ignore[no-untyped-def]
    """`barred_headings` for all sites (S, 2) with grips (S, K) and boxes (n, 8): (S, n)."""
    out = np.empty((sites.shape[0], boxes.shape[0]), dtype=np.int64)
    for i in range(sites.shape[0]):
        for j in range(boxes.shape[0]):
            out[i, j] = barred_headings(sites[i, 0], sites[i, 1], grips[i], boxes[j], strip)
    return out


@njit(cache=True)
def bar_counts(barred, present, reachable):  # type: ignore[no-untyped-def]
    """For each site and heading, how many of the present objects bar it: (S, K) of int32."""
    out = np.zeros((barred.shape[0], HEADINGS), dtype=np.int32)
    for i in range(barred.shape[0]):
        for j in range(barred.shape[1]):
            bits = barred[i, j] if present[j] else 0
            k = 0
            while bits:
                if bits & 1:
                    out[i, k] += 1
                bits >>= 1
                k += 1
        for k in range(HEADINGS):
            if not (reachable[i] >> k) & 1:
                out[i, k] += UNREACHABLE
    return out


@njit(cache=True)
def shifted_counts(counts, gone, come):  # type: ignore[no-untyped-def]
    """Counts (S, K) after one object has moved: `gone` (S,) are the headings that it barred
    before, `come` those that it bars now."""
    out = counts.copy()
    for i in range(counts.shape[0]):
        changed = gone[i] ^ come[i]
        if changed:
            for k in range(HEADINGS):
                out[i, k] += ((come[i] >> k) & 1) - ((gone[i] >> k) & 1)
    return out


@njit(cache=True)
def residue_minima(counts, minus, plus, modulus):  # type: ignore[no-untyped-def]
    """Fewest barring objects over the sites, by heading modulo `modulus`: (modulus,).

    `minus` and `plus` (S,) are headings barred by an object to be left out of the counts
    and by one to be added.
    """
    out = np.full(modulus, 2 * UNREACHABLE, dtype=np.int64)
    for i in range(counts.shape[0]):
        for k in range(HEADINGS):
            value = counts[i, k] - ((minus[i] >> k) & 1) + ((plus[i] >> k) & 1)
            r = k % modulus
            out[r] = min(out[r], value)
    return out


@njit(cache=True)
def least_union(pick, pick_reachable, place, place_reachable, counted, modulus, turn):  # type: ignore[no-untyped-def]
    """Fewest objects that bar one heading to an object or one heading to a site of its goal.

    `pick` (n,) and `place` (S, n) are headings that each object bars, `counted` (n,) tells
    which objects are there. The heading at the site is that to the object plus `turn`,
    modulo `modulus`. An object that bars both headings counts once.
    """
    words = (len(counted) + 62) // 63
    before = np.zeros((HEADINGS, words), dtype=np.int64)
    after = np.zeros((HEADINGS, words), dtype=np.int64)
    _transpose(pick, counted, before)
    best = 2 * UNREACHABLE
    for i in range(place.shape[0]):
        after[:] = 0
        _transpose(place[i], counted, after)
        for k in range(HEADINGS):
            if not (pick_reachable >> k) & 1 or _bits(before[k]) >= best:
                continue
            for m in range((k + turn) % modulus, HEADINGS, modulus):
                if (place_reachable[i] >> m) & 1:
                    best = min(best, _bits(before[k] | after[m]))
    return best


@njit(cache=True)
def _transpose(barred, counted, sets):  # type: ignore[no-untyped-def]
    """From the headings that each object bars to the set of objects that bar each heading,
    63 objects a word."""
    for j in range(len(counted)):
        if counted[j]:
            for k in range(HEADINGS):
                sets[k, j // 63] |= ((barred[j] >> k) & 1) << (j % 63)


@njit(cache=True)
def _bits(words):  # type: ignore[no-untyped-def]
    """How many bits of some words are set."""
    count = 0
    for word in words:
        while word:
            word &= word - 1
            count += 1
    return count


@njit(cache=True)
def reachable_headings(  # type: ignore[no-untyped-def]
    sites, strip, shoulder, tool_offset, inner, outer, low, high,
    room, x0, y0, cell, statics, clearance,
):  # fmt: skip
    """Bits of the headings at each site (S, 2) for which the robot can get to where it
    would have to stand (`runtime.motion.room`).

    The wrist is `tool_offset` behind the site and must be between `inner` and `outer` from
    the shoulder axis, which is `shoulder` (2,) in the base frame. Static boxes that reach
    into heights low..high bar the strip of the arm.
    """
    out = np.zeros(sites.shape[0], dtype=np.int64)
    for i in range(sites.shape[0]):
        x = sites[i, 0]
        y = sites[i, 1]
        for k in range(HEADINGS):
            c = math.cos(k * STEP)
            s = math.sin(k * STEP)
            barred = False
            for w in range(statics.shape[0]):
                if statics[w, 2] + statics[w, 5] > low and statics[w, 2] - statics[w, 5] < high:
                    back = strip[2]
                    if (
                        segment_distance(
                            statics[w],
                            x - strip[0] * c,
                            y - strip[0] * s,
                            x - back * c,
                            y - back * s,
                        )
                        < strip[3]
                        or segment_distance(statics[w], x + strip[1] * c, y + strip[1] * s, x, y)
                        < 0.5 * strip[3]
                    ):
                        barred = True
                        break
            if not barred and _has_stand(
                x - tool_offset * c, y - tool_offset * s, x, y, k, shoulder, inner, outer,
                room, x0, y0, cell, statics, clearance,
            ):  # fmt: skip
                out[i] |= 1 << k
    return out


@njit(cache=True)
def _has_stand(  # type: ignore[no-untyped-def]
    wx, wy, x, y, k, shoulder, inner, outer, room, x0, y0, cell, statics, clearance
):
    """Whether some base position, on a coarse fan around the wrist, is clear."""
    for turn in range(13):
        # Straight behind the gripper first, then further and further aside.
        offset = (turn + 1) // 2 * (1.0 if turn % 2 else -1.0) * 0.2
        heading = k * STEP + offset
        for ring in range(4):
            reach = outer - ring * (outer - inner) / 4.0
            hx = wx - reach * math.cos(heading)
            hy = wy - reach * math.sin(heading)
            # The base faces the object.
            yaw = math.atan2(y - hy, x - hx)
            c = math.cos(yaw)
            s = math.sin(yaw)
            bx = hx - c * shoulder[0] + s * shoulder[1]
            by = hy - s * shoulder[0] - c * shoulder[1]
            if in_room(room, x0, y0, cell, statics, clearance, bx, by):
                return True
    return False


@njit(cache=True)
def occupied_sites(sites, radius, boxes, skip):  # type: ignore[no-untyped-def]
    """Whether something round at each site (S, 2) would overlap one of the boxes (n, 8),
    the one with index `skip` left out: (S,) of bool."""
    out = np.zeros(sites.shape[0], dtype=np.bool_)
    for i in range(sites.shape[0]):
        for j in range(boxes.shape[0]):
            if j != skip and point_distance(boxes[j], sites[i, 0], sites[i, 1]) < radius + PLAY:
                out[i] = True
                break
    return out


@njit(cache=True)
def nearest_static(x, y, statics, low, high):  # type: ignore[no-untyped-def]
    """Distance from a point to the nearest static box that reaches into heights low..high."""
    best = math.inf
    for w in range(statics.shape[0]):
        if statics[w, 2] + statics[w, 5] > low and statics[w, 2] - statics[w, 5] < high:
            best = min(best, point_distance(statics[w], x, y))
    return best


@njit(cache=True)
def least_barred(counts, minus):  # type: ignore[no-untyped-def]
    """Bits (S,) of the headings that fewest objects bar, over all sites; `minus` (S,) are
    headings barred by an object to be left out of the counts (S, K)."""
    best = np.int64(2 * UNREACHABLE)
    for i in range(counts.shape[0]):
        for k in range(HEADINGS):
            best = min(best, counts[i, k] - ((minus[i] >> k) & 1))
    out = np.zeros(counts.shape[0], dtype=np.int64)
    for i in range(counts.shape[0]):
        for k in range(HEADINGS):
            if counts[i, k] - ((minus[i] >> k) & 1) == best:
                out[i] |= 1 << k
    return out


@njit(cache=True)
def leaves_open(headings, sites, grips, box, strip):  # type: ignore[no-untyped-def]
    """Whether an upright box leaves one of the headings (S,) to sites (S, 2) open."""
    for i in range(sites.shape[0]):
        if headings[i] and headings[i] & ~barred_headings(
            sites[i, 0], sites[i, 1], grips[i], box, strip
        ):
            return True
    return False
