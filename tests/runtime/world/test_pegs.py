"""Rings around knobs and holes, and hollows that go over them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from runtime.world.body import Part
from runtime.world.making import body_of, open_box, standing
from runtime.world.pegs import (
    ABOVE,
    PLAY,
    Hollow,
    hollow_of,
    hollow_of_body,
    name_of_ring,
    owner_of_ring,
    ring_of,
)
from runtime.world.poses import compose, rotation_from_rpy, upright
from runtime.world.solids import Box, Cylinder
from runtime.world.stable import stable_poses
from runtime.world.tops import top_of
from runtime.world.world import Peg

AIR = 0.002
PLATE = Part(Box((0.1, 0.08, 0.02)), upright(0, 0, 0.01, 0))


def frame(inner: float, outer: float, height: float) -> tuple[Part, ...]:
    """A square frame of four boards, open above and below."""
    board, out = (outer - inner) / 2, (outer + inner) / 4
    return tuple(
        Part(
            Box((outer, board, height)),
            compose(upright(0, 0, 0, k * math.pi / 2), upright(0, out, height / 2, 0)),
        )
        for k in range(4)
    )


def knobbed(radius: float, height: float, x: float = 0.0):
    knob = Part(Cylinder(radius, height), upright(x, 0, 0.02 + height / 2, 0))
    return body_of([PLATE, knob])


def test_the_place_around_a_knob_is_what_it_leaves_free_on_all_sides() -> None:
    body = knobbed(0.01, 0.05)
    ring = ring_of("lid", body, stable_poses(body)[0], AIR)
    assert ring is not None
    assert owner_of_ring(ring.name) == ring.owner == "lid"
    assert ring.pose[:, 3] == pytest.approx([0.0, 0.0, 0.02 + AIR])
    assert sorted(ring.half) == pytest.approx([0.04, 0.05])
    assert ring.peg is not None
    assert ring.peg.radius == pytest.approx(0.01, rel=0.01)
    assert ring.peg.height == pytest.approx(0.05 - AIR)


def test_it_is_measured_from_the_knob_where_that_is_not_in_the_middle() -> None:
    body = knobbed(0.01, 0.05, x=0.02)
    ring = ring_of("lid", body, stable_poses(body)[0], AIR)
    assert ring is not None
    assert ring.pose[0, 3] == pytest.approx(0.02)
    assert sorted(ring.half) == pytest.approx([0.03, 0.04])


@pytest.mark.parametrize(
    "body",
    [
        standing(Box((0.1, 0.1, 0.02))),
        knobbed(0.038, 0.05),
        knobbed(0.01, 0.05, x=0.044),
        open_box((0.2, 0.2, 0.05), 0.01),
        body_of(
            [
                PLATE,
                *(Part(Box((0.01, 0.01, 0.05)), upright(x, 0, 0.045, 0)) for x in (-0.045, 0.045)),
            ]
        ),
    ],
    ids=["plain", "no shoulder", "at the edge", "tray", "two knobs"],
)
def test_there_is_none_around_what_leaves_no_room_on_some_side(body) -> None:
    assert ring_of("it", body, stable_poses(body)[0], AIR) is None


def test_a_ring_has_a_place_around_its_hole_but_no_peg() -> None:
    body = body_of(frame(0.03, 0.1, 0.03))
    stable = stable_poses(body)[0]
    ring = ring_of("ring", body, stable, AIR)
    assert ring is not None
    assert ring.name == name_of_ring("ring")
    assert ring.peg == Peg(0.0, 0.0)
    assert ring.pose[2, 3] == pytest.approx(0.03 + AIR)
    # The circle within the square outside, to a millimetre.
    assert ring.half[0] * math.sqrt(2) == pytest.approx(0.05, abs=0.0011)
    assert top_of("ring", body, stable, AIR) is not None  # a board of it is wide enough


def test_a_hole_goes_through_and_a_cavity_has_a_roof() -> None:
    through = hollow_of(frame(0.04, 0.1, 0.03))
    assert through == Hollow(pytest.approx(0.02), math.inf)
    lid = Part(Box((0.1, 0.1, 0.01)), upright(0, 0, 0.035, 0))
    assert hollow_of((*frame(0.04, 0.1, 0.03), lid)) == Hollow(
        pytest.approx(0.02), pytest.approx(0.03)
    )
    assert hollow_of((Part(Box((0.1, 0.1, 0.1)), upright(0, 0, 0.05, 0)),)) is None
    assert hollow_of((PLATE, *frame(0.04, 0.1, 0.1))) is None


def test_a_tray_is_hollow_upside_down() -> None:
    tray = open_box((0.3, 0.2, 0.05), 0.01)
    assert hollow_of_body(tray, stable_poses(tray)[0].pose) is None
    over = np.column_stack([rotation_from_rpy(math.pi, 0.0, 0.4), [0.0, 0.0, 0.05]])
    hollow = hollow_of_body(tray, over)
    assert hollow == Hollow(pytest.approx(0.09), pytest.approx(0.04))


def test_what_goes_over_a_peg_has_play_on_all_sides() -> None:
    hollow = Hollow(0.02, 0.05)
    assert hollow.goes_over(Peg(0.02 - PLAY, 0.05 - ABOVE))
    assert not hollow.goes_over(Peg(0.02 - PLAY + 1e-6, 0.01))
    assert not hollow.goes_over(Peg(0.01, 0.05))
    assert Hollow(0.02, math.inf).goes_over(Peg(0.01, 2.0))
