"""States as scenes that begin there: what is written and read again is the same state."""

from __future__ import annotations

import json
import random
import re
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result
from hypothesis import given, settings
from hypothesis import strategies as st

import domains.blocks.scene
import domains.delivery.scene
from domains.pddl.ground.task import ground
from domains.pddl.started import started_from
from domains.pddl.state import State, atom_texts
from domains.pddl.syntax.read import read_domain, read_task
from domains.tabletop.actions.actions import MoveBase
from runtime.reporting import UnsayableError
from runtime.solve import Task, open_task
from runtime.toml_text import document
from runtime.trial.explore import Sample, successors
from sketchlang.cli import cli
from sketchlang.library import find_scene
from sketchlang.loader import builtin_sketch, load_sketch
from sketchlang.source import Source
from tests.pddl.random_tasks import texts


def run(*arguments: object) -> Result:
    result = CliRunner().invoke(cli, [str(argument) for argument in arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result


def walk(problem: Any, rng: random.Random, steps: int) -> list[Any]:
    """The states of a random walk."""
    found = [problem.initial]
    for _ in range(steps):
        following = [after for _, after in problem.successors(found[-1])]
        if not following:
            break
        found.append(rng.choice(following))
    return found


@pytest.mark.parametrize(
    ("reader", "scene"),
    [
        (domains.blocks.scene, "blocks/eight"),
        (domains.blocks.scene, "blocks/clear"),
        (domains.delivery.scene, "delivery/walls"),
    ],
)
def test_states_of_python_domains(reader: Any, scene: str, tmp_path: Path) -> None:
    problem = reader.read(find_scene(scene)[0])
    path = tmp_path / "scene.toml"
    written = 0
    for state in walk(problem, random.Random(3), 300):
        text = problem.scene(state)
        if text is None:
            continue
        written += 1
        path.write_text(text)
        again = reader.read(path)
        # Tasks are compared by identity; what they say is in the picture.
        assert list(again.picture(again.initial)) == list(problem.picture(state))
    assert written > 30


def without_places(formula: object) -> str:
    return re.sub(r"Span\([^)]*\)", "", repr(formula))


def test_states_of_pddl_tasks() -> None:
    moved = 0
    for seed in range(25):
        domain_text, text = texts(seed)
        domain = read_domain(Source("domain", domain_text))
        pddl = read_task(Source("task", text), domain)
        grounded = ground(pddl)
        start = State(grounded.initial, grounded)
        rng = random.Random(seed)
        state = start
        for _ in range(3):
            following = [o for o in grounded.operators if o.condition.holds(state.bits)]
            if not following:
                break
            state = State(rng.choice(following).apply(state.bits), grounded)
        moved += state != start
        again = read_task(Source("task", started_from(state)), domain)
        task = ground(again)
        assert sorted(atom_texts(State(task.initial, task))) == sorted(atom_texts(state))
        changing = domain.changing()
        assert {f for f in again.init if f[0] not in changing} == {
            f for f in pddl.init if f[0] not in changing
        }
        assert again.values == pddl.values
        assert without_places(again.goal) == without_places(pddl.goal)
    assert moved > 10


def tabletop_walk(task: Task, rng: np.random.Generator, steps: int) -> Iterator[Any]:
    """The states after manipulations chosen at random, of those that can be carried out."""
    state = task.problem.initial
    for _ in range(steps):
        choices = list(successors(Sample.drawn(rng).of(task.problem, state), state))
        moved = [c for c in choices if not isinstance(c[0], MoveBase)] or choices
        _, state = moved[int(rng.integers(len(moved)))]
        yield state


# Meshes, things that lie, towers, one thing on two; several goals of which one will do.
@pytest.mark.parametrize("scene", ["kitchen/tidy", "stack/pyramid", "desk/sort"])
def test_states_of_tables(scene: str, tmp_path: Path) -> None:
    checked = load_sketch("pick_and_place").checked
    task = open_task(checked, scene)
    path = tmp_path / "scene.toml"
    written = 0
    for state in tabletop_walk(task, np.random.default_rng(5), 12):
        if state.held is not None:
            with pytest.raises(UnsayableError, match="is in the hand"):
                task.reporting.scene_files(state)
            continue
        (text,) = task.reporting.scene_files(state).values()
        path.write_text(text)
        again = open_task(checked, str(path))
        assert again.problem.initial == state
        assert again.sketch.evaluate(again.problem.initial) == task.sketch.evaluate(state)
        written += 1
    assert written > 3


STARTS = """
robot_start = [-0.5, 0.0, 0.0]
[[table]]
name = "t"
at = [0.8, 0.0]
size = [0.6, 1.6]
top = 0.7
[[object]]
name = "a"
colour = "red"
size = [0.05, 0.05, 0.2]
at = [0.6, 0.3]
[[object]]
name = "b"
colour = "red"
size = [0.05, 0.05, 0.2]
at = [0.6, -0.3]
[[goal]]
colour = "red"
any = [{ at = "start", yaw = 90.0 }, { held = true }]
"""


def test_a_goal_at_the_start_stays_where_that_was(tmp_path: Path) -> None:
    checked = load_sketch("pick_and_place").checked
    path, there = tmp_path / "a.toml", tmp_path / "b.toml"
    path.write_text(STARTS)
    task = open_task(checked, str(path))
    first, second = task.problem.initial.placements
    moved = replace(
        task.problem.initial, placements=(first._replace(x=65_000), second._replace(yaw=78_540))
    )
    (text,) = task.reporting.scene_files(moved).values()
    there.write_text(text)
    again = open_task(checked, str(there))
    assert again.problem.initial == moved
    assert again.problem.world.scene.goals == task.problem.world.scene.goals
    assert text.count("[[goal]]") == 2


def test_facts_that_a_scene_has_no_words_for() -> None:
    task = open_task(load_sketch("pick_and_place").checked, "desk/sort")
    with pytest.raises(UnsayableError, match="door"):
        task.reporting.scene_files(task.problem.initial.with_fact("door", 1))


def test_what_was_sampled_is_replayed(tmp_path: Path) -> None:
    path = builtin_sketch("pick_and_place")
    assert path is not None
    sketch = tmp_path / "it.sketch"
    sketch.write_text(path.read_text().replace("\ngoal {", "\ninvariant H or m > 0\ngoal {"))
    scene = tmp_path / "it.toml"
    scene.write_text(STARTS.partition("[[goal]]")[0] + '[[goal]]\nobject = "a"\nat = [0.6, 0.1]\n')
    options = ("--states", 80, "--subproblems", 10, "--time-limit", 20, "--out", tmp_path / "out")
    assert run("test", sketch, "--scenes", scene, *options).exit_code == 1
    (found,) = (tmp_path / "out").glob("*-invariant.json")
    data = json.loads(found.read_text())
    assert len(data["actions"]) > 2
    replayed = run("test", sketch, "--replay", found)
    assert replayed.exit_code == 0
    last = replayed.output.splitlines()[-1]
    assert all(f"{name} = {value}" in last for name, value in data["values"].items())
    # A scene stands beside, and the state in it is this one.
    refused = run("run", sketch, found.with_suffix(".toml"))
    assert refused.exit_code == 2
    assert "invariant" in refused.stderr


def test_a_scene_starts_earlier_where_it_has_no_words(tmp_path: Path) -> None:
    path = builtin_sketch("blocks_towers")
    assert path is not None
    sketch = tmp_path / "it.sketch"
    options = ("--scenes", "blocks/three", "--states", 400, "--subproblems", 5)
    for planted, said in (
        ("invariant not H", "No scene starts there: scenes of its domain cannot begin"),
        ("invariant H -> m > 0 and u = 0", "It starts 1 action earlier: scenes of its domain"),
    ):
        sketch.write_text(path.read_text().replace("invariant H -> m > 0", planted))
        assert said in run("test", sketch, *options, "--out", tmp_path / "out").output


texts_ = st.text(st.characters(codec="utf-8"), max_size=8)
plain = st.one_of(st.booleans(), st.integers(-(2**60), 2**60), st.floats(allow_nan=False), texts_)
values = st.recursive(
    plain, lambda v: st.lists(v, max_size=3) | st.dictionaries(texts_, v, max_size=3), max_leaves=6
)
tables = st.dictionaries(texts_, values, max_size=3)


@settings(deadline=None)
@given(st.dictionaries(texts_, values | tables | st.lists(tables, min_size=1, max_size=3)))
def test_tables_as_text(data: dict[str, Any]) -> None:
    assert tomllib.loads(document(data)) == data


def test_a_run_starts_from_a_finding(tmp_path: Path) -> None:
    path = builtin_sketch("blocks_towers")
    assert path is not None
    sketch = tmp_path / "it.sketch"
    sketch.write_text(path.read_text().replace("invariant H", "invariant u > 0 -> H\ninvariant H"))
    folder = tmp_path / "findings"
    options = ("--states", 400, "--subproblems", 20, "--time-limit", 20, "--out", folder)
    assert run("test", sketch, "--scenes", "blocks/three", *options).exit_code == 1
    (scene,) = folder.glob("*-invariant.toml")
    values = json.loads(scene.with_suffix(".json").read_text())["values"]
    # The state of the finding is the start: the invariant fails there at once.
    refused = run("run", sketch, scene)
    assert refused.exit_code == 2
    assert "invariant" in refused.stderr
    solved = run("run", "blocks_towers", scene, "--json")
    assert solved.exit_code == 0
    assert (values["H"], values["u"] > 0) == (False, True)
