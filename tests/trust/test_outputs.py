"""No output is written over an input: by any command, option, kind of file and kind of name."""

from __future__ import annotations

import itertools
import shutil
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from click.testing import CliRunner, Result

from sketchlang.cli import cli
from tests.trust.workspace import FORMS, Workspace, commands, make

OTHERS = {
    ("new domain", "--into"),
    ("bench run", "--out"),
    ("bench kinder", "--keep"),
    ("robot import", "--out"),
    ("import dlplan", "--out"),
    ("import runir", "--out"),
    ("import tmp", "--out"),
}
"""Folders, a store, and what reads other tools' files: these have tests of their own."""
INPUTS = {
    ("robot import", "--srdf"),
    ("bench run", "--tasks"),
    ("bench kinder", "--python"),
    ("replay", "--against"),
}


def call(*arguments: object) -> Result:
    return CliRunner().invoke(cli, [str(argument) for argument in arguments])


@pytest.fixture
def space(tmp_path: Path) -> Workspace:
    return make(tmp_path / "space")


@pytest.fixture
def plan(plan_file: Path, space: Workspace) -> Path:
    return Path(shutil.copy(plan_file, space.folder / "plan.json"))


@pytest.fixture
def no_work(monkeypatch) -> None:
    """Fails where a command begins with what takes its time."""

    def work(*_: object, **__: object) -> None:
        raise AssertionError("the work began")

    for name in (
        "sketchlang.analysis.termination.decide_termination",
        "runtime.solve.Task.solve",
        "runtime.physics.execute.execute",
        "domains.tabletop.loop.closed_loop.ClosedLoop.run",
        "runtime.show.page.page",
        "runtime.show.pictures.camera_of",
        "runtime.export.model.glb",
    ):
        monkeypatch.setattr(name, work)


def test_every_command_is_here(space, plan) -> None:
    tried = {(name, option) for name, _, option, _ in commands(space, plan)}
    assert set(path_options("", cli)) == tried | OTHERS | INPUTS


def path_options(name: str, command: click.Command) -> Iterator[tuple[str, str]]:
    """All options of the command line that are paths: what is written, and a few inputs."""
    if isinstance(command, click.Group):
        context = click.Context(command)
        for inner in command.list_commands(context):
            found = command.get_command(context, inner)
            assert found is not None
            yield from path_options(f"{name} {inner}".strip(), found)
    for parameter in command.params:
        if isinstance(parameter, click.Option) and isinstance(parameter.type, click.Path):
            yield name, parameter.opts[-1]


def test_the_commands_work_where_nothing_is_in_the_way(space, plan) -> None:
    """Guards the tests below against commands that are refused for another reason."""
    done = call("terminate", space.sketch, "--domain", space.domain, "--certificate",
                space.folder / "new.json")  # fmt: skip
    assert done.exit_code == 0, done.output
    given = ("--scene", space.scene, "--robot", space.robot, "--sketch", space.sketch)
    done = call("replay", plan, *given, "--trace", space.folder / "trace.json")
    assert done.exit_code == 0, done.output


def refused(space: Workspace, before: dict[Path, bytes], done: Result) -> None:
    assert done.exit_code == 2, done.output
    assert "Traceback" not in done.output
    assert {path: space.files()[path] for path in before} == before


@pytest.mark.usefixtures("no_work")
def test_nothing_is_written_over_an_input(space, plan) -> None:
    before = space.files()
    tried = 0
    for name, arguments, option, read in commands(space, plan):
        for path, form in itertools.product(read.values(), FORMS):
            output = space.alias(path, form)
            done = call(name, *arguments, option, output)
            refused(space, before, done)
            if option not in (
                "--png",
                "--bag",
                "--mp4",
                "--gif",
            ):  # those have more reasons to refuse
                assert "would overwrite what is read" in done.output, (name, option, path, form)
            if form.endswith("link"):
                output.unlink()
            tried += 1
    assert tried > 200


def test_a_proposal_for_a_robot_does_not_replace_what_is_read(space) -> None:
    before = space.files()
    done = call("robot", "import", space.urdf, "--out", space.folder)
    assert {path: space.files()[path] for path in before} == before, done.output
    assert "a bug in" not in done.output


def test_pictures_do_not_replace_what_is_read(space, plan) -> None:
    picture = space.folder / "pictures" / "start.png"
    picture.parent.mkdir()
    plan.rename(picture)
    before = space.files()
    refused(space, before, call("replay", picture, "--png", picture.parent))


def test_a_film_through_a_link_does_not_replace_what_is_read(space, plan) -> None:
    link = space.folder / "film.mp4"
    link.symlink_to(plan)
    before = space.files()
    refused(space, before, call("replay", plan, "--mp4", link))


def test_fmt_changes_its_file_as_a_whole(space, monkeypatch) -> None:
    path = space.folder / "ugly.sketch"
    path.write_text("sketch s\nfeature   n : nat\n")
    path.chmod(0o640)
    link = space.folder / "link.sketch"
    link.symlink_to(path)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr("os.replace", full)
        refused(space, space.files(), call("fmt", link))
    assert call("fmt", link).exit_code == 0
    assert path.read_text() == "sketch s\nfeature n : nat\n"
    assert link.is_symlink()
    assert path.stat().st_mode & 0o777 == 0o640


def test_new_writes_all_its_files_or_none(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    with monkeypatch.context() as patched:
        patched.setattr("os.rename", lambda *_: (_ for _ in ()).throw(OSError(28, "full")))
        done = call("new", "domain", "lamps")
    assert done.exit_code == 2
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "lamps").mkdir()
    assert call("new", "domain", "lamps").exit_code == 2
    assert list((tmp_path / "lamps").iterdir()) == []
    done = call("new", "domain", "a" * 240)
    assert done.exit_code == 2
    assert [path.name for path in tmp_path.iterdir()] == ["lamps"]
