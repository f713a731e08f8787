"""Parts in a form that a page reads quickly: arrays of small integers, in base64.

Positions are 16-bit steps of the box around a part, at most 15 micrometres for a part of a metre;
normals are bytes.
"""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runtime.show.parts import Node, Part
from runtime.show.shading import shaded

STEPS = 65535


def packed(part: Part, nodes: dict[Node, int]) -> dict[str, Any]:
    """A part as plain data: `node` is its number in `nodes`, `box` the corner and the extents of
    the box around it."""
    vertices, normals, faces = shaded(part.vertices, part.faces)
    low = vertices.min(axis=0)
    size = np.maximum(vertices.max(axis=0) - low, 1e-9)
    steps = np.round((vertices - low) / size * STEPS).astype("<u2")
    small = len(vertices) <= STEPS
    return {
        "node": nodes[part.node],
        "layer": part.layer,
        "colour": [round(255 * value) for value in part.colour],
        "box": np.round(np.concatenate([low, size]), 6).tolist(),
        "points": _text(steps),
        "normals": _text(np.round(normals * 127).astype("i1")),
        "faces": _text(faces.astype("<u2" if small else "<u4")),
        "wide": not small,
    }


def _text(array: NDArray[Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode("ascii")
