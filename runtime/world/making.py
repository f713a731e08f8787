"""Bodies made of solids: their mass, and where their centre of mass is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from runtime.world.body import Body, Mesh, Part
from runtime.world.mesh import mesh_of, volume_and_centre
from runtime.world.poses import apply, upright
from runtime.world.solids import Box, Hull, Solid

DENSITY = 500.0
"""kg/m^3 of what does not give its mass: light wood."""


def body_of(parts: Sequence[Part], mass: float | None = None, mesh: Mesh | None = None) -> Body:
    """A body of solids of one material. `mass` in kg; without it that of light wood.

    The mass of a mesh that is closed is spread over its inside, else over that of the solids.
    """
    volumes = np.array([part.solid.volume for part in parts])
    centres = np.array([apply(part.pose, _middle(part.solid)[None])[0] for part in parts])
    volume, centre = float(volumes.sum()), volumes @ centres / volumes.sum()
    if mesh is not None and _closed(mesh):
        volume, centre = volume_and_centre(mesh)
    x, y, z = centre.tolist()
    return Body(tuple(parts), DENSITY * volume if mass is None else mass, (x, y, z), mesh)


def standing(solid: Solid, mass: float | None = None) -> Body:
    """A body of one solid that stands on its frame."""
    return body_of([Part(solid, upright(0.0, 0.0, solid.half[2], 0.0))], mass)


def open_box(size: tuple[float, float, float], wall: float, mass: float | None = None) -> Body:
    """A bin or a tray: a floor and four walls, `wall` thick; `size` outside."""
    x, y, z = size
    inner = z - wall
    side = (x - 2 * wall, wall, inner)
    end = (wall, y, inner)
    height = wall + inner / 2
    return body_of(
        [
            Part(Box((x, y, wall)), upright(0.0, 0.0, wall / 2, 0.0)),
            Part(Box(end), upright((wall - x) / 2, 0.0, height, 0.0)),
            Part(Box(end), upright((x - wall) / 2, 0.0, height, 0.0)),
            Part(Box(side), upright(0.0, (wall - y) / 2, height, 0.0)),
            Part(Box(side), upright(0.0, (y - wall) / 2, height, 0.0)),
        ],
        mass,
    )


def _middle(solid: Solid) -> np.ndarray:
    """The centre of mass of a solid in its frame."""
    if isinstance(solid, Hull):
        return volume_and_centre(mesh_of(solid))[1]
    return np.zeros(3)


def _closed(mesh: Mesh) -> bool:
    """Whether every edge has a face on each side, the same way round."""
    faces = np.asarray(mesh.faces)
    edges = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    there = {tuple(edge) for edge in edges.tolist()}
    return len(there) == len(edges) and all((b, a) in there for a, b in there)
