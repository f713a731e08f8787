"""`sketchlang bench SUITE`: run scenes x planners x seeds and print the tables."""

from __future__ import annotations

from pathlib import Path

import click

from sketchlang.cli.common import fail, interruptible


@click.command(
    epilog="""\b
Examples:
  sketchlang bench paper --seeds 10
  sketchlang bench paper --planner siw-r --scene sorting/4t-07 --seeds 3
  sketchlang bench scaling --jobs 1
Run the same command again after an interruption: finished runs are not repeated.
"""
)
@click.argument("suite", type=click.Choice(["paper", "scaling"]))
@click.option("--seeds", type=click.IntRange(min=1), help="Runs of each; 10, and 3 for scaling.")
@click.option("--planner", "planners", multiple=True, help="Only these planners.")
@click.option("--scene", "scenes", multiple=True, help="Only these scenes.")
@click.option("--jobs", type=click.IntRange(min=1), help="Processes; as many as there are cores.")
@click.option("--timeout", type=float, default=120.0, show_default=True, help="Seconds a run.")
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
    jobs: int | None,
    timeout: float,
    out: Path | None,
) -> None:
    """Run the benchmark SUITE in parallel processes, one core a run.

    `paper`: the eight scenes of the paper with both planners. `scaling`: generated sorting
    scenes with 10 to 200 objects.
    """
    import os
    import sys

    from domains.tabletop.scene.generate import sorting_scene
    from runtime.bench import runner, tables
    from runtime.bench.suites import jobs_of
    from sketchlang.errors import InputError

    path = out or Path(f"bench-{suite}.jsonl")
    try:
        wanted = jobs_of(suite, seeds, planners, scenes, timeout, path, sorting_scene)
        stored = {runner.key(result) for result in runner.read_results(path)}
        todo = sum(job not in stored for job in wanted)
        if todo < len(wanted):
            click.echo(f"{len(wanted) - todo} of {len(wanted)} are in {path}", err=True)
        with click.progressbar(
            length=todo, label="runs", show_eta=True, file=sys.stderr
        ) as progress:
            runner.run_all(
                wanted, path, jobs or os.cpu_count() or 1, done=lambda _: progress.update(1)
            )
        results = {runner.key(result): result for result in runner.read_results(path)}
    except InputError as error:
        fail(error)
    chosen = [results[job] for job in wanted]
    parts = [tables.scaling_table(chosen)] if suite == "scaling" else [tables.main_table(chosen)]
    parts += [tables.profile_table(chosen), tables.share_table(chosen), tables.ratio_lines(chosen)]
    click.echo("\n\n".join("\n".join(part) for part in parts if part))
    if suite == "scaling":
        from runtime.bench.plot import scaling_plot
        from sketchlang.files import write_text

        picture = path.with_suffix(".svg")
        write_text(picture, scaling_plot(chosen, [tables.size_of(r["scene"]) for r in chosen]))
        click.echo(f"\nplot: {picture}")
    failed = [result for result in chosen if not (result["solved"] and result.get("valid"))]
    for result in failed:
        reason = result.get("reason") or "; ".join(result.get("findings", []))
        click.echo(f"{result['scene']} {result['planner']} seed {result['seed']}: {reason}")
