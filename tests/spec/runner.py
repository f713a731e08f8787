"""Markdown files as tests of the language.

A heading names a test; the fenced blocks below it are its files and what is expected:

    ```sketch             a sketch (`main.sketch` without a name after the word)
    ```sketch FILE        another one, for `include`
    ```python FILE        a domain, given with --domain
    ```output             all that `sketchlang check` prints for the sketch before it
    ```format             the sketch before it, formatted
    ```map                a delivery scene, and then
    ```values FILE        the features of the sketch in its initial state, or in that of a PDDL task
    ```transitions        `RULE: H=0 n=2 -> H=1 n=1: yes`, whether a rule is satisfied

    ```scene              two tables (tables.toml) and what the block adds to them
    ```run SKETCH SCENE   why there is no plan: the reason, and what else is known. Without names,
                          the sketch and the scene before it

PDDL files and sketches that lie beside the Markdown files are at hand in every section.

Without an output block a sketch has exactly the findings that comments of the form
`# error: [code] "part of the message"` announce on their line, and none if there are no such
comments. `python -m tests.spec.runner FILE...` rewrites the blocks that do not say what
happens; read what it wrote before you believe it.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from unittest.mock import patch

from sketchlang.compile import compile_sketch
from sketchlang.domain import Domain, LoadOptions
from sketchlang.findings import findings
from sketchlang.loader import Loaded, domains_of_file, load_source, load_text
from sketchlang.render import console

ROOT = Path(__file__).resolve().parents[2]
_FENCE = re.compile(r"^```(\w+)(?: (\S+(?: \S+)?))?$")
_EXPECTED = re.compile(r'#\s*(error|warning): \[([\w-]+)\](?: "(.*)")?\s*$')


@dataclass
class Block:
    """A fenced block: its kind, name, text and the (0-based) line of its first line."""

    kind: str
    name: str
    text: str
    line: int


@dataclass
class Section:
    """A heading with the blocks below it."""

    title: str
    line: int
    prose: list[str] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)


def sections(path: Path) -> Iterator[Section]:
    """The sections of a Markdown file that have text or blocks below their heading."""
    section: Section | None = None
    lines = path.read_text(encoding="utf-8").splitlines()
    number = 0
    while number < len(lines):
        line = lines[number]
        fence = _FENCE.match(line)
        if line.startswith("#"):
            if section and (section.prose or section.blocks):
                yield section
            # A title may have an introduction without an example.
            title = line.startswith("# ")
            section = None if title else Section(line.lstrip("#").strip(" `"), number + 1)
        elif fence and section:
            end = lines.index("```", number)
            text = "\n".join(lines[number + 1 : end]) + "\n"
            section.blocks.append(Block(fence[1], fence[2] or "", text, number + 1))
            number = end
        elif line.strip() and section:
            section.prose.append(line)
        number += 1
    if section and (section.prose or section.blocks):
        yield section


class MismatchError(AssertionError):
    """A block that does not say what happens; `actual` would be right."""

    def __init__(self, block: Block, actual: str) -> None:
        super().__init__(f"line {block.line}: expected\n{block.text}\nbut got\n{actual}")
        self.block = block
        self.actual = actual


def run(section: Section, directory: Path) -> None:
    """Check every block of a section; `directory` is empty and the current one."""
    extra: dict[str, Domain] = {}
    loaded: Loaded | None = None
    scene = ""
    pending: Block | None = None
    for block in section.blocks:
        if block.kind == "sketch" and block.name:
            (directory / block.name).write_text(block.text, encoding="utf-8")
            continue
        if block.kind in ("scene", "run"):
            pending = None  # what `check` says of a broken sketch is not the point there
        if block.kind not in ("output", "format") and pending and loaded:
            check_comments(loaded, pending)
            pending = None
        match block.kind:
            case "sketch":
                (directory / "main.sketch").write_text(block.text, encoding="utf-8")
                loaded, pending = load_text(load_source("main.sketch"), extra), block
            case "python":
                (directory / block.name).write_text(block.text, encoding="utf-8")
                extra = domains_of_file(block.name)
            case "map":
                scene = block.text
            case "scene":
                (directory / "main.toml").write_text(_on_tables(block.text), encoding="utf-8")
            case _:
                _expect(block, _happens(block, loaded, scene))
                pending = None if block.kind in ("output", "format") else pending
    if pending and loaded:
        check_comments(loaded, pending)


def _happens(block: Block, loaded: Loaded | None, scene: str) -> str:
    """What a block should say that shows what happens."""
    if block.kind == "run":
        return why(*(block.name.split() or ["main.sketch", "main.toml"]))
    assert loaded, "such a block needs a sketch before it"
    match block.kind:
        case "output":
            return output(loaded)
        case "format":
            from sketchlang.syntax.formatter import format_source

            return format_source(loaded.source)
        case "values":
            return values(loaded, scene, block.name)
        case "transitions":
            return transitions(loaded, block.text)
        case kind:
            raise AssertionError(f"line {block.line}: there are no blocks of the kind {kind}")


def _on_tables(text: str) -> str:
    """A scene with two tables, and what a block adds to them."""
    tables = (Path(__file__).parent / "tables.toml").read_text(encoding="utf-8")
    first, _, rest = text.partition("\n")
    if not first.startswith("approaches"):
        first, rest = "", text  # that is a key of the whole scene
    return f"{first}\n{tables}{rest}"


def _expect(block: Block, actual: str) -> None:
    if block.text.rstrip() != actual.rstrip():
        raise MismatchError(block, actual)


def output(loaded: Loaded) -> str:
    """What `sketchlang check` prints, with paths of this checkout made relative to it."""
    found = findings(loaded)
    text = console.render(found, [loaded.source.name], colour=False)
    text = text.replace(f"{ROOT}/", "")
    return "\n".join(line.rstrip() for line in text.splitlines()) + "\n"


def check_comments(loaded: Loaded, block: Block) -> None:
    """Compare findings with the comments that announce them."""
    expected = []
    for number, line in enumerate(loaded.source.text.splitlines(), 1):
        for severity, code, text in _EXPECTED.findall(line):
            expected.append((number, severity, code, text))
    actual = []
    for found in findings(loaded):
        row = found.primary.source.position(found.primary.span.start)[0]
        actual.append((row, found.severity.value, found.code, found.message))
    fits = len(expected) == len(actual) and all(
        want[:3] == have[:3] and want[3] in have[3]
        for want, have in zip(sorted(expected), sorted(actual), strict=True)
    )
    if not fits:
        raise AssertionError(
            f"line {block.line}: announced {expected}\nbut found {actual}\n{output(loaded)}"
        )


def values(loaded: Loaded, scene: str, task: str = "") -> str:
    """The features of a sketch in the initial state of a delivery map or of a PDDL task; of a
    task, the plain and the quick evaluator have to agree."""
    from domains.delivery.scene import of_map

    sketch = compile_sketch(loaded.checked)
    domain = loaded.checked.domain
    if task:
        assert domain, "a sketch for a task uses its domain"
        assert domain.load, "a PDDL domain loads tasks"
        initial = domain.load(task, LoadOptions(task)).initial
        plain = compile_sketch(loaded.checked, plain=True)
        assert plain.evaluate(initial) == sketch.evaluate(initial)
    else:
        initial = of_map(scene).initial
    found = sketch.evaluate(initial)
    return "".join(
        f"{feature.name} = {value}\n"
        for feature, value in zip(sketch.model.features, found, strict=True)
    )


def why(sketch: str, scene: str) -> str:
    """What `sketchlang run` says of why there is no plan."""
    from runtime.search.limits import Limits
    from runtime.solve import open_task
    from sketchlang.loader import load_sketch

    task = open_task(load_sketch(sketch).checked, scene)
    warnings = [f"warning: {warning['text']}" for warning in task.warnings()]
    # What is said must not depend on how busy the machine is.
    with patch("runtime.solve.CURES", 60.0), patch("runtime.search.retrospect.PATIENCE", 60.0):
        outcome = task.solve(Limits()).outcome
    reason = "solved" if outcome.solved else f"not solved: {outcome.reason}"
    findings = [f"  {finding['text']}" for finding in outcome.why]
    more = [text for text in findings if text.strip() not in reason]
    return "\n".join([*warnings, reason, *more]) + "\n"


def transitions(loaded: Loaded, text: str) -> str:
    """The lines of a transitions block with the right answers."""
    model = loaded.checked.model
    rules = {rule.name: rule for rule in model.rules}
    names = [feature.name for feature in model.features]
    answers = []
    for line in text.splitlines():
        name, change, _ = (part.strip() for part in line.split(":"))
        before, after = (_vector(part, names) for part in change.split("->"))
        answer = "yes" if rules[name].satisfied_by(before, after) else "no"
        answers.append(f"{name}: {change}: {answer}\n")
    return "".join(answers)


def _vector(text: str, names: list[str]) -> tuple[int, ...]:
    given = dict(part.split("=") for part in text.split())
    assert list(given) == names, f"name all features, in order: {names}"
    return tuple(map(int, given.values()))


def run_in_empty_directory(section: Section) -> None:
    """Check a section where none of its files are in the way."""
    here = Path.cwd()
    with tempfile.TemporaryDirectory() as directory:
        for suffix in ("*.pddl", "*.sketch"):
            for file in Path(__file__).parent.glob(suffix):
                shutil.copy(file, directory)
        os.chdir(directory)
        try:
            run(section, Path(directory))
        finally:
            os.chdir(here)


def rewrite(path: Path) -> None:
    """Put what really happens into a file, from its end to its beginning: line numbers before
    a block that changes its length stay right."""
    for section in reversed(list(sections(path))):
        for _ in section.blocks:
            try:
                run_in_empty_directory(section)
            except MismatchError as mismatch:
                lines = path.read_text(encoding="utf-8").splitlines()
                start = mismatch.block.line
                lines[start : lines.index("```", start)] = mismatch.actual.rstrip().splitlines()
                path.write_text("\n".join(lines) + "\n", encoding="utf-8")
                section = next(s for s in sections(path) if s.line == section.line)
            except AssertionError as error:
                print(f"{path}: {section.title}: {error}")
                break


if __name__ == "__main__":
    for name in sys.argv[1:]:
        rewrite(Path(name))
