"""`sketchlang import dlplan|runir FILE`: a sketch from another tool's notation."""

from __future__ import annotations

import re
from pathlib import Path

import click

from sketchlang.cli.common import check_outputs, fail, interruptible, say


@click.command(
    epilog="""\b
Examples:
  sketchlang import dlplan policy.txt --domain domain.pddl --out policy.sketch
  sketchlang import runir policy.txt --domain domain.pddl
"""
)
@click.argument("notation", type=click.Choice(["dlplan", "runir"]))
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--domain", "domain_pddl", required=True, metavar="FILE", help="The PDDL domain.")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Write it here.")
@interruptible
def command(notation: str, file: Path, domain_pddl: str, out: Path | None) -> None:
    """Translate the policy or sketch in FILE.

    There, what a rule does not name may change; here it keeps its value: it becomes `?`.
    Exit 0: translated, and clean but for warnings. 1: translated, with errors in it. 2: not
    translated.
    """
    import os

    from domains.pddl.interchange import dlplan, runir
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
        reader = dlplan if notation == "dlplan" else runir
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
        say(f"{out}: {len(policy.rules)} rules, {len(loaded.checked.model.features)} features")
    raise SystemExit(0 if loaded.ok else 1)
