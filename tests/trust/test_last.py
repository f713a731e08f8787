"""Whatever comes out of a command is one line and a status that is no verdict."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import click
import pytest

from sketchlang.cli import last
from sketchlang.errors import InputError
from tests.trust.workspace import ROOT

SKETCH = str(ROOT / "domains" / "pick_and_place.sketch")
LONG = "x" * 300
FULL = "/dev/full"


def shell(command: str, cwd: Path | None = None, **extra: object) -> subprocess.CompletedProcess:
    """Run a command line in which `sketchlang` is ours."""
    return subprocess.run(
        ["bash", "-c", f'sketchlang() {{ "{sys.executable}" -m sketchlang "$@"; }}; {command}'],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        errors="surrogateescape",
        cwd=cwd,
        timeout=60,
        check=False,
        **extra,
    )


def one_line(done: subprocess.CompletedProcess, status: int = 2) -> None:
    assert done.returncode == status, done
    assert "Traceback" not in done.stderr
    assert "a bug in" not in done.stderr
    lines = done.stderr.strip().split("\n")
    assert len([line for line in lines if "hint:" not in line]) == 1, lines


@pytest.mark.parametrize(
    "command",
    [
        f"check {SKETCH} >&-",
        "--help >&-",
        f"--help >{FULL}",
        f"check {SKETCH} >{FULL}",
        f"check --format json {SKETCH} >{FULL}",
        f"graph {SKETCH} >{FULL}",
        "check - <&-",
        f"fmt - <{SKETCH} >{FULL}",
    ],
)
def test_output_that_cannot_be_written(command) -> None:
    one_line(shell(f"sketchlang {command}"))


def test_a_reader_that_goes_is_no_verdict() -> None:
    done = shell("sketchlang explain uncovered >&3 3>&-", pass_fds=())  # a descriptor that is not
    assert done.returncode != 0
    done = shell("set -o pipefail; (sketchlang explain; echo $? >&2) | true")
    assert done.stderr.strip() in ("0", str(last.PIPE_CLOSED))
    read, write = os.pipe()
    os.close(read)
    ended = subprocess.run(
        [sys.executable, "-m", "sketchlang", "explain"], stdout=write, cwd=ROOT,
        stderr=subprocess.PIPE, check=False,
    )  # fmt: skip
    os.close(write)
    assert (ended.returncode, ended.stderr) == (last.PIPE_CLOSED, b"")


@pytest.mark.parametrize(
    "command",
    [
        f"check {LONG}",
        f"check {LONG}/a.sketch",
        f"check a.sketch --domain {LONG}.py",
        f"fmt {LONG}",
        f"terminate {LONG}",
        f"terminate {SKETCH} --certificate {LONG}",
        f"terminate {SKETCH} --domain {LONG}",
        f"verify {LONG} {SKETCH}",
        f"coverage {LONG}",
        f"graph {SKETCH} -o {LONG}.svg",
        f"run {SKETCH} {LONG}",
        f"run {SKETCH} sorting/3t-02 --robot {LONG}.toml",
        f"run {SKETCH} sorting/3t-02 --out {LONG}",
        f"validate {LONG}",
        f"execute {LONG}",
        f"replay {LONG} --html a.html",
        f"replay plan.json --html {LONG}",
        f"export {LONG} --glb a.glb",
        f"bench paper --out {LONG}",
        f"new domain {LONG}",
        f"new domain a --into {LONG}",
    ],
)
def test_names_that_are_too_long(command, tmp_path, in_process) -> None:
    (tmp_path / "a.sketch").write_text("sketch s\n")
    assert in_process(command.split()) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["a.sketch"]


def test_an_include_whose_name_is_too_long_is_a_finding(tmp_path, in_process) -> None:
    (tmp_path / "a.sketch").write_text(f'sketch s\ninclude "{LONG}.sketch"\n')
    assert in_process(["check", "a.sketch"]) == 1


@pytest.fixture
def in_process(tmp_path, monkeypatch, capsys):
    """Calls a command in the folder of the test; its status, and at most two lines besides
    those of click's usage."""
    from sketchlang.cli import cli

    monkeypatch.chdir(tmp_path)

    def call(arguments: list[str]) -> int:
        with pytest.raises(SystemExit) as ended:
            cli.main(arguments)
        output = capsys.readouterr()
        assert "Traceback" not in output.err
        assert "a bug in" not in output.err
        assert output.err.count("rror:") == (1 if ended.value.code == 2 else 0)
        return int(ended.value.code or 0)

    return call


@pytest.mark.parametrize("option", ["--time-limit", "--memory-limit"])
@pytest.mark.parametrize("value", ["nan", "inf", "-1", "-nan"])
def test_limits_are_numbers(option, value, in_process) -> None:
    assert in_process(["terminate", SKETCH, f"{option}={value}"]) == 2


@pytest.mark.parametrize("value", ["nan", "inf", "-1", "0"])
def test_time_limits_of_planning_are_numbers_above_zero(value, in_process) -> None:
    assert in_process(["run", SKETCH, "sorting/3t-02", f"--timeout={value}"]) == 2
    assert in_process(["bench", "paper", f"--timeout={value}"]) == 2


@pytest.mark.skipif(os.getuid() != 0, reason="only root can become another user")
def test_a_folder_that_cannot_be_read(tmp_path) -> None:
    (tmp_path / "locked").mkdir()
    (tmp_path / "locked" / "a.sketch").write_text("sketch s\n")
    (tmp_path / "locked").chmod(0)
    for folder in (tmp_path, *tmp_path.parents):
        if folder.stat().st_uid == os.getuid() and folder != tmp_path.parents[-1]:
            folder.chmod(folder.stat().st_mode | 0o005)
    script = (
        "import os, sys\n"
        "from sketchlang.cli import main\n"
        "import sketchlang.cli.check, sketchlang.cli.graph, sketchlang.cli.common\n"
        "import sketchlang.analysis.termination\n"
        "os.setgroups([]); os.setgid(12345); os.setuid(12345)\n"
        "main()"
    )
    for arguments in (["check", "locked/a.sketch"], ["graph", "locked/a.sketch"]):
        done = subprocess.run(
            [sys.executable, "-c", script, *arguments], cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True,
            check=False,
        )  # fmt: skip
        one_line(done)
        assert "Permission denied" in done.stderr


def test_names_that_are_not_utf8(tmp_path, in_process) -> None:
    name = os.fsdecode(b"caf\xe9.sketch")
    (tmp_path / name).write_text("sketch s\nrule r { x } -> { }\n")
    for form in ("full", "concise", "json", "github", "sarif"):
        assert in_process(["check", "--format", form, name]) == 1
    done = shell("sketchlang check --format sarif $'caf\\xe9.sketch'", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (1, "")
    assert "caf%E9" in done.stdout


@pytest.mark.parametrize(
    ("error", "status", "words"),
    [
        (InputError("bad", place="here\n"), 2, "error: here\\n: bad"),
        (OSError(28, "No space left on device"), 2, "output cannot be written: No space"),
        (PermissionError(13, "Permission denied", "a\nb"), 2, "error: a\\nb: Permission denied"),
        (MemoryError(), 2, "out of memory"),
        (RecursionError(), 2, "nested too deeply"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (click.Abort(), 130, "interrupted"),
        (BrokenPipeError(), 141, ""),
        (click.UsageError("no\n::error::"), 2, "Error: no\\n::error::"),
        (click.FileError("x", "no"), 2, "Could not open file"),
        (SystemExit(1), 1, ""),
        (SystemExit(None), 0, ""),
        (ZeroDivisionError("x\ny"), 70, "a bug in sketchlang"),
    ],
)
def test_every_end_has_its_status(error, status, words, capsys) -> None:
    def work() -> None:
        raise error

    assert last.status_of(work) == status
    said = capsys.readouterr().err
    assert words in said
    assert len(said.splitlines()) == bool(words)


def test_a_bug_shows_its_traceback_on_request(monkeypatch, capsys) -> None:
    monkeypatch.setenv(last.TRACEBACK, "1")
    assert last.status_of(lambda: 1 / 0) == 70
    assert "Traceback" in capsys.readouterr().err


def test_sigterm_ends_with_its_own_status(tmp_path) -> None:
    pipe = tmp_path / "ready"
    os.mkfifo(pipe)
    script = (
        "import sys\n"
        "from sketchlang.cli import last\n"
        "last.prepare_process()\n"
        "def work():\n"
        "    try:\n"
        "        open(sys.argv[1], 'w').close()\n"
        "        while True: pass\n"
        "    finally:\n"
        "        print('tidied up')\n"
        "sys.exit(last.status_of(work))"
    )
    with subprocess.Popen(
        [sys.executable, "-c", script, str(pipe)], cwd=ROOT, stdout=subprocess.PIPE
    ) as process:
        pipe.read_bytes()  # waits until it is at work
        process.send_signal(signal.SIGTERM)
        assert process.communicate(timeout=60)[0] == b"tidied up\n"
        assert process.returncode == last.TERMINATED
