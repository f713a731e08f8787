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
    mesh = _load(path)
    vertices = np.asarray(mesh.vertices, dtype=float).reshape(-1, 3) * unit * scale
    faces = np.asarray(mesh.faces, dtype=np.int64).reshape(-1, 3)
    if not len(faces) or not np.isfinite(vertices).all():
        raise InputError("holds no triangles", place=str(path))
    return Mesh(vertices, faces)


def _load(path: Path) -> Any:
    import trimesh

    options = {"skip_materials": True} if path.suffix.lower() == ".obj" else {}
    try:
        scene = trimesh.load_scene(str(path), process=False, **options)
        return scene.to_mesh()
    except Exception as error:  # readers of foreign formats raise whatever comes
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"cannot be read as a mesh: {reason}", place=str(path)) from None


def _collada_unit(path: Path) -> float:
    """Metres of one unit of a COLLADA file; refuses what `read_xml` refuses."""
    for element in read_xml(path, MAX_BYTES).iter():
        if element.tag.rpartition("}")[2] == "unit":
            try:
                unit = float(element.get("meter", "1"))
            except ValueError:
                break
            return unit if 0.0 < unit < 1e6 else 1.0
    return 1.0
