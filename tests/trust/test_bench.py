"""Benchmarks: nothing that was found is lost, nothing is found twice, nobody stays behind."""

from __future__ import annotations

import contextlib
import json
import os
import random
import select
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from runtime.bench import comparison, store, tables
from runtime.bench.job import Job, key, new_result
from runtime.bench.picture import MARK
from runtime.bench.plot import scaling_plot
from runtime.bench.pool import run_jobs
from runtime.bench.summary import summarise
from runtime.bench.survival import survival_plot
from runtime.bench.write.data import as_csv, as_json
from runtime.bench.write.latex import latex
from runtime.bench.write.markdown import markdown
from sketchlang.cli import cli
from sketchlang.errors import InputError
from tests.trust.bench_driver import job, uneven, values
from tests.trust.workspace import ROOT

LINES = [json.dumps({"job": {}} | new_result(job(n), values(job(n)))) + "\n" for n in range(4)]
STORE = "".join(LINES)


def driver(path: Path, count: int, work: str = "values") -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "tests.trust.bench_driver", str(path), str(count), work],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )


def seeds(path: Path) -> list[int]:
    """Of the results in a store, as its lines have them."""
    return [json.loads(line)["seed"] for line in path.read_text().splitlines()]


# -- the store -----------------------------------------------------------------------------------


def test_what_was_appended_is_read_again(tmp_path) -> None:
    path = tmp_path / "store"
    with store.opened(path) as results:
        for number in range(3):
            results.append(new_result(job(number), values(job(number))))
    assert [key(result) for result in store.read_results(path)] == list(map(job, range(3)))


@pytest.mark.parametrize("cut", [1, 20, 200, len(LINES[3]) - 2])
def test_a_line_that_was_cut_off_is_taken_away(cut, tmp_path) -> None:
    path = tmp_path / "store"
    for whole in (0, 3):
        path.write_text("".join(LINES[:whole]) + LINES[3][:cut])
        with store.opened(path) as results:
            assert list(results.results) == list(map(job, range(whole)))
            results.append(new_result(job(9), values(job(9))))
        assert seeds(path) == [*range(whole), 9]


def test_a_whole_line_without_its_end_is_a_result(tmp_path) -> None:
    path = tmp_path / "store"
    path.write_text(STORE[:-1])
    assert len(store.read_results(path)) == 4
    with store.opened(path) as results:
        results.append(new_result(job(9), values(job(9))))
    assert seeds(path) == [0, 1, 2, 3, 9]


@pytest.mark.parametrize(
    "text",
    ["notes", "my notes\n", '{"mine": 1}', "\xff", STORE + "notes", LINES[0] * 2, "[" * 99_999]
    + [STORE.replace(": 10,", f": {value},", 1) for value in ('"x"', "null", "NaN", "-1", "true")]
    + [STORE.replace('"seed": 0, "timeout"', '"seed": 9e999, "timeout"', 1), STORE[5:]],
    ids=range(14),
)
def test_what_is_no_store_stays_as_it_is(text, tmp_path) -> None:
    path = tmp_path / "notes.txt"
    path.write_text(text, encoding="latin-1")
    before = path.read_bytes()
    with pytest.raises(InputError), store.opened(path):
        pytest.fail("it was opened")
    done = CliRunner().invoke(cli, ["bench", "paper", "--out", str(path)])
    assert done.exit_code == 2, done.output
    assert path.read_bytes() == before


def test_stores_are_regular_files(tmp_path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    for path in (Path("/dev/full"), Path("/dev/null"), tmp_path / "pipe", tmp_path / "folder",
                 tmp_path / "no" / "such", tmp_path / ("x" * 300)):  # fmt: skip
        done = CliRunner().invoke(cli, ["bench", "paper", "--out", str(path)])
        assert done.exit_code == 2, done.output
        assert "a bug in" not in done.output


def test_a_full_disk_leaves_the_lines_that_were_there(tmp_path, monkeypatch) -> None:
    path = tmp_path / "store"
    path.write_text(STORE)
    write, calls = os.write, []

    def half(handle: int, data: bytes) -> int:
        calls.append(data)
        if len(calls) > 1:
            raise OSError(28, "No space left on device")
        return write(handle, data[: len(data) // 2])

    with store.opened(path) as results:
        monkeypatch.setattr(store.os, "write", half)
        with pytest.raises(InputError, match="No space left"):
            results.append(new_result(job(9), values(job(9))))
        monkeypatch.undo()
    assert path.read_text() == STORE


def test_damaged_stores_are_told_apart_from_good_ones() -> None:
    """Each of 1,000 mutations is refused with its line, or is a store that tables can show."""
    rng = random.Random(0)
    said: list[str] = []
    for _ in range(1000):
        data = mutated(STORE.encode(), rng)
        try:
            results, end = store.parsed(Path("store"), data)
        except InputError as error:
            said.append(str(error))
            continue
        assert 0 <= end <= len(data)
        found = list(results.values())
        for table in (t for kind in ("plain", "paper") for t in tables.tables_of(kind, found)):
            markdown(table)
            latex(table)
        scaling_plot(found, [10] * len(found))
        survival_plot(found)
        as_csv(summarise(found))
        as_json("store", summarise(found), [])
        comparison.chosen(found, {"planner": "siw-r"})
    assert 300 < len(said) < 1000
    assert all(text.startswith("store: line ") and "\n" not in text for text in said)


def mutated(data: bytes, rng: random.Random) -> bytes:
    """Bytes changed, cut, doubled, or a value replaced by another one."""
    for _ in range(rng.randint(1, 3)):
        place = rng.randrange(len(data) + 1)
        match rng.randrange(5):
            case 0:
                data = data[:place] + bytes([rng.randrange(256)]) + data[place + 1 :]
            case 1:
                data = data[:place]
            case 2:
                data = data[:place] + data[place : place + rng.randrange(900)] + data[place:]
            case 3:
                old = rng.choice([b"10", b"0.5", b"60.0", b"true", b"2", b'"siw-r"', b"200"])
                new = rng.choice([b"null", b"-1", b"1e999", b"NaN", b"[]", b'"x"', b"0", b"0.0"])
                data = data.replace(old, new, rng.randint(1, 3))
            case _:
                lines = data.split(b"\n")
                rng.shuffle(lines)
                data = b"\n".join(lines)
    return data


def test_zero_times_and_counts_make_tables() -> None:
    none = {"planning_time_s": 0.0, "objects_moved": 0, "expanded": 0, "execution_time_s": 0}
    found = [new_result(job(n), values(job(n)) | none) for n in range(2)]
    for result in found:
        result["job"]["scene"] = "sorting-10.toml"
    for kind in ("plain", "paper", "scaling"):
        assert all(markdown(table) for table in tables.tables_of(kind, found))
    assert MARK in scaling_plot(found, [10, 10])
    assert MARK in survival_plot(found)
    comparison.tables({"all": comparison.compared(list(zip(found, found, strict=True)))})


# -- names that nobody gave ----------------------------------------------------------------------


@pytest.fixture
def no_runs(monkeypatch) -> None:
    monkeypatch.setattr("runtime.bench.runner.run_jobs", lambda *_: [])


@pytest.mark.usefixtures("no_runs")
@pytest.mark.parametrize("mine", ["sorting-10.toml", "bench-scaling.svg"])
def test_files_beside_the_results_are_not_replaced(mine, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / mine).write_text("mine")
    done = CliRunner().invoke(cli, ["bench", "scaling"])
    assert done.exit_code == 2, done.output
    assert (tmp_path / mine).read_text() == "mine"
    (tmp_path / mine).unlink()
    assert CliRunner().invoke(cli, ["bench", "scaling"]).exit_code == 0
    assert CliRunner().invoke(cli, ["bench", "scaling"]).exit_code == 0  # its own are replaced


@pytest.mark.usefixtures("no_runs")
def test_the_plot_does_not_replace_the_results(tmp_path) -> None:
    path = tmp_path / "keep.svg"
    path.write_text(STORE)
    assert CliRunner().invoke(cli, ["bench", "scaling", "--out", str(path)]).exit_code == 2
    assert path.read_text() == STORE


# -- processes -----------------------------------------------------------------------------------


def test_one_run_that_fails_costs_no_other() -> None:
    found: dict[Job, object] = {}
    wanted = [job(number) for number in range(8)]
    limits = {job: 0.0 if job.seed % 4 == 3 else 60.0 for job in wanted}
    lost = run_jobs(wanted, 2, uneven, found.__setitem__, limits.__getitem__)
    assert sorted(job.seed for job in found) == [0, 4]
    reasons = {job.seed: reason for job, reason in lost}
    assert sorted(reasons) == [1, 2, 3, 5, 6, 7]
    assert reasons[1] == "ValueError: no\nsuch luck"
    assert reasons[2] == f"its process ended with status {-signal.SIGSEGV}"
    assert reasons[3] == "it did not stop in time"


@pytest.mark.parametrize("sign", [signal.SIGTERM, signal.SIGKILL, signal.SIGINT, signal.SIGHUP])
def test_workers_end_with_their_parent(sign, tmp_path) -> None:
    with driver(tmp_path / "store", 2, "endless") as process:
        assert process.stdout is not None
        pids = []
        while len(pids) < 2:
            word, _, number = process.stdout.readline().partition(" ")
            if word == "working":
                pids.append(int(number))
        handles = [os.pidfd_open(pid) for pid in pids]
        process.send_signal(sign)
        process.wait(timeout=60)
        for handle in handles:
            gone, _, _ = select.select([handle], [], [], 5.0)
            os.close(handle)
            assert gone, "a worker is still there 5 s after its parent"


MOST_GROWTH = 2500
"""Bytes by which a store grows before its benchmarks are killed, at most: some twenty results."""


def kill_and_go_on(path: Path, kills: int, runs: int) -> int:
    """Kill benchmarks of one store at random moments, two at a time, then let two finish.
    Returns how many were killed while they worked.

    A moment is when the store has grown by so much: however quick the machine is, there is work
    left for the next round."""
    rng = random.Random(kills)
    caught = 0
    for _ in range(kills):
        size = path.stat().st_size if path.exists() else 0
        enough = size + rng.randint(0, MOST_GROWTH)
        both = [driver(path, runs) for _ in range(2)]
        while all(process.poll() is None for process in both):
            with contextlib.suppress(subprocess.TimeoutExpired):
                both[0].wait(timeout=0.002)
            if path.exists() and path.stat().st_size > enough:
                caught += 1
                break
        for process in both:
            process.kill()
            process.communicate()
        if path.exists():
            store.parsed(path, path.read_bytes())
    both = [driver(path, runs) for _ in range(2)]
    for process in both:
        assert process.communicate(timeout=300)[0].endswith("done\n")
    return caught


def test_kills_and_company_lose_and_double_nothing(tmp_path) -> None:
    path = tmp_path / "store"
    kill_and_go_on(path, kills=1, runs=60)
    assert sorted(seeds(path)) == list(range(60))


@pytest.mark.slow
def test_a_hundred_kills_lose_and_double_nothing(tmp_path) -> None:
    path = tmp_path / "store"
    assert kill_and_go_on(path, kills=100, runs=2000) > 20
    assert sorted(seeds(path)) == list(range(2000))
