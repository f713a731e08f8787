"""Triangle meshes of robot descriptions: which file is meant, and what is in it."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from runtime.world.body import Mesh
from runtime.world.solids import Floats
from sketchlang.errors import InputError
from sketchlang.reading import read_bytes, read_xml

MAX_BYTES = 200_000_000
FORMATS = (".stl", ".obj", ".dae")

ROS_PATHS = ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH")
"""Environment variables with folders of packages, where ROS is set up."""


def find_mesh(reference: str, folder: Path) -> Path:
    """The file that a URDF in `folder` means by a mesh's `filename`.

    Paths are relative to the URDF; `package://NAME/...` is looked for in the folders around
    it and in ROS's own, with and without the package's name.

    Raises:
        InputError: no file is there, or it has another format than `FORMATS`.
    """
    scheme, found, rest = reference.partition("://")
    if not found:
        candidates = [folder / reference]
    elif scheme == "file":
        candidates = [Path(rest)]
    elif scheme in {"package", "model"}:
        candidates = _in_packages(rest, folder)
    else:
        raise InputError(f"mesh {reference!r}: paths, package:// and file:// are understood")
    for path in candidates:
        if path.suffix.lower() not in FORMATS:
            raise InputError(
                f"mesh {reference!r} is of an unknown format",
                hint=f"known: {', '.join(FORMATS)}",
            )
        if path.is_file():
            return path
    raise InputError(
        f"mesh {reference!r} is not there",
        hint=f"looked for {', '.join(str(path) for path in candidates[:3])}"
        + (" and further up" if len(candidates) > 3 else ""),
    )


def _in_packages(rest: str, folder: Path) -> list[Path]:
    package, _, inside = rest.partition("/")
    candidates = []
    for above in (folder.absolute(), *folder.absolute().parents):
        candidates.append(above / package / inside)
        if above.name == package:
            candidates.append(above / inside)
    for variable in ROS_PATHS:
        for entry in filter(None, os.environ.get(variable, "").split(os.pathsep)):
            candidates += [Path(entry) / package / inside, Path(entry) / "share" / rest]
    return candidates


def read_mesh(path: Path, scale: Floats) -> Mesh:
    """Triangles of a file; `scale` (3,) multiplies its coordinates, which become metres.

    Raises:
        InputError: the file cannot be read or holds no triangles.
    """
    read_bytes(path, MAX_BYTES)  # says what is wrong with a file that cannot be read
    unit = 1.0
    if path.suffix.lower() == ".dae":
        unit = _collada_unit(path)
    vertices, faces = _load(path)
    vertices = vertices * unit * scale
    if not len(faces) or not np.isfinite(vertices).all():
        raise InputError("holds no triangles", place=str(path))
    return Mesh(vertices, faces)


def _load(path: Path) -> tuple[Floats, Any]:
    """Vertices and triangles as they are in a file."""
    if path.suffix.lower() == ".obj":
        return _read_obj(path)
    import trimesh

    try:
        mesh = trimesh.load_scene(str(path), process=False).to_mesh()
        return np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces, dtype=np.int64)
    except Exception as error:  # readers of foreign formats raise whatever comes
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"cannot be read as a mesh: {reason}", place=str(path)) from None


def _read_obj(path: Path) -> tuple[Floats, Any]:
    """Vertices and faces of an OBJ file, without its materials: for those, libraries want
    pictures that are often missing."""
    vertices: list[list[float]] = []
    faces: list[tuple[int, int, int]] = []
    for line in read_bytes(path, MAX_BYTES).decode("utf-8", "replace").splitlines():
        words = line.split()
        try:
            if words[:1] == ["v"]:
                vertices.append([float(word) for word in words[1:4]])
            elif words[:1] == ["f"]:
                corners = [int(word.split("/")[0]) for word in words[1:]]
                ring = [k - 1 if k > 0 else len(vertices) + k for k in corners]
                faces += [(ring[0], ring[k], ring[k + 1]) for k in range(1, len(ring) - 1)]
        except ValueError:
            raise InputError(f"is no OBJ: {line.strip()[:60]!r}", place=str(path)) from None
    points = np.array(vertices, dtype=float).reshape(-1, 3) if vertices else np.empty((0, 3))
    triangles = np.array(faces, dtype=np.int64).reshape(-1, 3)
    if triangles.size and not 0 <= triangles.min() <= triangles.max() < len(points):
        raise InputError("is no OBJ: a face names a vertex that is not there", place=str(path))
    return points, triangles


def _collada_unit(path: Path) -> float:
    """Metres of one unit of a COLLADA file; refuses what `read_xml` refuses."""
    for element in read_xml(path, MAX_BYTES).iter():
        if element.tag.rpartition(":")[2] == "unit":
            try:
                unit = float(element.get("meter", "1"))
            except ValueError:
                break
            return unit if 0.0 < unit < 1e6 else 1.0
    return 1.0
