"""States as scenes that begin there: what is written and read again is the same state."""

from __future__ import annotations

import json
import random
import re
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

import domains.blocks.scene
import domains.delivery.scene
from domains.pddl.ground.task import ground
from domains.pddl.started import started_from
from domains.pddl.state import State, atom_texts
from domains.pddl.syntax.read import read_domain, read_task
from sketchlang.cli import cli
from sketchlang.library import find_scene
from sketchlang.loader import builtin_sketch
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
