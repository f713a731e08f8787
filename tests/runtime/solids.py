"""Random solids, and what FCL and a quadratic programme say about them."""

from __future__ import annotations

import fcl
import numpy as np
from scipy.optimize import minimize, nnls
from scipy.spatial import ConvexHull

from runtime.world.poses import Pose
from runtime.world.solids import Box, Capsule, Cylinder, Floats, Hull, Solid, Sphere
from tests.runtime import reference

KINDS = ("box", "cylinder", "sphere", "capsule", "hull")


def random_solid(rng: np.random.Generator, kind: str | None = None, corners: int = 30) -> Solid:
    """A solid between a stick and a plate of half a metre, all sizes alike on a log scale; a
    hull is that of fewer points than `corners`."""
    kind = kind or KINDS[rng.integers(len(KINDS))]
    a, b, c = np.exp(rng.uniform(np.log(0.005), np.log(0.5), 3)).tolist()
    match kind:
        case "box":
            return Box((a, b, c))
        case "cylinder":
            return Cylinder(a / 2, b)
        case "sphere":
            return Sphere(a / 2)
        case "capsule":
            return Capsule(a / 2, b)
    return hull_of(rng.normal(size=(int(rng.integers(4, corners)), 3)) * [a / 3, b / 3, c / 3])


def hull_of(points: Floats) -> Hull:
    """The hull of points, in the middle of its box."""
    kept = points[ConvexHull(points).vertices]
    kept = kept - (kept.min(axis=0) + kept.max(axis=0)) / 2
    return Hull(tuple(map(tuple, kept.tolist())))


def fcl_solid(solid: Solid, pose: Pose) -> fcl.CollisionObject:
    """A solid as FCL has it."""
    match solid:
        case Box():
            shape = fcl.Box(*solid.size)
        case Cylinder():
            shape = fcl.Cylinder(solid.radius, solid.height)
        case Sphere():
            shape = fcl.Sphere(solid.radius)
        case Capsule():
            shape = fcl.Capsule(solid.radius, solid.height)
        case Hull():
            hull = ConvexHull(solid.points)
            outward = []
            for simplex, plane in zip(hull.simplices, hull.equations, strict=True):
                p, q, r = hull.points[simplex]
                flip = np.cross(q - p, r - p) @ plane[:3] < 0
                outward += [3, *(simplex[::-1] if flip else simplex)]
            shape = fcl.Convex(hull.points, len(hull.simplices), np.array(outward))
    return fcl.CollisionObject(shape, fcl.Transform(pose[:, :3], pose[:, 3]))


def fcl_touch(a: Solid, pose_a: Pose, b: Solid, pose_b: Pose) -> bool:
    """Whether FCL finds a contact."""
    first, second = fcl_solid(a, pose_a), fcl_solid(b, pose_b)
    return bool(fcl.collide(first, second, fcl.CollisionRequest(), fcl.CollisionResult()))


def exact_distance(a: Solid, pose_a: Pose, b: Solid, pose_b: Pose) -> float:
    """The distance of two solids by optimisation: the point of least norm of a polytope by
    non-negative least squares, of round solids by sequential quadratic programming."""
    rounding = sum(s.radius for s in (a, b) if isinstance(s, Sphere | Capsule))
    if not isinstance(a, Cylinder) and not isinstance(b, Cylinder):
        one, other = _corners(a, pose_a), _corners(b, pose_b)
        points = (one[:, None] - other[None]).reshape(-1, 3)
        weights, _ = nnls(np.vstack([points.T, np.ones(len(points))]), np.array([0, 0, 0, 1.0]))
        cores = float(np.linalg.norm(weights @ points) / weights.sum())
    else:
        cores = min(_descend(a, pose_a, b, pose_b, start) for start in range(3))
    return max(0.0, cores - rounding)


def _corners(solid: Solid, pose: Pose) -> Floats:
    match solid:
        case Hull():
            return solid.points @ pose[:, :3].T + pose[:, 3]
        case Sphere():
            return pose[:, 3][None]
        case Capsule():
            return reference.corners(pose, np.array([0.0, 0.0, solid.height / 2]))
    return reference.corners(pose, np.array(solid.half))


def _descend(a: Solid, pose_a: Pose, b: Solid, pose_b: Pose, start: int) -> float:
    """SLSQP over weights of corners, or over a point of a cylinder."""
    sides = [_coordinates(a, pose_a), _coordinates(b, pose_b)]
    first = sides[0][0]

    def gap(x: Floats) -> float:
        apart = sides[0][1](x[:first]) - sides[1][1](x[first:])
        return float(apart @ apart) * 1e3

    rng = np.random.default_rng(start)
    bounds = [*sides[0][2], *sides[1][2]]
    constraints = []
    for side, part in zip(sides, (slice(0, first), slice(first, None)), strict=True):
        kind, function = side[3]
        constraints.append({"type": kind, "fun": lambda x, f=function, p=part: f(x[p])})
    x0 = np.array([rng.uniform(low / 2, high / 2) for low, high in bounds])
    found = minimize(
        gap, x0, bounds=bounds, constraints=constraints, method="SLSQP",
        options={"ftol": 1e-18, "maxiter": 500},
    )  # fmt: skip
    return float(np.sqrt(max(0.0, found.fun) / 1e3))


def _coordinates(solid: Solid, pose: Pose):
    """How many variables, the point that they stand for, their bounds, and a constraint."""
    if isinstance(solid, Cylinder):
        scale = np.array([solid.radius, solid.radius, solid.height / 2])
        return (
            3,
            lambda x: pose[:, :3] @ (x * scale) + pose[:, 3],
            [(-1.0, 1.0)] * 3,
            ("ineq", lambda x: 1.0 - x[0] ** 2 - x[1] ** 2),
        )
    points = _corners(solid, pose)
    return (
        len(points),
        lambda x: x @ points,
        [(0.0, 1.0)] * len(points),
        ("eq", lambda x: x.sum() - 1.0),
    )
