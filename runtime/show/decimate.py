"""Meshes of fewer triangles."""

from __future__ import annotations

import numpy as np

from runtime.show.forms import Ints, Triangles, welded
from runtime.world.poses import Floats

FEWEST = 60
"""Triangles that are left of any mesh."""


def decimated(vertices: Floats, faces: Ints, share: float) -> Triangles:
    """About a share (0 to 1) of a mesh's triangles, by collapsing edges where that changes its
    surface least."""
    if share >= 1.0:
        return vertices, faces
    vertices, faces = welded(vertices, faces)  # STL repeats the corners of every triangle
    target = max(FEWEST, int(share * len(faces)))
    if target >= len(faces):
        return vertices, faces
    import fast_simplification

    points, corners = fast_simplification.simplify(
        np.ascontiguousarray(vertices, dtype=np.float32),
        np.ascontiguousarray(faces, dtype=np.int32),
        target_count=target,
    )
    return np.asarray(points, dtype=np.float64), np.asarray(corners, dtype=np.int64)
