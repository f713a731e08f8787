"""Stable poses in closed form against those of facets, and both against trimesh and physics."""

from __future__ import annotations

import math

import numpy as np
import pytest

from runtime.world.body import Body, Part
from runtime.world.making import body_of, open_box, standing
from runtime.world.mesh import body_mesh
from runtime.world.poses import apply, compose, rotation_from_rpy, upright
from runtime.world.snap import middle_of, nearest_stable, resting_heading, resting_pose
from runtime.world.solids import Box, Capsule, Cylinder, Sphere
from runtime.world.stable import ANY_TURN, StablePose, stable_poses
from tests.runtime.reference import corners, random_pose
from tests.runtime.solids import hull_of

BODIES = {
    "box": standing(Box((0.1, 0.2, 0.05))),
    "stick": standing(Box((0.04, 0.04, 0.2))),
    "can": standing(Cylinder(0.03, 0.12)),
    "ball": standing(Sphere(0.04)),
    "pill": standing(Capsule(0.02, 0.1)),
    "tray": open_box((0.3, 0.2, 0.05), 0.01),
    "wedge": standing(
        hull_of(
            np.array(
                [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0.1, 0.1, 0], [0, 0, 0.1], [0, 0.1, 0.1]]
            )
        )
    ),
}
ALL = pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)


def as_hull(box: Box) -> Body:
    """A box of which nobody knows that it is one."""
    return standing(hull_of(corners(np.eye(3, 4), np.array(box.half))))


@ALL
def test_bodies_touch_the_plane_in_their_polygon_and_nowhere_go_below_it(body) -> None:
    for stable in stable_poses(body):
        points = apply(stable.pose, body_mesh(body).vertices)
        assert points[:, 2].min() == pytest.approx(0.0, abs=2e-3)
        assert points[:, 2].max() == pytest.approx(stable.height, abs=2e-3)
        assert np.all(np.abs(points[:, :2]).max(axis=0) <= np.array(stable.half) + 1e-6)
        low = points[points[:, 2] < 2e-3][:, :2]
        reach = max(np.linalg.norm(stable.polygon, axis=1).max(), 1e-3)
        assert np.linalg.norm(low, axis=1).max() <= reach + 1e-2


@ALL
def test_the_centre_of_mass_is_over_the_polygon(body) -> None:
    for stable in stable_poses(body):
        centre = (stable.pose[:, :3] @ body.centre + stable.pose[:, 3])[:2]
        low, high = stable.polygon.min(axis=0), stable.polygon.max(axis=0)
        assert np.all(centre >= low - 1e-9)
        assert np.all(centre <= high + 1e-9)


def test_a_box_rests_on_its_six_sides_as_its_hull_does() -> None:
    box = Box((0.1, 0.2, 0.05))
    exact, facets = stable_poses(standing(box)), stable_poses(as_hull(box))
    assert len(exact) == len(facets) == 6
    ups = sorted(np.round(pose.up, 6).tolist() for pose in exact)
    assert ups == sorted(np.round(pose.up, 6).tolist() for pose in facets)
    for pose in exact:
        other = next(f for f in facets if f.up @ pose.up > 0.999)
        assert other.height == pytest.approx(pose.height)
        # The same heading means the same pose.
        assert other.pose == pytest.approx(pose.pose, abs=1e-9)


def test_facets_agree_with_trimesh(rng) -> None:
    trimesh = pytest.importorskip("trimesh")
    body = standing(hull_of(rng.normal(size=(12, 3)) * 0.1))
    mesh = body_mesh(body)
    found = stable_poses(body)
    tri = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    transforms, _ = trimesh.poses.compute_stable_poses(tri, center_mass=np.array(body.centre))
    ours = sorted(np.round(stable.up, 4).tolist() for stable in found)
    theirs = sorted(np.round(transform[2, :3], 4).tolist() for transform in transforms)
    assert len(ours) == len(theirs)
    assert np.array(ours) == pytest.approx(np.array(theirs), abs=2e-4)


def test_round_things_lie_too_and_say_that_they_roll() -> None:
    can = stable_poses(BODIES["can"])
    assert [pose.symmetry for pose in can] == [ANY_TURN, ANY_TURN, 2]
    assert [pose.rolls for pose in can] == [False, False, True]
    assert can[2].height == pytest.approx(0.06)
    assert [pose.rolls for pose in stable_poses(BODIES["ball"])] == [True]
    assert [pose.height for pose in stable_poses(BODIES["pill"])] == pytest.approx([0.04])


def test_the_first_pose_is_the_one_of_the_file() -> None:
    for name in ("box", "stick", "can", "ball", "tray", "wedge"):
        first = stable_poses(BODIES[name])[0]
        assert first.pose[:, :3] == pytest.approx(np.eye(3))


@ALL
def test_orientations_snap_to_the_pose_and_heading_that_they_are_near_to(body, rng) -> None:
    poses = stable_poses(body)
    for number, stable in enumerate(poses):
        yaw = float(rng.uniform(-3.0, 3.0))
        shake = rotation_from_rpy(*rng.uniform(-0.02, 0.02, 2), 0.0)
        pose = resting_pose(stable, 0.3, -0.2, 0.5, yaw)
        found, heading, off = nearest_stable(body, poses, shake @ pose[:, :3])
        assert off < 0.03
        assert same_space(poses, found, number)
        if found == number and stable.symmetry != ANY_TURN:
            assert abs(math.remainder(heading - yaw, 2 * math.pi)) < 0.05
        x, y, _ = middle_of(body, pose)
        assert (x, y) == pytest.approx((0.3, -0.2))
        if stable.symmetry != ANY_TURN:
            turn = 2 * math.pi / stable.symmetry
            assert abs(math.remainder(resting_heading(body, pose) - yaw, turn)) < 1e-6


def same_space(poses: tuple[StablePose, ...], a: int, b: int) -> bool:
    return a == b or poses[a].like == poses[b].like


def test_a_lying_can_may_have_turned_about_its_axis() -> None:
    body = BODIES["can"]
    rolled = rotation_from_rpy(0.0, math.pi / 2, 0.0) @ rotation_from_rpy(0.0, 0.0, 1.1)
    turned = rotation_from_rpy(0.0, 0.0, 0.4) @ rolled
    number, yaw, off = nearest_stable(body, stable_poses(body), turned)
    assert (number, off) == (2, pytest.approx(0.0, abs=1e-6))
    assert yaw == pytest.approx(0.4)


@pytest.mark.slow
def test_physics_lets_bodies_lie_as_they_do(rng) -> None:
    """In PyBullet a body that starts in a stable pose stays; tilted by 30 degrees it does not
    stay there unless it rolls back."""
    pybullet = pytest.importorskip("pybullet")
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setGravity(0, 0, -9.81, physicsClientId=client)
        plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
        pybullet.createMultiBody(0.0, plane, physicsClientId=client)
        for _ in range(5):
            body = standing(hull_of(rng.normal(size=(10, 3)) * 0.1))
            for stable in stable_poses(body)[:3]:
                assert fallen(pybullet, client, body, stable) < 0.1
    finally:
        pybullet.disconnect(client)


def fallen(pybullet, client: int, body: Body, stable: StablePose) -> float:
    """By how much what was up has tilted after two seconds, radians."""
    centre = np.array(body.centre)
    points = (body_mesh(body).vertices - centre).tolist()
    shape = pybullet.createCollisionShape(
        pybullet.GEOM_MESH, vertices=points, physicsClientId=client
    )
    pose = compose(upright(0.0, 0.0, 0.0, 0.0), stable.pose)
    trace = pose[0, 0] + pose[1, 1] + pose[2, 2]
    w = math.sqrt(max(1e-12, 1 + trace)) / 2
    q = [
        (pose[2, 1] - pose[1, 2]) / (4 * w),
        (pose[0, 2] - pose[2, 0]) / (4 * w),
        (pose[1, 0] - pose[0, 1]) / (4 * w),
        w,
    ]
    if w < 1e-3:
        return 0.0
    thing = pybullet.createMultiBody(
        1.0, shape, -1, (pose[:, :3] @ centre + pose[:, 3]).tolist(), q, physicsClientId=client
    )
    for _ in range(480):
        pybullet.stepSimulation(physicsClientId=client)
    _, end = pybullet.getBasePositionAndOrientation(thing, physicsClientId=client)
    turn = np.array(pybullet.getMatrixFromQuaternion(end)).reshape(3, 3)
    pybullet.removeBody(thing, physicsClientId=client)
    return math.acos(min(1.0, max(-1.0, float(turn[2] @ stable.up))))


def test_mass_and_centre_are_those_of_the_parts(rng) -> None:
    a, b = Box((0.1, 0.1, 0.1)), Box((0.1, 0.1, 0.3))
    body = body_of([Part(a, upright(0, 0, 0.05, 0)), Part(b, upright(0.4, 0, 0.15, 0))])
    assert body.mass == pytest.approx(500 * (0.001 + 0.003))
    assert body.centre == pytest.approx((0.3, 0.0, (0.05 + 3 * 0.15) / 4))
    hull = hull_of(rng.normal(size=(20, 3)) * 0.1)
    whole = body_of([Part(hull, random_pose(rng, 0.3))], mass=2.0)
    inside = body_of([Part(hull, whole.parts[0].pose)], mesh=body_mesh(whole))
    assert whole.mass == 2.0
    assert inside.centre == pytest.approx(whole.centre)
    assert inside.mass == pytest.approx(500 * hull.volume)
