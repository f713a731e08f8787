"""Read and validate scene files (TOML). `docs/scenes.md` describes the format.

All mistakes of a file are told in one run: each step notes what it finds and goes on with what
is well.
"""

from __future__ import annotations

import hashlib
import math
from pathlib import Path

from domains.tabletop.scene.furniture import read_furniture, refuse_far
from domains.tabletop.scene.goals import GoalReader
from domains.tabletop.scene.model import Scene
from domains.tabletop.scene.objects import read_objects
from domains.tabletop.scene.overlaps import note_overlaps
from domains.tabletop.scene.wanted import wanted_of
from domains.tabletop.state import FAMILIES, USUAL
from runtime.entry import Document, Entry, known
from runtime.world.world import World
from sketchlang.reading import read_bytes


def load_scene(path: Path, name: str | None = None) -> Scene:
    """Read a scene.

    Raises:
        InputError: with file, line, table and key, for whatever is wrong with it; it is
            `CollectedInputError` where that is more than one thing.
    """
    document = Document(path)
    root = document.root
    x, y, yaw = root.numbers("robot_start", 3)
    refuse_far(root, "robot_start", (x, y))
    furniture = read_furniture(root)
    drawn, placed = read_objects(root, furniture)
    wanted = GoalReader(drawn, placed).read(root)
    note_overlaps(drawn, placed, furniture.fixed)
    families = _families(root)
    document.finish()
    objects = tuple(thing for thing in placed.objects if thing is not None)
    return Scene(
        World(
            name=name or path.stem,
            digest=_digest(path, document),
            # As states and plans have headings: in [0, 2 pi).
            robot_start=(x, y, math.radians(yaw % 360.0)),
            fixed=tuple(furniture.fixed),
            movables=tuple(thing for thing in placed.movables if thing is not None),
            supports=tuple(placed.supports),
            goals=wanted_of(wanted.goals, wanted.word, objects, placed.supports),
        ),
        objects,
        wanted.goals,
        wanted.word,
        families,
        aslant=not root.has("approaches"),
    )


def _families(root: Entry) -> tuple[int, ...]:
    """The approaches that may be used, the usual ones unless the scene says which."""
    if not root.has("approaches"):
        return USUAL
    names = root.names("approaches")
    for name in names:
        if name not in FAMILIES:
            hint = known("approaches", name, FAMILIES)
            root.problem("approaches", f"there is no approach {name!r}", hint)
    if not names:
        root.problem("approaches", "names no approach")
    return tuple(i for i, name in enumerate(FAMILIES) if name in names)


def _digest(path: Path, document: Document) -> str:
    """SHA-256 of the file, and of the meshes that it names."""
    content = hashlib.sha256(read_bytes(path))
    for entry in document.data.get("object", []):
        if "mesh" in entry:
            content.update(read_bytes(path.parent / entry["mesh"]))
    return content.hexdigest()
