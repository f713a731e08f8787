"""Grips of any body from any side, measured between the fingers of the built-in robot."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from runtime.judge.grip import grip_fault, load_fault
from runtime.judge.skeleton import Skeleton
from runtime.world.body import Body, Part
from runtime.world.poses import Floats, identity
from runtime.world.solids import Box, Capsule, Cylinder, Solid, Sphere


def single(solid: Solid) -> Body:
    return Body((Part(solid, identity()),), 0.1, (0.0, 0.0, 0.0))


def turned(axis: str, angle: float, place: tuple[float, float, float] = (0, 0, 0)) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    pose = np.eye(4)
    pose[:3, :3] = {
        "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }[axis]
    pose[:3, 3] = place
    return pose


@pytest.fixture(scope="module")
def skeleton(robot) -> Skeleton:
    return Skeleton(robot)


@pytest.mark.parametrize(
    ("solid", "width"),
    [(Box((0.2, 0.04, 0.06)), 0.04), (Cylinder(0.03, 0.1), 0.06), (Sphere(0.03), 0.06),
     (Capsule(0.02, 0.1), 0.04)],
)  # fmt: skip
@pytest.mark.parametrize("angle", [0.0, 0.5, 1.5])
def test_round_and_flat_things_are_held_from_any_side(skeleton, solid, width, angle) -> None:
    """Turned about the axis that the fingers close along, a body stays as wide."""
    pose = turned("y", angle)
    assert grip_fault(skeleton, width, single(solid), "it", pose) is None
    assert "narrower" in str(grip_fault(skeleton, width - 0.006, single(solid), "it", pose))
    assert "wider" in str(grip_fault(skeleton, width + 0.006, single(solid), "it", pose))


def test_what_is_beside_or_off_centre_is_not_held(skeleton) -> None:
    cube = single(Box((0.04, 0.04, 0.04)))
    aside = turned("z", 0.0, (0.0, 0.004, 0.0))
    assert "off centre" in str(grip_fault(skeleton, 0.04, cube, "it", aside))
    away = turned("z", 0.0, (0.2, 0.0, 0.0))
    assert "not between" in str(grip_fault(skeleton, 0.04, cube, "it", away))


@pytest.mark.parametrize(("angle", "slips"), [(0.0, False), (0.12, True), (0.3, False)])
def test_fingers_across_corners_hold_as_far_as_friction_goes(skeleton, angle, slips) -> None:
    """A square turned by an angle is cos + sin wide, its corners cos - sin apart."""
    side = 0.04
    width = side * (math.cos(angle) + math.sin(angle))
    found = grip_fault(skeleton, width, single(Box((side, side, 0.1))), "it", turned("z", angle))
    assert (found is not None and "slips" in found) == slips


def test_a_wedge_slips_out(skeleton) -> None:
    """Two blocks like stairs: one finger touches far in front of the other."""
    parts = (
        Part(Box((0.02, 0.02, 0.02)), turned("z", 0, (0.01, 0.01, 0))[:3]),
        Part(Box((0.02, 0.02, 0.02)), turned("z", 0, (-0.05, -0.01, 0))[:3]),
    )
    stairs = Body(parts, 0.1, (0.0, 0.0, 0.0))
    assert "slips" in str(grip_fault(skeleton, 0.04, stairs, "it", np.eye(4)))


def test_loads_are_measured_against_the_gripper(robot) -> None:
    down = np.array([0.0, 0.0, -1.0])

    def fault(mass: float, centre: tuple[float, float, float], **limits: float) -> str | None:
        strong = replace(robot, gripper=replace(robot.gripper, **limits))
        return load_fault(strong, mass, np.array(centre), down)

    assert fault(50.0, (0.0, 0.0, 0.0)) is None  # nothing is known of what it bears
    assert "too heavy" in str(fault(2.0, (0, 0, 0), payload=1.5))
    assert fault(1.4, (0, 0, 0), payload=1.5) is None
    assert "slip" in str(fault(2.0, (0, 0, 0), max_force=10.0))
    assert fault(1.0, (0, 0, 0), max_force=10.0) is None
    assert "turns" in str(fault(1.0, (0.3, 0, 0), max_torque=2.0))
    assert fault(1.0, (0.0, 0.3, 0.0), max_torque=2.0) is None  # along the axis of the fingers
