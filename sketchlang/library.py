"""The scenes that come with the package, by name (`sorting/4t-07`) or path."""

from __future__ import annotations

import difflib
import os
from pathlib import Path

from sketchlang.errors import InputError

_ROOT = Path(__file__).resolve().parent.parent / "domains"

SCENES_OF = "tabletop"
"""The domain of scenes in folders that are no domain themselves, and of any scene file unless
another domain is named."""


def built_in_scenes() -> list[str]:
    """Names of all scenes that come with the package."""
    return sorted(f"{path.parent.parent.name}/{path.stem}" for path in _ROOT.glob("*/scenes/*"))


def find_scene(name: str) -> tuple[Path, str]:
    """Path and display name of a scene given by name or by path.

    Raises:
        InputError: there is no such scene.
    """
    path = Path(name)
    if _is_file(path):
        return path, name
    folder, _, stem = name.partition("/")
    known = built_in_scenes()
    if name in known:
        return next((_ROOT / folder / "scenes").glob(f"{stem}.*")), name
    if os.path.exists(path) and not os.path.isdir(path):
        return path, name  # a pipe or a device: who reads it says so
    close = difflib.get_close_matches(name, known, 1)
    hint = f"did you mean {close[0]!r}?" if close else f"built in: {', '.join(known)}"
    raise InputError(f"there is no scene {name!r}, neither a file nor built in", hint=hint)


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # a name that is too long, a folder that may not be entered
        return False
