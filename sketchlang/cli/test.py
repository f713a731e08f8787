"""`sketchlang test`: a sketch against the states of small scenes."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sketchlang.analysis.words import counted
from sketchlang.cli import names
from sketchlang.cli.common import Number, domain_option, fail, interruptible, load_valid, say

if TYPE_CHECKING:
    from runtime.reporting import Reporting
    from runtime.solve import Task
    from runtime.trial.findings import Finding, Trial
    from sketchlang.loader import Loaded

FORMAT = "sketchlang-test-finding"

SCENES = 4
"""Scenes of its own that a domain is tested with, the smallest ones."""


@click.command("test")
@click.argument("sketch", metavar="SKETCH", shell_complete=names.sketches)
@click.option(
    "--scenes",
    "scenes",
    metavar="SCENE",
    multiple=True,
    shell_complete=names.scenes,
    help="A scene, by name or path; may be given more than once [default: four small ones].",
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
@click.option(
    "--states",
    type=click.IntRange(1, 1_000_000),
    default=2000,
    show_default=True,
    help="States of each scene to look at.",
)
@click.option(
    "--subproblems",
    type=click.IntRange(1, 100_000),
    default=120,
    show_default=True,
    help="States of each scene whose width is measured.",
)
@click.option(
    "--k-max", type=click.IntRange(1, 3), default=2, show_default=True, help="Largest width tried."
)
@click.option(
    "--time-limit",
    type=Number(min=0, min_open=True),
    default=50.0,
    show_default=True,
    metavar="S",
    help="Stop after S seconds.",
)
@click.option(
    "--out",
    metavar="FOLDER",
    help="Write each finding to a file here, for --replay, and as a scene that starts there.",
)
@click.option("--replay", metavar="FILE", help="Go to the state of a finding, step by step.")
@click.option("--strict", is_flag=True, help="Exit 1 for warnings, too.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@domain_option
@interruptible
def command(
    *,
    sketch: str,
    scenes: tuple[str, ...],
    seed: int,
    states: int,
    subproblems: int,
    k_max: int,
    time_limit: float,
    out: str | None,
    replay: str | None,
    strict: bool,
    as_json: bool,
    domain_file: str | None,
) -> None:
    """Test a sketch against states of small scenes.

    Looks at all states of a scene where there are few, else at near ones and those of random
    walks. Errors are invariants that are false, features declared bounded that rise and rise,
    and dead ends: states from which no subgoal can be reached. Warnings are states that no rule
    provides for, rules that never fire, and subproblems that need a larger width than was tried.

    Exit 0 without errors, 1 with errors, 2 if a file cannot be read or has errors.

    \b
    Examples:
      sketchlang test blocks_towers
      sketchlang test my.sketch --scenes a.toml --scenes b.toml --out findings
      sketchlang test my.sketch --replay findings/1-invariant.json
    """
    from runtime.solve import open_task
    from runtime.trial.findings import Effort
    from sketchlang.compile import EvaluationError
    from sketchlang.domain import SceneError
    from sketchlang.errors import InputError
    from sketchlang.files import check_output

    loaded = load_valid(sketch, domain_file)
    try:
        if replay is not None:
            _replay(loaded, replay)
            return
        if out is not None:
            check_output(Path(out), folder=True, option="--out")
        names = scenes or _own_scenes(loaded)
        effort = Effort(states=states, subproblems=subproblems, k_max=k_max)
        tasks = [open_task(loaded.checked, scene, seed) for scene in names]
        trial = _examined(loaded, tasks, effort, time_limit, seed)
        written = [] if out is None else _write(Path(out), tasks, trial, seed)
    except (InputError, SceneError) as error:
        fail(error)
    except EvaluationError as error:
        fail(f"the sketch cannot be evaluated: {error}")
    if as_json:
        from sketchlang.escape import dumps

        click.echo(dumps(_as_json(trial), indent=2))
    else:
        _print(trial, k_max, written)
    bad = any(finding.is_error or strict for finding in trial.findings)
    sys.exit(1 if bad else 0)


def _own_scenes(loaded: Loaded) -> list[str]:
    """The smallest scenes that come with the sketch's domain."""
    from sketchlang.library import built_in_scenes, find_scene
    from sketchlang.loader import domain_of_scene

    domain = loaded.checked.domain
    if domain is None:
        fail("a sketch that uses no domain cannot be tested", "write `use DOMAIN`")
    names = [name for name in built_in_scenes() if domain_of_scene(name) == domain.name]
    names = sorted(names, key=lambda name: find_scene(name)[0].stat().st_size)[:SCENES]
    if not names:
        fail(f"the domain {domain.name} has no scenes of its own", "give --scenes FILE")
    return names


def _examined(
    loaded: Loaded, tasks: Sequence[Task], effort: Any, time_limit: float, seed: int
) -> Trial:
    from runtime.trial.findings import Examiner

    examiner = Examiner(loaded.checked, effort, seed)
    started = time.perf_counter()
    for number, task in enumerate(tasks):
        task.reporting.warm_up()
        left = time_limit - (time.perf_counter() - started)
        examiner.examine(
            task.scene,
            task.problem,
            max(left, 0.0) / (len(tasks) - number),
            task.reporting.describe,
        )
    return examiner.finish()


def _as_json(trial: Trial) -> dict[str, Any]:
    names = [feature.name for feature in trial.model.features]
    return {
        "sketch": trial.model.name,
        "scenes": [
            {
                "scene": scene,
                "states": count,
                "complete": trial.complete[scene],
                "width": trial.by_scene.get(scene, 0),
            }
            for scene, count in trial.states.items()
        ],
        "subproblems": trial.subproblems,
        "width": trial.width(),
        "widths": trial.widths,
        "out_of_time": trial.out_of_time,
        "findings": [_finding(finding, names) for finding in trial.findings],
    }


def _finding(finding: Finding, names: list[str]) -> dict[str, Any]:
    values = finding.values
    return {
        "kind": finding.kind,
        "error": finding.is_error,
        "text": finding.text,
        "scene": finding.scene,
        "actions": list(finding.actions),
        "state": finding.state,
        "values": None if values is None else dict(zip(names, values, strict=True)),
        "samples": list(finding.samples),
    }


def _print(trial: Trial, k_max: int, written: list[str]) -> None:
    name = trial.model.name
    for finding in trial.findings:
        say(f"{'error' if finding.is_error else 'warning'}[{finding.kind}]: {finding.text}")
        if finding.scene is not None:
            after = len(finding.actions)
            when = f"after {counted(after, 'action')}" if after else "at the start"
            done = f" (`{finding.done}`)" if finding.done else ""
            say(f"  {finding.scene}, {when}{done}")
            values = zip(trial.model.features, finding.values or (), strict=True)
            say("  " + ", ".join(f"{feature.name} = {value}" for feature, value in values))
        say("")
    for scene, count in trial.states.items():
        width = _width(trial.by_scene.get(scene, 0), k_max)
        every = "all " if trial.complete[scene] and count > 1 else ""
        say(f"{scene}: {every}{counted(count, 'state')}, width {width}")
    say(f"{counted(trial.subproblems, 'subproblem')}, width {_width(trial.width(), k_max)}:")
    for rule in (*(rule.name for rule in trial.model.rules), "goal"):
        if rule in trial.widths:
            say(f"  {rule}: {_width(trial.widths[rule], k_max)}")
    if trial.out_of_time:
        say("The time was over before all was looked at.")
    for line in written:
        say(line)
    errors = sum(finding.is_error for finding in trial.findings)
    warnings = counted(len(trial.findings) - errors, "warning")
    say(f"{name}: {counted(errors, 'error')}, {warnings}")


def _width(width: int | None, k_max: int) -> str:
    return f"more than {k_max}" if width is None else str(width)


def _write(folder: Path, tasks: Sequence[Task], trial: Trial, seed: int) -> list[str]:
    """A file for each finding that a state shows, and scenes that start in these states; what was
    written, and why what was not."""
    from sketchlang.errors import InputError
    from sketchlang.escape import dumps
    from sketchlang.files import write_text

    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"{error.strerror or error}", place=str(folder)) from error
    names = [feature.name for feature in trial.model.features]
    reports = {task.scene: task.reporting for task in tasks}
    said: list[str] = []
    for number, finding in enumerate((f for f in trial.findings if f.scene), start=1):
        path = folder / f"{number}-{finding.kind}.json"
        content = {"format": FORMAT, "version": 1, "sketch": trial.model.name, "seed": seed}
        write_text(path, dumps(content | _finding(finding, names), indent=2) + "\n")
        said.append(f"written: {path}")
        said += _write_scene(path, reports[str(finding.scene)], finding)
    return said


def _write_scene(path: Path, reporting: Reporting, finding: Finding) -> list[str]:
    """Beside a finding's file, a scene that starts in its state, or in the last one on the way to
    it that scenes have words for."""
    from runtime.reporting import Restartable, UnsayableError
    from sketchlang.files import write_text

    if not isinstance(reporting, Restartable):
        return []
    why = ""
    for before, state in enumerate(reversed(finding.states)):
        try:
            scenes = reporting.scene_files(state)
        except UnsayableError as error:
            why = why or str(error)
            continue
        said = []
        for ending, text in scenes.items():
            beside = path.with_name(path.stem + ending)
            write_text(beside, text)
            said.append(f"written: {beside}")
        if why:
            said.append(f"  It starts {counted(before, 'action')} earlier: {why}.")
        return said
    return [f"  No scene starts there: {why}."]


def _replay(loaded: Loaded, file: str) -> None:
    """Says what every action of a finding does, by the features' values."""
    from runtime.solve import open_task
    from runtime.trial.findings import without_invariants
    from runtime.trial.replay import read, replayed

    found = read(file, FORMAT)
    task: Task = open_task(loaded.checked, found.scene, found.seed)
    sketch = without_invariants(loaded.checked)
    names = [feature.name for feature in sketch.model.features]
    say(f"{found.scene}: {found.text}", "")
    for action, values in replayed(sketch, task.problem, found):
        shown = ", ".join(f"{name} = {value}" for name, value in zip(names, values, strict=True))
        say(f"  {action:<24} {shown}")
