"""`sketchlang import`: sketches and scenes from the formats of others."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import click

from sketchlang.analysis.words import counted
from sketchlang.cli import names
from sketchlang.cli.common import FILE, check_outputs, fail, interruptible, say

READ = click.Path(path_type=Path)
WRITTEN = FILE


def _of_a_policy(command: Callable[..., None]) -> Callable[..., None]:
    """The argument and the options of commands that translate a policy."""
    command = click.option("--out", type=WRITTEN, help="Write it here.")(command)
    command = click.option(
        "--domain", "domain_pddl", required=True, metavar="FILE", help="The PDDL domain."
    )(command)
    return click.argument("file", type=READ)(command)


@click.group(
    epilog="""\b
Examples:
  sketchlang import dlplan policy.txt --domain domain.pddl --out policy.sketch
  sketchlang import tmp nonmono.xml nonmono_pb.pddl --out nonmono.toml
"""
)
def command() -> None:
    """Translate policies of other tools and scenes of benchmarks."""


@command.command(
    epilog="""\b
Example:
  sketchlang import dlplan policy.txt --domain domain.pddl --out policy.sketch
"""
)
@_of_a_policy
@interruptible
def dlplan(file: Path, domain_pddl: str, out: Path | None) -> None:
    """Translate the policy or sketch of dlplan in FILE.

    There, what a rule does not name may change; here it keeps its value: it becomes `?`.
    Exit 0: translated, and clean but for warnings. 1: translated, with errors in it. 2: not
    translated.
    """
    from domains.pddl.interchange import dlplan as reader

    _translate(reader, file, domain_pddl, out)


@command.command(
    epilog="""\b
Example:
  sketchlang import runir policy.txt --domain domain.pddl --out policy.sketch
"""
)
@_of_a_policy
@interruptible
def runir(file: Path, domain_pddl: str, out: Path | None) -> None:
    """Translate the policy or sketch of runir in FILE.

    Features and exit status as with dlplan.
    """
    from domains.pddl.interchange import runir as reader

    _translate(reader, file, domain_pddl, out)


@command.command(
    epilog="""\b
Examples:
  sketchlang import tmp nonmono.xml nonmono_pb.pddl --out nonmono.toml
  sketchlang import tmp clutter.xml clutter_pb7.pddl --separate-overlaps --out clutter.toml
"""
)
@click.argument("xml", type=READ)
@click.argument("pddl", type=READ)
@click.option("--out", type=WRITTEN, required=True, metavar="SCENE.toml", help="The scene file.")
@click.option(
    "--robot",
    metavar="NAME|FILE",
    shell_complete=names.robots,
    help="Tried with the scene: what it cannot do is said.",
)
@click.option(
    "--separate-overlaps",
    is_flag=True,
    help="Move objects apart that start in one another, and say which.",
)
@click.option(
    "--any-grasp",
    is_flag=True,
    help="Objects may be held from all sides, not only as XML lists for their PR2.",
)
@interruptible
def tmp(
    xml: Path, pddl: Path, out: Path, robot: str | None, separate_overlaps: bool, any_grasp: bool
) -> None:
    """Write a problem of the public benchmark for task and motion planning as a scene.

    XML has its things, with their meshes in the folder `meshes` beside it, PDDL its goal
    (Lagriffoul et al. 2018). What a scene cannot say is named.

    Exit 0: written. 2: not written.
    """
    from domains.tabletop.tmp_benchmark.problem import read_problem
    from domains.tabletop.tmp_benchmark.start import with_free_start
    from domains.tabletop.tmp_benchmark.wanted import read_wanted_file
    from sketchlang.errors import InputError
    from sketchlang.files import replacing

    check_outputs((xml, pddl), {"--out": out})
    try:
        problem = read_problem(xml)
        wanted, notes = read_wanted_file(pddl, problem.things)
        with replacing(out) as written:
            text, more = with_free_start(
                problem, wanted, written, robot, separate=separate_overlaps, any_grasp=any_grasp
            )
            written.write_text(text, encoding="utf-8")
    except InputError as error:
        fail(error)
    objects = sum(1 for _ in problem.movable())
    say(f"{out}: {counted(objects, 'object')}, {counted(len(wanted.goals), 'goal')}")
    say(*(f"note: {note}" for note in (*notes, *more)))
    with_robot = "" if robot is None else f" --robot {robot}"
    sketch = "towers" if wanted.only_on else "pick_and_place"
    say(f"plan it: sketchlang run {sketch} {out}{with_robot}")


def _translate(reader: ModuleType, file: Path, domain_pddl: str, out: Path | None) -> None:
    import os

    from domains.pddl.interchange.translate import Translator
    from domains.pddl.interface import interface_of
    from sketchlang.errors import InputError
    from sketchlang.files import write_text
    from sketchlang.loader import load_text
    from sketchlang.reading import read_text
    from sketchlang.render import console
    from sketchlang.source import Source
    from sketchlang.syntax.formatter import format_source

    check_outputs((file, domain_pddl), {"--out": out})
    folder = out.parent if out is not None else Path()
    try:
        domain = interface_of(domain_pddl)
        policy = reader.read(read_text(file, 1 << 20), str(file))
        title = re.sub(r"\W", "_", file.stem)
        title = title if title[:1].isalpha() else f"s{title}"
        used = os.path.relpath(domain_pddl, folder)
        text = Translator(domain, used, str(file)).sketch(policy, title)
        source = Source(str(out or "<sketch>"), text)
        source = Source(source.name, format_source(source))
    except InputError as error:
        fail(error)
    loaded = load_text(source, {}, domain)
    if loaded.diagnostics:
        found = console.render(list(loaded.diagnostics), [source.name], colour=False)
        say(*found.rstrip().splitlines(), err=True)
    if out is None:
        say(*source.text.rstrip().splitlines())
    else:
        write_text(out, source.text)
        features = counted(len(loaded.checked.model.features), "feature")
        say(f"{out}: {counted(len(policy.rules), 'rule')}, {features}")
    raise SystemExit(0 if loaded.ok else 1)
