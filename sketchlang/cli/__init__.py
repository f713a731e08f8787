"""The command line: one file a command, each imported only when it is called."""

from __future__ import annotations

import errno
import importlib
import os
import sys
from typing import Any

import click

from sketchlang import __version__

COMMANDS = {
    "check": "Parse a sketch, check its types and rules.",
    "fmt": "Write sketches in their canonical form.",
    "explain": "Print what a diagnostic means.",
    "new": "Write a working domain to start from.",
    "terminate": "Prove that a sketch terminates, or show how it does not.",
    "verify": "Check a proof of termination independently.",
    "coverage": "Find states that no rule provides for.",
    "graph": "Draw the policy graph or the rules of a sketch.",
    "run": "Plan a scene with a sketch.",
    "validate": "Certify a plan file with exact geometry.",
    "execute": "Execute a plan under physics, open loop or closed loop.",
    "replay": "Show a plan: a page for the browser, pictures, a film.",
    "export": "Write trajectories for ROS 2, a bag, a 3D model.",
    "bench": "Run a benchmark suite and print its tables.",
}

INTERRUPTED = 130
"""Exit status after Ctrl-C, as shells have it."""

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)
"""What a device says that takes no more output."""


class LazyGroup(click.Group):
    """Lists the commands of `COMMANDS` and imports `sketchlang.cli.NAME` on first use.

    `check` must answer within a blink: it cannot pay for the imports of `run`.
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        module = importlib.import_module(f"sketchlang.cli.{name}")
        command: click.Command = module.command
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            from sketchlang.suggest import did_you_mean

            hint = did_you_mean(args[0], COMMANDS)
            message = error.format_message()
            # Newer versions of click have a hint of their own.
            if hint is None or "Did you mean" in message:
                raise
            raise click.UsageError(f"{message} {hint}", ctx) from None

    def invoke(self, ctx: click.Context) -> Any:
        # Not left to click, whose exit status for Ctrl-C is 1: that is a verdict here.
        try:
            try:
                return super().invoke(ctx)
            finally:
                sys.stdout.flush()  # a full disk has to show now, not when Python exits
        except KeyboardInterrupt:
            click.echo("interrupted", err=True)
            ctx.exit(INTERRUPTED)
        except OSError as error:
            # Commands tell of their files themselves. What is left is standard output.
            if error.errno not in FULL:
                raise
            click.echo(f"error: output cannot be written: {error.strerror or error}", err=True)
            # What is still buffered cannot be written either.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            ctx.exit(2)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.command(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="sketchlang")
def cli() -> None:
    """Write sketches, prove that they terminate, plan robot tasks with them."""


def main() -> None:
    """Entry point of the `sketchlang` script."""
    try:
        cli(prog_name="sketchlang")
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        raise SystemExit(INTERRUPTED) from None
