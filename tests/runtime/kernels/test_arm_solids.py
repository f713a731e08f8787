"""An arm of round links among round obstacles: contacts and distances by FCL."""

from __future__ import annotations

import fcl
import numpy as np
import pytest

from runtime.kernels.convex import Obstacles, boxes_only, join
from runtime.motion.arm_context import ArmContext
from runtime.motion.base import footprint
from runtime.robot.model import Body, RobotModel
from runtime.world import body as world_body
from runtime.world.packed import PackedBodies, pack_bodies, pack_shapes
from runtime.world.poses import Pose
from runtime.world.solids import Box, Capsule, Cylinder, Solid
from tests.runtime import reference
from tests.runtime.reference import Floats, along, random_pose, random_uprights
from tests.runtime.solids import fcl_solid, hull_of, random_solid


def round_solids(body: Body) -> list[Solid]:
    """Every third part of a body as a cylinder in its box, every third as a hull in it."""
    solids: list[Solid] = []
    for i, half in enumerate(body.half):
        box = Box(tuple((2 * half).tolist()))
        eight = reference.corners(np.eye(3, 4), half)
        chamfered = np.vstack(
            [eight * [1.0, 0.7, 0.7], eight * [0.7, 1.0, 0.7], eight * [0.7, 0.7, 1.0]]
        )
        around = Cylinder(float(min(half[:2])), float(2 * half[2]))
        solids.append((box, around, hull_of(chamfered))[i % 3])
    return solids


def round_body(body: Body, solids: list[Solid]) -> Body:
    index = np.arange(len(solids))
    index[[isinstance(solid, Box) for solid in solids]] = -1
    return body._replace(shape=index, shapes=pack_shapes(solids))


class Scene:
    """A few solids at random poses, as the kernel and as FCL have them, and two boxes."""

    def __init__(self, rng: np.random.Generator, count: int) -> None:
        solids = [random_solid(rng) for _ in range(count)]
        packed: PackedBodies = pack_bodies(
            [world_body.Body((world_body.Part(solid),), 1.0, (0, 0, 0)) for solid in solids]
        )
        poses = [random_pose(rng, 0.9) for _ in solids]
        rows = random_uprights(rng, 2, 1.2)
        self.obstacles: Obstacles = join(
            boxes_only(rows), *(packed.at(i, pose) for i, pose in enumerate(poses))
        )
        self.fcl = [fcl_solid(solid, pose) for solid, pose in zip(solids, poses, strict=True)]
        self.fcl += [
            fcl_solid(Box(tuple(2 * row[3:6])), reference.upright_pose(row)) for row in rows
        ]


def placed_parts(robot: RobotModel, body: Body, solids: list[Solid], q: Floats):
    poses: list[Pose] = reference.placed_boxes(robot.chain, body, q)
    return [fcl_solid(solid, pose) for solid, pose in zip(solids, poses, strict=True)]


def fcl_gap(robot: RobotModel, body: Body, solids: list[Solid], scene: Scene, q: Floats) -> float:
    """FCL's smallest distance, 0 for contact."""
    parts = placed_parts(robot, body, solids, q)
    pairs = [(p, o) for i, p in enumerate(parts) if body.frame[i] for o in scene.fcl]
    pairs += [(parts[a], parts[b]) for a, b in body.pairs]
    gap = np.inf
    for one, other in pairs:
        if fcl.collide(one, other, fcl.CollisionRequest(), fcl.CollisionResult()):
            return 0.0
        found = fcl.distance(one, other, fcl.DistanceRequest(), fcl.DistanceResult())
        gap = min(gap, max(0.0, float(found)))
    return gap


@pytest.fixture
def parts(robot: RobotModel) -> tuple[Body, list[Solid]]:
    boxes = robot.body(0.05)
    solids = round_solids(boxes)
    return round_body(boxes, solids), solids


def test_collisions_are_the_contacts_that_fcl_sees(robot, parts, rng) -> None:
    body, solids = parts
    touching = free = 0
    for _ in range(120):
        scene = Scene(rng, 5)
        context = ArmContext(robot, body, scene.obstacles)
        q = rng.uniform(robot.lower, robot.upper)
        gap = fcl_gap(robot, body, solids, scene, q)
        if gap == 0.0:
            touching += 1
            assert context.collides(q, 1e-5)
        elif gap > 0.02:
            free += 1
            assert not context.collides(q, 0.01)
    assert touching > 10
    assert free > 10


def test_paths_that_pass_keep_half_the_margin_in_between(robot, parts, rng) -> None:
    body, solids = parts
    margin, free, refused = 0.01, 0, 0
    for _ in range(8):
        scene = Scene(rng, 3)
        context = ArmContext(robot, body, scene.obstacles)
        path = np.array([rng.uniform(robot.lower, robot.upper) for _ in range(2)])
        path[1] = path[0] + (path[1] - path[0]) * rng.uniform(0.02, 0.4)
        if context.path_is_free(path, margin):
            free += 1
            for q in along(path, 20):
                assert fcl_gap(robot, body, solids, scene, q) >= margin / 2 - 1e-5
        else:
            refused += 1
            gaps = [fcl_gap(robot, body, solids, scene, q) for q in along(path, 40)]
            assert min(gaps) <= np.sqrt(3.0) * margin + 0.02
    assert free
    assert refused


def test_rings_hold_round_parts_and_are_not_those_of_their_boxes(robot, parts) -> None:
    body, solids = parts
    placed = reference.placed_boxes(robot.chain, body, robot.home)
    rings = footprint(robot, body).rings
    boxes = footprint(robot, robot.body(0.05)).rings
    assert np.all(rings[:, 2] <= boxes[:, 2] * 1.006)
    for ring, pose, solid in zip(rings, placed, solids, strict=True):
        wall = np.eye(3, 4)
        part = fcl_solid(solid, pose)
        for height in (ring[0] - 0.51, ring[1] + 0.51):
            wall[2, 3] = height
            slab = fcl_solid(Box((9.0, 9.0, 1.0)), wall)
            assert not fcl.collide(part, slab, fcl.CollisionRequest(), fcl.CollisionResult())
    assert any(isinstance(solid, Capsule | Cylinder) for solid in solids)
