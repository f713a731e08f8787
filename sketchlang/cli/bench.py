"""`sketchlang bench SUITE`: run sketches x scenes x planners x robots x seeds, print the tables."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sketchlang import reading
from sketchlang.cli import names
from sketchlang.cli.common import FILE, Number, fail, interruptible, say

if TYPE_CHECKING:
    from runtime.bench.job import Job, Result
    from runtime.bench.runner import Lost
    from runtime.bench.store import Store
    from runtime.bench.suite import Suite
    from runtime.bench.table import Table

FORMATS = ("md", "csv", "latex", "json")
RUN = "run"


class BenchGroup(click.Group):
    """`bench SUITE` is `bench run SUITE`; `kinder` is a suite with options of its own."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return [RUN, "compare", "kinder"]

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name == "kinder":
            from sketchlang.cli import kinder

            return kinder.command
        if name == "compare":
            from sketchlang.cli import bench_compare

            return bench_compare.command
        return super().get_command(ctx, name)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Put in the command that may be left out."""
        if args and args[0] not in [*self.list_commands(ctx), *ctx.help_option_names]:
            args = [RUN, *args]
        return super().parse_args(ctx, args)

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The options of `run`, and the commands."""
        self.commands[RUN].format_options(ctx, formatter)
        self.format_commands(ctx, formatter)


@click.group("bench", cls=BenchGroup, no_args_is_help=True, subcommand_metavar="SUITE | COMMAND")
def command() -> None:
    """Run the benchmark SUITE in parallel processes, one core a run.

    SUITE is a TOML file with sketches, scenes, planners, robots and seeds (see
    docs/howto-benchmark.md), or one that comes along. `paper`: the eight scenes of the paper.
    `baselines`: the same with planners that know no sketch. `scaling`: generated sorting scenes
    with 10 to 200 objects. `ipc`: the PDDL tasks of a folder, each with its `domain.pddl` beside
    it; `--sketch siw` and `--sketch iw` know nothing of a domain.

    \b
    Examples:
      sketchlang bench my.toml
      sketchlang bench my.toml --format latex
      sketchlang bench paper --planner siw-r --scene sorting/4t-07 --seeds 3
      sketchlang bench ipc --tasks FOLDER
      sketchlang bench kinder --help
      sketchlang bench compare before.jsonl after.jsonl

    Run the same command again after an interruption: finished runs are not repeated, unless the
    sketch, the scene, the robot or this tool has changed.

    Exit 0: every run has a result. 1: some have none. 2: bad input.
    """


@command.command(RUN, help=command.help)
@click.argument("suite", shell_complete=names.suites)
@click.option("--seeds", type=click.IntRange(1, 10_000), help="So many runs of each.")
@click.option(
    "--planner",
    "planners",
    multiple=True,
    shell_complete=names.planners,
    help="These planners.",
)
@click.option(
    "--scene", "scenes", multiple=True, shell_complete=names.scenes, help="Only these scenes."
)
@click.option(
    "--tasks", type=click.Path(path_type=Path), help="ipc: a folder with folders of PDDL tasks."
)
@click.option(
    "--sketch",
    shell_complete=names.sketches,
    help="ipc: this one for all tasks; else the built-in one of the domain.",
)
@click.option("--jobs", type=click.IntRange(1, 256), help="Processes; as many as there are cores.")
@click.option("--timeout", type=Number(min=0, max=999_999, min_open=True), help="Seconds a run.")
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Run on the workers of a dask.distributed scheduler (tcp://HOST:PORT).",
)
@click.option(
    "--format",
    "shape",
    type=click.Choice(FORMATS),
    default="md",
    show_default=True,
    help="What is printed.",
)
@click.option(
    "--out",
    type=FILE,
    help="Results, one JSON object a line; bench-NAME.jsonl. The plot lies beside it.",
)
@interruptible
def run(
    suite: str,
    seeds: int | None,
    planners: tuple[str, ...],
    scenes: tuple[str, ...],
    tasks: Path | None,
    sketch: str | None,
    jobs: int | None,
    timeout: float | None,
    scheduler: str | None,
    shape: str,
    out: Path | None,
) -> None:
    """As the group's."""
    from runtime.bench import store
    from sketchlang.errors import InputError

    if (suite == "ipc") != (tasks is not None):
        fail("--tasks FOLDER names the tasks of the suite ipc, and belongs to no other")
    if suite != "ipc" and sketch is not None:
        fail("--sketch belongs to the suite ipc")
    if scheduler is not None and jobs is not None:
        fail("--jobs: with --scheduler, its workers are as many as run")
    try:
        _refuse_unknown(planners)
        path = out or Path(f"bench-{Path(suite).stem}.jsonl")
        picture = path.with_suffix(".svg")
        _refuse_other_pictures(path, picture)
        found = _suite(suite, path.parent, tasks, sketch)
        wanted = found.narrowed(planners, scenes, seeds, timeout).jobs()
        with store.opened(path, lambda: say(f"waiting: {path} is in use", err=True)) as results:
            lost = _run(wanted, results, jobs, scheduler)
        chosen = [results.results[job] for job in wanted if job in results.results]
        Shown(found, chosen, lost).show(shape)
        _draw(found, chosen, picture, quiet=shape != "md")
    except InputError as error:
        fail(error)
    raise SystemExit(1 if lost else 0)


def _refuse_unknown(planners: Sequence[str]) -> None:
    from sketchlang.errors import InputError
    from sketchlang.suggest import did_you_mean

    for planner in planners:
        if planner not in names.PLANNERS:
            known = f"planners: {', '.join(names.PLANNERS)}"
            hint = did_you_mean(planner, names.PLANNERS) or known
            raise InputError(f"there is no planner {planner!r}", hint=hint)


def _suite(name: str, folder: Path, tasks: Path | None, sketch: str | None) -> Suite:
    """The suite of a name or a file."""
    from runtime.bench.suite_file import BUILT_IN, built_in_suite, read_suite
    from sketchlang.errors import InputError
    from sketchlang.suggest import did_you_mean

    if tasks is not None:
        from domains.pddl.bench import suite_of

        return suite_of(tasks, sketch)
    if name == "scaling":
        from domains.tabletop.scene.generate import sorting_scene
        from runtime.bench.scaling import scaling_suite

        return scaling_suite(folder, sorting_scene)
    if name in BUILT_IN:
        return built_in_suite(name)
    if not name.endswith(".toml") and not os.path.exists(name):
        known = did_you_mean(name, names.SUITES) or f"built in: {', '.join(names.SUITES)}"
        raise InputError(f"there is no suite {name!r}, neither a file nor built in", hint=known)
    return read_suite(Path(name))


def _run(wanted: list[Job], results: Store, jobs: int | None, scheduler: str | None) -> Lost:
    from runtime.bench.runner import run_all

    todo = sum(job not in results.results for job in wanted)
    if todo < len(wanted):
        say(f"{len(wanted) - todo} of {len(wanted)} are in {results.path}", err=True)
    with click.progressbar(length=todo, label="runs", show_eta=True, file=sys.stderr) as progress:

        def done(_: Result) -> None:
            progress.update(1)

        if scheduler is None:
            return run_all(wanted, results, jobs or os.cpu_count() or 1, done)
        from runtime.bench.scheduler import run_on

        return run_on(scheduler, wanted, results, done)


@dataclass(frozen=True)
class Shown:
    """What came of a suite, and how it is printed."""

    suite: Suite
    results: list[Result]
    lost: Lost

    def show(self, shape: str) -> None:
        """Print it: the data on standard output, what else there is to say beside it."""
        from runtime.bench.summary import summarise
        from runtime.bench.write.data import as_csv, as_json
        from runtime.bench.write.tables import lines_of

        if shape == "csv":
            say(*as_csv(summarise(self.results)))
        elif shape == "json":
            without = [
                {"scene": job.scene, "planner": job.planner, "seed": job.seed, "reason": reason}
                for job, reason in self.lost
            ]
            click.echo(as_json(self.suite.name, summarise(self.results), without))
        else:
            say(*lines_of(self.tables(), shape))
        for result in self.results:
            if not (result["solved"] and result.get("valid")):
                reason = result.get("reason") or "; ".join(result.get("findings", []))
                about = f"{result['job']['scene']} {result['planner']} seed {result['seed']}"
                say(f"{about}: {reason}", err=shape != "md")
        for job, reason in self.lost:
            say(f"{job.scene} {job.planner} seed {job.seed}: no result, {reason}", err=True)

    def tables(self) -> list[Table]:
        """The tables of the suite."""
        if self.suite.tables == "ipc":
            from domains.pddl import bench as ipc

            return ipc.tables(self.results)
        from runtime.bench.tables import tables_of

        return tables_of(self.suite.tables, self.results)


def _draw(suite: Suite, results: list[Result], picture: Path, quiet: bool) -> None:
    from runtime.bench.plot import scaling_plot
    from runtime.bench.survival import survival_plot
    from runtime.bench.tables import size_of
    from sketchlang.files import write_text

    if suite.tables == "scaling":
        sizes = [size_of(result["job"]["scene"]) for result in results]
        write_text(picture, scaling_plot(results, sizes))
    else:
        write_text(picture, survival_plot(results))
    say("", f"plot: {picture}", err=quiet)


def _refuse_other_pictures(path: Path, picture: Path) -> None:
    """The plot has a name that nobody gave: it replaces plots only."""
    from runtime.bench.picture import MARK
    from sketchlang.errors import InputError
    from sketchlang.files import check_output
    from sketchlang.reading import read_text

    if picture == path:
        raise InputError("--out: the plot ends in .svg, so the results must not")
    check_output(picture)
    with reading.recording():  # of its own: the picture is read to know it, and may be replaced
        if os.path.lexists(picture) and MARK not in read_text(picture):
            raise InputError("is here already and not a plot of a suite", place=str(picture))
