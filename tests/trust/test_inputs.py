"""What is no file, or too much of one, as every input of every command: refused, at once."""

from __future__ import annotations

import os
import shutil
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner

from sketchlang.cli import cli
from tests.trust.workspace import URDF, Workspace, make

ODD = ("pipe", "socket", "folder", "zero", "random", "gigabyte", "keys", "loop", "locked name")


def put(path: Path, kind: str) -> None:
    """Put something odd where a file was."""
    path.unlink(missing_ok=True)
    match kind:
        case "pipe":
            os.mkfifo(path)
        case "socket":
            with socket.socket(socket.AF_UNIX) as server:
                server.bind(str(path))
        case "folder":
            path.mkdir()
        case "zero":
            path.symlink_to("/dev/zero")
        case "random":
            path.symlink_to("/dev/urandom")
        case "gigabyte":
            with path.open("wb") as file:
                file.truncate(1 << 30)
        case "keys":
            path.write_text(".".join("a" * 100_000) + " = 1\n")
        case "loop":
            path.symlink_to(path)
        case "locked name":
            path.symlink_to(path / ("x" * 300))


def commands(space: Workspace, plan: Path) -> Iterator[tuple[list[str], Path]]:
    """Every command and each of the files that it reads."""
    sketch, domain, scene, robot = map(str, (space.sketch, space.domain, space.scene, space.robot))
    proof, page, out = (str(space.folder / name) for name in ("proof.json", "page", "new"))
    for name in ("check", "fmt", "terminate", "repair", "coverage", "graph"):
        yield [name, sketch], space.sketch
    for name in ("check", "terminate", "repair", "coverage", "graph"):
        yield [name, sketch, "--domain", domain], space.domain
    yield ["verify", proof, sketch], Path(proof)
    yield ["verify", proof, sketch], space.sketch
    run = ["run", sketch, scene, "--robot", robot, "--domain", domain]
    loop = ["execute", sketch, scene, "--robot", robot, "--closed-loop"]
    for path in (space.sketch, space.scene, space.robot, space.urdf):
        yield run, path
        yield loop, path
    yield run, space.domain
    own = ["--scene", scene, "--robot", robot]
    whole = [str(plan), *own, "--sketch", sketch]
    for path in (plan, space.scene, space.robot, space.urdf):
        yield ["validate", str(plan), *own], path
    for path in (plan, space.sketch, space.scene, space.robot, space.urdf):
        yield ["execute", *whole], path
        yield ["replay", *whole, "--html", page], path
        yield ["export", *whole, "--glb", out], path
    yield ["bench", "paper", "--out", out], Path(out)


@pytest.fixture
def space(tmp_path: Path) -> Workspace:
    made = make(tmp_path / "space")
    (made.folder / "proof.json").write_text("{}")
    return made


@pytest.mark.parametrize("kind", ODD)
def test_as_every_input_of_every_command(kind, space, plan_file) -> None:
    plan = Path(shutil.copy(plan_file, space.folder / "plan.json"))
    for arguments, path in commands(space, plan):
        if kind == "folder" and arguments[0] == "fmt":
            continue  # it formats what is in the folder
        kept = path.read_bytes() if path.exists() else b""
        put(path, kind)
        done = CliRunner().invoke(cli, arguments)
        # Where no TOML is read, dotted keys are a wrong text: `check` and `verify` say so.
        judged = {"check": ".sketch", "verify": ".json"}.get(arguments[0]) == path.suffix
        verdict = kind == "keys" and judged
        assert done.exit_code == (1 if verdict else 2), (arguments, path.name, done.output)
        assert "a bug in" not in done.output
        assert "Traceback" not in done.output
        if not verdict and not (kind == "keys" and path.suffix == ".sketch"):
            lines = [line for line in done.stderr.splitlines() if "rror:" in line]
            assert len(lines) == 1, (arguments, path.name, lines)
        if path.is_dir():
            path.rmdir()
        else:
            path.unlink()
        path.write_bytes(kept)


@pytest.mark.parametrize("kind", ODD)
def test_as_an_include(kind, space) -> None:
    put(space.include, kind)
    for name, status in (("check", 1), ("terminate", 2), ("graph", 2), ("coverage", 2)):
        done = CliRunner().invoke(cli, [name, str(space.sketch)])
        assert done.exit_code == status, done.output
        assert "a bug in" not in done.output


@pytest.mark.parametrize("target", ["/etc/passwd", "/proc/self/environ", "secret.txt", "../secret"])
def test_other_files_are_not_shown_by_including_them(target, space) -> None:
    (space.folder / "secret.txt").write_text("password")
    (space.folder.parent / "secret").write_text("password")
    space.sketch.write_text(f'sketch s\ninclude "{target}"\n')
    done = CliRunner().invoke(cli, ["check", str(space.sketch)])
    assert done.exit_code == 1
    assert "only files ending in .sketch are included" in done.output
    for word in ("password", "root:", "PATH="):
        assert word not in done.output


def test_a_plan_does_not_make_us_read_standard_input(plan_file, space) -> None:
    text = plan_file.read_text().replace('"sketch":"pick_and_place"', '"sketch":"-"')
    assert '"sketch":"-"' in text
    plan = space.folder / "plan.json"
    plan.write_text(text)
    for name, option in (("replay", "--html"), ("export", "--glb")):
        done = CliRunner().invoke(
            cli, [name, str(plan), option, str(space.folder / "o")], "sketch s"
        )
        assert done.exit_code == 2
        assert "--sketch FILE" in done.stderr


def test_the_urdf_is_one_of_the_inputs(space) -> None:
    """Guards the tests above: the robot of the workspace names the URDF of the workspace."""
    assert f'{URDF} = "{space.urdf.name}"' in space.robot.read_text()
