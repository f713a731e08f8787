"""Imported policies beside the library that they were written for, in an environment of its own.

    python -m venv .dlplan && .dlplan/bin/python -m pip install --no-deps dlplan==0.3.29
    python -m benchmarks.policies POLICIES TASKS --python .dlplan/bin/python

POLICIES is a folder with files of dlplan in folders that bear a domain's name, like
`driverlog/driverlog_1.txt`; TASKS has a folder for each domain (`driverlog`, or the part before a
`-`) with `domain.pddl` and tasks. Of each file, a line: whether it was imported, and on how many of
the pairs of random states the same rules hold, and the features of how many states have the
same values. Half of the pairs are a state and one that follows it.
"""

from __future__ import annotations

import argparse
import json
import random
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from domains.pddl.features.rows import bits_of
from domains.pddl.interchange import dlplan
from domains.pddl.interchange.translate import UNREACHABLE, Translator
from domains.pddl.interface import PddlInterface, interface_of
from domains.pddl.problem import PddlProblem
from domains.pddl.state import State, atom_texts
from sketchlang.checking.checker import CheckedSketch
from sketchlang.compile import compile_sketch
from sketchlang.errors import InputError
from sketchlang.loader import load_text
from sketchlang.source import Source

PEER = Path(__file__).with_name("dlplan_peer.py")
WALKS, STEPS = 12, 25
Pair = tuple[int, int]


@dataclass(frozen=True)
class Agreement:
    """On how many pairs the same rules hold, and how many states have the same feature values;
    `satisfied` counts the pairs that satisfy a rule at all."""

    pairs: int
    same_rules: int
    satisfied: int
    states: int
    same_values: int

    @property
    def complete(self) -> bool:
        """Whether there was no difference."""
        return self.pairs == self.same_rules and self.states == self.same_values


def walked(problem: PddlProblem, rng: random.Random) -> tuple[list[State], list[Pair]]:
    """States of random walks, and pairs of them that follow each other."""
    states: dict[State, int] = {}
    steps: list[Pair] = []
    for _ in range(WALKS):
        state = problem.initial
        before = states.setdefault(state, len(states))
        for _ in range(rng.randint(1, STEPS)):
            followers = problem.successors(state)
            if not followers:
                break
            state = rng.choice(followers)[1]
            now = states.setdefault(state, len(states))
            steps.append((before, now))
            before = now
    return list(states), steps


def question(policy: str, problem: PddlProblem, states: list[State], pairs: list[Pair]) -> Any:
    """What the other library is asked, as `dlplan_peer.py` reads it."""
    task = problem.task
    names = task.objects
    predicates = {name: len(found) for name, found in task.pddl.domain.predicates.items()}
    types = {name: mask for name, mask in task.types.items() if name not in predicates}
    static = [
        [name, *(names[value] for value in values)]
        for name, found in [
            *task.static.items(),
            *((f"{name}_g", found) for name, found in task.goal_atoms.items()),
        ]
        for values in found
    ] + [[name, names[place]] for name, mask in types.items() for place in bits_of(mask)]
    return {
        "policy": policy,
        "predicates": predicates
        | {f"{name}_g": count for name, count in predicates.items()}
        | dict.fromkeys(types, 1),
        "constants": [constant.name for constant in task.pddl.domain.constants],
        "objects": list(names),
        "static": static,
        "states": [[text.strip("()").split() for text in atom_texts(state)] for state in states],
        "pairs": pairs,
    }


def ask(python: str, asked: Any) -> Any:
    """The other library's answer."""
    done = subprocess.run(
        [python, str(PEER)], input=json.dumps(asked), capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise RuntimeError(done.stderr[-2000:])
    return json.loads(done.stdout)


def compare(
    python: str, policy: str, checked: CheckedSketch, problem: PddlProblem, rng: random.Random,
    wanted: int,
) -> Agreement:  # fmt: skip
    """Look at `wanted` pairs of states of one task, both ways. Features that the other library
    has not kept, since no rule names them, are not compared."""
    states, steps = walked(problem, rng)
    places = range(len(states))
    pairs = [rng.choice(steps) for _ in range(wanted // 2)] if steps else []
    pairs += [(rng.choice(places), rng.choice(places)) for _ in range(wanted - len(pairs))]
    told = ask(python, question(policy, problem, states, pairs))
    sketch = compile_sketch(checked)
    values = [sketch.evaluate(state) for state in states]
    names = [feature.name.rstrip("_") for feature in sketch.model.features]
    same_values = 0
    for ours, theirs in zip(values, told["values"], strict=True):
        mine = {name: min(value, UNREACHABLE) for name, value in zip(names, ours, strict=True)}
        same_values += all(
            mine[name.rstrip("_")] == min(value, UNREACHABLE) for name, value in theirs.items()
        )
    rules = [
        [
            number
            for number, rule in enumerate(sketch.model.rules)
            if rule.satisfied_by(values[i], values[j])
        ]
        for i, j in pairs
    ]
    same_rules = sum(a == b for a, b in zip(rules, told["rules"], strict=True))
    return Agreement(len(pairs), same_rules, sum(map(bool, rules)), len(states), same_values)


def imported(file: Path, interface: PddlInterface) -> CheckedSketch:
    """A policy as a sketch.

    Raises:
        InputError: what of it has no words in the language.
    """
    policy = dlplan.read(file.read_text(), str(file))
    text = Translator(interface, "domain.pddl", str(file)).sketch(policy, "imported")
    loaded = load_text(Source(str(file), text), {}, interface)
    if not loaded.ok:
        raise InputError(loaded.diagnostics[0].message)
    return loaded.checked


def folder_for(domain: str, tasks: Path) -> Path | None:
    """The folder of a domain: of that name, or one whose name is the beginning of it."""
    found = [
        path
        for path in tasks.iterdir()
        if path.is_dir() and domain.partition("-")[0] == path.name.partition("-")[0]
    ]
    return min(found, default=None)


def line(file: Path, folder: Path, python: str, pairs: int, tasks: int) -> tuple[str, bool]:
    """One row of the table, and whether all is well."""
    interface = interface_of(str(folder / "domain.pddl"))
    try:
        checked = imported(file, interface)
    except InputError as error:
        return f"| {file.stem} | no: {error} | | |", False
    paths = [path for path in folder.glob("*.pddl") if "domain" not in path.name]
    paths = sorted(paths, key=lambda path: path.stat().st_size)[:tasks]
    found = []
    for number, path in enumerate(paths):
        assert interface.load is not None
        problem = interface.load(str(path), None)  # type: ignore[arg-type]
        share = pairs // len(paths) + (1 if number < pairs % len(paths) else 0)
        rng = random.Random(number)
        found.append(compare(python, file.read_text(), checked, problem, rng, share))
    same, all_pairs = sum(a.same_rules for a in found), sum(a.pairs for a in found)
    values, states = sum(a.same_values for a in found), sum(a.states for a in found)
    text = f"| {file.stem} | yes | {same}/{all_pairs} ({sum(a.satisfied for a in found)} satisfy"
    return f"{text} a rule) | {values}/{states} |", all(a.complete for a in found)


def main(arguments: Sequence[str]) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("policies", type=Path)
    parser.add_argument("tasks", type=Path)
    parser.add_argument("--python", required=True)
    parser.add_argument("--pairs", type=int, default=1000)
    parser.add_argument("--task-count", type=int, default=4)
    options = parser.parse_args(arguments)
    print("| policy | imported | pairs with the same rules | states with the same values |")
    print("|---|---|---|---|")
    well = True
    for file in sorted(options.policies.rglob("*_*.txt")):
        folder = folder_for(file.parent.name, options.tasks)
        if folder is None:
            print(f"| {file.stem} | no tasks | | |")
            continue
        text, good = line(file, folder, options.python, options.pairs, options.task_count)
        print(text, flush=True)
        well &= good
    raise SystemExit(0 if well else 1)


if __name__ == "__main__":
    main(sys.argv[1:])
