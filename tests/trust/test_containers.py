"""Users without a home whose installation cannot be written: everything works, with one line."""

from __future__ import annotations

import logging
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from runtime.kernels import cache

ROOT = Path(__file__).parents[2]
PACKAGES = ("sketchlang", "runtime", "domains", "grammars")
NOWHERE = "/proc/none"
"""A folder that not even root can make."""


@pytest.fixture
def bare(monkeypatch, tmp_path) -> Path:
    """No home, a package in which nothing can be written, and a folder for temporary files."""
    for name in (cache.FOLDER, "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", NOWHERE)
    monkeypatch.setattr(cache.tempfile, "tempdir", str(tmp_path))
    (tmp_path / "package").mkdir()
    (tmp_path / "package" / "__pycache__").write_text("not a folder")
    return tmp_path / "package"


def find(package: Path) -> Path | None:
    """The folder, looked for anew."""
    return cache.folder.__wrapped__(package)


def test_the_usual_places_come_first(bare, monkeypatch, tmp_path, caplog) -> None:
    with caplog.at_level(logging.WARNING):
        assert find(tmp_path) == tmp_path / "__pycache__"
        monkeypatch.setenv("HOME", str(tmp_path))
        in_home = find(bare)
        assert in_home is not None
        assert in_home.parent == tmp_path / ".cache" / "sketchlang"
        assert find(tmp_path / "package" / "another") != in_home
        monkeypatch.setenv("HOME", NOWHERE)
        monkeypatch.setenv(cache.FOLDER, str(tmp_path / "named"))
        assert find(bare) == tmp_path / "named"
    assert caplog.messages == []


def test_a_private_folder_stands_in(bare, tmp_path, caplog) -> None:
    with caplog.at_level(logging.WARNING):
        folder = find(bare)
    assert folder == tmp_path / f"sketchlang-kernels-{os.getuid()}"
    assert folder.stat().st_mode & 0o777 == 0o700
    assert len(caplog.messages) == 1


@pytest.mark.parametrize("spoil", ["open", "link", "file"])
def test_a_folder_that_others_can_write_is_not_used(spoil, tmp_path) -> None:
    folder = tmp_path / f"sketchlang-kernels-{os.getuid()}"
    if spoil == "link":
        (tmp_path / "elsewhere").mkdir(0o700)
        folder.symlink_to(tmp_path / "elsewhere")
    elif spoil == "file":
        folder.write_text("")
    else:
        folder.mkdir()
        folder.chmod(0o777)
    with pytest.raises(OSError, match="not for this user alone"):
        cache.own_folder(tmp_path)


def test_without_any_folder_nothing_is_kept(bare, monkeypatch, caplog) -> None:
    def none(_folder: Path) -> Path:
        raise PermissionError

    monkeypatch.setattr(cache, "own_folder", none)
    with caplog.at_level(logging.WARNING):
        assert find(bare) is None
    assert len(caplog.messages) == 1


@pytest.mark.slow
@pytest.mark.parametrize("folder", [True, False], ids=["temporary files", "nothing"])
def test_plan_validate_replay_and_execute(folder, tmp_path) -> None:
    installed = tmp_path / "installed"
    for package in PACKAGES:
        shutil.copytree(
            ROOT / package, installed / package, ignore=shutil.ignore_patterns("__pycache__")
        )
    for inner in [p for p in installed.rglob("*") if p.is_dir()]:
        (inner / "__pycache__").write_text("not a folder")
    (tmp_path / "work").mkdir()
    environment = {"PATH": os.environ["PATH"], "HOME": NOWHERE, "PYTHONPATH": str(installed)}
    if folder:
        (tmp_path / "temporary").mkdir()
        environment["TMPDIR"] = str(tmp_path / "temporary")
        start = "from sketchlang.cli import main; main()"
    else:  # what a system without any folder to write to is like
        start = (
            "import os\n"
            "mkdir = os.mkdir\n"
            "def none(path, *rest, **more):\n"
            "    if 'sketchlang-kernels' in str(path): raise PermissionError(13, 'no', str(path))\n"
            "    mkdir(path, *rest, **more)\n"
            "os.mkdir = none\n"
            "from sketchlang.cli import main; main()"
        )

    def call(*arguments: str) -> None:
        done = subprocess.run(
            [sys.executable, "-c", start, *arguments],
            cwd=tmp_path / "work",
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        # Judge, page and physics need none.
        assert done.stderr.count("compiled kernels") == (arguments[0] == "run")
        assert "Traceback" not in done.stderr

    call("run", "pick_and_place", "sorting/3t-02", "--out", "plan.json")
    call("validate", "plan.json")
    call("replay", "plan.json", "--html", "page.html")
    pytest.importorskip("pybullet")
    call("execute", "plan.json")
    names = sorted(path.name for path in (tmp_path / "work").iterdir())
    assert names == ["page.html", "plan.json"]  # no folder called ~
