"""Which approaches are in whose way: the geometry behind the features u, v and I.

A hand that comes to an object sweeps the volume of its fingers, on both sides of what they
grip, and that of palm, wrist and forearm: a few boxes in the frame of the approach, which has
its origin at the grasp centre, x along the heading and z up. Headings are a fixed set of
K = 24, one bit each, so "the headings that object j bars for an object at site s" is one
integer. All functions are about one family of approaches (`domains.tabletop.state`).

A *site* is (x, y, z): the middle of an object's bottom. A *hand* is the rows (v, 7) of the
volumes: lowest and highest x, y and z, and 1 or 2 where y or z is widened by half of the width
that the fingers grip. A *hold* is (K, 3): half that width, and where the grasp centre is, along
the heading and aside of it; `height` is that of the centre above the bottom. Boxes are packed
as in `runtime.kernels.boxes`.
"""

from __future__ import annotations

import math

import numpy as np

from runtime.kernels.compiled import njit
from runtime.kernels.plane import in_room, point_distance

HEADINGS = 24
STEP = 2.0 * math.pi / HEADINGS
ALL = (1 << HEADINGS) - 1
COS = np.cos(np.arange(HEADINGS) * STEP)
SIN = np.sin(np.arange(HEADINGS) * STEP)
FAN = tuple((turn + 1) // 2 * (1.0 if turn % 2 else -1.0) * 0.2 for turn in range(13))
"""Radians by which stands are looked for aside of a heading: straight behind the gripper first,
then further and further away."""

FAN_COS = np.array([[math.cos(k * STEP + offset) for offset in FAN] for k in range(HEADINGS)])
FAN_SIN = np.array([[math.sin(k * STEP + offset) for offset in FAN] for k in range(HEADINGS)])
PLAY = 0.002
"""Metres kept between objects that stand side by side."""

UNREACHABLE = 1_000_000
"""Added to the count of a heading from which the arm cannot come at all."""

BETWEEN = 0.25
"""Share of a step beyond which a heading is between two."""

LEVEL = 1e-3
"""Metres by which things above each other may overlap in height and count as apart."""


def heading_bit(heading: float) -> int:
    """The number of the heading (radians) that is nearest."""
    return round(heading / STEP) % HEADINGS


def near_headings(heading: float) -> int:
    """Bits of the headings next to one (radians): one, or two where it is between them."""
    place = heading / STEP
    low = math.floor(place)
    near = {low + (place - low > BETWEEN), low + (place - low > 1 - BETWEEN)}
    return sum(1 << k % HEADINGS for k in near)


@njit(cache=True)
def extent(hand):  # type: ignore[no-untyped-def]
    """How far, in the plane, the volumes of a hand reach from the grasp centre."""
    best = 0.0
    for v in range(hand.shape[0]):
        x = max(abs(hand[v, 0]), abs(hand[v, 1]))
        y = max(abs(hand[v, 2]), abs(hand[v, 3]))
        best = max(best, math.sqrt(x * x + y * y))
    return best


@njit(cache=True)
def barred_headings(sx, sy, sz, hold, height, own, box, hand, reach):  # type: ignore[no-untyped-def]
    """Bits of the headings along which an upright box bars the way to an object at a site.

    `own` is the inner radius and the height of that object: where the box stands in its place,
    it bars all. `reach` bounds how far from the site a box can matter. In the frame of an
    approach the box counts as the smallest box around it.
    """
    distance = point_distance(box, sx, sy)
    if distance > reach:
        return 0
    low = box[2] - box[5] - sz
    high = box[2] + box[5] - sz
    if distance < own[0] + PLAY and low < own[1] - LEVEL and high > LEVEL:
        return ALL  # it stands where the object is, or is to be
    low -= height
    high -= height
    dx = box[0] - sx
    dy = box[1] - sy
    bits = 0
    for k in range(HEADINGS):
        c = COS[k]
        s = SIN[k]
        along = c * dx + s * dy - hold[k, 1]
        aside = c * dy - s * dx - hold[k, 2]
        # The box in the frame of the approach.
        turn_c = abs(c * box[6] + s * box[7])
        turn_s = abs(c * box[7] - s * box[6])
        half_along = box[3] * turn_c + box[4] * turn_s
        half_aside = box[3] * turn_s + box[4] * turn_c
        for v in range(hand.shape[0]):
            wider = hold[k, 0] if hand[v, 6] == 1.0 else 0.0
            taller = hold[k, 0] if hand[v, 6] == 2.0 else 0.0
            if (
                along + half_along > hand[v, 0]
                and along - half_along < hand[v, 1]
                and aside + half_aside > hand[v, 2] - wider
                and aside - half_aside < hand[v, 3] + wider
                and high > hand[v, 4] - taller
                and low < hand[v, 5] + taller
            ):
                bits |= 1 << k
                break
    return bits


@njit(cache=True)
def barred_matrix(sites, holds, heights, owns, boxes, hand, play):  # type: ignore[no-untyped-def]
    """`barred_headings` for all sites (S, 3), with holds (S, K, 3), heights (S,) and own sizes
    (S, 2), and boxes (n, 8): (S, n). `play` metres are added to what a box can matter from."""
    out = np.empty((sites.shape[0], boxes.shape[0]), dtype=np.int64)
    wide = extent(hand) + play
    for i in range(sites.shape[0]):
        reach = wide + _farthest(holds[i])
        for j in range(boxes.shape[0]):
            out[i, j] = barred_headings(
                sites[i, 0], sites[i, 1], sites[i, 2], holds[i], heights[i], owns[i], boxes[j],
                hand, reach,
            )  # fmt: skip
    return out


@njit(cache=True)
def _farthest(hold):  # type: ignore[no-untyped-def]
    """How far a hold's grip and centre reach from the site, at most."""
    best = 0.0
    for k in range(hold.shape[0]):
        best = max(best, hold[k, 0] + abs(hold[k, 1]) + abs(hold[k, 2]))
    return best


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
def open_headings(sites, hold, height, own, statics, hand):  # type: ignore[no-untyped-def]
    """Bits of the headings at each site (S, 3) along which nothing fixed bars the way."""
    out = np.zeros(sites.shape[0], dtype=np.int64)
    reach = extent(hand) + _farthest(hold)
    for i in range(sites.shape[0]):
        barred = 0
        for w in range(statics.shape[0]):
            barred |= barred_headings(
                sites[i, 0], sites[i, 1], sites[i, 2], hold, height, own, statics[w], hand, reach
            )
            if barred == ALL:
                break
        out[i] = ALL & ~barred
    return out


@njit(cache=True)
def stand_headings(  # type: ignore[no-untyped-def]
    sites, hold, wanted, shoulder, wrist, inner, outer,
    marks, x0, y0, cell, statics, clearance,
):  # fmt: skip
    """Those of the `wanted` (S,) headings at sites for which the robot can get to where it
    would have to stand (`runtime.motion.room`).

    The wrist is `wrist` behind the grasp centre and must be between `inner` and `outer` from
    the shoulder axis, which is `shoulder` (2,) in the base frame.
    """
    out = np.zeros(sites.shape[0], dtype=np.int64)
    for i in range(sites.shape[0]):
        for k in range(HEADINGS):
            if not (wanted[i] >> k) & 1:
                continue
            c = COS[k]
            s = SIN[k]
            x = sites[i, 0] + c * hold[k, 1] - s * hold[k, 2]
            y = sites[i, 1] + s * hold[k, 1] + c * hold[k, 2]
            if _has_stand(
                x - wrist * c, y - wrist * s, x, y, k, shoulder, inner, outer,
                marks, x0, y0, cell, statics, clearance,
            ):  # fmt: skip
                if wrist == 0.0:  # from above the arm may come from anywhere
                    out[i] = wanted[i]
                    break
                out[i] |= 1 << k
    return out


@njit(cache=True)
def fixed_headings(sites, hold, wanted, base, shoulder, wrist, inner, outer):  # type: ignore[no-untyped-def]
    """The same for a robot that cannot drive and stands at `base` (x, y, heading)."""
    out = np.zeros(sites.shape[0], dtype=np.int64)
    c = math.cos(base[2])
    s = math.sin(base[2])
    hx = base[0] + c * shoulder[0] - s * shoulder[1]
    hy = base[1] + s * shoulder[0] + c * shoulder[1]
    for i in range(sites.shape[0]):
        for k in range(HEADINGS):
            if not (wanted[i] >> k) & 1:
                continue
            c = math.cos(k * STEP)
            s = math.sin(k * STEP)
            x = sites[i, 0] + c * (hold[k, 1] - wrist) - s * hold[k, 2]
            y = sites[i, 1] + s * (hold[k, 1] - wrist) + c * hold[k, 2]
            distance = math.sqrt((x - hx) ** 2 + (y - hy) ** 2)
            if inner <= distance <= outer:
                out[i] |= 1 << k
    return out


@njit(cache=True)
def _has_stand(  # type: ignore[no-untyped-def]
    wx, wy, x, y, k, shoulder, inner, outer, marks, x0, y0, cell, statics, clearance
):
    """Whether some base position, on a coarse fan around the wrist, is clear."""
    for turn in range(FAN_COS.shape[1]):
        ahead = FAN_COS[k, turn]
        aside = FAN_SIN[k, turn]
        for ring in range(4):
            reach = outer - ring * (outer - inner) / 4.0
            hx = wx - reach * ahead
            hy = wy - reach * aside
            # The base faces the object.
            away = math.sqrt((x - hx) ** 2 + (y - hy) ** 2)
            c = (x - hx) / away if away > 0.0 else 1.0
            s = (y - hy) / away if away > 0.0 else 0.0
            bx = hx - c * shoulder[0] + s * shoulder[1]
            by = hy - s * shoulder[0] - c * shoulder[1]
            if in_room(marks, x0, y0, cell, statics, clearance, bx, by):
                return True
    return False


@njit(cache=True)
def standing_at(sites, own, boxes):  # type: ignore[no-untyped-def]
    """Which of the boxes (n, 8) something round at each site (S, 3), `own` its radius and height,
    would overlap: (n, S) of bool."""
    out = np.zeros((boxes.shape[0], sites.shape[0]), dtype=np.bool_)
    for j in range(boxes.shape[0]):
        for i in range(sites.shape[0]):
            low = boxes[j, 2] - boxes[j, 5] - sites[i, 2]
            high = boxes[j, 2] + boxes[j, 5] - sites[i, 2]
            out[j, i] = (
                low < own[1] - LEVEL
                and high > LEVEL
                and point_distance(boxes[j], sites[i, 0], sites[i, 1]) < own[0] + PLAY
            )
    return out


@njit(cache=True)
def occupied_sites(sites, own, boxes, skip):  # type: ignore[no-untyped-def]
    """The same for any of the boxes but the one with index `skip`: (S,) of bool."""
    out = np.zeros(sites.shape[0], dtype=np.bool_)
    for i in range(sites.shape[0]):
        for j in range(boxes.shape[0]):
            if j == skip:
                continue
            low = boxes[j, 2] - boxes[j, 5] - sites[i, 2]
            high = boxes[j, 2] + boxes[j, 5] - sites[i, 2]
            if (
                low < own[1] - LEVEL
                and high > LEVEL
                and point_distance(boxes[j], sites[i, 0], sites[i, 1]) < own[0] + PLAY
            ):
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
