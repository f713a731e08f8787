"""The same results in one go, killed and resumed, and on a cluster that loses a worker."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from domains.tabletop.scene.generate import sorting_scene
from runtime.bench.job import Job, key
from runtime.bench.store import read_results
from sketchlang.loader import load_source

ROOT = Path(__file__).resolve().parents[3]
SUITE = """\
sketches = ["pick_and_place", "plain.sketch"]
scenes = ["sorting/3t-02", "four.toml"]
planners = ["lazy-siiw-r", "siw-r"]
seeds = 5
timeout = 60
"""
RUNS = 2 * 2 * 2 * 5
SAME = ("solved", "valid", "expanded", "generated", "subplans", "actions", "execution_time_s")
"""What does not depend on how quick a machine is."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    made = tmp_path_factory.mktemp("suite")
    (made / "my.toml").write_text(SUITE)
    (made / "four.toml").write_text(sorting_scene(4, 1))
    text = load_source("pick_and_place").text
    rules, _, _ = text.partition("# Not in the paper.")
    (made / "plain.sketch").write_text(rules)
    return made


def start(folder: Path, out: str, *more: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "sketchlang", "bench", "my.toml", "--out", out, *more]
    return subprocess.Popen(
        command, cwd=folder, env=environment(), text=True, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )  # fmt: skip


def environment() -> dict[str, str]:
    return os.environ | {"PYTHONPATH": str(ROOT)}


def finish(process: subprocess.Popen[str]) -> str:
    out, err = process.communicate(timeout=500)
    assert process.returncode == 0, err
    return out


def grown(path: Path, process: subprocess.Popen[str], lines: int) -> None:
    """Wait until a store has so many lines, or its benchmark has ended."""
    while process.poll() is None and (not path.exists() or path.read_bytes().count(b"\n") < lines):
        with suppress(subprocess.TimeoutExpired):
            process.wait(timeout=0.02)


def facts(path: Path) -> dict[Job, tuple[Any, ...]]:
    """What of the results is the same on every machine; each run is there once."""
    lines = path.read_text().splitlines()
    found = read_results(path)
    assert len(lines) == len(found) == RUNS
    return {key(result): tuple(result[name] for name in SAME) for result in found}


@pytest.fixture(scope="module")
def in_one_go(folder: Path) -> dict[Job, tuple[Any, ...]]:
    out = finish(start(folder, "one.jsonl", "--jobs", "2", "--format", "latex"))
    (folder / "table.tex").write_text(out)
    found = facts(folder / "one.jsonl")
    assert all(solved and valid for solved, valid, *_ in found.values())
    return found


@pytest.mark.slow
def test_a_suite_gives_a_table_and_a_plot(folder, in_one_go) -> None:
    text = (folder / "table.tex").read_text()
    assert text.count(r"\begin{tabular}") == text.count(r"\end{tabular}") == 3
    assert text.count("5/5") == 2 * 8  # solved and certified
    picture = ElementTree.parse(folder / "one.svg").getroot()
    texts = [element.text for element in picture.iter() if element.tag.endswith("text")]
    for planner in ("lazy-siiw-r", "siw-r"):
        for sketch in ("pick_and_place", "plain.sketch"):
            assert f"{planner} {sketch}: 10/10" in texts


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="no LaTeX")
def test_the_table_compiles(folder, in_one_go) -> None:
    document = r"\documentclass{article}\begin{document}\input{table}\end{document}"
    (folder / "document.tex").write_text(document)
    done = subprocess.run(
        ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "document.tex"],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-2000:]


@pytest.mark.slow
def test_killed_three_times_and_resumed(folder, in_one_go) -> None:
    store, rng = folder / "killed.jsonl", random.Random(3)
    for number in range(3):
        process = start(folder, store.name, "--jobs", "2")
        grown(store, process, 8 * number + rng.randint(1, 8))
        process.send_signal(signal.SIGKILL)
        process.communicate()
    assert 0 < store.read_bytes().count(b"\n") < RUNS
    finish(start(folder, store.name, "--jobs", "2"))
    assert facts(store) == in_one_go


@contextmanager
def cluster(folder: Path, workers: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A scheduler on this machine and so many workers, each a process of its own."""
    file = folder / "scheduler.json"
    dask = [sys.executable, "-m", "dask"]
    quiet: dict[str, Any] = {
        "cwd": folder, "env": environment(), "stderr": subprocess.DEVNULL,
        "stdout": subprocess.DEVNULL,
    }  # fmt: skip
    words = ["scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    started = [subprocess.Popen([*dask, *words, "--scheduler-file", str(file)], **quiet)]
    try:
        while not file.exists():
            assert started[0].poll() is None
            with suppress(subprocess.TimeoutExpired):
                started[0].wait(timeout=0.1)
        address = json.loads(file.read_text())["address"]
        words = ["worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard"]
        started += [subprocess.Popen([*dask, *words], **quiet) for _ in range(workers)]
        yield address, started[1:]
    finally:
        for process in started:
            process.kill()
        for process in started:
            process.wait()


@pytest.mark.slow
def test_on_three_workers_one_of_which_is_killed(folder, in_one_go) -> None:
    pytest.importorskip("distributed")
    store = folder / "cluster.jsonl"
    with cluster(folder, 3) as (address, workers):
        process = start(folder, store.name, "--scheduler", address)
        grown(store, process, 6)
        workers[0].send_signal(signal.SIGKILL)
        assert process.poll() is None, "it was killed too late"
        finish(process)
    assert facts(store) == in_one_go


def test_a_scheduler_that_does_not_answer_is_said(folder) -> None:
    pytest.importorskip("distributed")
    process = start(folder, "none.jsonl", "--scheduler", "nonsense")
    _, said = process.communicate(timeout=200)
    assert process.returncode == 2
    assert "error: --scheduler: nonsense does not answer" in said
    assert "Traceback" not in said
