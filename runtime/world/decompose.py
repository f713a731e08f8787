"""A mesh as convex hulls: exact ones where it is a stack of prisms (`layers.py`), else those of an
approximate convex decomposition (CoACD; Wei et al. 2022).

That takes seconds, so the result is kept in the user's cache folder, by the digest of the mesh
and of all settings; where that cannot be written it is computed anew, silently.
"""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path

import numpy as np

from runtime.world.body import Mesh, Part
from runtime.world.layers import layers_of
from runtime.world.poses import upright
from runtime.world.solids import Floats, Hull
from sketchlang.files import cache_folder

CONVEX = 0.03
"""A mesh whose convex hull is larger by this part of its volume at most is taken for convex."""

CONCAVITY = 0.05
"""How deep, relative to the size of the mesh, a dent may be that is filled up."""

MOST_HULLS = 24
MOST_CORNERS = 20
"""Corners of one hull."""

SETTINGS = {
    "threshold": CONCAVITY,
    "max_convex_hull": MOST_HULLS,
    "max_ch_vertex": MOST_CORNERS,
    "decimate": True,
    "preprocess_mode": "auto",
    "mcts_iterations": 60,
    "mcts_max_depth": 2,
    "mcts_nodes": 10,
    "seed": 0,
}


def decompose(mesh: Mesh, watertight: bool) -> list[Part]:
    """Convex hulls that together take up the space of a mesh, in its frame.

    Pieces that do not hang together are taken one by one. Only of a mesh that is watertight can
    be known that it is convex; the others are all decomposed.
    """
    return [part for piece in pieces_of(mesh) for part in _decompose(piece, watertight)]


def pieces_of(mesh: Mesh) -> list[Mesh]:
    """The parts of a mesh that share no corner."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    faces, n = np.asarray(mesh.faces), len(mesh.vertices)
    start, end = faces.ravel(), np.roll(faces, 1, axis=1).ravel()
    links = coo_matrix((np.ones(len(start)), (start, end)), shape=(n, n))
    _, piece = connected_components(links, directed=False)
    found = []
    for number in np.unique(piece[faces[:, 0]]):
        own = faces[piece[faces[:, 0]] == number]
        used, renumbered = np.unique(own, return_inverse=True)
        found.append(Mesh(mesh.vertices[used], renumbered.reshape(-1, 3)))
    return found


def _decompose(mesh: Mesh, watertight: bool) -> list[Part]:
    from scipy.spatial import ConvexHull

    from runtime.world.mesh import volume_and_centre

    around = ConvexHull(mesh.vertices)
    if watertight and around.volume <= volume_and_centre(mesh)[0] * (1 + CONVEX):
        return [_part(_thinned(mesh.vertices[around.vertices]))]
    points = _by_layers(mesh)
    if points is None:
        path = cache_folder() / f"hulls-{_digest(mesh)}.json"
        points = _read(path)
        if points is None:
            points = _by_coacd(mesh)
            _write(path, points)
    return [_part(corners) for corners in points]


def _by_layers(mesh: Mesh) -> list[Floats] | None:
    """The pieces of a stack of prisms, which take no time and are exact; None where it is none,
    or has too many pieces."""
    found = layers_of(mesh)
    return found if found is not None and len(found) <= MOST_HULLS else None


def _by_coacd(mesh: Mesh) -> list[Floats]:
    import coacd

    coacd.set_log_level("error")
    found = coacd.run_coacd(coacd.Mesh(mesh.vertices, np.asarray(mesh.faces)), **SETTINGS)
    return [np.asarray(vertices, dtype=float) for vertices, _ in found]


def _part(points: Floats) -> Part:
    from scipy.spatial import ConvexHull

    corners = points[ConvexHull(points).vertices]
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    solid = Hull(tuple((x, y, z) for x, y, z in (corners - middle).tolist()))
    x, y, z = middle.tolist()
    return Part(solid, upright(x, y, z, 0.0))


def _thinned(corners: Floats) -> Floats:
    """At most some hundred corners of a convex mesh: those farthest along directions that are
    spread over the sphere (a Fibonacci lattice) and along the axes."""
    most = 10 * MOST_CORNERS
    if len(corners) <= most:
        return corners
    k = np.arange(most) + 0.5
    height, bearing = 1 - 2 * k / most, k * np.pi * (3 - np.sqrt(5.0))
    flat = np.sqrt(1 - height**2)
    spread = np.column_stack([flat * np.cos(bearing), flat * np.sin(bearing), height])
    directions = np.vstack([spread, np.eye(3), -np.eye(3)])
    kept: Floats = corners[np.unique(np.argmax(corners @ directions.T, axis=0))]
    return kept


def _digest(mesh: Mesh) -> str:
    content = hashlib.sha256(json.dumps(SETTINGS).encode())
    content.update(np.ascontiguousarray(mesh.vertices, dtype=np.float64).tobytes())
    content.update(np.ascontiguousarray(mesh.faces, dtype=np.int64).tobytes())
    return content.hexdigest()[:32]


def _read(path: Path) -> list[Floats] | None:
    try:
        found = [np.array(points, dtype=float) for points in json.loads(path.read_text("utf-8"))]
    except (OSError, ValueError, TypeError):
        return None
    sound = found and all(
        p.ndim == 2 and p.shape[1] == 3 and len(p) > 3 and np.isfinite(p).all() for p in found
    )
    return found if sound else None


def _write(path: Path, points: list[Floats]) -> None:
    new = path.with_name(f"{path.name}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        new.write_text(json.dumps([p.tolist() for p in points]), encoding="utf-8")
        new.replace(path)
    except OSError:
        new.unlink(missing_ok=True)
