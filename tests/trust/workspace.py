"""A folder with one of everything that a command can read, all of it the user's own."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
FORMS = ("path", "roundabout", "soft link", "hard link")
INCLUDE = "include"
URDF = "urdf"


@dataclass(frozen=True)
class Workspace:
    """Paths of a sketch and the file it includes, a domain, a scene, a robot, and its URDF."""

    folder: Path
    sketch: Path
    include: Path
    domain: Path
    scene: Path
    robot: Path
    urdf: Path

    def files(self) -> dict[Path, bytes]:
        """All files of the folder and what they hold; links are left out."""
        found = sorted(path for path in self.folder.rglob("*") if not path.is_symlink())
        return {path: path.read_bytes() for path in found if path.is_file()}

    def alias(self, path: Path, form: str) -> Path:
        """Another name of a file."""
        match form:
            case "roundabout":
                return path.parent / ".." / path.parent.name / path.name
            case "soft link":
                link = self.folder / f"soft{path.suffix}"
                link.symlink_to(path)
                return link
            case "hard link":
                link = self.folder / f"hard{path.suffix}"
                link.hardlink_to(path)
                return link
        return path


def make(folder: Path) -> Workspace:
    """A workspace in a new folder."""
    folder.mkdir()
    text = (ROOT / "domains" / "pick_and_place.sketch").read_text(encoding="utf-8")
    features, _, rest = text.partition("atoms ")
    title, _, features = features.partition("\nuse ")
    (folder / "features.sketch").write_text(f"use {features}", encoding="utf-8")
    (folder / "main.sketch").write_text(
        f'{title}\ninclude "features.sketch"\natoms {rest}', encoding="utf-8"
    )
    (folder / "domain.py").write_text("from domains.tabletop import domain\n")
    shutil.copy(ROOT / "domains" / "sorting" / "scenes" / "3t-02.toml", folder / "scene.toml")
    robot = ROOT / "runtime" / "robot" / "tiago"
    shutil.copy(robot / "tiago.toml", folder / "robot.toml")
    shutil.copy(robot / "tiago.urdf", folder / "tiago.urdf")
    names = ("main.sketch", "features.sketch", "domain.py", "scene.toml", "robot.toml")
    return Workspace(folder, *(folder / name for name in names), folder / "tiago.urdf")


def commands(space: Workspace, plan: Path) -> Iterator[tuple[str, list[str], str, dict[str, Path]]]:
    """Every command with an output: its name, arguments, the option, and the files it reads."""
    sketch = {"sketch": space.sketch, INCLUDE: space.include}
    domain = ["--domain", str(space.domain)]
    scene = {"scene": space.scene, "robot": space.robot, URDF: space.urdf}
    own = ["--scene", str(space.scene), "--robot", str(space.robot)]
    given = [str(plan), *own, "--sketch", str(space.sketch)]
    robot = ["--robot", str(space.robot)]
    read = {"plan": plan, **sketch, **scene}
    with_domain = {**sketch, "domain": space.domain}
    yield "terminate", [str(space.sketch), *domain], "--certificate", with_domain
    yield "graph", [str(space.sketch), "--format", "dot", *domain], "--out", with_domain
    yield (
        "show",
        [str(space.scene), *domain],
        "--svg",
        {"scene": space.scene, "domain": space.domain},
    )
    arguments = [str(space.sketch), str(space.scene), *robot]
    yield "run", [*arguments, *domain], "--out", {**with_domain, **scene}
    yield "execute", [*arguments, "--closed-loop"], "--trace", {**sketch, **scene}
    yield "execute", given, "--trace", read
    for option in ("--html", "--trace", "--mp4", "--gif", "--png"):
        yield "replay", given, option, read
    for option in ("--steps", "--moveit", "--trajectory", "--glb", "--bag"):
        yield "export", given, option, read
    for option in ("--dlplan", "--runir"):
        yield "export", [str(space.sketch), *domain], option, with_domain
