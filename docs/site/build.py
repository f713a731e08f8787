"""Builds the documentation site: pages by zensical, and a playground that needs no network.

    python -m docs.site.build [--out FOLDER] [--pyodide FOLDER] [--zensical PROGRAM]

`make site` installs what it needs first, in the versions of the lock files here: zensical, and
Pyodide from npm.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from docs.site.language import pack, try_out
from docs.site.pages import DOCS, PLAYGROUND, ROOT, Entry, stage

PYODIDE = (
    "pyodide.mjs",
    "pyodide.asm.mjs",
    "pyodide.asm.wasm",
    "python_stdlib.zip",
    "pyodide-lock.json",
)
"""What a browser loads of the npm package."""


def main() -> None:
    """Build, into a new folder that takes the place of the old one."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "site")
    parser.add_argument("--pyodide", type=Path, default=DOCS / "site" / "node_modules" / "pyodide")
    parser.add_argument("--zensical", default="zensical", help="the program that makes pages")
    options = parser.parse_args()
    if not (options.pyodide / PYODIDE[0]).exists():
        sys.exit(f"error: there is no Pyodide in {options.pyodide}: npm ci --prefix docs/site")
    zensical = shutil.which(options.zensical)
    if zensical is None:
        sys.exit("error: there is no zensical: pip install sketchlang[docs]")
    out: Path = options.out.resolve()
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.parent, prefix=".site") as temporary:
        work = Path(temporary)
        build_pages(work, Path(zensical).absolute())
        playground(work / "site" / "playground", options.pyodide)
        shutil.rmtree(out, ignore_errors=True)
        (work / "site").rename(out)
    print(f"the site is in {out}; to look at it: python -m http.server -d {out}")


def build_pages(work: Path, zensical: Path) -> None:
    """Stage the pages in `work/docs` and build `work/site`."""
    (work / "docs").mkdir()
    found = stage(work / "docs")
    text = (DOCS / "site" / "zensical.toml").read_text(encoding="utf-8")
    (work / "zensical.toml").write_text(f"{navigation(found)}\n{text}", encoding="utf-8")
    subprocess.run([zensical, "build", "--clean", "--strict"], check=True, cwd=work)


def navigation(found: dict[str, list[Entry]]) -> str:
    """The navigation as TOML, the first key of the table `[project]`."""
    lines = ["[project]", "nav = [", '  { "Home" = "index.md" },']
    for section, entries in found.items():
        pages = ", ".join(f"{{ {json.dumps(e.title)} = {json.dumps(e.path)} }}" for e in entries)
        lines.append(f"  {{ {json.dumps(section)} = [{pages}] }},")
    alone = {"Gallery": "gallery.md", "Playground": PLAYGROUND}
    lines += [f"  {{ {json.dumps(name)} = {json.dumps(path)} }}," for name, path in alone.items()]
    lines.append("]")
    return "\n".join(lines)


def playground(folder: Path, pyodide: Path) -> None:
    """The playground: its page, Pyodide, and the language, which is tried out first."""
    shutil.copytree(DOCS / "playground", folder)
    (folder / "pyodide").mkdir()
    for name in PYODIDE:
        shutil.copy(pyodide / name, folder / "pyodide" / name)
    pack(folder / "language.zip")
    with tempfile.TemporaryDirectory() as temporary:
        try_out(folder / "language.zip", Path(temporary))


if __name__ == "__main__":
    main()
