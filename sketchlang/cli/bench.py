"""`sketchlang bench SUITE`: run scenes x planners x seeds and print the tables."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import click

from sketchlang import reading
from sketchlang.cli import names
from sketchlang.cli.common import Number, fail, interruptible, say


class Bench(click.Command):
    """The command; its suite `kinder` is one with options of its own."""

    def make_context(
        self,
        info_name: str | None,
        args: list[str],
        parent: click.Context | None = None,
        **extra: Any,
    ) -> click.Context:
        if args[:1] == ["kinder"]:
            from sketchlang.cli import kinder

            return kinder.command.make_context(f"{info_name} kinder", args[1:], parent, **extra)
        return super().make_context(info_name, args, parent, **extra)


@click.command(
    cls=Bench,
    epilog="""\b
Examples:
  sketchlang bench paper --seeds 10
  sketchlang bench paper --planner siw-r --scene sorting/4t-07 --seeds 3
  sketchlang bench scaling --jobs 1
  sketchlang bench ipc --tasks FOLDER
  sketchlang bench kinder --help
Run the same command again after an interruption: finished runs are not repeated.
""",
)
@click.argument("suite", type=click.Choice(["paper", "scaling", "ipc"]))
@click.option(
    "--seeds", type=click.IntRange(1, 10_000), help="Runs of each; 10, and 3 for scaling."
)
@click.option(
    "--planner",
    "planners",
    multiple=True,
    shell_complete=names.planners,
    help="Only these planners.",
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
@click.option(
    "--timeout",
    type=Number(min=0, max=1e6, min_open=True),
    default=120.0,
    show_default=True,
    help="Seconds a run.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Results, one JSON object a line; bench-SUITE.jsonl.",
)
@interruptible
def command(
    suite: str,
    seeds: int | None,
    planners: tuple[str, ...],
    scenes: tuple[str, ...],
    tasks: Path | None,
    sketch: str | None,
    jobs: int | None,
    timeout: float,
    out: Path | None,
) -> None:
    """Run the benchmark SUITE in parallel processes, one core a run.

    `paper`: the eight scenes of the paper with both planners. `scaling`: generated sorting
    scenes with 10 to 200 objects. `ipc`: the PDDL tasks of a folder, each with its `domain.pddl`
    beside it; `--sketch siw` and `--sketch iw` know nothing of a domain.

    Exit 0: every run has a result. 1: some have none. 2: bad input.
    """
    import sys

    from domains.tabletop.scene.generate import sorting_scene
    from runtime.bench import store, tables
    from runtime.bench.runner import run_all
    from runtime.bench.suites import jobs_of
    from sketchlang.errors import InputError

    path = out or Path(f"bench-{suite}.jsonl")
    if (suite == "ipc") != (tasks is not None):
        fail("--tasks FOLDER names the tasks of the suite ipc, and belongs to no other")
    if suite != "ipc" and sketch is not None:
        fail("--sketch belongs to the suite ipc")
    picture = path.with_suffix(".svg") if suite == "scaling" else None
    try:
        if picture is not None:
            _refuse_other_pictures(path, picture)
        work = None
        if tasks is not None:
            from domains.pddl import bench as ipc

            work = ipc.run_job
            wanted = ipc.jobs_of(tasks, sketch, (planners or ("siw-r",))[0], timeout)
        else:
            wanted = jobs_of(suite, seeds, planners, scenes, timeout, path, sorting_scene)
        with store.opened(path, lambda: say(f"waiting: {path} is in use", err=True)) as results:
            todo = sum(job not in results.results for job in wanted)
            if todo < len(wanted):
                say(f"{len(wanted) - todo} of {len(wanted)} are in {path}", err=True)
            with click.progressbar(
                length=todo, label="runs", show_eta=True, file=sys.stderr
            ) as progress:
                processes = jobs or os.cpu_count() or 1
                lost = run_all(wanted, results, processes, lambda _: progress.update(1), work)
        chosen = [results.results[job] for job in wanted if job in results.results]
        _show(suite, chosen)
        if picture is not None:
            from runtime.bench.plot import scaling_plot
            from sketchlang.files import write_text

            write_text(picture, scaling_plot(chosen, [tables.size_of(r["scene"]) for r in chosen]))
            say("", f"plot: {picture}")
    except InputError as error:
        fail(error)
    for result in chosen:
        if not (result["solved"] and result.get("valid")):
            reason = result.get("reason") or "; ".join(result.get("findings", []))
            say(f"{result['scene']} {result['planner']} seed {result['seed']}: {reason}")
    for job, reason in lost:
        say(f"{job.scene} {job.planner} seed {job.seed}: no result, {reason}", err=True)
    raise SystemExit(1 if lost else 0)


def _show(suite: str, results: list[dict[str, Any]]) -> None:
    """Print the tables."""
    from runtime.bench import tables

    if suite == "ipc":
        from domains.pddl import bench as ipc

        say(*ipc.table(results))
        return
    first = tables.scaling_table if suite == "scaling" else tables.main_table
    parts = [first(results), tables.profile_table(results), tables.share_table(results)]
    for number, part in enumerate(part for part in [*parts, tables.ratio_lines(results)] if part):
        say(*([""] if number else []), *part)


def _refuse_other_pictures(path: Path, picture: Path) -> None:
    """The plot has a name that nobody gave: it replaces plots only."""
    from runtime.bench.plot import MARK
    from sketchlang.errors import InputError
    from sketchlang.files import check_output
    from sketchlang.reading import read_text

    if picture == path:
        raise InputError("--out: the plot ends in .svg, so the results must not")
    check_output(picture)
    with reading.recording():  # of its own: the picture is read to know it, and may be replaced
        if os.path.lexists(picture) and MARK not in read_text(picture):
            raise InputError("is here already and not a plot of this suite", place=str(picture))
