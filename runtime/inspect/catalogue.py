"""What comes along: sketches, scenes, robots, planners and domains, each with a line about it."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from runtime.search.planners import ABOUT, DEFAULT
from sketchlang.errors import InputError
from sketchlang.library import built_in_scenes, find_scene
from sketchlang.loader import (
    builtin_sketches,
    domain_names,
    domain_of_scene,
    load_builtin,
    load_domain,
    read_includes,
    used_domain,
)
from sketchlang.syntax.parser import parse

ROBOTS = Path(__file__).resolve().parent.parent / "robot"


@dataclass(frozen=True)
class Entry:
    """A name, one line about what it names, and further columns by their heading."""

    name: str
    about: str
    more: dict[str, str] = field(default_factory=dict)


def sketches() -> list[Entry]:
    """The sketches that come along, with the domains they are for."""
    found = []
    for name in builtin_sketches():
        source = load_builtin(name)
        tree, _ = read_includes(parse(source)[0])
        found.append(Entry(name, head(source.text), {"domain": used_domain(tree) or ""}))
    return found


def scenes() -> list[Entry]:
    """The scenes that come along."""
    found = []
    for name in built_in_scenes():
        path, _ = find_scene(name)
        found.append(Entry(name, _about_scene(path), {"domain": domain_of_scene(name)}))
    return found


def _about_scene(path: Path) -> str:
    text = path.read_text(encoding="utf-8")
    summary = tomllib.loads(text).get("summary") if path.suffix == ".toml" else None
    return summary if isinstance(summary, str) else head(text)


def robots() -> list[Entry]:
    """The robots that come along, with how their bases move and how many joints are planned."""
    found = []
    for path in sorted(ROBOTS.glob("*/*.toml")):
        text = path.read_text(encoding="utf-8")
        data = tomllib.loads(text)
        base = data.get("base", {}).get("type", "differential")
        more = {"base": base, "joints": str(len(data.get("joints", [])))}
        found.append(Entry(path.parent.name, head(text), more))
    return found


def planners() -> list[Entry]:
    """The planners."""
    return [
        Entry(name, text + (" (the default)" if name == DEFAULT else ""))
        for name, text in ABOUT.items()
    ]


def domains() -> list[Entry]:
    """The domains that a sketch can use by name: those that come along, and those that other
    packages offer. One that cannot be loaded is listed with the reason."""
    found = []
    for name in domain_names():
        try:
            domain = load_domain(name)
            about = "" if domain is None else domain.summary
        except InputError as error:
            about = f"cannot be used: {error.message}"
        found.append(Entry(name, about))
    return found


KINDS: dict[str, Callable[[], list[Entry]]] = {
    "sketches": sketches,
    "scenes": scenes,
    "robots": robots,
    "planners": planners,
    "domains": domains,
}

_SENTENCE = re.compile(r"(?<=[.!?])\s")


def head(text: str) -> str:
    """The first sentence of the comment that a file begins with."""
    words: list[str] = []
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        words.append(line.strip("# \t"))
    return _SENTENCE.split(" ".join(words), maxsplit=1)[0].rstrip(".")


def columns(entries: list[Entry], width: int) -> list[str]:
    """Entries in columns: name, further columns, and the line about each, cut to the width."""
    names = max((len(entry.name) for entry in entries), default=0)
    wide = {
        key: max(len(entry.more.get(key, "")) for entry in entries)
        for key in (entries[0].more if entries else {})
    }
    lines = []
    for entry in entries:
        cells = [f"{entry.name:<{names}}"]
        cells += [f"{entry.more.get(key, ''):<{size}}" for key, size in wide.items()]
        line = "  ".join([*cells, entry.about]).rstrip()
        lines.append(line if len(line) <= width else f"{line[: width - 3].rstrip()}...")
    return lines
