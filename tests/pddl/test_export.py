"""Sketches as policies of other tools: read back, they mean the same."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from click.testing import CliRunner

from domains.pddl.interchange import dlplan, runir
from domains.pddl.interchange.export import Exported, to_dlplan, to_runir
from domains.pddl.interchange.translate import Translator
from domains.pddl.interface import PddlInterface, make_interface
from domains.pddl.problem import PddlProblem
from domains.pddl.syntax.read import read_domain
from sketchlang.checking.checker import CheckedSketch
from sketchlang.cli import cli
from sketchlang.compile import compile_sketch
from sketchlang.errors import InputError
from sketchlang.loader import load_sketch, load_text
from sketchlang.source import Source
from tests.pddl.small_tasks import TASKS
from tests.pddl.test_features import Expressions, interface_and_problem

NOTATIONS = {"dlplan": (to_dlplan, dlplan), "runir": (to_runir, runir)}
BOOL_WORDS, NAT_WORDS = ["{}", "!{}", "{}?", ""], ["{}--", "{}++", "{}?", "!{}++", "!{}--", ""]


def loaded(text: str, interface: PddlInterface) -> CheckedSketch:
    found = load_text(Source("s", text), {}, interface)
    assert found.ok, [d.message for d in found.diagnostics if d.severity.value == "error"]
    return found.checked


def states_of(problem: PddlProblem, rng: random.Random) -> list[object]:
    states, state = [problem.initial], problem.initial
    for _ in range(25):
        followers = problem.successors(state)
        if not followers:
            break
        state = rng.choice(followers)[1]
        states.append(state)
    return states


def same_meaning(
    one: CheckedSketch, text: Exported, notation: str, interface: PddlInterface,
    problem: PddlProblem, rng: random.Random,
) -> None:  # fmt: skip
    """The policy, read again, has the same rules for the same pairs of states. A rule of ours may
    have become two there."""
    policy = NOTATIONS[notation][1].read(text.text, notation)
    other = loaded(Translator(interface, "d.pddl", notation).sketch(policy, "s"), interface)
    states = states_of(problem, rng)
    values = [
        [compile_sketch(checked).evaluate(state) for state in states] for checked in (one, other)
    ]
    for i in range(len(states)):
        for j in range(len(states)):
            holds = [
                any(rule.satisfied_by(found[i], found[j]) for rule in checked.model.rules)
                for checked, found in zip((one, other), values, strict=True)
            ]
            assert holds[0] == holds[1], (i, j, text.text)
    if notation == "dlplan":
        assert len(other.model.rules) == len(one.model.rules)


def random_sketch(seed: int, notation: str) -> tuple[PddlInterface, PddlProblem, CheckedSketch]:
    """One feature of each kind that can be exported, and rules about them."""
    rng = random.Random(seed)
    interface, problem = interface_and_problem(seed)
    make = Expressions(rng)
    draws = {
        "b": lambda: f"feature F : bool = some z in {make.set({}, 3)}: true",
        "i": lambda: f"feature F : bool = {make.set({}, 2)} <= {make.set({}, 2)}",
        "t": lambda: f"feature F : bool = {make.truth({}, 3)}",
        "n": lambda: f"feature F : nat = count z in {make.set({}, 3)}: true",
    }
    kept = []
    for name, kind in (("A", "b"), ("B", "i"), ("C", "t"), ("m", "n"), ("n", "n")):
        for _ in range(30):
            line = draws[kind]().replace("feature F", f"feature {name}")
            found = load_text(Source("s", f'sketch s\nuse "d.pddl"\n{line}\n'), {}, interface)
            try:
                assert found.ok, (line, found.diagnostics)
                NOTATIONS[notation][0](found.checked, interface)
            except InputError:
                continue
            kept.append((name, kind, line))
            break
    rules = []
    for number in range(4):
        effects = [
            word.format(name)
            for name, kind, _ in kept
            if (word := rng.choice(NAT_WORDS if kind == "n" else BOOL_WORDS))
        ]
        name, kind, _ = rng.choice(kept)
        condition = f"{name} > 0" if kind == "n" else rng.choice([name, f"!{name}"])
        rules.append(f"rule r{number} {{ {condition} }} -> {{ {', '.join(effects)} }}")
    text = "\n".join(["sketch s", 'use "d.pddl"', *(line for _, _, line in kept), *rules])
    return interface, problem, loaded(text + "\n", interface)


@pytest.mark.parametrize("notation", NOTATIONS)
@pytest.mark.parametrize("block", range(3))
def test_random_sketches_mean_the_same_when_they_are_read_back(block: int, notation: str) -> None:
    for seed in range(block * 8, block * 8 + 8):
        interface, problem, checked = random_sketch(seed, notation)
        assert len(checked.model.features) >= 4
        exported = NOTATIONS[notation][0](checked, interface)
        same_meaning(checked, exported, notation, interface, problem, random.Random(seed))


@pytest.mark.parametrize("name", sorted(TASKS))
def test_built_in_sketches(name: str, tmp_path: Path) -> None:
    """Each is exported and means the same, or what cannot be said is named with its place."""
    found = load_sketch(name)
    interface = found.checked.domain
    assert isinstance(interface, PddlInterface)
    task = tmp_path / "task.pddl"
    task.write_text(TASKS[name])
    assert interface.load is not None
    problem = interface.load(str(task), None)  # type: ignore[arg-type]
    for notation, (write, _) in NOTATIONS.items():
        try:
            exported = write(found.checked, interface)
        except InputError:
            continue
        same_meaning(found.checked, exported, notation, interface, problem, random.Random(0))


def test_the_command_names_what_cannot_be_said(tmp_path: Path) -> None:
    out = tmp_path / "policy.txt"
    done = CliRunner().invoke(cli, ["export", "gripper", "--dlplan", str(out)])
    assert done.exit_code == 0, done.output
    assert "note: the sketch's goal is left out" in done.stderr
    assert out.read_text().startswith("(:policy\n")
    out.unlink()
    done = CliRunner().invoke(cli, ["export", "driverlog", "--runir", str(out)])
    assert done.exit_code == 2
    assert "feature `w` cannot be said there" in done.stderr
    assert "feature `d` cannot be said there" in done.stderr
    assert "driverlog.sketch:24:5" in done.stderr
    assert not out.exists()
    for words in (["pick_and_place", "--dlplan"], ["gripper", "--glb", "x.glb", "--dlplan"]):
        done = CliRunner().invoke(cli, ["export", *words, str(out)])
        assert done.exit_code == 2
        assert done.stderr.startswith("error: ")


def test_what_two_tools_cannot_tell_apart_is_refused() -> None:
    domain = "(define (domain d) (:predicates (p ?x) (p_g ?x)))"
    interface = make_interface(read_domain(Source("d", domain)))
    checked = loaded('sketch s\nuse "d.pddl"\nfeature n : nat = count x in p: true\n', interface)
    with pytest.raises(InputError, match="the domain has both"):
        to_dlplan(checked, interface)
