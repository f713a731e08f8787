"""What the shape of an object says about grasping it, against points on its surface."""

from __future__ import annotations

import math

import numpy as np
import pytest

from domains.tabletop.hand import Hand, hand_of
from domains.tabletop.items import GRASP_HEIGHT, PALM_AIR, PINCH_DEPTH, Item, why_not
from domains.tabletop.state import PINCH, SIDE, SLANT, SLOPE, TOP, Grasp
from runtime.robot.load import load_robot
from runtime.world.body import Body, Part
from runtime.world.poses import Pose, apply, compose, invert, upright
from runtime.world.solids import Box, Capsule, Cylinder, Hull, Solid, Sphere
from runtime.world.world import Movable
from tests.runtime.reference import Floats, turn_z

ANGLES = np.linspace(-math.pi, math.pi, 25)
ROUNDING = 0.006
"""Share of its size by which an outline may be larger than what is round."""


@pytest.fixture(scope="module")
def hand() -> Hand:
    return hand_of(load_robot("tiago"))


def movable(*solids: tuple[Solid, Pose], pose: Pose | None = None, mass: float = 0.2) -> Movable:
    """Something of some solids, centre of mass in the middle of the first one."""
    parts = tuple(Part(solid, at) for solid, at in solids)
    x, y, z = solids[0][1][:, 3].tolist()
    body = Body(parts, mass, (x, y, z))
    return Movable("thing", body, upright(0.0, 0.0, 0.0, 0.0) if pose is None else pose)


def lying(x: float, y: float, z: float) -> Pose:
    """A pose in which the body's z axis is along the world's x axis."""
    return np.column_stack([[[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]], [x, y, z]])


def at(z: float, x: float = 0.0, y: float = 0.0) -> Pose:
    return upright(x, y, z, 0.0)


HULL = Hull(((0.03, 0, -0.05), (-0.03, 0.03, -0.05), (-0.03, -0.03, -0.05), (-0.01, 0, 0.05)))
MUG = ((Cylinder(0.04, 0.09), at(0.045)), (Box((0.03, 0.01, 0.06)), at(0.045, 0.055)))
THINGS = {
    "stick": movable((Box((0.04, 0.05, 0.2)), at(0.1))),
    "plate": movable((Box((0.2, 0.15, 0.02)), at(0.01))),
    "can": movable((Cylinder(0.03, 0.12), at(0.06))),
    "lying can": movable((Cylinder(0.03, 0.12), at(0.06)), pose=lying(0.3, 0.2, 0.5)),
    "ball": movable((Sphere(0.035), at(0.035))),
    "pill": movable((Capsule(0.02, 0.06), at(0.05))),
    "mug": movable(*MUG),
    "turned mug": movable(*MUG, pose=upright(1.0, -2.0, 0.3, 2.0)),
    "wedge": movable((HULL, at(0.05))),
}


HEADING = 0.4
"""The heading that objects are said to have at the start: any will do."""


def item_of(thing: Movable) -> Item:
    return Item.of(thing, 0.0, 1)[0]


def surface_points(item: Item, rng: np.random.Generator) -> Floats:
    """Points (n, 3) on the solids, in the standing frame, sampled from their definitions."""
    found = []
    for part in item.parts:
        solid = part.solid
        u = rng.uniform(-1, 1, (4000, 3))
        unit = u / np.linalg.norm(u, axis=1)[:, None]
        match solid:
            case Box():
                points = np.sign(u) * np.where(rng.random(u.shape) < 0.7, 1.0, np.abs(u))
                points = points * solid.size / 2
            case Sphere():
                points = unit * solid.radius
            case Cylinder():
                round_ = u[:, :2] / np.linalg.norm(u[:, :2], axis=1)[:, None] * solid.radius
                points = np.column_stack([round_, u[:, 2] * solid.height / 2])
                points[::3, 2] = np.sign(points[::3, 2]) * solid.height / 2
            case Capsule():
                points = unit * solid.radius
                points[:, 2] += np.sign(points[:, 2]) * solid.height / 2
                straight = points[::2]
                scale = np.linalg.norm(straight[:, :2], axis=1)[:, None]
                straight[:, :2] *= solid.radius / scale
                straight[:, 2] = u[::2, 2] * solid.height / 2
            case Hull():
                weights = rng.dirichlet(np.full(len(solid.points), 0.3), 4000)
                points = np.vstack([weights @ solid.points, solid.points])
        found.append(apply(part.pose, points))
    return np.vstack(found)


@pytest.mark.parametrize("name", THINGS)
def test_the_standing_frame_is_under_the_middle(name, rng) -> None:
    thing = THINGS[name]
    item, (x, y, z, yaw) = Item.of(thing, HEADING, 1)
    points = surface_points(item, rng)
    low, high = points.min(axis=0), points.max(axis=0)
    size = np.array(item.size)
    slack = 0.03 * size.max() + 1e-9
    assert np.abs((low + high)[:2] / 2).max() < slack
    assert abs(low[2]) < slack
    assert (high - low <= size + 1e-9).all(), "the box is around all of it"
    assert (high - low >= size * (1 - ROUNDING) - slack).all()
    # Where the frame is at the start is where the body is at the start.
    assert compose(upright(x, y, z, yaw), item.standing) == pytest.approx(thing.pose)


@pytest.mark.parametrize("name", THINGS)
def test_corners_and_sections_enclose_what_is_there(name, rng) -> None:
    item = item_of(THINGS[name])
    points = surface_points(item, rng)
    low, high = 0.3 * item.size[2], 0.6 * item.size[2]
    between = points[(points[:, 2] > low) & (points[:, 2] < high)][:, :2]
    section, around = np.vstack(item.section(low, high)), item.corners
    seen_twin = []
    for angle in ANGLES:
        direction = np.array([math.cos(angle), math.sin(angle)])
        assert (points[:, :2] @ direction).max() <= (around[:, :2] @ direction).max() + 1e-9
        most, twin = (section @ direction).max(), (between @ direction).max()
        assert twin <= most + 1e-9
        seen_twin.append(most - twin)
    assert min(seen_twin) < 0.05 * max(item.size), "and not by far"


def test_sections_of_a_wedge_are_narrower_further_up() -> None:
    """Exactly: at height z the triangle is 1 - z / 0.1 of its size."""
    item = item_of(THINGS["wedge"])
    for z in (0.02, 0.05, 0.08):
        section = np.vstack(item.section(z, z))
        assert np.ptp(section[:, 1]) == pytest.approx(0.06 * (1 - z / 0.1))
        assert np.ptp(section[:, 0]) == pytest.approx(0.06 * (1 - z / 0.1))


@pytest.mark.parametrize("family", [SIDE, TOP, PINCH])
@pytest.mark.parametrize("name", THINGS)
def test_holds_agree_with_points_on_the_surface(hand, name, family, rng) -> None:
    item = item_of(THINGS[name])
    hold = item.holds(hand, family, ANGLES)
    if hold is None:
        return
    assert 0.0 < hold.height < item.size[2] + hand.back
    points = surface_points(item, rng)
    if family == SIDE:
        points = points[np.abs(points[:, 2] - hold.height) <= hand.pad]
    elif family == TOP:
        points = points[points[:, 2] >= hold.height - hand.tip]
    slack = 0.05 * max(item.size)
    for k, angle in enumerate(ANGLES):
        seen = points @ turn_z(angle)
        near, far = seen[:, 0].min(), seen[:, 0].max()
        low, high = seen[:, 2].min(), seen[:, 2].max()
        behind, ahead = (hand.pad, hand.pad) if family == TOP else (hand.back, hand.tip)
        between = np.abs(seen[:, 0] - hold.along[k] + (behind - ahead) / 2) <= (behind + ahead) / 2
        if between.sum() < 30:
            continue
        right, left = seen[between, 1].min(), seen[between, 1].max()
        width = high - low if family == PINCH else left - right
        assert width <= hold.width[k] + 1e-9
        assert width >= hold.width[k] * (1 - ROUNDING) - slack
        middle = (left + right) / 2
        assert hold.aside[k] == pytest.approx(middle, abs=slack)
        if not hold.fits[k]:
            continue
        assert hold.width[k] + 2 * hand.clearance <= hand.max_opening + 1e-9
        if family == SIDE:
            assert near < hold.along[k] <= near + hand.back + slack, "the palm is in front of it"
        elif family == PINCH:
            depth = hold.along[k] - near
            assert -slack < depth <= min(PINCH_DEPTH, hand.back - PALM_AIR) + slack
        else:
            assert near - slack < hold.along[k] < far + slack


@pytest.mark.parametrize("name", THINGS)
@pytest.mark.parametrize("flipped", [False, True])
def test_what_is_taken_aslant_is_between_the_fingers(hand, name, flipped, rng) -> None:
    """Points on the surface, in the frame of the tool: those between the fingers are as wide as it
    is said, none is behind the palm, and the fingers stay above what the object stands on."""
    item = item_of(THINGS[name])
    hold = item.holds(hand, SLANT, ANGLES)
    if hold is None:
        return
    points = surface_points(item, rng)
    for k, angle in enumerate(ANGLES):
        if not hold.fits[k]:
            continue
        tool = item.grasp(hold, k, angle, flipped).tool
        assert tool[2, 0] == pytest.approx(-SLOPE)
        assert tool[2, 1] == 0.0
        ahead, across, up = apply(invert(tool), points).T
        between = (ahead > -hand.back) & (ahead < hand.tip) & (np.abs(up) < hand.pad)
        if between.sum() > 30:
            assert np.abs(across[between]).max() <= hold.width[k] / 2 + 1e-4
        assert ahead.min() >= -hand.back + PALM_AIR - 1e-4 or name == "mug"
        for x, z in ((hand.tip, hand.pad), (hand.tip, -hand.pad)):
            assert apply(tool, np.array([[x, 0.0, z]]))[0, 2] >= PALM_AIR - 1e-6
        assert hold.along[k] > (points @ turn_z(angle))[:, 0].min()


def test_some_things_are_taken_aslant(hand) -> None:
    holds = {name: item_of(thing).holds(hand, SLANT, ANGLES) for name, thing in THINGS.items()}
    taken = {name for name, hold in holds.items() if hold is not None and hold.fits.any()}
    assert {"stick", "can", "lying can"} <= taken
    assert "plate" not in taken  # too wide, and too low for the tips


def test_low_objects_are_gripped_lower(hand) -> None:
    tall = item_of(movable((Box((0.04, 0.04, 0.3)), at(0.15))))
    low = item_of(movable((Box((0.04, 0.04, 0.06)), at(0.03))))
    assert tall.holds(hand, SIDE, ANGLES).height == GRASP_HEIGHT
    assert 0.0 < low.holds(hand, SIDE, ANGLES).height < 0.06


def test_radii_are_inside_and_around() -> None:
    item = item_of(movable((Box((0.03, 0.04, 0.2)), at(0.1))))
    assert item.inner_radius == pytest.approx(0.015)
    assert item.outer_radius == pytest.approx(0.025)


@pytest.mark.parametrize("size", [(1e-6, 0.04, 0.2), (0.04, 0.04, 1e-6), (19.0, 0.001, 3.0)])
@pytest.mark.parametrize("family", [SIDE, TOP, PINCH])
def test_extreme_boxes_are_answered(hand, size, family) -> None:
    item = item_of(movable((Box(size), at(size[2] / 2))))
    hold = item.holds(hand, family, ANGLES)
    assert hold is None or np.isfinite(np.vstack([hold.width, hold.along, hold.aside])).all()
    if family == SIDE:
        assert hold is not None
        assert 0.0 < hold.height < size[2]


def test_what_cannot_be_held_says_why(hand) -> None:
    crate = item_of(movable((Box((0.4, 0.3, 0.3)), at(0.15))))
    assert "mm across at its narrowest" in (why_not(crate, hand, (SIDE, TOP, PINCH)) or "")
    assert why_not(item_of(THINGS["can"]), hand, (SIDE,)) is None


@pytest.mark.parametrize("flipped", [False, True])
@pytest.mark.parametrize("family", [SIDE, TOP, PINCH])
@pytest.mark.parametrize("angle", [0.0, 0.7, 2.5, -1.9])
def test_a_tool_frame_is_a_rotation_with_the_axes_of_its_family(family, angle, flipped) -> None:
    grasp = Grasp.of(angle, 0.1, flipped, family, along=0.02, aside=-0.01)
    tool = grasp.tool
    x, y, z = tool[:, :3].T
    assert tool[:, :3].T @ tool[:, :3] == pytest.approx(np.eye(3), abs=1e-9)
    assert np.cross(x, y) == pytest.approx(z, abs=1e-9)
    heading = np.array([math.cos(angle), math.sin(angle), 0.0])
    left = np.array([-math.sin(angle), math.cos(angle), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    sign = -1.0 if flipped else 1.0
    if family == SIDE:
        assert x == pytest.approx(heading, abs=1e-4)
        assert y == pytest.approx(sign * left, abs=1e-4)
    elif family == TOP:
        assert x == pytest.approx(-up, abs=1e-9)
        assert y == pytest.approx(sign * left, abs=1e-4)
        assert z == pytest.approx(sign * heading, abs=1e-4)
    else:
        assert x == pytest.approx(heading, abs=1e-4)
        assert y == pytest.approx(sign * up, abs=1e-9)
    assert tool[:, 3] == pytest.approx(0.02 * heading - 0.01 * left + 0.1 * up, abs=1e-4)


def test_the_room_that_is_filled_is_that_of_the_outline() -> None:
    """Against points of the outline: none of them is nearer to the middle."""
    corner = Hull(
        ((0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.02), (0.1, 0, 0.02), (0, 0.1, 0.02))
    )
    assert item_of(movable((corner, at(0.0)))).inner_radius == pytest.approx(0.0, abs=1e-9)
    low = Hull(((0, 0, 0), (0.1, 0, 0), (0.1, 0.04, 0), (0, 0.1, 0), (0, 0, 0.02), (0.1, 0, 0.02)))
    item = item_of(movable((low, at(0.0))))
    (outline,) = item.section(0.0, item.size[2])
    share = np.linspace(0, 1, 200)[:, None, None]
    edge = (outline * (1 - share) + np.roll(outline, -1, axis=0) * share).reshape(-1, 2)
    assert item.inner_radius == pytest.approx(np.hypot(*edge.T).min(), abs=1e-4)
    box = item_of(THINGS["plate"])
    assert box.inner_radius == 0.075
    assert item_of(THINGS["can"]).inner_radius == pytest.approx(0.03, rel=ROUNDING)


def test_a_slab_is_taken_by_the_knob_on_it(hand) -> None:
    """Though it would fit between the fingers along some headings."""
    slab = Hull(((0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.02), (0.1, 0, 0.02), (0, 0.1, 0.02)))
    knob = Box((0.02, 0.02, 0.08)), at(0.06, 0.033, 0.033)  # first: the centre of mass is there
    item = item_of(movable(knob, (slab, at(0.0))))
    hold = item.holds(hand, TOP, ANGLES)
    assert hold.fits.all()
    assert hold.height - hand.tip > 0.02
    assert (hold.width < 0.03).all()
