"""`check --watch` and `lsp` from the command line."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner

from sketchlang.cli import check, cli
from sketchlang.cli.watch import watch

GOOD = "sketch s\nfeature n : nat\ngoal { n = 0 }\nrule r { n > 0 } -> { n-- }\n"


def script(*changes: Callable[[], object]) -> Iterator[None]:
    """One change before each tick."""
    for change in changes:
        change()
        yield


def write(path: Path, text: str) -> Callable[[], object]:
    def change() -> None:
        path.write_text(text, encoding="utf-8")
        # Later than what was there, whatever the clock of the file system.
        later = os.stat(path).st_mtime_ns + 1_000_000 * len(text)
        os.utime(path, ns=(later, later))

    return change


def test_files_are_looked_at_again_when_one_of_them_changes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main, part = tmp_path / "main.sketch", tmp_path / "part.sketch"
    main.write_text(GOOD, encoding="utf-8")
    statuses = []

    def look() -> list[str]:
        status, paths = check._look((str(main),), None, "concise")
        statuses.append(status)
        return paths

    including = GOOD.replace("feature n : nat", 'include "part.sketch"')
    changes = script(
        lambda: None,
        write(main, including),
        write(part, "feature n : nat"),
        lambda: None,
        write(part, "feature m : nat"),
        part.unlink,
        write(part, "feature n : nat  # again"),
    )
    watch(look, changes)
    assert statuses == [0, 1, 0, 1, 1, 0]
    assert "include-not-found" in capsys.readouterr().out


def test_watching_standard_input_is_refused() -> None:
    done = CliRunner().invoke(cli, ["check", "--watch", "-"])
    assert done.exit_code == 2
    assert "--watch needs files" in done.output


def test_lsp_without_pygls_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    find = "importlib.util.find_spec"
    monkeypatch.setattr(find, lambda name, package=None: None)
    done = CliRunner().invoke(cli, ["lsp"])
    assert done.exit_code == 2
    assert "pip install 'sketchlang[lsp]'" in done.output
