"""What is drawn: robots without gaps, meshes with fewer triangles, nothing that looks inwards."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from runtime.robot.load import built_in_robots, load_robot
from runtime.robot.shapes import Visual
from runtime.show import forms
from runtime.show.decimate import decimated
from runtime.show.forms import Triangles
from runtime.show.looks import BUDGET, looks_of
from runtime.show.pack import packed
from runtime.show.parts import Node, Part
from runtime.show.shading import shaded
from runtime.trace.kinematics import Tree
from runtime.trace.make import trace_robot
from runtime.trace.model import TraceRobot
from runtime.trace.read import read_trace
from runtime.trace.write import write_trace
from runtime.world.poses import Floats

FORMS = {
    "box": (forms.rounded_box((0.2, 0.1, 0.3), 0.02), 0.2 * 0.1 * 0.3),
    "cylinder": (forms.cylinder(0.1, 0.4, 0.01, 96), np.pi * 0.01 * 0.4),
    "tube": (forms.tube([[0, 0, 0, 0.1], [0, 0, 0.5, 0.1]]), np.pi * (0.005 + 4 / 3 * 0.001)),
    "bent": (forms.tube([[0, 0, 0, 0.05], [0.1, 0, 0, 0.05], [0.2, 0.1, 0, 0.04]]), None),
    "loft": (forms.loft([[0, 0.1, 0.2], [0.5, 0.1, 0.2]], 2.0, 0.001), np.pi * 0.02 * 0.5),
}


def closed(triangles: Triangles) -> trimesh.Trimesh:
    return trimesh.Trimesh(*forms.welded(*triangles), process=False)


@pytest.mark.parametrize("name", FORMS)
def test_forms_are_closed_and_face_outwards(name) -> None:
    triangles, volume = FORMS[name]
    mesh = closed(triangles)
    assert mesh.is_watertight
    assert mesh.volume > 0
    if volume is not None:
        assert mesh.volume == pytest.approx(volume, rel=0.04)


@pytest.mark.parametrize("name", FORMS)
def test_normals_point_outwards(name) -> None:
    vertices, normals, faces = shaded(*FORMS[name][0])
    corners = vertices[faces]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-6)
    assert ((normals[faces] * flat[:, None]).sum(axis=2) > -1e-12).all()


def test_edges_of_a_box_stay_sharp() -> None:
    mesh = trimesh.creation.box((1, 1, 1))
    _, normals, _ = shaded(np.asarray(mesh.vertices), np.asarray(mesh.faces))
    assert np.sort(np.abs(normals), axis=1) == pytest.approx(
        np.repeat([[0.0, 0.0, 1.0]], len(normals), axis=0), abs=1e-9
    )


def test_packed_parts_are_where_they_were() -> None:
    vertices, faces = FORMS["bent"][0]
    data = packed(Part(Node("link", "a"), vertices, faces, (0.5, 0.5, 0.5)), {Node("link", "a"): 3})
    import base64

    steps = np.frombuffer(base64.b64decode(data["points"]), "<u2").reshape(-1, 3)
    low, size = np.array(data["box"][:3]), np.array(data["box"][3:])
    found = low + size * steps / 65535
    assert {*map(tuple, np.round(found, 4))} == {*map(tuple, np.round(vertices, 4))} or np.abs(
        found.min(axis=0) - vertices.min(axis=0)
    ).max() < 1e-5
    assert data["node"] == 3


def surfaces(robot: TraceRobot) -> dict[str, Floats]:
    """Points on what is seen of each link, in the world, in the home posture."""
    poses = Tree(robot).links(np.zeros(3), robot.home, robot.max_opening)
    found: dict[str, Floats] = {}
    for link, triangles, _ in looks_of(robot):
        points, _ = trimesh.sample.sample_surface(closed(triangles), 1500, seed=0)
        placed = points @ poses[link][:3, :3].T + poses[link][:3, 3]
        found[link] = np.concatenate([found.get(link, np.empty((0, 3))), placed])
    return found


@pytest.mark.parametrize("name", built_in_robots())
def test_built_in_robots_have_no_gaps(name) -> None:
    """Each link that is seen touches the link above it that is seen, within a centimetre."""
    robot = trace_robot(load_robot(name))
    placed, joints = surfaces(robot), robot.urdf.joints
    assert placed.keys() >= {link for link, shapes in robot.urdf.shapes.items() if shapes}
    for link, points in placed.items():
        above = link
        while above in joints and (above == link or above not in placed):
            above = joints[above].parent
        if above in placed and above != link:
            assert cKDTree(placed[above]).query(points)[0].min() < 0.01, (link, above)


@pytest.fixture
def with_mesh(tmp_path) -> tuple[object, int]:
    """A robot, one link of which is seen as a large STL file."""
    path: Path = tmp_path / "ball.stl"
    ball = trimesh.creation.icosphere(subdivisions=6, radius=0.1)
    ball.export(path)
    robot = trace_robot(load_robot("ur5e_desk"))
    pose = np.eye(4)[:3]
    visuals = {"base": (Visual(pose, None, path, np.full(3, 2.0), (1.0, 0.0, 0.0)),)}
    return replace(robot, name="mine", urdf=replace(robot.urdf, visuals=visuals)), len(ball.faces)


def test_visual_meshes_are_drawn_with_fewer_triangles(with_mesh) -> None:
    robot, many = with_mesh
    assert many > BUDGET
    ((_, (vertices, faces), colour),) = [look for look in looks_of(robot) if look[0] == "base"]
    assert BUDGET / 2 < len(faces) <= BUDGET
    assert colour == (1.0, 0.0, 0.0)
    assert np.linalg.norm(vertices, axis=1) == pytest.approx(0.2, abs=2e-3)
    # What has no visual of its own is drawn as what it collides with.
    assert "forearm" in {link for link, _, _ in looks_of(robot)}


def test_a_trace_file_keeps_the_meshes(with_mesh, trace, tmp_path) -> None:
    robot, _ = with_mesh
    ball = [look for look in looks_of(robot) if look[0] == "base"]
    small = replace(trace.robot, name="mine", looks=(("base_link", *ball[0][1:]),))
    path = tmp_path / "trace.json"
    write_trace(replace(trace, robot=small), path)
    ((link, (vertices, faces), colour), *_) = looks_of(read_trace(path).robot)
    assert (link, colour) == ("base_link", (1.0, 0.0, 0.0))
    assert vertices == pytest.approx(ball[0][1][0], abs=1e-6)
    assert (faces == ball[0][1][1]).all()


def test_few_triangles_are_left_as_they_are() -> None:
    vertices, faces = FORMS["box"][0]
    assert decimated(vertices, faces, 1.0)[1] is faces
