"""Which pages the site has, in which order, and those that are made of other files."""

from __future__ import annotations

import inspect
import re
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"

SECTIONS = {
    "Tutorials": ("tutorial.md", "tutorial-*.md"),
    "How-to": ("howto-*.md", "extending.md"),
    "Reference": (
        "language/*.md",
        "commands.md",
        "diagnostics.md",
        "scenes.md",
        "robots.md",
        "editors.md",
        "inspect.md",
        "features.md",
        "pddl.md",
        "api.md",
        "api-names.md",
        "plan-format.md",
        "trace-format.md",
        "certificates.md",
    ),
    "Explanation": (
        "planning.md",
        "termination.md",
        "execution.md",
        "architecture.md",
        "slips.md",
        "benchmarks.md",
        "kinder.md",
        "*.md",
    ),
    "Decisions": ("adr/*.md",),
}
"""Sections of the site, and which pages each has, in this order; each page once. What is new goes
to the explanations until somebody says better."""

PLAYGROUND = "playground/index.html"
"""This one is no page of the generator's: it is put beside them."""

ALONE = ("index.md", "gallery.md")
"""Pages outside of sections."""


@dataclass(frozen=True)
class Entry:
    """A page in the navigation: its title and its path."""

    title: str
    path: str


def stage(folder: Path) -> dict[str, list[Entry]]:
    """Copy and make all pages into an empty folder; the entries of each section."""
    for path in DOCS.rglob("*"):
        name = path.relative_to(DOCS)
        if path.is_file() and name.parts[0] not in ("site", "playground"):
            target = folder / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, target)
    shutil.copy(DOCS / "site" / "index.md", folder / "index.md")
    (folder / "language").mkdir()
    for path in sorted((ROOT / "tests" / "spec").glob("*.md")):
        shutil.copy(path, folder / "language" / path.name)
    (folder / "commands.md").write_text(commands(), encoding="utf-8")
    (folder / "diagnostics.md").write_text(diagnostics(), encoding="utf-8")
    (folder / "api-names.md").write_text(names(), encoding="utf-8")
    (folder / "gallery.md").write_text(gallery(folder / "images" / "scenes"), encoding="utf-8")
    for path in folder.rglob("*.md"):
        path.write_text(relinked(path, folder), encoding="utf-8")
    return sections(folder)


def sections(folder: Path) -> dict[str, list[Entry]]:
    """The pages that are there, by section."""
    seen = {folder / name for name in ALONE}
    found: dict[str, list[Entry]] = {}
    for section, patterns in SECTIONS.items():
        found[section] = []
        for pattern in patterns:
            for path in sorted(set(folder.glob(pattern)) - seen, key=_natural):
                seen.add(path)
                name = path.relative_to(folder).as_posix()
                found[section].append(Entry(title_of(path), name))
    return found


def _natural(path: Path) -> tuple[int, str]:
    """Pages with numbers by their numbers."""
    number = re.match(r"(\d+)", path.name)
    return int(number[1]) if number else 0, path.name


def title_of(path: Path) -> str:
    """The first heading of a page, short: without Markdown."""
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("# "):
            return line[2:].replace("`", "").strip()
    raise ValueError(f"{path.name} has no heading")


LINK = re.compile(r"\[((?:[^\[\]]|\[[^\]]*\])+)\]\(((?!\w+:|#)[^)\s#]+)(#[^)\s]*)?\)")
"""Words, the path of a file, and perhaps a place in it."""


def relinked(path: Path, folder: Path) -> str:
    """The text of a page with links for the site: those to pages of the language lead to them
    there, and of links to files that are no pages the words stay."""

    def link(match: re.Match[str]) -> str:
        words, target, anchor = match[1], match[2], match[3] or ""
        place = (path.parent / target).resolve()
        if place.is_file() and folder.resolve() in place.parents:
            return match[0]
        if target == PLAYGROUND:
            return match[0]
        moved = folder / "language" / Path(target).name
        if target.endswith(".md") and moved.exists():
            up = "../" * (len(path.relative_to(folder).parts) - 1)
            return f"[{words}]({up}language/{moved.name}{anchor})"
        return words

    return LINK.sub(link, path.read_text(encoding="utf-8"))


def commands() -> str:
    """A page of what every command says of itself."""
    from click.testing import CliRunner

    from sketchlang.cli import COMMANDS, cli

    parts = ["# Commands", "", "What `sketchlang COMMAND --help` prints.", ""]
    for name, summary in COMMANDS.items():
        shown = CliRunner().invoke(cli, [name, "--help"], prog_name="sketchlang", terminal_width=90)
        parts += [f"## {name}", "", summary, "", "```text", shown.output.rstrip(), "```", ""]
    return "\n".join(parts)


def diagnostics() -> str:
    """A page of what `sketchlang explain` knows."""
    from sketchlang.pages import pages

    parts = ["# Diagnostics", "", "What `sketchlang explain CODE` prints.", ""]
    for page in pages().values():
        parts += [f"## {page.code}", "", f"*{page.severity}.* {page.summary}", "", page.body, ""]
    return "\n".join(parts)


OFFERED = {
    "sketchlang": ("load", "check", "terminate", "plan", "Result", "Plan"),
    "sketchlang.domain": ("Domain",),
}
"""What the page of names has: modules, and what is public there."""


def names() -> str:
    """A page of the Python interface, made of its docstrings."""
    import importlib

    parts = ["# Python: all names", "", "[How they are used](api.md).", ""]
    for module, offered in OFFERED.items():
        for name in offered:
            thing = getattr(importlib.import_module(module), name)
            parts += [*_documented(f"{module}.{name}", thing, "##"), ""]
            if inspect.isclass(thing):
                for member, value in _members(thing):
                    parts += [*_documented(f"{name}.{member}", value, "###"), ""]
    return "\n".join(parts)


def _members(thing: type) -> Iterator[tuple[str, object]]:
    for name, value in vars(thing).items():
        public = not name.startswith("_")
        if public and (inspect.isfunction(value) or isinstance(value, property | classmethod)):
            yield name, value


def _documented(title: str, thing: object, level: str) -> list[str]:
    called = thing.fget if isinstance(thing, property) else thing
    called = called.__func__ if isinstance(called, classmethod) else called
    text = inspect.getdoc(called) or ""
    # What is indented there is a list of exceptions, not code.
    text = re.sub(r"^Raises:\n", "*Raises:*\n\n", text, flags=re.M)
    text = re.sub(r"^    (\w[\w.]*): ", r"- `\1`: ", text, flags=re.M)
    heading = [f"{level} {title}", ""]
    if not isinstance(thing, property):
        short = title.rsplit(".", 1)[-1]
        signature = f"{short}{inspect.signature(called)}"  # type: ignore[arg-type]
        heading += ["```python", signature.replace("'", ""), "```", ""]
    return [*heading, text]


def gallery(folder: Path) -> str:
    """A page with a picture of each built-in scene, drawn by `sketchlang show`, and a replay of
    its plan. `folder` is for the pictures."""
    from click.testing import CliRunner

    from sketchlang.cli import cli
    from sketchlang.library import built_in_scenes

    folder.mkdir(parents=True, exist_ok=True)
    parts = ["# Gallery", "", "The scenes that come along, from above. Each was drawn by", ""]
    parts += ["    sketchlang show sorting/4t-07 --svg scene.svg", ""]
    parts += ["and is planned by `sketchlang run SKETCH SCENE`.", ""]
    for name in built_in_scenes():
        picture = folder / f"{name.replace('/', '-')}.svg"
        words = ["show", name, "--as", "scene", "--svg", str(picture)]
        drawn = CliRunner().invoke(cli, words)
        if drawn.exit_code == 0 and picture.exists():
            parts += [f"## {name}", "", f"![{name}](images/scenes/{picture.name})", ""]
            parts += [_replayed(name, folder / f"{picture.stem}.html"), ""]
    return "\n".join(parts)


def _replayed(scene: str, out: Path) -> str:
    """A line about the plan of a scene, with a link to its replay."""
    import sketchlang

    done = sketchlang.plan("pick_and_place", scene, seed=0)
    if not done.solved:
        return f"`pick_and_place` does not solve it with seed 0: {done.reason}"
    done.plan.replay(out)
    subplans, seconds = done.report["subplans"], done.plan.execution_time
    link = f"[Watch the plan](images/scenes/{out.name})"
    return f"{link} of `pick_and_place`: {subplans} subplans, {seconds:.0f} s to execute."
