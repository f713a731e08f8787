"""The commands of the language: what they print and how they exit."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from sketchlang.cli import COMMANDS, cli

ROOT = Path(__file__).parents[2]
GOOD = "sketch s\nfeature n : nat\ngoal { n = 0 }\nrule r { n > 0 } -> { n-- }\n"
UGLY = "sketch   s\n\n\nfeature n:nat # the number\ngoal{n=0}\nrule r{n>0}↦{n↓}"
NEAT = "sketch s\n\nfeature n : nat  # the number\ngoal { n = 0 }\nrule r { n > 0 } -> { n-- }\n"


def run(*arguments: str, stdin: str | bytes | None = None) -> Result:
    return CliRunner().invoke(cli, list(arguments), input=stdin)


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_check_exit_codes(here: Path) -> None:
    (here / "good.sketch").write_text(GOOD)
    (here / "warn.sketch").write_text(GOOD + "feature m : nat\n")
    (here / "bad.sketch").write_text(GOOD + "feature n : bool\n")
    assert run("check", "good.sketch").exit_code == 0
    assert run("check", "warn.sketch").exit_code == 0
    assert run("check", "bad.sketch").exit_code == 1
    assert run("check", "good.sketch", "bad.sketch").exit_code == 1
    assert run("check").exit_code == 2
    missing = run("check", "good.sketch", "nowhere.sketch")
    assert missing.exit_code == 2
    assert "nowhere.sketch: no such file" in missing.stderr
    assert "good.sketch: ok" in missing.stdout


def test_check_unreadable_files(here: Path) -> None:
    (here / "dir.sketch").mkdir()
    (here / "bytes.sketch").write_bytes(b"\xff\xfe\x00")
    for name, message in (("dir.sketch", "directory"), ("bytes.sketch", "UTF-8")):
        result = run("check", name)
        assert result.exit_code == 2
        assert message in result.stderr


def test_check_builtin_names() -> None:
    assert run("check", "pick_and_place").exit_code == 0
    assert run("check", "delivery_s5").exit_code == 0
    result = run("check", "pick_and_plce")
    assert result.exit_code == 2
    assert "Did you mean `pick_and_place`?" in result.stderr


def test_check_standard_input() -> None:
    assert run("check", "-", stdin=GOOD).exit_code == 0
    result = run("check", "-", stdin="sketch s s")
    assert result.exit_code == 1
    assert "<stdin>:1:1" in result.stdout


def test_three_mistakes_three_findings(here: Path) -> None:
    (here / "t.sketch").write_text(
        "sketch t\nfeature n : nat\ngoal { n = 0 }\n"
        "rule a { n > 0 } -> { m-- }\nrule b { n > 0 } { n-- }\nrule a { n > 0 } -> { n-- }\n"
    )
    lines = run("check", "--format", "concise", "t.sketch").stdout.splitlines()
    assert [line.split(" ")[0] + line.split(" ")[1] for line in lines] == [
        "t.sketch:4:23:error[undefined-feature]",
        "t.sketch:5:18:error[missing-arrow]",
        "t.sketch:6:6:error[duplicate-rule]",
    ]


def test_include_through_folders(here: Path) -> None:
    (here / "parts").mkdir()
    (here / "parts" / "deep.sketch").write_text("feature n : nat\n")
    (here / "parts" / "all.sketch").write_text('include "deep.sketch"\ngoal { n = 0 }\n')
    text = 'sketch s\ninclude "parts/all.sketch"\ninclude "parts/deep.sketch"\n'
    (here / "s.sketch").write_text(text + "rule r { n > 0 } -> { n-- }\n")
    result = run("check", "s.sketch")
    assert (result.exit_code, result.stdout) == (0, "s.sketch: ok\n")
    # A mistake in a part is shown there.
    (here / "parts" / "deep.sketch").write_text("feature n : nut\n")
    result = run("check", "s.sketch")
    assert result.exit_code == 1
    assert "parts/deep.sketch:1:13" in result.stdout
    # Nothing else is reported because of it.
    assert "1 error\n" in result.stdout


def test_explain() -> None:
    result = run("explain", "impossible-effect")
    assert result.exit_code == 0
    assert "An effect cannot happen under the rule's own condition." in result.stdout
    assert "error[impossible-effect]: `n--` cannot happen" in result.stdout
    assert run("explain", "error[impossible-effect]").exit_code == 2
    assert run("explain", "[impossible-effect]").exit_code == 0
    wrong = run("explain", "imposible-effect")
    assert wrong.exit_code == 2
    assert "Did you mean `impossible-effect`?" in wrong.stderr
    listed = run("explain").stdout.splitlines()
    assert len(listed) >= 40


def test_fmt(here: Path) -> None:
    path = here / "s.sketch"
    path.write_text(UGLY, encoding="utf-8")
    assert run("fmt", "--check", "s.sketch").exit_code == 1
    shown = run("fmt", "--diff", "s.sketch")
    assert shown.exit_code == 1
    assert "+feature n : nat  # the number\n" in shown.stdout
    assert path.read_text(encoding="utf-8") == UGLY
    assert run("fmt", ".").exit_code == 0
    assert path.read_text(encoding="utf-8") == NEAT
    assert run("fmt", "--check", "--diff", "s.sketch").exit_code == 0
    assert run("fmt", "-", stdin=UGLY).stdout == NEAT


def test_fmt_refuses_what_does_not_parse(here: Path) -> None:
    path = here / "s.sketch"
    path.write_text("sketch s\nrule {\n")
    result = run("fmt", "s.sketch")
    assert result.exit_code == 2
    assert "missing-name" in result.stderr
    assert path.read_text() == "sketch s\nrule {\n"
    assert run("fmt", "pick_and_place").exit_code == 2
    assert not (here / "pick_and_place").exists()


def test_fmt_windows_line_ends(here: Path) -> None:
    path = here / "s.sketch"
    path.write_bytes(UGLY.replace("\n", "\r\n").encode())
    assert run("fmt", "s.sketch").exit_code == 0
    assert path.read_bytes() == NEAT.encode()


def test_no_colour_without_a_terminal(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from sketchlang.render import console

    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    assert console.wants_colour(Terminal())
    assert not console.wants_colour(io.StringIO())
    monkeypatch.setenv("NO_COLOR", "1")
    assert not console.wants_colour(Terminal())
    monkeypatch.delenv("NO_COLOR")
    monkeypatch.setenv("TERM", "dumb")
    assert not console.wants_colour(Terminal())
    assert sys.stdout is not None


def test_a_terminal_without_the_characters(here: Path) -> None:
    (here / "t.sketch").write_text("sketch größe\n", encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", "from sketchlang.cli import main; main()", "check", "t.sketch"],
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONPATH": str(ROOT)},
        check=False,
    )
    assert done.returncode == 1
    assert rb"gr\xf6\xdfe" in done.stdout
    assert done.stderr == b""


@pytest.mark.parametrize("command", [*(name for name in COMMANDS if name != "new"), "new domain"])
def test_help_has_an_example(command: str) -> None:
    result = run(*command.split(), "--help")
    assert result.exit_code == 0
    assert f"  sketchlang {command}" in result.output.partition("Example")[2]


def test_misspelt_commands() -> None:
    result = run("chek", "pick_and_place")
    assert result.exit_code == 2
    assert result.stderr.count("Did you mean") == 1
    assert "check" in result.stderr.partition("Did you mean")[2]


def test_ctrl_c_is_no_verdict(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also while a command reads its input, and while it is being imported."""

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    for target in ("sketchlang.cli.check.load_source", "sketchlang.cli.importlib.import_module"):
        monkeypatch.setattr(target, interrupt)
        result = run("check", "pick_and_place")
        assert result.exit_code == 130
        assert result.stderr == "interrupted\n"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is full")
@pytest.mark.parametrize("command", ["check", "terminate", "coverage"])
def test_output_that_cannot_be_written(command: str) -> None:
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run(
            [
                sys.executable,
                "-c",
                "from sketchlang.cli import main; main()",
                command,
                "delivery_s5",
            ],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
            cwd=ROOT,
        )
    assert done.returncode == 2
    assert done.stderr.startswith("error: output cannot be written")
    assert "Traceback" not in done.stderr


def test_diff_shows_a_missing_line_end(here: Path) -> None:
    (here / "s.sketch").write_text(NEAT.rstrip("\n"))
    shown = run("fmt", "--diff", "s.sketch").stdout
    assert shown.endswith(
        "-rule r { n > 0 } -> { n-- }\n\\ No newline at end of file\n+rule r { n > 0 } -> { n-- }\n"
    )


def test_a_folder_is_no_domain_file(here: Path) -> None:
    result = run("check", "pick_and_place", "--domain", ".")
    assert result.exit_code == 2
    assert "is a directory" in result.stderr
