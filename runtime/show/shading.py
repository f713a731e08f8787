"""Normals at the corners of faces: smooth over gentle edges, sharp over steep ones."""

from __future__ import annotations

import numpy as np

from runtime.show.forms import Ints
from runtime.world.poses import Floats

CREASE = 40.0
"""Degrees between two faces from which on their edge is seen."""


def shaded(vertices: Floats, faces: Ints, crease: float = CREASE) -> tuple[Floats, Floats, Ints]:
    """Vertices (n, 3), their unit normals (n, 3) and faces (m, 3) that name them. A vertex of
    the mesh that lies on a crease becomes several."""
    corners = vertices[faces]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(areas, axis=1)
    units = areas / np.maximum(lengths, 1e-15)[:, None]
    at = faces.ravel()  # corner -> vertex
    face = np.repeat(np.arange(len(faces)), 3)
    order = np.argsort(at, kind="stable")
    counts = np.bincount(at, minlength=len(vertices))
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    # All pairs of corners at the same vertex, one vertex's after the other's.
    many = counts[at[order]]
    first = np.repeat(order, many)
    offset = np.arange(len(first)) - np.repeat(np.cumsum(many) - many, many)
    second = order[np.repeat(starts[at[order]], many) + offset]
    gentle = (units[face[first]] * units[face[second]]).sum(axis=1) > np.cos(np.radians(crease))
    normals = np.zeros((len(at), 3))
    np.add.at(normals, first[gentle], areas[face[second[gentle]]])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-15)
    rows = np.column_stack([at, np.round(normals * 100).astype(np.int64)])
    _, keep, back = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return vertices[at[keep]], normals[keep], back.reshape(-1, 3)
