"""The world and the robot at one time as GLB, the binary form of glTF."""

from __future__ import annotations

import numpy as np

from runtime.show.drawn import drawn
from runtime.trace.model import Trace
from sketchlang.escape import visible

Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
"""glTF has y upwards, worlds have z."""


def glb(trace: Trace, time: float) -> bytes:
    """The GLB file; nodes have the names of objects, fixed things and links."""
    import trimesh

    scene = trimesh.Scene()
    for thing in drawn(trace, time):
        shown = visible(thing.name)
        # Unmerged corners: edges between faces are edges, not rounded by shared normals.
        mesh = trimesh.Trimesh(thing.vertices[thing.faces].reshape(-1, 3), process=False)
        mesh.faces = np.arange(len(mesh.vertices)).reshape(-1, 3)
        material = trimesh.visual.material.PBRMaterial(
            baseColorFactor=[*thing.colour, 1.0], metallicFactor=0.0, roughnessFactor=0.8
        )
        mesh.visual = trimesh.visual.TextureVisuals(material=material)
        scene.add_geometry(mesh, node_name=shown, geom_name=shown, transform=Y_UP @ thing.pose)
    data: bytes = scene.export(file_type="glb")
    return data
