"""Benchmarks: results are kept line by line, nothing is lost and nothing repeated."""

from __future__ import annotations

import json
import re
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner

from runtime.bench import store
from runtime.bench.job import Job, as_data, key
from runtime.bench.plot import scaling_plot
from runtime.bench.runner import run_all
from runtime.bench.suite_file import built_in_suite
from sketchlang.cli import cli
from sketchlang.errors import InputError


def line(job: Job, seconds: float = 1.0) -> str:
    result = {
        "job": as_data(job), "scene": job.scene, "planner": job.planner, "seed": job.seed,
        "solved": True, "valid": True, "planning_time_s": seconds, "execution_time_s": 60.0,
        "expanded": 10, "subplans": 4, "objects_moved": 2, "peak_mb": 200,
        "profile": {"motion_plan": {"calls": 4, "successes": 2, "time_s": 0.01}},
    }  # fmt: skip
    return json.dumps(result) + "\n"


def job(seed: int, planner: str = "siw-r") -> Job:
    return Job("pick_and_place", "sorting/3t-02", planner, seed, 60.0)


def test_a_line_that_was_cut_off_is_no_result(tmp_path) -> None:
    path = tmp_path / "results.jsonl"
    path.write_text(line(job(0)) + line(job(1))[:-20])
    assert [key(result) for result in store.read_results(path)] == [job(0)]


def test_a_store_cut_off_anywhere_goes_on_with_what_is_whole(tmp_path) -> None:
    """A line that lacks nothing but its end is whole, and what is added begins a line."""
    path, whole = tmp_path / "results.jsonl", (line(job(0)) + line(job(1))).encode()
    ends = [i for i, byte in enumerate(whole) if byte == ord("\n")]
    near_ends = {end + by for end in (0, *ends) for by in range(-2, 3)}
    for length in sorted({*range(0, len(whole), 41), *near_ends} & {*range(len(whole) + 1)}):
        path.write_bytes(whole[:length])
        kept = [job(number) for number, end in enumerate(ends) if end <= length]
        with store.opened(path) as results:
            assert list(results.results) == kept
            results.append(json.loads(line(job(2))))
        assert [key(result) for result in store.read_results(path)] == [*kept, job(2)]


def test_a_damaged_line_in_the_middle_is_named(tmp_path) -> None:
    path = tmp_path / "results.jsonl"
    path.write_text(line(job(0))[:-20] + "\n" + line(job(1)))
    with pytest.raises(InputError, match="line 1"):
        store.read_results(path)


def test_nothing_is_run_when_all_is_there(tmp_path) -> None:
    path = tmp_path / "results.jsonl"
    text = line(job(0)) + line(job(1))
    path.write_text(text)
    with store.opened(path) as results:
        run_all([job(0), job(1)], results, 1, done=lambda _: pytest.fail("ran again"))
    assert path.read_text() == text


def test_the_scaling_plot_is_a_picture_with_every_size() -> None:
    results = [json.loads(line(job(seed), seed + 1.0)) for seed in range(3)]
    picture = ElementTree.fromstring(scaling_plot(results, [10, 28, 200]))
    texts = [element.text for element in picture.iter() if element.tag.endswith("text")]
    assert {"10", "28", "200"} <= set(texts)
    assert sum(element.tag.endswith("circle") for element in picture.iter()) == 6


def test_the_paper_suite_is_scenes_by_planners_by_seeds() -> None:
    suite = built_in_suite("paper")
    jobs = suite.jobs()
    assert len(set(jobs)) == len(jobs) == 8 * 2 * 10
    few = suite.narrowed(["bfws"], ["sorting/3t-02"], seeds=3, timeout=5.0).jobs()
    assert {(j.planner, j.scene, j.timeout) for j in few} == {("bfws", "sorting/3t-02", 5.0)}
    assert [job.seed for job in few] == [0, 1, 2]
    with pytest.raises(InputError, match="no scene"):
        suite.narrowed(scenes=["sorting/none"])


@pytest.mark.slow
def test_an_interrupted_benchmark_goes_on_where_it_was(tmp_path) -> None:
    out = tmp_path / "results.jsonl"
    arguments = ["bench", "paper", "--scene", "sorting/3t-02", "--planner", "siw-r"]
    arguments += ["--jobs", "1", "--out", str(out), "--seeds"]
    assert CliRunner().invoke(cli, [*arguments, "1"]).exit_code == 0
    first = out.read_text()
    out.write_text(first + '{"job": {"sk')
    done = CliRunner().invoke(cli, [*arguments, "2"])
    assert done.exit_code == 0
    assert out.read_text().startswith(first)
    results = store.read_results(out)
    assert [result["seed"] for result in results] == [0, 1]
    assert all(result["solved"] and result["valid"] for result in results)
    assert re.search(r"\| sorting/3t-02 +\| siw-r +\| +2/2 \|.*\| +2/2 \|", done.stdout)
