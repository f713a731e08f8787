"""Stable poses: the ways in which a body can rest on a plane without tipping over.

A pose is stable where the centre of mass is above the inside of the polygon in which the body
touches the plane. For boxes, cylinders, spheres and capsules this is known in closed form;
everything else is asked for the facets of its convex hull (SciPy).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from runtime.world.body import Body
from runtime.world.mesh import mesh_of
from runtime.world.poses import Pose, apply, rotation_from_rpy
from runtime.world.solids import Box, Capsule, Cylinder, Floats, Sphere

COPLANAR = 1e-5
"""Metres by which corners of one facet may be off its plane."""

INSIDE = 1e-4
"""Metres that the centre of mass has to be inside the contact polygon."""

ANY_TURN = 0
"""The symmetry of what looks the same however it is turned about z."""

UPRIGHT = 0.7
"""A body whose z rises more than this is headed where its x is, else where its z is."""

MOST = 64
"""As many stable poses of a mesh are kept: those that are hardest to tip over."""

CIRCLE = 32
"""Corners of the polygon inside the circle on which something round stands."""


@dataclass(frozen=True, eq=False)
class StablePose:
    """One way to rest. `pose` (3, 4) is the body's frame in the *resting frame*: origin on the
    plane, under the middle of the box around the body along its own axes, z up. The first stable
    pose of a body is the one that its file describes, where that one is stable.

    `polygon` (k, 2) is where the body touches the plane, counter-clockwise, in the resting
    frame; it has one corner where a sphere rests and two where a cylinder lies. `half` are how
    far the body reaches along x and y from the origin, `height` its height, metres. Turns by
    a full circle divided by `symmetry` change nothing, no turn at all where it is `ANY_TURN`.
    `rolls`: the body can roll there; `like` is the number of the first stable pose in which the
    body takes up the same space.
    """

    pose: Pose
    polygon: Floats
    half: tuple[float, float]
    height: float
    symmetry: int
    rolls: bool = False
    like: int = 0

    @cached_property
    def up(self) -> Floats:
        """The direction (3,) of the body's frame that points up."""
        return self.pose[2, :3].copy()


def stable_poses(body: Body) -> tuple[StablePose, ...]:
    """All stable poses of a body. Those in which it could roll are given once for each line or
    point of contact that it can roll along."""
    if len(body.parts) == 1 and np.array_equal(body.parts[0].pose[:, :3], np.eye(3)):
        shift = body.parts[0].pose[:, 3]
        match body.parts[0].solid:
            case Box() as box:
                return _box_poses(box, shift)
            case Cylinder() as can:
                return _cylinder_poses(can, shift)
            case Sphere() as ball:
                return (_resting(np.eye(3), np.zeros((1, 2)), ball.half, shift, ANY_TURN, True),)
            case Capsule() as pill:
                line = np.array([[-pill.height / 2, 0.0], [pill.height / 2, 0.0]])
                return (_resting(LYING, line, pill.half, shift, 2, True),)
    return _facets(body)


LYING = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
"""Turns z to x: how what stands along z lies."""

# Rotations that turn each side of a box down; the one that it is described in comes first. A box
# that lies on a lateral side has its own z along x.
_DOWN = (
    np.eye(3),
    np.diag([1.0, -1.0, -1.0]),
    np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]),
    LYING,
    np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
    np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]),
)


def _box_poses(box: Box, shift: Floats) -> tuple[StablePose, ...]:
    poses = []
    for number, rotation in enumerate(_DOWN):
        x, y, _ = np.abs(rotation) @ np.array(box.half)
        polygon = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
        symmetry = 4 if math.isclose(x, y) else 2
        pose = _resting(rotation, polygon, box.half, shift, symmetry)
        poses.append(replace(pose, like=number - number % 2))
    return tuple(poses)


def _cylinder_poses(can: Cylinder, shift: Floats) -> tuple[StablePose, ...]:
    angles = np.arange(CIRCLE) * (2 * math.pi / CIRCLE)
    circle = can.radius * np.column_stack([np.cos(angles), np.sin(angles)])
    line = np.array([[-can.height / 2, 0.0], [can.height / 2, 0.0]])
    return (
        _resting(np.eye(3), circle, can.half, shift, ANY_TURN),
        _resting(_DOWN[1], circle, can.half, shift, ANY_TURN),
        replace(_resting(LYING, line, can.half, shift, 2, True), like=2),
    )


def _resting(
    rotation: Floats,
    polygon: Floats,
    half: tuple[float, float, float],
    shift: Floats,
    symmetry: int,
    rolls: bool = False,
) -> StablePose:
    """Of a solid whose middle is at `shift` in the body's frame."""
    x, y, z = (np.abs(rotation) @ np.array(half)).tolist()
    pose = np.column_stack([rotation, np.array([0.0, 0.0, z]) - rotation @ shift])
    return StablePose(pose, polygon, (x, y), 2 * z, symmetry, rolls)


def _facets(body: Body) -> tuple[StablePose, ...]:
    """The facets of the convex hull above whose inside the centre of mass is."""
    from scipy.spatial import ConvexHull

    points = np.vstack([apply(part.pose, mesh_of(part.solid).vertices) for part in body.parts])
    hull = ConvexHull(points)
    corners = points[hull.vertices]
    found: list[tuple[bool, float, StablePose]] = []
    seen: list[Floats] = []
    for normal in hull.equations[:, :3]:
        if any(normal @ known > 1 - 1e-8 for known in seen):
            continue
        seen.append(normal)
        rotation = _turning_down(normal)
        turned = corners @ rotation.T
        flat = turned[turned[:, 2] < turned[:, 2].min() + COPLANAR][:, :2]
        if len(flat) < 3:
            continue
        polygon = flat[ConvexHull(flat).vertices]
        room = _room(polygon, (rotation @ np.array(body.centre))[:2])
        if room > INSIDE:
            pose = _on_its_facet(body, rotation, turned, polygon)
            found.append((normal[2] > -1 + 1e-9, -room, pose))
    found.sort(key=lambda entry: entry[:2])
    return tuple(replace(pose, like=i) for i, (_, _, pose) in enumerate(found[:MOST]))


def _on_its_facet(body: Body, rotation: Floats, turned: Floats, polygon: Floats) -> StablePose:
    low, high = body.bounds
    middle = rotation @ ((low + high) / 2)
    middle[2] = turned[:, 2].min()
    x, y = np.abs(turned - middle)[:, :2].max(axis=0).tolist()
    pose = np.column_stack([rotation, -middle])
    height = float(turned[:, 2].max() - middle[2])
    return StablePose(pose, polygon - middle[:2], (x, y), height, 1)


def _turning_down(normal: Floats) -> Floats:
    """A rotation that turns a direction down, after which the body's x is along x in the plane,
    or its z where it lies on a side; the identity for what points down already."""
    down = np.array([0.0, 0.0, -1.0])
    axis, cosine = np.cross(normal, down), float(normal @ down)
    if cosine > 1 - 1e-9:
        return np.eye(3)
    if cosine < -1 + 1e-9:
        return np.diag([1.0, -1.0, -1.0])
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned = np.eye(3) + cross + cross @ cross / (1 + cosine)
    along = turned[:, 0 if abs(turned[2, 2]) > UPRIGHT else 2]
    back = rotation_from_rpy(0.0, 0.0, -math.atan2(along[1], along[0]))
    headed: Floats = back @ turned
    return headed


def _room(polygon: Floats, point: Floats) -> float:
    """How far a point is inside a counter-clockwise polygon, metres; negative outside."""
    along = np.roll(polygon, -1, axis=0) - polygon
    to = point - polygon
    area = along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0]
    return float((area / np.linalg.norm(along, axis=1)).min())
