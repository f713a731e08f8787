"""The command line: one file a command, each imported only when it is called."""

from __future__ import annotations

import builtins
import importlib
import keyword
import os
import sys
from collections.abc import Sequence
from typing import Any

import click
from click.shell_completion import CompletionItem

from sketchlang.cli.last import USAGE, end_process, prepare_process, run_group, say_error
from sketchlang.guard import in_the_way
from sketchlang.version import __version__

COMMANDS = {
    "check": "Parse a sketch, check its types and rules.",
    "fmt": "Write sketches in their canonical form.",
    "explain": "Print what a diagnostic means.",
    "lsp": "Serve an editor: diagnostics, hover, completion, renaming.",
    "new": "Write a working domain to start from.",
    "list": "List what comes along: sketches, scenes, robots, planners, domains.",
    "show": "Show a domain, scene, robot or sketch.",
    "terminate": "Prove that a sketch terminates, or show how it does not.",
    "repair": "Find the smallest changes after which a sketch terminates.",
    "test": "Test a sketch against states of small scenes.",
    "compare": "Tell whether two sketches name the same subgoals.",
    "verify": "Check a proof of termination independently.",
    "coverage": "Find states that no rule provides for.",
    "graph": "Draw the policy graph or the rules of a sketch.",
    "run": "Plan a scene with a sketch.",
    "inspect": "Show why features have their values and which rules apply.",
    "step": "Walk through a run subgoal by subgoal.",
    "validate": "Certify a plan file with exact geometry.",
    "execute": "Execute a plan under physics, open loop or closed loop.",
    "replay": "Show a plan: a page for the browser, pictures, a film.",
    "export": "Write steps for controllers, trajectories, a bag, a 3D model.",
    "send": "Send a plan to a robot's controllers, step by step.",
    "robot": "Bring in a robot of one's own, look its file over.",
    "import": "Translate policies of other tools and scenes of benchmarks.",
    "bench": "Run a benchmark suite and print its tables.",
}

COMPLETION = "_SKETCHLANG_COMPLETE"
"""Environment variable by which shells ask for completions."""


class LazyGroup(click.Group):
    """Lists the commands of `COMMANDS` and imports `sketchlang.cli.NAME` on first use.

    `check` must answer within a blink: it cannot pay for the imports of `run`.
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        # `import` is a word of Python, and `list` would hide what is built in: their files have
        # other names.
        taken = keyword.iskeyword(name) or hasattr(builtins, name)
        file = f"{name}_" if taken else name
        module = importlib.import_module(f"sketchlang.cli.{file}")
        command: click.Command = module.command
        return command

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        # click would import every command for its help.
        found = [
            CompletionItem(name, help=summary)
            for name, summary in COMMANDS.items()
            if name.startswith(incomplete)
        ]
        return [*found, *click.Command.shell_complete(self, ctx, incomplete)]

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

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        windows_expand_args: bool = True,
        **extra: Any,
    ) -> Any:
        """Run the command line and end the process with an exit status of ours, not click's."""
        name = prog_name or "sketchlang"
        if not standalone_mode or COMPLETION in os.environ:
            return super().main(args, name, COMPLETION, standalone_mode, **extra)
        arguments = list(sys.argv[1:] if args is None else args)
        sys.exit(run_group(self, arguments, name, **extra))

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.command(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="sketchlang")
def cli() -> None:
    """Write sketches, prove that they terminate, plan robot tasks with them."""


def main() -> None:
    """Entry point of the `sketchlang` script."""
    prepare_process()
    trouble = in_the_way()
    if trouble is not None:
        say_error(f"error: {trouble}")
        sys.exit(USAGE)
    try:
        cli(prog_name="sketchlang")
    except SystemExit as end:
        end_process(end.code if isinstance(end.code, int) else 0)
