"""Writers whose disk is full or who are killed: the old text or the new one, never a mix."""

from __future__ import annotations

import random
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.trust.workspace import ROOT, Workspace, commands, make

WRITER = """
import sys
from pathlib import Path
from sketchlang.files import write_text
path = Path(sys.argv[1])
for number in range(10**9):
    write_text(path, f"{number % 10}" * 300_000 + "end")
    if not number:
        print("begun", flush=True)
"""

SMALL = """
import resource, sys
from sketchlang.cli import main
resource.setrlimit(resource.RLIMIT_FSIZE, (1024, 1024))
main()
"""


def killed(path: Path, seconds: float) -> None:
    """A writer that is killed after a while."""
    with subprocess.Popen(
        [sys.executable, "-c", WRITER, str(path)], cwd=ROOT, stdout=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()
        try:
            process.wait(timeout=seconds)
        except subprocess.TimeoutExpired:
            process.kill()


def check_kills(path: Path, count: int) -> None:
    rng = random.Random(count)
    path.write_text("old")
    for _ in range(count):
        killed(path, rng.uniform(0.0, 0.1))
        text = path.read_text()
        assert text == text[0] * 300_000 + "end"


def test_a_kill_leaves_a_whole_file(tmp_path) -> None:
    check_kills(tmp_path / "file", 3)


@pytest.mark.slow
def test_fifty_kills_leave_whole_files(tmp_path) -> None:
    check_kills(tmp_path / "file", 50)


@pytest.fixture
def space(tmp_path: Path) -> Workspace:
    return make(tmp_path / "space")


def cannot_write(space: Workspace, arguments: list[str]) -> None:
    """A command whose files cannot be larger than 1 KB leaves everything as it is."""
    before = space.files()
    done = subprocess.run(
        [sys.executable, "-c", SMALL, *arguments], cwd=ROOT, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 2, done
    assert "Traceback" not in done.stderr
    assert "a bug in" not in done.stderr
    assert space.files() == before


def test_a_file_that_has_no_room_stays_as_it_was(space) -> None:
    ugly = space.folder / "ugly.sketch"
    ugly.write_text("sketch  s\n" + "# a comment\n" * 200)
    cannot_write(space, ["fmt", str(ugly)])


@pytest.mark.slow
def test_no_writer_leaves_half_a_file(space, plan_file) -> None:
    plan = Path(shutil.copy(plan_file, space.folder / "plan.json"))
    for name, arguments, option, _ in commands(space, plan):
        if option in ("--png", "--bag"):
            output = space.folder / "folder"
        else:
            suffix = option.replace("--", ".") if option in ("--mp4", "--gif") else ""
            output = space.folder / f"old{suffix}"
            output.write_text("old")
        cannot_write(space, [name, *arguments, option, str(output)])
        assert not [path for path in space.folder.iterdir() if path.name.startswith(".")]
