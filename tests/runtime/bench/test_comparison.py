"""`bench compare`: pairs by scene and seed, with exact tests."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from runtime.bench.comparison import chosen, compared
from runtime.bench.job import Versions
from sketchlang.cli import cli
from tests.runtime.bench.runs import job, result


def write(path: Path, found) -> str:
    path.write_text("".join(json.dumps({"job": r["job"]} | r) + "\n" for r in found))
    return str(path)


def call(*arguments: str) -> Result:
    return CliRunner().invoke(cli, ["bench", "compare", *arguments])


def test_what_pairs_tell() -> None:
    a = [1.0, 2.0, 3.0, None, 5.0, None, 7.0]
    b = [2.0, 4.0, 6.0, 8.0, None, None, 7.0]
    pairs = [(result(job(0), x), result(job(0), y)) for x, y in zip(a, b, strict=True)]
    found = compared(pairs)
    assert (found.pairs, found.both, found.only_a, found.only_b) == (7, 4, 1, 1)
    assert (found.median_a, found.median_b) == (2.5, 5.0)
    assert found.ratio == 2.0
    assert (found.a_quicker, found.b_quicker) == (3, 0)
    assert found.p_sign == pytest.approx(0.25)
    assert found.p_solved == 1.0


def test_pairs_that_none_solves_have_no_times() -> None:
    found = compared([(result(job(0), None), result(job(0), 1.0))])
    assert found.ratio is None
    assert found.only_b == 1


def test_of_a_repeated_run_the_last_counts() -> None:
    old, new = job(0, versions=Versions(tool="old")), job(0, versions=Versions(tool="new"))
    found = chosen([result(old, 1.0), result(job(1), 2.0), result(new, 3.0)], {})
    assert [r["planning_time_s"] for r in found] == [2.0, 3.0]


def test_two_stores_are_compared_scene_by_scene(tmp_path) -> None:
    scenes = ("sorting/3t-02", "sorting/4t-07")
    slow = [result(job(n, scene=s), 2.0 + n) for s in scenes for n in range(8)]
    quick = [result(job(n, scene=s), 1.0 + n / 2) for s in scenes for n in range(9)]
    a, b = write(tmp_path / "a.jsonl", slow), write(tmp_path / "b.jsonl", quick)
    done = call(a, b, "--format", "json")
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)["scenes"]
    assert list(found) == [*scenes, "all"]
    assert [found[s]["pairs"] for s in found] == [8, 8, 16]
    assert found["all"]["ratio"] == pytest.approx(0.5)
    assert found["sorting/3t-02"]["p_sign"] == pytest.approx(2 / 2**8)
    text = call(a, b)
    assert text.exit_code == 0
    assert all(
        len(line) <= 80 for line in text.stdout.splitlines() if not line.startswith(("A:", "B:"))
    )
    assert r"\begin{tabular}" in call(a, b, "--format", "latex").stdout


def test_planners_in_one_store_are_compared(tmp_path) -> None:
    found = [result(job(n, p), 1.0 + n) for p in ("siw-r", "bfws") for n in range(3)]
    path = write(tmp_path / "r.jsonl", found)
    done = call(f"{path}:planner=siw-r", f"{path}:planner=bfws", "--format", "json")
    assert json.loads(done.stdout)["scenes"]["sorting/3t-02"]["both"] == 3


@pytest.mark.parametrize(
    ("a", "b", "said"),
    [
        ("none.jsonl", "r.jsonl", "no such file"),
        ("r.jsonl:planer=x", "r.jsonl", "ou mean"),
        ("r.jsonl:planner", "r.jsonl", "cannot be chosen"),
        ("r.jsonl:planner=siw-r", "r.jsonl:scene=x", "no run of A"),
        ("two.jsonl", "r.jsonl", "several results of one run"),
    ],
)
def test_what_cannot_be_compared_is_said(a, b, said, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    write(Path("r.jsonl"), [result(job(0))])
    write(Path("two.jsonl"), [result(job(0)), result(replace(job(0), timeout=5.0))])
    done = call(a, b)
    assert done.exit_code == 2
    assert said in done.output.replace("\n  hint: ", " ")
    assert "Traceback" not in done.output
