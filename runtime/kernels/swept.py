"""Which approach directions are in whose way: the geometry behind the features u, v and I.

A gripper that comes in horizontally, with heading theta, sweeps two strips in the plane:
the fingers, from behind the palm's face to past the object, and the palm, wrist and forearm
behind them. Headings are a fixed set of K = 24, one bit each, so "the headings that object
j bars for an object at site s" is one integer.

`strip` = [finger back, finger tip, arm length, arm half width, finger thickness and play]:
metres; the first three along the approach, measured from the object's centre.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from runtime.kernels.plane import point_distance, point_is_clear, segment_distance

HEADINGS = 24
STEP = 2.0 * math.pi / HEADINGS
ALL = (1 << HEADINGS) - 1
UNREACHABLE = 1000
"""Added to the count of a heading from which the arm cannot come at all."""


@njit(cache=True)
def barred_headings(sx, sy, grip, px, py, radius, strip):  # type: ignore[no-untyped-def]
    """Bits of the headings along which something round at (px, py) bars the way to (sx, sy).

    `grip` is half the width of the gripped object, `radius` that of what may bar.
    """
    dx = px - sx
    dy = py - sy
    distance = math.hypot(dx, dy)
    if distance > strip[2] + strip[3] + radius:
        return 0
    if distance < grip + radius:
        return ALL  # it stands where the object is, or is to be
    finger = grip + strip[4] + radius
    bits = 0
    for k in range(HEADINGS):
        c = math.cos(k * STEP)
        s = math.sin(k * STEP)
        along = c * dx + s * dy
        aside = abs(c * dy - s * dx)
        if (-strip[0] - radius < along < strip[1] + radius and aside < finger) or (
            -strip[2] - radius < along < -strip[0] + radius and aside < strip[3] + radius
        ):
            bits |= 1 << k
    return bits


@njit(cache=True)
def barred_matrix(sites, grips, points, radii, strip):  # type: ignore[no-untyped-def]
    """`barred_headings` for all sites (S, 2) and points (n, 2): (S, n) of int64."""
    out = np.empty((sites.shape[0], points.shape[0]), dtype=np.int64)
    for i in range(sites.shape[0]):
        for j in range(points.shape[0]):
            out[i, j] = barred_headings(
                sites[i, 0], sites[i, 1], grips[i], points[j, 0], points[j, 1], radii[j], strip
            )
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
def reachable_headings(  # type: ignore[no-untyped-def]
    sites, strip, shoulder, tool_offset, inner, outer, statics, clearance, low, high
):
    """Bits of the headings at each site (S, 2) for which the robot has somewhere to stand.

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
                            statics[w], x - strip[0] * c, y - strip[0] * s, x - back * c, y - back * s
                        )
                        < strip[3]
                        or segment_distance(
                            statics[w], x + strip[1] * c, y + strip[1] * s, x, y
                        )
                        < 0.5 * strip[3]
                    ):
                        barred = True
                        break
            if not barred and _has_stand(
                x - tool_offset * c, y - tool_offset * s, x, y, k, shoulder, inner, outer,
                statics, clearance,
            ):  # fmt: skip
                out[i] |= 1 << k
    return out


@njit(cache=True)
def _has_stand(wx, wy, x, y, k, shoulder, inner, outer, statics, clearance):  # type: ignore[no-untyped-def]
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
            if point_is_clear(statics, clearance, bx, by):
                return True
    return False


@njit(cache=True)
def occupied(x, y, half, points, halves):  # type: ignore[no-untyped-def]
    """Whether something round of radius `half` at a point would overlap round things."""
    for j in range(points.shape[0]):
        reach = half + halves[j]
        dx = points[j, 0] - x
        dy = points[j, 1] - y
        if dx * dx + dy * dy < reach * reach:
            return True
    return False


@njit(cache=True)
def occupied_sites(sites, half, points, halves, skip):  # type: ignore[no-untyped-def]
    """`occupied` for sites (S, 2), the point with index `skip` left out: (S,) of bool."""
    out = np.zeros(sites.shape[0], dtype=np.bool_)
    for i in range(sites.shape[0]):
        for j in range(points.shape[0]):
            reach = half + halves[j]
            dx = points[j, 0] - sites[i, 0]
            dy = points[j, 1] - sites[i, 1]
            if j != skip and dx * dx + dy * dy < reach * reach:
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
def leaves_open(headings, sites, grips, px, py, radius, strip):  # type: ignore[no-untyped-def]
    """Whether something round at a point leaves one of the headings (S,) to sites (S, 2)."""
    for i in range(sites.shape[0]):
        if headings[i] and headings[i] & ~barred_headings(
            sites[i, 0], sites[i, 1], grips[i], px, py, radius, strip
        ):
            return True
    return False
