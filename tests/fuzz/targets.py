"""What is fuzzed: for every format that we read, good files and what reads them."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from sketchlang.errors import InputError
from tests.fuzz.mutate import mutated
from tests.trust.hostile import harm

ROOT = Path(__file__).parents[2]
CORPUS = Path(__file__).parent / "corpus"
DOMAINS = ROOT / "domains"
SPEC = ROOT / "tests" / "spec"
SUITES = ROOT / "runtime" / "bench"
ROBOT = ROOT / "runtime" / "robot" / "tiago"


@dataclass(frozen=True)
class Target:
    """A format: the ending of its files, good files, and a reader.

    The reader takes a path and an empty folder around it. It returns or raises one of `refused`;
    anything else that it raises is a finding, and so is a message that is not fit to be shown.
    """

    suffix: str
    good: Callable[[], Sequence[bytes]]
    read: Callable[[Path], object]
    refused: tuple[type[Exception], ...] = (InputError,)

    def seeds(self, name: str) -> list[bytes]:
        """Good files, and those that once were a finding."""
        return [*self.good(), *(path.read_bytes() for path in sorted(CORPUS.glob(f"{name}-*")))]

    def finding(self, path: Path) -> str | None:
        """Read a file; what is wrong with how that ends, None if nothing is."""
        try:
            self.read(path)
        except self.refused as error:
            bad = harm(str(error))
            return None if bad is None else f"its message: {bad}"
        except Exception as error:
            return f"{type(error).__name__}: {error}"
        return None


def files(pattern: str, root: Path = DOMAINS) -> Callable[[], list[bytes]]:
    """The bytes of files by a pattern."""
    return lambda: [path.read_bytes() for path in sorted(root.glob(pattern))]


@cache
def plan() -> bytes:
    """A plan, made once."""
    from runtime.search.limits import Limits
    from runtime.solve import open_task
    from sketchlang.loader import load_sketch

    task = open_task(load_sketch("pick_and_place").checked, "sorting/3t-02")
    result = task.solve(Limits(timeout=60.0))
    assert result.solved
    return _saved(result.plan.save)


@cache
def trace() -> bytes:
    """The trace of that plan."""
    import tempfile

    from domains.tabletop.scene.worlds import find_world
    from runtime.trace.load import load_trace
    from runtime.trace.write import write_trace

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "plan.json"
        path.write_bytes(plan())
        made = load_trace(path, find_world)
    return _saved(lambda path: write_trace(made, path))


def _saved(write: Callable[[Path], object]) -> bytes:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder) / "file.json")
        return (Path(folder) / "file.json").read_bytes()


def _model() -> Any:
    from sketchlang.loader import load_sketch

    return load_sketch("pick_and_place").checked.model


@cache
def certificate() -> bytes:
    """A proof that a sketch terminates."""
    from sketchlang.analysis.certificate import as_text, certificate_of
    from sketchlang.analysis.termination import Terminating, decide_termination

    verdict = decide_termination(_model())
    assert isinstance(verdict, Terminating)
    return as_text(certificate_of(_model(), verdict)).encode()


def results() -> bytes:
    """A store of benchmark results."""
    from runtime.bench.job import new_result
    from tests.trust.bench_driver import job, values

    return "".join(json.dumps(new_result(job(n), values(job(n)))) + "\n" for n in range(3)).encode()


# -- readers -------------------------------------------------------------------------------------


def read_sketch(path: Path) -> None:
    """All that `check` and `fmt` do, and a proof."""
    from sketchlang.analysis.limits import Budget
    from sketchlang.analysis.termination import decide_termination
    from sketchlang.loader import load_source, load_text
    from sketchlang.render import as_json, concise, full, github, sarif
    from sketchlang.syntax.formatter import format_tree
    from sketchlang.syntax.parser import parse

    source = load_source(str(path))
    loaded = load_text(source)
    found = list(loaded.diagnostics)
    texts = [concise.render(found), *map(full.render, found)]
    for render in (as_json.render, sarif.render, github.render):
        render(found)
    bad = harm("\n".join(texts), own=("::: ",))
    assert bad is None, bad
    parsed, mistakes = parse(source)
    if not mistakes:
        format_tree(parsed)
    if loaded.ok:
        decide_termination(loaded.checked.model, Budget(1.0))


def read_scene(path: Path) -> None:
    from domains.tabletop.scene.load import load_scene

    load_scene(path)


def read_robot(path: Path) -> None:
    from runtime.robot.load import load_robot

    (path.parent / "tiago.urdf").write_bytes((ROBOT / "tiago.urdf").read_bytes())
    load_robot(path)


def read_urdf(path: Path) -> None:
    from runtime.robot.load import load_robot

    text = (ROBOT / "tiago.toml").read_text(encoding="utf-8")
    robot = path.parent / "robot.toml"
    robot.write_text(text.replace("tiago.urdf", path.name), encoding="utf-8")
    load_robot(robot)


def read_plan(path: Path) -> None:
    from runtime.plan.read import read_plan as read

    read(path)


def read_trace(path: Path) -> None:
    from runtime.show.page import page
    from runtime.trace.read import read_trace as read

    page(read(path))


def read_proof(path: Path) -> None:
    from sketchlang.analysis.verify import RefusedError, read_certificate, verify
    from sketchlang.reading import read_bytes

    try:
        verify(read_certificate(read_bytes(path)), _model())
    except RefusedError as error:
        raise InputError(str(error)) from None


def read_store(path: Path) -> None:
    from runtime.bench import store, tables
    from runtime.bench.write.markdown import markdown

    with store.opened(path) as opened:
        found = list(opened.results.values())
    for table in tables.tables_of("paper", found):
        markdown(table)


def read_suite(path: Path) -> None:
    from runtime.bench.suite_file import read_suite

    read_suite(path, doubting=False)


def read_blocks(path: Path) -> None:
    from domains.blocks.scene import read

    read(path)


def read_delivery(path: Path) -> None:
    from domains.delivery.scene import read

    read(path)


def read_domain(path: Path) -> None:
    from domains.pddl.syntax.read import load
    from domains.pddl.syntax.read import read_domain as read

    read(load(path))


def read_task(path: Path) -> None:
    from domains.pddl.syntax.read import load
    from domains.pddl.syntax.read import read_domain as read
    from domains.pddl.syntax.read import read_task as read_its_task

    read_its_task(load(path), read(load(SPEC / "yard.pddl")))


def _scene_errors() -> tuple[type[Exception], ...]:
    from sketchlang.domain import SceneError

    return (InputError, SceneError)


TARGETS = {
    "sketch": Target(".sketch", files("**/*.sketch"), read_sketch),
    "scene": Target(".toml", files("sorting/scenes/[13]t-*.toml"), read_scene),
    "words": Target(".toml", files("words/scenes/*.toml"), read_scene),
    "blocks": Target(".toml", files("blocks/scenes/*.toml"), read_blocks, _scene_errors()),
    "delivery": Target(".toml", files("delivery/scenes/*.toml"), read_delivery, _scene_errors()),
    "robot": Target(".toml", files("tiago.toml", ROBOT), read_robot),
    "urdf": Target(".urdf", files("tiago.urdf", ROBOT), read_urdf),
    "plan": Target(".json", lambda: [plan()], read_plan),
    "trace": Target(".json", lambda: [trace()], read_trace),
    "certificate": Target(".json", lambda: [certificate()], read_proof),
    "domain": Target(".pddl", files("yard.pddl", SPEC), read_domain),
    "task": Target(".pddl", files("task.pddl", SPEC), read_task),
    "suite": Target(".toml", files("*.toml", SUITES), read_suite),
    "store": Target(".jsonl", lambda: [results()], read_store),
}


def case(name: str, seed: str) -> bytes:
    """The damaged file of a seed: the same one whenever it is asked for."""
    import random

    rng = random.Random(f"{name} {seed}")
    seeds = TARGETS[name].seeds(name)
    return mutated(rng.choice(seeds), rng, seeds)
