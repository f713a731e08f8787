"""Layouts of parts in a rack, against points on a fine grid."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from domains.tabletop.kinder.packing import APART, PartShape, fit, gap, shape_of, turned
from runtime.world.load_mesh import load_mesh
from tests.tabletop.kinder.observations import cuboid, observation, triangle

PARTS = {
    "square": cuboid(0, 0, 0, (0.05, 0.05, 0.01)),
    "right": triangle(0, 0, 0, right=True),
    "equilateral": triangle(0, 0, 0, right=False),
}
SHAPES = {
    name: shape_of(observation({"part": part}).things["part"]) for name, part in PARTS.items()
}
HALF = (0.09, 0.14)


def inside(outline, points):
    """Which points (n, 2) are in a convex outline, counter-clockwise."""
    along = np.roll(outline, -1, axis=0) - outline
    to = points[:, None] - outline
    return (along[:, 0] * to[..., 1] - along[:, 1] * to[..., 0] >= 0).all(axis=1)


GRID = np.stack(np.meshgrid(np.linspace(-0.1, 0.1, 201), np.linspace(-0.15, 0.15, 301)), -1)
POINTS = GRID.reshape(-1, 2)


@pytest.mark.parametrize(
    "names",
    [
        ["square"],
        ["square", "square"],
        ["right", "square", "equilateral"],
        ["right", "right", "right"],
        ["square", "square", "right"],
        ["equilateral", "equilateral", "equilateral"],
    ],
)
def test_parts_fit_side_by_side(names) -> None:
    shapes = [SHAPES[name] for name in names]
    layout = fit(shapes, HALF)
    assert layout is not None
    outlines = [
        turned(shape.outline, yaw) + np.array([x, y])
        for shape, (x, y, yaw) in zip(shapes, layout, strict=True)
    ]
    for outline in outlines:
        assert (np.abs(outline) <= np.array(HALF) - APART + 1e-9).all()
    covered = sum(inside(outline, POINTS).astype(int) for outline in outlines)
    assert covered.max() == 1


def test_what_does_not_fit_is_not_laid_out() -> None:
    assert fit([SHAPES["square"]] * 4, HALF) is None
    assert fit([PartShape(SHAPES["square"].outline * 2, 0.02)], HALF) is None


@settings(deadline=None, max_examples=60)
@given(
    st.sampled_from(list(SHAPES)), st.sampled_from(list(SHAPES)),
    st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), st.floats(0, 6.28),
)  # fmt: skip
def test_gaps_are_never_more_than_distances(one, other, x, y, yaw) -> None:
    a = SHAPES[one].outline
    b = turned(SHAPES[other].outline, yaw) + np.array([x, y])

    def edge(outline):
        share = np.linspace(0, 1, 40)[:, None, None]
        return (outline * (1 - share) + np.roll(outline, -1, axis=0) * share).reshape(-1, 2)

    distance = np.linalg.norm(edge(a)[:, None] - edge(b), axis=2).min()
    apart = not inside(a, edge(b)).any() and not inside(b, edge(a)).any()
    if apart:
        assert gap(a, b) <= distance + 1e-9
    else:
        assert gap(a, b) <= 1e-9
    assert gap(a, b) == pytest.approx(gap(b, a))


@pytest.mark.parametrize("name", SHAPES)
def test_smaller_parts_have_their_sides_further_in(name) -> None:
    shape, by = SHAPES[name], 0.001
    smaller = shape.smaller(by)
    assert smaller.outline.mean(axis=0) == pytest.approx(shape.outline.mean(axis=0))
    sides = np.roll(shape.outline, -1, axis=0) - shape.outline
    normals = np.column_stack([-sides[:, 1], sides[:, 0]])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    inwards = ((smaller.outline[:, None] - shape.outline) * normals).sum(axis=2).min(axis=0)
    assert (inwards >= by - 1e-9).all()
    assert (inwards <= 1.5 * by).all()
    assert smaller.smaller(0.0).outline == pytest.approx(smaller.outline)


@pytest.mark.parametrize("name", SHAPES)
def test_meshes_are_a_slab_and_a_peg(tmp_path, name) -> None:
    path = tmp_path / "part.obj"
    path.write_text(SHAPES[name].mesh())
    body = load_mesh(path)
    assert len(body.parts) == 2
    slab = 0.01 if name == "square" else 0.005 if name == "right" else math.sqrt(3) / 4 * 0.01
    assert body.mass == pytest.approx(500 * (slab * 0.02 + 0.02**2 * 0.05), rel=1e-3)
