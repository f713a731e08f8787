"""Meshes of solids, mesh files, and what a mesh becomes for the planner."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from runtime.world import decompose, load_mesh
from runtime.world.making import open_box
from runtime.world.mesh import body_mesh, mesh_of, volume_and_centre
from runtime.world.poses import apply, invert
from runtime.world.solids import Capsule, Cylinder, Hull, Sphere
from sketchlang.errors import InputError
from tests.runtime.solids import KINDS, random_solid

KITCHEN = Path(load_mesh.__file__).parents[2] / "domains" / "kitchen" / "meshes" / "mug.obj"


@pytest.mark.parametrize("kind", KINDS)
def test_meshes_are_closed_and_have_the_volume_of_their_solids(kind, rng) -> None:
    trimesh = pytest.importorskip("trimesh")
    for _ in range(5):
        solid = random_solid(rng, kind)
        mesh = mesh_of(solid)
        tri = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        assert tri.is_watertight
        assert tri.is_winding_consistent
        volume, centre = volume_and_centre(mesh)
        assert volume == pytest.approx(tri.volume)
        assert centre == pytest.approx(tri.center_mass, abs=1e-9)
        if isinstance(solid, Cylinder | Sphere | Capsule):  # corners are on the surface
            assert 0.9 * solid.volume < volume < solid.volume
        else:
            assert volume == pytest.approx(solid.volume)
        assert np.abs(mesh.vertices).max(axis=0) == pytest.approx(solid.half)


def holds(body, point) -> bool:
    """Whether a point is in one of a body's hulls."""
    from scipy.spatial import ConvexHull

    for part in body.parts:
        assert isinstance(part.solid, Hull)
        local = apply(invert(part.pose), np.array([point], dtype=float))[0]
        planes = ConvexHull(part.solid.points).equations
        if np.all(planes[:, :3] @ local + planes[:, 3] <= 1e-9):
            return True
    return False


def test_the_mug_keeps_its_hollow_and_its_handle(monkeypatch) -> None:
    monkeypatch.setattr(decompose, "_by_coacd", lambda mesh: pytest.fail("its pieces are convex"))
    mug = load_mesh.load_mesh(KITCHEN, mass=0.25)
    low, high = mug.bounds
    assert (low + high)[:2] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert (low[2], high[2]) == pytest.approx((0.0, 0.09))
    wall = low[0]
    inside = [wall + 0.034, 0.0]
    assert not holds(mug, [*inside, 0.05])
    assert holds(mug, [*inside, 0.002])
    assert holds(mug, [wall + 0.002, 0.004, 0.05])
    assert not holds(mug, [high[0] - 0.015, 0.0, 0.047])  # through the handle one can reach
    assert holds(mug, [high[0] - 0.004, 0.0, 0.047])
    assert mug.mass == 0.25


def bowl(folder: Path) -> Path:
    """A mug in one piece, that is not convex: a floor with walls, joined to one surface."""
    trimesh = pytest.importorskip("trimesh")
    profile = [[0, 0], [0.04, 0], [0.04, 0.09], [0.036, 0.09], [0.036, 0.005], [0, 0.005]]
    path = folder / "bowl.stl"
    trimesh.creation.revolve(np.array(profile), sections=12).export(path)
    return path


@pytest.mark.slow
def test_a_surface_of_one_piece_is_decomposed_and_remembered(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    path = bowl(tmp_path)
    body = load_mesh.load_mesh(path)
    assert 4 < len(body.parts) <= decompose.MOST_HULLS
    assert not holds(body, [0.0, 0.0, 0.05])
    assert holds(body, [0.0, 0.0, 0.002])
    monkeypatch.setattr(decompose, "_by_coacd", lambda mesh: pytest.fail("computed twice"))
    again = load_mesh.load_mesh(path)
    assert [p.solid for p in again.parts] == [p.solid for p in body.parts]
    assert body.mass == pytest.approx(500 * (np.pi * (0.04**2 * 0.09 - 0.036**2 * 0.085)), rel=0.1)


def test_what_the_cache_holds_is_not_trusted(tmp_path) -> None:
    path = tmp_path / "hulls.json"
    for text in ("", "{", "[]", "[[1, 2]]", "[[[0, 0]]]", '[[[0, 0, "x"]]]', "null"):
        path.write_text(text, encoding="utf-8")
        assert decompose._read(path) is None


TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
BAD = {
    "thing.txt": (TETRAHEDRON, "kind"),
    "empty.obj": ("", "mesh|triangles|surface"),
    "flat.obj": (
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\nf 1 3 2\nf 2 3 4\n",
        "less than",
    ),
    "huge.obj": (TETRAHEDRON.replace("1 0 0", "1000 0 0"), "more than 5 m"),
    "tiny.obj": (TETRAHEDRON.replace("0 0 1", "0 0 0.0001"), "less than"),
    "noise.stl": ("\x01" * 200, "mesh|triangles|surface"),
    "nan.obj": (TETRAHEDRON.replace("0 0 1", "0 0 nan"), "numbers|mesh"),
}


@pytest.mark.parametrize(("name", "bad"), BAD.items(), ids=BAD)
def test_what_is_no_mesh_for_us_is_said(tmp_path, name, bad) -> None:
    path = tmp_path / name
    path.write_text(bad[0], encoding="utf-8")
    with pytest.raises(InputError, match=bad[1]) as caught:
        load_mesh.load_mesh(path)
    assert caught.value.place == str(path)


def test_scale_and_missing_files(tmp_path) -> None:
    path = tmp_path / "t.obj"
    path.write_text(TETRAHEDRON.replace("1", "100"), encoding="utf-8")
    path.write_text(
        "v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    )
    body = load_mesh.load_mesh(path, scale=0.001)
    assert len(body.parts) == 1
    assert body.mass == pytest.approx(500 * 0.1**3 / 6)
    with pytest.raises(InputError, match="no such file"):
        load_mesh.load_mesh(tmp_path / "missing.obj")


def test_bodies_look_like_all_their_parts() -> None:
    tray = open_box((0.3, 0.2, 0.05), 0.01)
    volume, _ = volume_and_centre(body_mesh(tray))
    assert volume == pytest.approx(tray.mass / 500)
    assert volume == pytest.approx(0.3 * 0.2 * 0.05 - 0.28 * 0.18 * 0.04)
