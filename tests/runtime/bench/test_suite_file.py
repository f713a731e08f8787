"""Suites of one's own: all mistakes are told with table, key and line; runs have a key."""

from __future__ import annotations

from pathlib import Path

import pytest

from runtime.bench.job import as_data, job_of
from runtime.bench.suite import Suite
from runtime.bench.suite_file import BUILT_IN, built_in_suite, natural, read_suite
from sketchlang.errors import InputError
from sketchlang.loader import load_source

SMALL = 'sketches = "pick_and_place"\nscenes = ["sorting/3t-02"]\n'


def suite(folder: Path, text: str) -> Suite:
    path = folder / "my.toml"
    path.write_text(text)
    return read_suite(path)


def mistakes(folder: Path, text: str) -> list[str]:
    """What is told, without the folder and hints."""
    with pytest.raises(InputError) as caught:
        suite(folder, text)
    lines = str(caught.value).splitlines()
    return [line.replace(f"{folder}/", "") for line in lines if not line.startswith("  hint")]


def test_a_suite_is_the_product_of_what_it_lists(tmp_path) -> None:
    (tmp_path / "mine.sketch").write_text(load_source("pick_and_place").text)
    found = suite(
        tmp_path,
        'sketches = ["pick_and_place", "mine.sketch"]\n'
        'scenes = ["sorting/3t-02", "sorting/4t-07"]\n'
        'planners = ["siw-r", "bfws"]\nseeds = "3-5"\nrobots = ["tiago"]\n',
    )
    jobs = found.jobs()
    assert len(set(jobs)) == 2 * 2 * 2 * 3
    assert {job.seed for job in jobs} == {3, 4, 5}
    assert {job.located(job.sketch) for job in jobs} == {
        "pick_and_place",
        str(tmp_path / "mine.sketch"),
    }


def test_what_stands_above_counts_for_every_block(tmp_path) -> None:
    found = suite(
        tmp_path,
        'sketches = "pick_and_place"\nseeds = [7]\ntimeout = 5\n'
        '[[block]]\nscenes = ["sorting/3t-02"]\n'
        '[[block]]\nscenes = ["sorting/4t-07"]\nplanners = ["brfs"]\nseeds = 2\n',
    )
    assert [(j.scene, j.planner, j.seed, j.timeout) for j in found.jobs()] == [
        ("sorting/3t-02", "lazy-siiw-r", 7, 5.0),
        ("sorting/4t-07", "brfs", 0, 5.0),
        ("sorting/4t-07", "brfs", 1, 5.0),
    ]


def test_patterns_are_scenes_in_natural_order(tmp_path) -> None:
    from domains.tabletop.scene.generate import sorting_scene

    for name in ("s10", "s2"):
        (tmp_path / f"{name}.toml").write_text(sorting_scene(2, 0))
    found = suite(tmp_path, 'sketches = "pick_and_place"\nscenes = ["s*.toml"]\nseeds = 1\n')
    assert [job.scene for job in found.jobs()] == ["s2.toml", "s10.toml"]
    assert sorted(["b", "a10", "a9", "10"], key=natural) == ["10", "a9", "a10", "b"]


MISTAKEN = """\
sketches = ["pick_and_plaice", "gone.sketch"]
planners = ["siwr", "siw-r", "siw-r"]
seedz = 3
k_max = 2.5

[[block]]
scenes = ["sorting/3t-2", "no*.toml"]
robots = "tiaga"
timeout = -1
[[block]]
seeds = [1, true]
timeout = 1e9
domain = "none.py"
"""


def test_all_mistakes_are_told_in_one_run_with_table_key_and_line(tmp_path) -> None:
    there_is_none = "scenes: there is no scene 'sorting/3t-2', neither a file nor built in"
    assert mistakes(tmp_path, MISTAKEN) == [
        "my.toml:1: sketches: 'pick_and_plaice': no such file",
        "my.toml:1: sketches: 'gone.sketch': no such file",
        "my.toml:2: planners: there is no planner 'siwr'",
        "my.toml:2: planners: 'siw-r' stands there twice",
        "my.toml:3: unknown key 'seedz'",
        "my.toml:4: k_max: expected a whole number up to 3, found 2.5",
        f"my.toml:7: [[block]] 1: {there_is_none}",
        "my.toml:7: [[block]] 1: scenes: nothing matches 'no*.toml'",
        "my.toml:8: [[block]] 1: robots: there is no robot 'tiaga'",
        "my.toml:9: [[block]] 1: timeout: must be positive, found -1",
        "my.toml:10: [[block]] 2: the key 'scenes' is missing",
        "my.toml:11: [[block]] 2: seeds: are no seeds: [1, True]",
        "my.toml:12: [[block]] 2: timeout: expected a number of sensible size, found 1000000000.0",
        "my.toml:13: [[block]] 2: domain: there is no file 'none.py'",
    ]


@pytest.mark.parametrize(
    ("sketch", "scene", "said"),
    [
        ("broken.sketch", "sorting/3t-02", "sketches: 'broken.sketch': line 3: "),
        ("pick_and_place", "task.pddl", "sketches: 'pick_and_place' on the tasks in "),
        ("siw", "sorting/3t-02", "sketches: 'siw': "),
        ("iw", "alone.pddl", "scenes: 'alone.pddl': "),
    ],
)
def test_a_sketch_has_to_fit_its_scenes(sketch, scene, said, tmp_path) -> None:
    (tmp_path / "broken.sketch").write_text("sketch broken\nuse tabletop\ngoal { q }\n")
    (tmp_path / "task-domain.pddl").write_text("(define (domain d) (:predicates (p)))")
    (tmp_path / "task.pddl").write_text("(define (problem p) (:domain d) (:init) (:goal (p)))")
    (tmp_path / "alone.pddl").touch()
    (line,) = mistakes(tmp_path, f'sketches = "{sketch}"\nscenes = "{scene}"\n')
    number = 2 if said.startswith("scenes") else 1
    assert line.startswith(f"my.toml:{number}: {said}")


@pytest.mark.parametrize(
    "seeds", ["0", '"5-3"', '"x"', "[]", "[-1]", "1.5", '"1-"', "true", "[1e9]"]
)
def test_what_are_no_seeds_is_said(seeds, tmp_path) -> None:
    (line,) = mistakes(tmp_path, SMALL + f"seeds = {seeds}\n")
    assert line.startswith("my.toml:3: seeds: are no seeds")


def test_too_many_runs_are_refused(tmp_path) -> None:
    with pytest.raises(InputError, match="more than 1000000 runs"):
        suite(tmp_path, SMALL + "seeds = 1000000\nplanners = ['siw-r', 'iw']\n")


@pytest.mark.parametrize("name", BUILT_IN)
def test_suites_that_come_along_have_no_mistakes(name) -> None:
    assert len({job.scene for job in built_in_suite(name).narrowed(seeds=1).jobs()}) == 8


# -- keys ------------------------------------------------------------------------------------------


@pytest.fixture
def files(tmp_path) -> Path:
    from domains.tabletop.scene.generate import sorting_scene

    (tmp_path / "a.sketch").write_text('include "part.sketch"\nsketch a\nuse tabletop\n')
    (tmp_path / "part.sketch").write_text(
        "feature m : nat = count o in objects: misplaced(o)\ngoal { m = 0 }\n"
    )
    (tmp_path / "s.toml").write_text(sorting_scene(2, 0))
    return tmp_path


FILES = 'sketches = "a.sketch"\nscenes = "s.toml"\nseeds = 1\n'


@pytest.mark.parametrize(
    ("file", "changed"),
    [
        ("a.sketch", {"sketch"}),
        ("part.sketch", {"sketch"}),
        ("s.toml", {"scene"}),
        ("notes.txt", set()),
    ],
)
def test_a_run_is_another_one_when_what_it_reads_has_changed(file, changed, files) -> None:
    (before,) = suite(files, FILES).jobs()
    with open(files / file, "a") as more:
        more.write("\n# changed\n")
    (after,) = suite(files, FILES).jobs()
    for part in ("sketch", "scene", "robot", "tool"):
        same = getattr(before.versions, part) == getattr(after.versions, part)
        assert same == (part not in changed)
    assert (before == after) == (not changed)
    assert (before.digest == after.digest) == (not changed)


def test_the_tool_is_a_part_of_the_key(files, monkeypatch) -> None:
    (before,) = suite(files, FILES).jobs()
    monkeypatch.setattr("runtime.bench.versions.tool_version", lambda: "another")
    (after,) = suite(files, FILES).jobs()
    assert before != after


def test_meshes_that_a_scene_names_are_a_part_of_its_version(files) -> None:
    mesh = files / "cup.obj"
    mesh.write_text("v 0 0 0\n")
    text = (files / "s.toml").read_text()
    (files / "s.toml").write_text(f'# mesh = "cup.obj"\n{text}')
    (before,) = suite(files, FILES).jobs()
    mesh.write_text("v 0 0 1\n")
    (after,) = suite(files, FILES).jobs()
    assert before.versions.scene != after.versions.scene


def test_where_a_suite_lies_makes_no_difference(files, tmp_path_factory) -> None:
    (before,) = suite(files, FILES).jobs()
    other = tmp_path_factory.mktemp("other")
    for path in files.iterdir():
        (other / path.name).write_bytes(path.read_bytes())
    (after,) = suite(other, FILES).jobs()
    assert before == after
    assert before.folder != after.folder
    assert job_of(as_data(before)) == before
