"""What the commands that analyse sketches share."""

from __future__ import annotations

import functools
import math
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, ParamSpec, TypeVar

import click

from sketchlang import files, reading
from sketchlang.cli import names
from sketchlang.cli.last import INTERRUPTED
from sketchlang.domain import Domain
from sketchlang.errors import CollectedInputError, InputError
from sketchlang.escape import shown_line
from sketchlang.loader import PDDL, Loaded, load_sketch, pddl_domain

if TYPE_CHECKING:
    from runtime.trace.model import Trace

P = ParamSpec("P")
R = TypeVar("R")

FILE = click.Path(path_type=Path, dir_okay=False)
"""A file that an option names: one to be written, mostly."""

DEEP = 20_000
"""Calls within calls that proofs with very many steps may need."""

domain_option = click.option(
    "--domain",
    "domain_file",
    metavar="FILE",
    help="A Python file with a domain, or the PDDL file to check against.",
)
domain_pddl_option = click.option(
    "--domain-pddl",
    metavar="FILE",
    help="The domain of a PDDL task; without it, `domain.pddl` beside the task.",
)


def pddl_of(task: str, domain_pddl: str | None) -> Domain | None:
    """The domain of a PDDL task; None if what is named is none. Ends the command if the domain's
    file cannot be had."""
    if not task.endswith(PDDL):
        if domain_pddl is not None:
            fail("--domain-pddl: the scene is no PDDL task (its name does not end in .pddl)")
        return None
    from domains.pddl.interface import domain_beside

    try:
        return pddl_domain(domain_pddl or str(domain_beside(task)))
    except InputError as error:
        fail(error)


def named_options(command: Callable[P, R]) -> Callable[P, R]:
    """What a plan refers to, where that is not built in."""
    for option in (
        click.option(
            "--sketch",
            shell_complete=names.sketches,
            help="The sketch, where a plan does not name a built-in one.",
        ),
        click.option(
            "--robot",
            shell_complete=names.robots,
            help="The robot, where a plan does not name a built-in one.",
        ),
        click.option(
            "--scene",
            shell_complete=names.scenes,
            help="The scene, where a plan does not name a built-in one.",
        ),
    ):
        command = option(command)
    return command


def trace_options(command: Callable[P, R]) -> Callable[P, R]:
    """FILE, a plan or a trace, and what a plan refers to."""
    domain = click.option(
        "--domain", "domain_file", metavar="FILE", help="The domain that the sketch needs."
    )
    file = click.argument("file", type=click.Path(path_type=Path))
    return file(named_options(domain(command)))


def interruptible(command: Callable[P, R]) -> Callable[P, R]:
    """What every command with files runs in: what it reads is remembered, so that nothing is
    written over it, and Ctrl-C ends it with one word instead of a verdict's exit status."""

    @functools.wraps(command)
    def wrapped(*args: P.args, **kwargs: P.kwargs) -> R:
        depth = sys.getrecursionlimit()
        try:
            with reading.recording():
                return command(*args, **kwargs)
        except KeyboardInterrupt:
            click.echo("interrupted", err=True)
            sys.exit(INTERRUPTED)
        finally:
            # Long proofs need more; Python's own compiler crashes with it on deep code.
            sys.setrecursionlimit(depth)

    return wrapped


def say(*lines: str, err: bool = False) -> None:
    """Print lines in which every character is seen, whoever they are from."""
    for line in lines:
        click.echo(shown_line(line), err=err)


def fail(problem: str | Exception, hint: str | None = None) -> NoReturn:
    """Ends the command because of what the user asked for or gave."""
    # As an InputError it becomes one line, and one more for the hint.
    error = problem if isinstance(problem, InputError) else InputError(str(problem), hint=hint)
    for each in error.errors if isinstance(error, CollectedInputError) else (error,):
        click.echo(f"error: {each}", err=True)
    sys.exit(2)


def load_valid(file: str, domain_file: str | None = None, domain: Domain | None = None) -> Loaded:
    """The sketch of a file, checked against `domain` whatever it names, or against the domain that
    it names; ends the command if it cannot be read or has errors."""
    try:
        loaded = load_sketch(file, domain_file, domain)
    except InputError as error:
        fail(error)
    if not loaded.ok:
        from sketchlang.render import console, full

        colour = console.wants_colour(sys.stderr)
        for found in loaded.diagnostics:
            click.echo(full.render(found, colour) + "\n", err=True)
        click.echo(console.summary(loaded.diagnostics, [loaded.source.name]), err=True)
        sys.exit(2)
    return loaded


def check_outputs(
    named: Iterable[str | Path | None],
    outputs: Mapping[str, Path | None],
    folders: tuple[str, ...] = (),
) -> None:
    """Ends the command if an output, by its option, would overwrite something that is read, or
    another output, or cannot be written: before the work and not after it.

    `named` are inputs besides those that were read already; they may also be names of what is
    built in: those are no files. `folders` are the options that write a folder.
    """
    for name in named:
        if name is not None:
            reading.inputs().note(name)
    try:
        files.check_outputs(outputs, folders)
    except InputError as error:
        fail(error)


class Number(click.FloatRange):
    """A number in a range, neither infinite nor `nan`, which no range keeps out."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The number; fails as click's types do."""
        number: float = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number.", param, ctx)
        return number


def load_named(
    file: Path,
    scene: str | None,
    robot: str | None,
    sketch: str | None,
    domain_file: str | None = None,
) -> Trace:
    """The trace of FILE, a plan or a trace, with what `trace_options` give for it.

    Raises:
        InputError: what is wrong with the file or an option, and what to do about it.
    """
    from domains.tabletop.scene.worlds import find_world
    from runtime.trace.load import load_trace

    given = {"--scene": scene, "--robot": robot, "--sketch": sketch, "--domain": domain_file}
    _refuse_for_traces(file, [option for option, value in given.items() if value is not None])
    try:
        return load_trace(file, find_world, scene, robot, sketch, domain_file)
    except InputError as error:
        option = _option_for(error)
        if option is None or given[option] is not None:
            raise
        raise InputError(
            f"the plan names what is not here: {error.message}",
            place=error.place,
            hint=f"a path in a plan starts from the current folder: give {option} FILE",
        ) from None


def _refuse_for_traces(file: Path, options: list[str]) -> None:
    from runtime.plan.node import read_json
    from runtime.trace.write import FORMAT

    if not options:
        return
    data = read_json(file).value
    if isinstance(data, dict) and data.get("format") == FORMAT:
        raise InputError(
            "a trace holds its scene, its robot and its sketch",
            place=str(file),
            hint=f"leave out {' and '.join(options)}",
        )


def _option_for(error: InputError) -> str | None:
    """The option that stands in for what a plan names and an error misses."""
    if error.message.startswith("there is no scene"):
        return "--scene"
    lost = error.message == "no such file" and str(error.place).endswith(".toml")
    return "--robot" if lost or error.message.startswith("unknown robot") else None
