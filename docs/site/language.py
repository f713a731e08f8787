"""Packs the language for the playground: `sketchlang` without its command line, the grammar, the
sketches and domains that come along, and Lark; all of it plain Python.

    python -m docs.site.language OUT.zip
"""

from __future__ import annotations

import subprocess
import sys
import zipfile
from collections.abc import Iterator
from importlib.metadata import distribution
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

SUFFIXES = {".py", ".lark", ".txt", ".toml", ".md", ".sketch", ".pddl"}
LEFT_OUT = ("sketchlang/cli/", "sketchlang/lsp/", "sketchlang/template/")

NEITHER = ("numpy", "scipy", "numba", "clingo", "trimesh", "fcl", "ompl", "pybullet", "coacd")
"""What a browser does not have."""

PROVE_ALL = f"""
import sys
sys.path[:0] = [sys.argv[1]]
for name in {(*NEITHER, "click", "runtime")!r}:
    sys.modules[name] = None
import playground, json
for name, text in json.loads(playground.examples()).items():
    assert json.loads(playground.check(text))["ok"], name
    assert json.loads(playground.prove(text))["text"], name
outside = {{m.split(".")[0] for m, found in sys.modules.items() if found}}
outside -= set(sys.stdlib_module_names)
own = {{"sketchlang", "grammars", "domains", "lark", "playground", "__main__"}}
assert outside <= own, outside - own
"""


def files() -> Iterator[tuple[str, Path]]:
    """Paths in the archive, and the files that are there."""
    for top in ("sketchlang", "grammars", "domains"):
        for path in sorted((ROOT / top).rglob("*")):
            name = path.relative_to(ROOT).as_posix()
            if path.suffix in SUFFIXES and path.is_file() and not name.startswith(LEFT_OUT):
                yield name, path
    lark = distribution("lark")
    for file in sorted(lark.files or [], key=str):
        if file.parts[0] == "lark" and file.suffix in {".py", ".lark"}:
            yield file.as_posix(), Path(str(lark.locate_file(file)))


def pack(out: Path) -> None:
    """Write the archive; the same sources give the same bytes."""
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, path in files():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, path.read_bytes())


def try_out(archive: Path, folder: Path) -> None:
    """Unpack the archive into an empty folder and prove everything there, without what a browser
    does not have.

    Raises:
        subprocess.CalledProcessError: that does not work.
    """
    with zipfile.ZipFile(archive) as packed:
        packed.extractall(folder)
    source = ROOT / "docs" / "playground" / "playground.py"
    (folder / "playground.py").write_bytes(source.read_bytes())
    # Isolated: neither this checkout nor installed packages are found.
    command = [sys.executable, "-I", "-S", "-c", PROVE_ALL, str(folder)]
    subprocess.run(command, check=True, capture_output=True, text=True, cwd=folder)


if __name__ == "__main__":
    pack(Path(sys.argv[1]))
