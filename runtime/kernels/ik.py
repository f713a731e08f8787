"""Numerical inverse kinematics: damped least squares on the geometric Jacobian."""

from __future__ import annotations

import math

import numpy as np

from runtime.kernels.arm import collides, forward, jacobian
from runtime.kernels.compiled import njit

DAMPING = 0.05
MAX_STEP = 0.5  # radians (metres) a joint may move in one iteration
POSITION_TOLERANCE = 1e-5
ANGLE_TOLERANCE = 1e-4


@njit(cache=True, inline="always")
def pose_error(frame, tool, target, out):  # type: ignore[no-untyped-def]
    """Write position error (3) and rotation vector error (3) from tool to target.

    Returns (|position|, |angle|); `frame` and `tool` are composed here.
    """
    for i in range(3):
        p = (
            frame[i, 0] * tool[0, 3]
            + frame[i, 1] * tool[1, 3]
            + frame[i, 2] * tool[2, 3]
            + frame[i, 3]
        )
        out[i] = target[i, 3] - p
    # Rows of R_target R_tool^T, of which the rotation vector is taken.
    r = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            total = 0.0
            for k in range(3):
                tool_jk = (
                    frame[j, 0] * tool[0, k] + frame[j, 1] * tool[1, k] + frame[j, 2] * tool[2, k]
                )
                total += target[i, k] * tool_jk
            r[i, j] = total
    sx = r[2, 1] - r[1, 2]
    sy = r[0, 2] - r[2, 0]
    sz = r[1, 0] - r[0, 1]
    sine = 0.5 * math.sqrt(sx * sx + sy * sy + sz * sz)
    cosine = 0.5 * (r[0, 0] + r[1, 1] + r[2, 2] - 1.0)
    angle = math.atan2(sine, cosine)
    if sine > 1e-9:
        scale = 0.5 * angle / sine
        out[3], out[4], out[5] = sx * scale, sy * scale, sz * scale
    elif cosine > 0.0:
        out[3], out[4], out[5] = 0.5 * sx, 0.5 * sy, 0.5 * sz
    else:  # half a turn: any axis makes progress
        out[3], out[4], out[5] = angle, 0.0, 0.0
    position = math.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2])
    return position, angle


@njit(cache=True, inline="always")
def _solve_spd(a, b):  # type: ignore[no-untyped-def]
    """Solve the 6x6 symmetric positive definite system a x = b in place (Cholesky)."""
    for j in range(6):
        d = a[j, j]
        for k in range(j):
            d -= a[j, k] * a[j, k]
        d = math.sqrt(d)
        a[j, j] = d
        for i in range(j + 1, 6):
            s = a[i, j]
            for k in range(j):
                s -= a[i, k] * a[j, k]
            a[i, j] = s / d
    for i in range(6):
        s = b[i]
        for k in range(i):
            s -= a[i, k] * b[k]
        b[i] = s / a[i, i]
    for i in range(5, -1, -1):
        s = b[i]
        for k in range(i + 1, 6):
            s -= a[k, i] * b[k]
        b[i] = s / a[i, i]


@njit(cache=True)
def solve(origins, prismatic, lower, upper, tool, target, q, iterations, ease):  # type: ignore[no-untyped-def]
    """Move q (n,), in place, until the tool (3, 4 in the last frame) is at the target.

    Of all steps that bring it there, the one with the least sum of squares of each joint's part
    over its `ease` (n,) is taken: with speeds for eases, the least time (weighted least squares).
    Returns whether it got there. Joint limits hold at every step: a joint that would
    leave its range stops at the limit and takes no part in that step.
    """
    n = q.shape[0]
    frames = np.empty((n + 1, 3, 4))
    jac = np.empty((6, n))
    error = np.empty(6)
    point = np.empty(3)
    gram = np.empty((6, 6))
    step = np.empty(6)
    free = np.ones(n, dtype=np.bool_)
    for _ in range(iterations):
        forward(origins, prismatic, q, frames)
        last = frames[n]
        position, angle = pose_error(last, tool, target, error)
        if position < POSITION_TOLERANCE and angle < ANGLE_TOLERANCE:
            return True
        for i in range(3):
            point[i] = target[i, 3] - error[i]
        jacobian(frames, prismatic, point, jac)
        # Far from the target a step is bounded: the linearisation is local.
        size = position + 0.3 * angle
        shrink = min(1.0, 0.4 / size)
        damping = DAMPING * DAMPING * min(1.0, size)
        for k in range(n):
            free[k] = True
        for attempt in range(2):
            for i in range(6):
                for j in range(i + 1):
                    total = 0.0
                    for k in range(n):
                        if free[k]:
                            total += ease[k] * ease[k] * jac[i, k] * jac[j, k]
                    gram[i, j] = total
                    gram[j, i] = total
                gram[i, i] += damping
                step[i] = shrink * error[i]
            _solve_spd(gram, step)
            blocked = False
            for k in range(n):
                if not free[k]:
                    continue
                dq = 0.0
                for i in range(6):
                    dq += ease[k] * ease[k] * jac[i, k] * step[i]
                # A joint at its limit that is pushed outwards is frozen, once.
                outwards = (q[k] <= lower[k] and dq < 0.0) or (q[k] >= upper[k] and dq > 0.0)
                if attempt == 0 and outwards:
                    free[k] = False
                    blocked = True
            if not blocked:
                break
        for k in range(n):
            if free[k]:
                dq = 0.0
                for i in range(6):
                    dq += ease[k] * ease[k] * jac[i, k] * step[i]
                dq = min(MAX_STEP, max(-MAX_STEP, dq))
                q[k] = min(upper[k], max(lower[k], q[k] + dq))
    return False


@njit(cache=True)
def first_free(  # type: ignore[no-untyped-def]
    chain, lower, upper, tool, target, seeds, first, iterations, ease, body, obstacles, margin
):
    """Solve from the seeds (s, n), in place, from number `first` on, until a solution is free
    of collision: its number, or -1. All seeds in one call: most of them fail."""
    frames = np.empty((seeds.shape[1] + 1, 3, 4))
    placed = np.empty((body.frame.shape[0], 3, 4))
    for i in range(first, seeds.shape[0]):
        if solve(
            chain.origins, chain.prismatic, lower, upper, tool, target, seeds[i], iterations, ease
        ) and not collides(chain, body, obstacles, margin, seeds[i], frames, placed):
            return i
    return -1


@njit(cache=True)
def line(  # type: ignore[no-untyped-def]
    chain, lower, upper, tool, target, offset, start, steps, iterations, ease, most
):
    """Configurations (k, n) that move the tool by `offset` (3,) from the target in so many steps,
    from one that has it there; fewer where a step is not solved, or turns a joint by more than
    `most`."""
    path = np.empty((steps + 1, start.shape[0]))
    path[0] = start
    pose = target.copy()
    for i in range(1, steps + 1):
        for j in range(3):
            pose[j, 3] = target[j, 3] + offset[j] * (i / steps)
        path[i] = path[i - 1]
        if not solve(
            chain.origins, chain.prismatic, lower, upper, tool, pose, path[i], iterations, ease
        ):
            return path[:i]
        for j in range(start.shape[0]):
            if abs(path[i, j] - path[i - 1, j]) > most:
                return path[:i]
    return path
