"""What the commands that analyse sketches share."""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn, ParamSpec, TypeVar

import click

from sketchlang.cli import INTERRUPTED
from sketchlang.diagnostics import Label
from sketchlang.loader import Loaded, LoadError, load_sketch
from sketchlang.model import Rule
from sketchlang.source import Source, Span
from sketchlang.syntax import tree

P = ParamSpec("P")
R = TypeVar("R")

DEEP = 20_000
"""Calls within calls that proofs with very many steps may need."""

domain_option = click.option(
    "--domain", "domain_file", metavar="FILE.py", help="A Python file with a domain."
)


def trace_options(command: Callable[P, R]) -> Callable[P, R]:
    """FILE, a plan or a trace, and what a plan refers to where that is not built in."""
    for option in (
        click.option("--sketch", help="The sketch, where a plan does not name a built-in one."),
        click.option("--robot", help="The robot, where a plan does not name a built-in one."),
        click.option("--scene", help="The scene, where a plan does not name a built-in one."),
        click.argument("file", type=click.Path(path_type=Path)),
    ):
        command = option(command)
    return command


def interruptible(command: Callable[P, R]) -> Callable[P, R]:
    """Lets Ctrl-C end a command with one word instead of a verdict's exit status."""

    @functools.wraps(command)
    def wrapped(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return command(*args, **kwargs)
        except KeyboardInterrupt:
            click.echo("interrupted", err=True)
            sys.exit(INTERRUPTED)

    return wrapped


def fail(message: str) -> NoReturn:
    """Ends the command because of what the user asked for or gave."""
    click.echo(f"error: {message}", err=True)
    sys.exit(2)


def load_valid(file: str, domain_file: str | None = None) -> Loaded:
    """The sketch of a file; ends the command if it cannot be read or has errors."""
    try:
        loaded = load_sketch(file, domain_file)
    except LoadError as error:
        fail(str(error))
    if not loaded.ok:
        from sketchlang.render import console, full

        colour = console.wants_colour(sys.stderr)
        for found in loaded.diagnostics:
            click.echo(full.render(found, colour) + "\n", err=True)
        click.echo(console.summary(loaded.diagnostics, [loaded.source.name]), err=True)
        sys.exit(2)
    return loaded


def look_ahead(path: str) -> None:
    """Ends the command if a file cannot be written for want of its folder: before hours of
    work and not after them."""
    target = Path(path)
    if not target.parent.is_dir():
        fail(f"{path}: there is no folder {str(target.parent)!r}")
    if target.is_dir():
        fail(f"{path}: is a directory")


def write_file(path: str, text: str) -> None:
    """Writes a file as a whole or not at all: under another name first, then renamed."""
    import tempfile

    target = Path(path)
    try:
        handle, temporary = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
    except OSError as error:
        fail(f"{path}: {error.strerror or error}")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        os.chmod(temporary, 0o666 & ~_umask())
        os.replace(temporary, target)
    except OSError as error:
        os.unlink(temporary)
        fail(f"{path}: {error.strerror or error}")
    except BaseException:
        os.unlink(temporary)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


class Places:
    """Where rules were written: a sketch may include others, so in more than one file."""

    def __init__(self, loaded: Loaded) -> None:
        self._main = loaded.source
        self._sources: dict[str, Source] = {}
        self._collect(loaded.tree)

    def _collect(self, parsed: tree.Tree) -> None:
        for item in parsed.items:
            if isinstance(item, tree.RuleItem):
                self._sources.setdefault(item.name.text, parsed.source)
            elif isinstance(item, tree.Include) and item.tree is not None:
                self._collect(item.tree)

    def source(self, rule: Rule) -> Source:
        """The text in which a rule stands."""
        return self._sources.get(rule.name, self._main)

    def position(self, rule: Rule, span: Span | None = None) -> str:
        """`file:line:column` of a rule, or of a span in it."""
        source = self.source(rule)
        line, column = source.position((span or rule.span).start)
        return f"{source.name}:{line}:{column}"


def title(loaded: Loaded) -> Label:
    """The sketch's name where it is declared: the place of what belongs to no item."""
    for item in loaded.tree.items:
        if isinstance(item, tree.Title):
            return Label(loaded.source, item.name.span)
    return Label(loaded.source, Span(0, 0))
