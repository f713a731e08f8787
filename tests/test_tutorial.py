"""docs/tutorial.md, as written: its files are written, its commands run by a shell, and what they
show is compared."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from sketchlang.cli import cli
from tests.pages import DOCS, ROOT, Command, File, compare, read_page, run_page

PAGE = DOCS / "tutorial.md"
QUICK = ("list", "check", "terminate")
"""Commands that need no planning."""


def test_the_page_has_what_it_promises() -> None:
    page = read_page(PAGE)
    assert sum(isinstance(step, File) for step in page.steps) == 3
    words = {each.text.partition("sketchlang ")[2].split()[0] for each in page.commands}
    wanted = "list show check terminate run inspect step validate replay"
    assert words == set(wanted.split())
    assert "](docs/tutorial.md)" in (ROOT / "README.md").read_text(encoding="utf-8")


def test_what_is_checked_and_proved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = 0
    for step in read_page(PAGE).steps:
        if isinstance(step, File):
            Path(step.name).write_text(step.text, encoding="utf-8")
            continue
        assert isinstance(step, Command)
        words = step.text.split()
        if words[0] == "sketchlang" and words[1] in QUICK:
            result = CliRunner().invoke(cli, words[1:])
            compare(step.shown or [], result.output.splitlines(), step.text)
            done += 1
    assert done >= 6


@pytest.mark.slow
def test_every_command_as_written(tmp_path: Path) -> None:
    run_page(PAGE, tmp_path, verdicts=True)
    assert (tmp_path / "replay.html").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("shown", "output", "fits"),
    [
        (("a", "b"), "a\nb\n", True),
        (("a",), "a\nb\n", False),
        (("a", "..."), "a\nb\n", True),
        (("...", "c"), "a\nb\nc", True),
        (("...", "b"), "a\nb\nc", False),
        (("a", "...", "d"), "a\nb\nc", False),
        (("solved in 0.10 s: 2 actions",), "solved in 12.34 s: 7 actions", True),
        (("m is 2",), "m is 3", False),
    ],
)
def test_pages_and_outputs_are_compared(shown: tuple[str, ...], output: str, fits: bool) -> None:
    if fits:
        compare(list(shown), output.splitlines(), "here")
        return
    with pytest.raises(AssertionError):
        compare(list(shown), output.splitlines(), "here")
