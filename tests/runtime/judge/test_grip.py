"""Grips of any body from any side, measured between the fingers of the built-in robot."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from runtime.judge.grip import grip_fault, load_fault
from runtime.judge.skeleton import Skeleton
from runtime.world.body import Body, Part
from runtime.world.poses import Floats, identity, upright
from runtime.world.solids import Box, Capsule, Cylinder, Hull, Solid, Sphere
from runtime.world.world import Movable
from tests.runtime.judge.gantry import Script, table_world, thing


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


@pytest.mark.parametrize(("angle", "slips"), [(0.0, False), (0.1, True), (0.3, False)])
def test_fingers_across_corners_hold_as_far_as_friction_goes(skeleton, angle, slips) -> None:
    """A square turned by an angle is cos + sin wide, its corners cos - sin apart."""
    side = 0.07
    width = side * (math.cos(angle) + math.sin(angle))
    pose = turned("z", angle, (-0.02, 0.0, 0.0))
    found = grip_fault(skeleton, width, single(Box((side, side, 0.1))), "it", pose)
    assert (found is not None and "slips" in found) == slips


def test_a_wedge_slips_out(skeleton) -> None:
    """Two blocks like stairs: one finger touches far in front of the other."""
    parts = (
        Part(Box((0.02, 0.02, 0.02)), turned("z", 0, (0.01, 0.01, 0))[:3]),
        Part(Box((0.02, 0.02, 0.02)), turned("z", 0, (-0.05, -0.01, 0))[:3]),
    )
    stairs = Body(parts, 0.1, (0.0, 0.0, 0.0))
    assert "slips" in str(grip_fault(skeleton, 0.04, stairs, "it", np.eye(4)))


TIP = 0.022
"""Metres from the centre of a grasp to the tips of the fingers of the built-in robot."""


def leaning(kind: str, lean: float) -> tuple[Body, Floats, float]:
    """A body, its pose in the tool frame, and how wide it is between the very tips of the
    fingers, where each touches a face that leans by an angle and goes on widening."""
    s, c, t = math.sin(lean), math.cos(lean), math.tan(lean)
    match kind:
        case "rhombus":
            # A corner points to the palm.
            depth = 0.04
            back = TIP - 0.02
            corners = [(0.0, 0.0), (depth, depth * t), (2 * depth, 0.0), (depth, -depth * t)]
            points = tuple((x, y, z) for x, y in corners for z in (-0.05, 0.05))
            return single(Hull(points)), turned("z", 0.0, (back, 0.0, 0.0)), 2 * 0.02 * t
        case "cube":
            back = TIP - 0.02
            half = 0.05 * math.sqrt(2)
            return (
                single(Box((0.1, 0.1, 0.1))),
                turned("z", math.pi / 4, (back + half, 0.0, 0.0)),
                2 * 0.02,
            )
        case "two":
            hull = leaning("rhombus", lean)[0].parts[0].solid
            assert isinstance(hull, Hull)
            halves = [
                Hull(tuple((x, y, z) for x, y, z in hull.points.tolist() if y * side >= 0))
                for side in (1, -1)
            ]
            parts = tuple(Part(half, identity()) for half in halves)
            body = Body(parts, 0.1, (0.0, 0.0, 0.0))
            return body, *leaning("rhombus", lean)[1:]
        case _:
            radius = 0.04
            solid = {
                "cylinder": Cylinder(radius, 0.1),
                "sphere": Sphere(radius),
                "capsule": Capsule(radius, 0.05),
            }[kind]
            return single(solid), turned("z", 0.0, (TIP + radius * s, 0.0, 0.0)), 2 * radius * c


@pytest.mark.parametrize("kind", ["rhombus", "two", "cylinder", "sphere", "capsule"])
@pytest.mark.parametrize(("degrees", "held"), [(20, True), (33, True), (38, False), (55, False)])
def test_what_leans_away_from_the_fingers_is_held_as_far_as_friction_goes(
    skeleton, kind, degrees, held
) -> None:
    """The cone of friction of 0.7 opens by 35 degrees; the contacts are opposite each other."""
    body, pose, width = leaning(kind, math.radians(degrees))
    found = grip_fault(skeleton, width, body, "it", pose)
    assert (found is None) == held, found
    assert held or "leans" in str(found)


def test_a_corner_of_a_cube_that_is_too_large_slips_from_the_tips(skeleton) -> None:
    body, pose, width = leaning("cube", math.pi / 4)
    assert "leans more than 35 degrees" in str(grip_fault(skeleton, width, body, "it", pose))


@pytest.mark.parametrize("shear", [0.0, 0.3, 0.6])
def test_faces_that_lean_the_same_way_turn_between_the_fingers(skeleton, shear) -> None:
    """Parallel to each other: the fingers touch the one with their tips and the other near the
    palm, so that how far they lean and how far they are beside each other add up."""
    points = tuple(
        (x, y + shear * x, z) for x in (-0.03, 0.03) for y in (-0.03, 0.03) for z in (-0.05, 0.05)
    )
    reach = 0.03 + shear * TIP
    found = grip_fault(skeleton, 2 * reach, single(Hull(points)), "it", np.eye(4))
    assert (found is None) == (shear == 0.0), found


def test_a_plan_that_lifts_a_large_box_by_its_corner_is_not_valid() -> None:
    """The same plan is valid where the box is turned so that a narrow side is there."""

    def fault(size: tuple[float, float, float], heading: float, place: float) -> str:
        box = thing("box", size, 0.2, 0.0, 0.402)
        pose = upright(0.2, 0.0, 0.402, heading)
        script = Script(table_world(Movable("box", box.body, pose)))
        script.over(place, 0.0, 0.46).take("box", 0.03).to(place, 0.0, 0.5)
        script.to(place, 0.0, 0.46).put("box", "table", pose).home()
        return script.fault()

    corner = 0.2 + 0.05 * math.sqrt(2) - 0.005  # 15 mm of the corner are between the fingers
    assert fault((0.14, 0.03, 0.1), 0.0, 0.2) == ""
    assert "leans more than" in fault((0.1, 0.1, 0.1), math.pi / 4, corner)


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
