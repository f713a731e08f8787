"""Mesh files as bodies (trimesh reads them, and only here is it needed)."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from runtime.world.body import Body, Mesh
from runtime.world.decompose import decompose
from runtime.world.making import body_of
from runtime.world.solids import Floats
from sketchlang.errors import InputError
from sketchlang.reading import read_bytes

if TYPE_CHECKING:
    from trimesh import Trimesh

KINDS = (".obj", ".stl", ".ply", ".off", ".glb")
LARGEST_FILE = 20 << 20
MOST_FACES = 100_000
SMALLEST = 0.002
"""Metres that a mesh has to measure along each axis."""

LARGEST = 5.0
"""Metres that it may measure."""


def load_mesh(path: Path, scale: float = 1.0, mass: float | None = None) -> Body:
    """A body with the mesh of a file, `scale` times as large: its frame is in the middle of its
    bottom, its axes are those of the file, z up.

    Raises:
        InputError: the file cannot be read, holds no triangles, or is too large.
    """
    found = _read(path)
    vertices, faces = np.array(found.vertices, dtype=float), np.array(found.faces)
    watertight = bool(found.is_watertight and found.is_winding_consistent)
    vertices = vertices * scale
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    _refuse_size(path, high - low)
    vertices = vertices - [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]]
    if watertight and found.volume < 0:
        faces = faces[:, ::-1]
    mesh = Mesh(vertices, faces)
    return body_of(decompose(mesh, watertight), mass, mesh)


def pieces_of_mesh(path: Path) -> list[Floats]:
    """The corners (k, 3) of each connected piece of a mesh file, in its own frame.

    Raises:
        InputError: as above.
    """
    return [np.array(piece.vertices) for piece in _read(path).split(only_watertight=False)]


def filling(path: Path) -> float:
    """How much of the convex hull of a mesh file it fills, from 0 to 1; 1 where that cannot be
    said, for its surface is not closed.

    Raises:
        InputError: as above.
    """
    mesh = _read(path)
    whole = float(mesh.convex_hull.volume)
    return min(1.0, abs(float(mesh.volume)) / whole) if mesh.is_volume and whole > 0 else 1.0


def _read(path: Path) -> Trimesh:
    import trimesh

    if path.suffix.lower() not in KINDS:
        raise InputError(
            f"is of a kind that is not read: {path.suffix or 'no ending'}",
            place=str(path),
            hint=f"meshes are {', '.join(KINDS)} files",
        )
    data = read_bytes(path, LARGEST_FILE)
    try:
        found: Trimesh = trimesh.load(
            io.BytesIO(data), file_type=path.suffix.lower()[1:], force="mesh", process=True
        )
        vertices, faces = np.array(found.vertices, dtype=float), np.array(found.faces)
        found.is_watertight, found.is_winding_consistent  # noqa: B018 (they can fail, too)
    except Exception as error:  # each format fails in its own ways
        raise InputError(f"cannot be read as a mesh: {error}", place=str(path)) from None
    _refuse(path, vertices, faces)
    return found


def _refuse(path: Path, vertices: np.ndarray, faces: np.ndarray) -> None:
    if len(faces) < 4:
        raise InputError("holds no closed surface: it has fewer than 4 triangles", place=str(path))
    if len(faces) > MOST_FACES:
        raise InputError(
            f"has {len(faces)} triangles, more than {MOST_FACES}",
            place=str(path),
            hint="simplify it: planning sees convex pieces of a few corners all the same",
        )
    if not np.isfinite(vertices).all():
        raise InputError("has coordinates that are no numbers", place=str(path))


def _refuse_size(path: Path, size: np.ndarray) -> None:
    shown = " x ".join(f"{length:.4g}" for length in size)
    if size.max() > LARGEST:
        hint = "`scale` makes it smaller: scale = 0.001 for a file in millimetres"
        raise InputError(f"measures {shown} m, more than {LARGEST:g} m", place=str(path), hint=hint)
    if size.min() < SMALLEST:
        hint = "`scale` makes it larger; a mesh must not be flat"
        message = f"measures {shown} m, less than {1000 * SMALLEST:g} mm along one axis"
        raise InputError(message, place=str(path), hint=hint)
