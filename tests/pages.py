"""Pages of the documentation, executed as they are written.

A block of a page is code by four spaces or by a fence. What is done with it:

- a fence with a language and a file name (```` ```toml desk.toml ````) is that file: the first of
  a name is there from the start, later ones take its place when their turn comes;
- a block whose first line begins with `$ `, or with a word of `PROGRAMS`, is commands for a shell.
  Below a command with `$ `, its output is shown; `...` stands for any lines, and at the
  end of one for the rest of it. Decimals, and counts
  of what any change of the planner changes, are not compared;
- a block after a line `<!-- not run: REASON -->` is for readers only, and so is any other.

All commands of a page run in one shell, in a folder that holds nothing but the page's files. Each
has to succeed, unless the next one is `echo $?` or the page is one on which verdicts are bad.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"

PROGRAMS = ("sketchlang ", "python ", "cp ", "mkdir ", "cd ", "cat ", "DATA=")

NOT_RUN = re.compile(r"<!-- not run: \S.*-->")
FENCE = re.compile(r"```(\w+)?(?: +(\S+))?$")
HERE = re.compile(r"<<'?(\w+)'?")
VOLATILE = re.compile(
    r"-?\d+\.\d+|\d+(?=/\d+  )|(?<=\d/)\d+(?=  )"
    r"|\d+(?= (?:s|ms|robot configurations|states? generated|actions?|subplans?|steps?)\b)"
)
END = "@@ended"


@dataclass
class File:
    """A file of a page."""

    name: str
    text: str


@dataclass
class Command:
    """A command of a page: its text, the number of its line, and the lines that are shown as
    its output (None: none are)."""

    text: str
    line: int
    shown: list[str] | None = None


@dataclass
class Page:
    """What of a page can be executed: files and commands, as they come."""

    name: str
    steps: list[File | Command] = field(default_factory=list)

    @property
    def commands(self) -> list[Command]:
        """The commands alone."""
        return [step for step in self.steps if isinstance(step, Command)]


def read_page(path: Path) -> Page:
    """The files and commands of a page."""
    page = Page(path.name)
    for line, info, name, text, skipped in _blocks(path.read_text(encoding="utf-8")):
        if skipped:
            continue
        if name is not None:
            page.steps.append(File(name, text))
        elif info in (None, "console", "sh") and text.startswith(("$ ", *PROGRAMS)):
            page.steps += _commands(text, line)
    return page


def _blocks(text: str) -> list[tuple[int, str | None, str | None, str, bool]]:
    """Line number, language, file name and text of each block, and whether it is not run."""
    found = []
    lines = text.splitlines()
    skip, i = False, 0
    while i < len(lines):
        fence = FENCE.match(lines[i])
        start = i
        if fence:
            i += 1
            while i < len(lines) and lines[i] != "```":
                i += 1
            body = lines[start + 1 : i]
            found.append((start + 2, fence[1], fence[2], "\n".join(body) + "\n", skip))
            skip = False
            i += 1
        elif lines[i].startswith("    ") and (i == 0 or not lines[i - 1].strip()):
            while i < len(lines) and (lines[i].startswith("    ") or not lines[i].strip()):
                i += 1
            body = [line[4:] for line in lines[start:i]]
            found.append((start + 1, None, None, "\n".join(body).rstrip() + "\n", skip))
            skip = False
        else:
            if lines[i].strip():
                skip = bool(NOT_RUN.match(lines[i]))
            i += 1
    return found


def _commands(text: str, line: int) -> list[Command]:
    """The commands of a block, each with its continuation lines and its here-document."""
    found: list[Command] = []
    lines = text.splitlines()
    shows = text.startswith("$ ")
    i = 0
    while i < len(lines):
        if shows and not lines[i].startswith("$ "):
            found[-1].shown = [*(found[-1].shown or []), lines[i]]
            i += 1
            continue
        if not lines[i].strip() or lines[i].startswith("#"):
            i += 1
            continue
        start, words = i, [lines[i].removeprefix("$ ")]
        here = HERE.search(words[0])
        while here and lines[i] != here[1]:
            i += 1
            words.append(lines[i])
        while not here and words[-1].endswith("\\"):
            i += 1
            words.append(lines[i])
        found.append(Command("\n".join(words), line + start, [] if shows else None))
        i += 1
    return found


def run_page(
    path: Path,
    folder: Path,
    replace: Mapping[str, str] | None = None,
    verdicts: bool = False,
) -> str:
    """Execute a page in an empty folder; `replace` are texts of the page that are others here,
    such as addresses. Where a page has bad `verdicts`, exit status 1 is as good as 0. Returns all
    output.

    Raises:
        AssertionError: a command fails, or shows something else.
    """
    page = read_page(path)
    assert page.commands, f"{page.name} has no commands"
    programs = _programs(folder)
    lines: list[str] = []
    written: list[str] = []
    for number, step in enumerate(page.steps):
        if isinstance(step, File):
            kept, target = programs / f"file{number}", folder / step.name
            assert folder in target.resolve().parents
            kept.write_text(step.text, encoding="utf-8")
            write = f"mkdir -p '{target.parent}' && cp '{kept}' '{target}'"
            if step.name in written:
                lines.append(write)
            else:
                written.append(step.name)
                lines.insert(0, write)
        else:
            # The status is there for `echo $?` all the same.
            lines.append(_replaced(step.text, replace))
            lines.append(f"status=$?; echo; echo {END} $status; (exit $status)")
    done = subprocess.run(
        ["bash", "-c", "\n".join(lines)],
        cwd=folder,
        env={**os.environ, "PATH": f"{programs}:{os.environ['PATH']}", "NO_COLOR": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        stdin=subprocess.DEVNULL,
        text=True,
        check=False,
    )
    outputs = re.split(rf"\n?{END} (\d+)\n", done.stdout)
    said, statuses = outputs[:-1:2], outputs[1::2]
    for i, (command, output, status) in enumerate(zip(page.commands, said, statuses, strict=True)):
        where = f"{page.name}:{command.line}: {command.text}"
        asked = i + 1 < len(page.commands) and page.commands[i + 1].text == "echo $?"
        fine = status == "0" or (verdicts and status == "1")
        assert fine or asked, f"{where}\nexit {status}\n{output}"
        if command.shown is not None:
            compare(command.shown, output.splitlines(), where)
    return done.stdout


def _replaced(text: str, replace: Mapping[str, str] | None) -> str:
    for old, new in (replace or {}).items():
        text = text.replace(old, new)
    return text


def _programs(folder: Path) -> Path:
    """A folder with the programs that pages call: those of this interpreter and this tree."""
    programs = folder.parent / f"{folder.name}.bin"
    programs.mkdir(exist_ok=True)
    for name, words in (("python", ""), ("sketchlang", "-m sketchlang")):
        path = programs / name
        path.write_text(f'#!/bin/sh\nPYTHONPATH="{ROOT}" exec "{sys.executable}" {words} "$@"\n')
        path.chmod(0o755)
    return programs


def compare(shown: list[str], output: list[str], where: str) -> None:
    """What a page shows is what comes, but for what is volatile; `...` is any lines, and at the
    end of a line whatever else it says.

    Raises:
        AssertionError: it is something else.
    """
    wanted = [_plain(line) for line in shown if line.strip()]
    found = [_plain(line) for line in output if line.strip()]
    rest = found
    anywhere = False
    for line in wanted:
        if line == "...":
            anywhere = True
            continue
        places = [i for i, there in enumerate(rest) if _is(line, there)]
        assert places, _difference(where, line, found)
        assert anywhere or places[0] == 0, _difference(where, line, found)
        rest = rest[places[0] + 1 :]
        anywhere = False
    assert anywhere or not rest, _difference(where, "nothing more", rest)


def _is(shown: str, line: str) -> bool:
    return line.startswith(shown[:-4]) if shown.endswith(" ...") else line == shown


def _plain(line: str) -> str:
    return " ".join(VOLATILE.sub("#", line).split())


def _difference(where: str, line: str, found: list[str]) -> str:
    return f"{where}\nthe page shows: {line}\nit says:\n" + "\n".join(found)
