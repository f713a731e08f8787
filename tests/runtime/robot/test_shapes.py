"""Geometry of links: every kind of solid, meshes by path and package, hulls that enclose them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from runtime.robot.hulls import MAX_CORNERS, enclosing_hull, enclosing_hulls
from runtime.robot.meshes import find_mesh, read_mesh
from runtime.robot.outline import outline
from runtime.robot.shapes import hull_as_obj
from runtime.robot.urdf import read_urdf
from runtime.world.body import Mesh
from runtime.world.poses import apply
from runtime.world.solids import Box, Capsule, Cylinder, Hull, Sphere
from sketchlang.errors import InputError


def one_link(folder: Path, geometry: str, name: str = "robot.urdf") -> Path:
    path = folder / name
    path.write_text(
        f'<robot name="one"><link name="body"><collision><origin xyz="1 0 0"/>'
        f"<geometry>{geometry}</geometry></collision></link></robot>"
    )
    return path


def shapes(path: Path):
    return read_urdf(path).shapes["body"]


@pytest.mark.parametrize(
    ("text", "solid"),
    [
        ('<box size="0.1 0.2 0.3"/>', Box((0.1, 0.2, 0.3))),
        ('<cylinder radius="0.1" length="0.4"/>', Cylinder(0.1, 0.4)),
        ('<capsule radius="0.1" length="0.4"/>', Capsule(0.1, 0.4)),
        ('<sphere radius="0.1"/>', Sphere(0.1)),
    ],
)
def test_primitives_are_what_they_are(tmp_path, text, solid) -> None:
    (shape,) = shapes(one_link(tmp_path, text))
    assert shape.solid == solid
    assert shape.pose[:, 3].tolist() == [1.0, 0.0, 0.0]


@pytest.mark.parametrize("suffix", ["stl", "obj", "dae"])
def test_meshes_become_hulls_where_they_are(tmp_path, suffix) -> None:
    mesh = trimesh.creation.icosphere(subdivisions=3, radius=0.1)
    mesh.apply_translation([0.0, 0.2, 0.0])
    mesh.export(tmp_path / f"ball.{suffix}")
    (shape,) = shapes(one_link(tmp_path, f'<mesh filename="ball.{suffix}" scale="2 2 2"/>'))
    assert isinstance(shape.solid, Hull)
    assert shape.pose[:, 3] == pytest.approx([1.0, 0.4, 0.0], abs=0.02)
    assert 0.2 - 1e-6 <= min(shape.half) <= 0.25
    assert len(shape.solid.corners) <= MAX_CORNERS


def test_the_unit_of_a_collada_file_counts(tmp_path) -> None:
    trimesh.creation.box((100, 100, 100)).export(tmp_path / "box.dae")
    text = (tmp_path / "box.dae").read_text()
    assert "<asset>" in text
    unit = '<asset><unit name="millimeter" meter="0.001"/>'
    (tmp_path / "box.dae").write_text(text.replace("<asset>", unit))
    vertices = read_mesh(tmp_path / "box.dae", np.ones(3)).vertices
    assert np.ptp(vertices, axis=0) == pytest.approx([0.1] * 3)


@pytest.mark.parametrize(
    "place", ["arm_description/meshes/ball.stl", "share/arm_description/meshes/ball.stl"]
)
def test_packages_are_looked_for_around_the_file(tmp_path, place, monkeypatch) -> None:
    target = tmp_path / place
    target.parent.mkdir(parents=True)
    trimesh.creation.icosphere(subdivisions=1).export(target)
    folder = target.parents[1] / "urdf"
    folder.mkdir()
    reference = "package://arm_description/meshes/ball.stl"
    assert find_mesh(reference, folder) == target
    # From anywhere, where ROS knows its packages.
    with pytest.raises(InputError, match="is not there"):
        find_mesh(reference, tmp_path.parent)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    assert find_mesh(reference, tmp_path.parent) == target


@pytest.mark.parametrize(
    ("name", "content", "word"),
    [
        ("bad.stl", b"no mesh at all", "bad.stl"),
        ("bad.obj", b"v 0 0 nan\nv 1 0 0\n", "bad.obj"),
        ("bad.dae", b"<!DOCTYPE x><COLLADA/>", "document type"),
        ("bad.step", b"", "format"),
    ],
)
def test_meshes_that_cannot_be_read_are_named_with_their_link(
    tmp_path, name, content, word
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError) as caught:
        shapes(one_link(tmp_path, f'<mesh filename="{name}"/>'))
    assert "'body'" in str(caught.value)
    assert word in str(caught.value)


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    count=st.integers(1, 400),
    scale=st.tuples(*[st.sampled_from([0.0, 1e-3, 0.05, 1.0])] * 3),
)
def test_hulls_enclose_their_points(seed, count, scale) -> None:
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    points = (rng.normal(size=(count, 3)) * scale) @ turn.T + rng.normal(size=3)
    hull, pose = enclosing_hull(points)
    assert len(hull.corners) <= MAX_CORNERS
    planes = ConvexHull(apply(pose, hull.points), qhull_options="QJ").equations
    assert (points @ planes[:, :3].T + planes[:, 3]).max() < 1e-4
    low, high = hull.points.min(axis=0), hull.points.max(axis=0)
    assert low == pytest.approx(-high, abs=2e-6)


def test_a_branching_mesh_is_cut_and_what_it_encloses_stays_covered(rng) -> None:
    parts = [trimesh.creation.box((0.5, 0.1, 0.1)), trimesh.creation.box((0.1, 0.1, 0.5))]
    parts[1].apply_translation([0.2, 0.0, 0.3])
    tee = trimesh.util.concatenate(parts)
    hulls = enclosing_hulls(Mesh(np.array(tee.vertices), np.array(tee.faces)))
    assert len(hulls) > 1
    assert sum(hull.volume for hull, _ in hulls) < 0.6 * tee.convex_hull.volume
    within = [part.center_mass + rng.uniform(-0.04, 0.04, (50, 3)) for part in parts]
    points = np.vstack([*(part.sample(300) for part in parts), *within])
    inside = np.zeros(len(points), dtype=bool)
    for hull, pose in hulls:
        planes = ConvexHull(apply(pose, hull.points)).equations
        inside |= (points @ planes[:, :3].T + planes[:, 3]).max(axis=1) < 1e-5
    assert inside.all()


def test_written_hulls_are_read_as_they_are(tmp_path) -> None:
    trimesh.creation.icosphere(subdivisions=2, radius=0.1).export(tmp_path / "ball.stl")
    (shape,) = shapes(one_link(tmp_path, '<mesh filename="ball.stl"/>'))
    (tmp_path / "hull.obj").write_text(hull_as_obj(shape))
    again = read_urdf(one_link(tmp_path, '<mesh filename="hull.obj"/>')).shapes["body"][0]
    assert len(again.solid.corners) == len(shape.solid.corners)
    first = shape.solid.points @ shape.pose[:, :3].T + shape.pose[:, 3] + [1.0, 0.0, 0.0]
    second = again.solid.points @ again.pose[:, :3].T + again.pose[:, 3]
    assert second == pytest.approx(first, abs=3e-6)


@pytest.mark.parametrize(
    "solid", [Box((0.1, 0.2, 0.3)), Cylinder(0.1, 0.3), Sphere(0.2), Capsule(0.1, 0.3)]
)
def test_outlines_hold_their_solids(solid, rng) -> None:
    direction = rng.normal(size=(200, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    reach = (outline(solid) @ direction.T).max(axis=0)
    flat = np.hypot(direction[:, 0], direction[:, 1])
    match solid:
        case Box():
            exact = np.abs(direction) @ np.array(solid.half)
        case Cylinder():
            exact = solid.radius * flat + solid.height / 2 * np.abs(direction[:, 2])
        case Sphere():
            exact = np.full(200, solid.radius)
        case Capsule():
            exact = solid.radius + solid.height / 2 * np.abs(direction[:, 2])
    assert (reach >= exact - 1e-9).all()
    assert (reach <= exact * 1.2).all()
