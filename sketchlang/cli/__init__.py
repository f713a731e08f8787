"""The command line: one file a command, each imported only when it is called."""

from __future__ import annotations

import importlib
import sys

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
    "bench": "Run a benchmark suite and print its tables.",
}


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
        raise SystemExit(130) from None
