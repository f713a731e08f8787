"""What the result of a run depends on, as digests of contents: a run is repeated when they change.

A sketch is its text, what it includes, and the files of a domain that does not come along. A
scene is its file and every file that it names. A robot is its file, its URDFs and its meshes. The
tool is the code of this package and the versions of the libraries that planning uses.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Iterator
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from runtime.bench.job import Job, Versions
from runtime.robot.load import DEFAULT_ROBOT, robot_path
from sketchlang import reading
from sketchlang.library import find_scene
from sketchlang.loader import PDDL, load_sketch, pddl_domain_of

HOME = Path(__file__).resolve().parents[2]
PACKAGES = ("grammars", "sketchlang", "runtime", "domains")
LIBRARIES = ("clingo", "coacd", "lark", "numba", "numpy", "ompl", "scipy", "trimesh")
LENGTH = 12
"""Characters of a digest: half a million runs share one by chance once in a thousand times."""

_NAMED = re.compile(r"""["']([^"'\n]+\.[A-Za-z0-9]+)["']""")
"""What may be the name of a file in TOML, XML and URDF."""

TEXTS = (".toml", ".urdf", ".xml", ".srdf")


def versions_of(job: Job) -> Versions:
    """The versions of what a job reads, as it is now.

    Raises:
        InputError: something cannot be read.
    """
    scene = job.located(job.scene)
    domain = job.located(job.domain)
    sketch, has_robots = _sketch(job.located(job.sketch), domain, _pddl(scene))
    return Versions(sketch, _scene(scene), _robot(job, has_robots), tool_version())


def _pddl(scene: str) -> str:
    return scene if scene.endswith(PDDL) else ""


@cache
def tool_version() -> str:
    """The code of this package, and the libraries."""
    files = [p for name in PACKAGES for p in sorted((HOME / name).rglob("*.py"))]
    files += sorted((HOME / "grammars").glob("*.*"))
    parts = [(p.relative_to(HOME).as_posix(), p.read_bytes()) for p in dict.fromkeys(files)]
    parts += [(name, _version(name).encode()) for name in LIBRARIES]
    return digest(parts)


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return ""


def _sketch(target: str, domain_file: str, task: str) -> tuple[str, bool]:
    """The version of a sketch, and whether its domain has robots."""
    with reading.recording() as read:
        domain = pddl_domain_of(task) if task else None
        loaded = load_sketch(target, domain_file or None, domain)
    names = sorted(read.names.values())
    _note(names)
    found = loaded.checked.domain
    parts = [(Path(name).name, reading.read_bytes(name)) for name in names if not _is_own(name)]
    parts += [("text", loaded.source.text.encode())]
    parts += [(path.name, path.read_bytes()) for path in _code_of(found)]
    return digest(parts), found is not None and found.has_robots


def _is_own(name: str) -> bool:
    return name.endswith(PDDL)  # a part of the scene's version


def _code_of(domain: Any) -> Iterator[Path]:
    """The files of a domain that another package offers."""
    code = getattr(getattr(domain, "load", None), "__code__", None)
    path = Path(code.co_filename).resolve() if code is not None else HOME
    if path.is_file() and not path.is_relative_to(HOME):
        yield path


def _scene(name: str) -> str:
    path, _ = find_scene(name)
    parts = list(_with_named(path))
    if name.endswith(PDDL):
        with reading.recording() as read:
            pddl_domain_of(name)
        _note(read.names.values())
        parts += [("domain", reading.read_bytes(n)) for n in sorted(read.names.values())]
    return digest(parts)


def _robot(job: Job, has_robots: bool) -> str:
    if not has_robots:
        return ""
    path = robot_path(job.located(job.robot) if job.robot else DEFAULT_ROBOT)
    return digest(_with_named(path))


def _with_named(path: Path) -> Iterator[tuple[str, bytes]]:
    """A file and every file that it names, those that these name included."""
    pending, seen = [path], set[Path]()
    while pending:
        each = pending.pop()
        if each.resolve() in seen:
            continue
        seen.add(each.resolve())
        data = reading.read_bytes(each)
        yield each.name, data
        if each.suffix.lower() in TEXTS:
            pending += _named(each.parent, data.decode("utf-8", errors="replace"))


def _named(folder: Path, text: str) -> list[Path]:
    """The files that a text names and that are there: from its folder, or one above it."""
    found = []
    for name in dict.fromkeys(_NAMED.findall(text)):
        name = re.sub(r"^(file|package)://", "", name)
        tried = [folder / name, *(above / name for above in folder.parents[:3])]
        found += [path for path in tried if _is_file(path)][:1]
    return found


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _note(names: Iterable[str]) -> None:
    for name in names:
        reading.inputs().note(name)


def digest(parts: Iterable[tuple[str, bytes]]) -> str:
    """A digest of named contents, in any order."""
    whole = hashlib.sha256()
    for name, data in sorted(parts):
        whole.update(f"{name}\0{len(data)}\0".encode() + data)
    return whole.hexdigest()[:LENGTH]


def difference(ours: Versions, theirs: Versions) -> str | None:
    """What is not the same in two versions, in words; None if nothing is."""
    names = ("sketch", "scene", "robot", "tool")
    found = [name for name in names if getattr(ours, name) != getattr(theirs, name)]
    return " and ".join(found) or None
