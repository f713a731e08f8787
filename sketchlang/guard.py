"""What must hold before anything else is imported: our packages are the ones that are found.

`runtime`, `domains` and `grammars` are common names. A package of the same name that comes first on
Python's path would be imported in place of ours, and fail in strange ways.
"""

from __future__ import annotations

import importlib.util
import os
import sys

HOME = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
"""The folder that has all our packages side by side, in a checkout as in an installation."""

PACKAGES = ("grammars", "domains", "runtime")


def in_the_way() -> str | None:
    """One line about what would be imported in place of a package of ours; None if nothing is."""
    for name in PACKAGES:
        own = os.path.join(HOME, name)
        found = _found(name)
        if found is None:
            return f"the package `{name}` of sketchlang is missing in {HOME}: install it again"
        if os.path.realpath(found) != own:
            return (
                f"{found} is in the way of the package `{name}` of sketchlang: start from another "
                "folder, take its folder off PYTHONPATH, or rename it"
            )
    return None


def _found(name: str) -> str | None:
    """The folder, or the file, that an import of a name leads to."""
    loaded = sys.modules.get(name)
    if loaded is not None:
        # A program that uses sketchlang as a library may have a module of this name.
        file = getattr(loaded, "__file__", None)
        return os.path.dirname(file) if file and _is_package(file) else file
    try:
        spec = importlib.util.find_spec(name)
    except (ImportError, ValueError):
        return None
    if spec is None:
        return None
    if spec.origin is not None:
        return os.path.dirname(spec.origin) if _is_package(spec.origin) else spec.origin
    # A folder without `__init__.py`, which counts only where there is no package of the name.
    return next(iter(spec.submodule_search_locations or ()), None)


def _is_package(file: str) -> bool:
    return os.path.basename(file).startswith("__init__.")
