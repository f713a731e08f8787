"""The quick evaluator of PDDL features against the plain one, on random expressions."""

from __future__ import annotations

import random

import pytest

from domains.pddl.ground.task import ground
from domains.pddl.interface import PddlInterface, make_interface
from domains.pddl.problem import PddlProblem
from domains.pddl.syntax.read import read_domain, read_task
from sketchlang.compile import compile_sketch
from sketchlang.inspection.explain import Explainer
from sketchlang.loader import load_text
from sketchlang.source import Source
from tests.pddl.random_tasks import PREDICATES, TYPES, texts


class Expressions:
    """Draws well-typed expressions over the domain of the random tasks."""

    def __init__(self, rng: random.Random) -> None:
        self.rng = rng
        self.count = 0

    def variable(self) -> str:
        self.count += 1
        return f"v{self.count}"

    def element(self, scope: dict[str, str]) -> str:
        return self.rng.choice([*scope, "hall"])

    def name(self, arity: int) -> str:
        names = [name for name, sorts in PREDICATES.items() if len(sorts) == arity]
        found = self.rng.choice(names)
        return ("goal " if self.rng.random() < 0.2 else "") + (found if found != "in" else "in_")

    def set(self, scope: dict[str, str], depth: int) -> str:
        kind = self.rng.randint(0, 8) if depth else self.rng.randint(0, 1)
        if kind == 0:
            x = self.variable()
            chosen = f"{{ {x} in object where {x} in {self.rng.choice(list(TYPES))} }}"
            return self.rng.choice(["object", chosen])
        if kind == 1:
            return self.name(1)
        if kind <= 3:
            sign = self.rng.choice("|&-")
            return f"({self.set(scope, depth - 1)} {sign} {self.set(scope, depth - 1)})"
        if kind <= 6:
            one = self.rng.choice([self.element(scope), self.set(scope, depth - 1)])
            both = [one, "_"] if self.rng.random() < 0.5 else ["_", one]
            plain = self.rng.random() < 0.5
            name = self.name(2) if plain else f"({self.relation(scope, depth - 1)})"
            sign = "" if plain else self.rng.choice("+*")
            return f"{name}{sign}({', '.join(both)})"
        if kind == 7:
            return f"{{ {self.element(scope)}, {self.element(scope)} }}"
        x = self.variable()
        inner = self.truth({**scope, x: ""}, depth - 1)
        return f"{{ {x} in {self.set(scope, depth - 1)} where {inner} or {x} = {x} }}"

    def relation(self, scope: dict[str, str], depth: int) -> str:
        """Between objects, so that it can be closed."""
        kind = self.rng.randint(0, 7) if depth > 0 else self.rng.randint(0, 1)
        if kind <= 1:
            return self.rng.choice(["on", "goal on"])
        if kind == 2:
            return f"inverse({self.relation(scope, depth - 1)})"
        if kind == 3:
            return f"compose({self.relation(scope, depth - 1)}, {self.relation(scope, depth - 1)})"
        if kind == 4:
            return f"restrict({self.relation(scope, depth - 1)}, {self.set(scope, depth - 1)})"
        if kind == 5:
            sign = self.rng.choice("|&-")
            first, second = (self.relation(scope, depth - 1) for _ in range(2))
            return f"({first}) {sign} ({second})"
        if kind == 6:
            return f"({self.relation(scope, depth - 1)}){self.rng.choice('+*')}"
        x, y = self.variable(), self.variable()
        inner = self.truth({**scope, x: "", y: ""}, depth - 1)
        return f"{{ {x} in object, {y} in object where {inner} or {x} = {y} }}"

    def truth(self, scope: dict[str, str], depth: int) -> str:
        kind = self.rng.randint(0, 8) if depth > 0 else 0
        if kind == 0:
            arity = self.rng.randint(0, 2)
            arguments = ", ".join(self.element(scope) for _ in range(arity))
            return f"{self.name(arity)}({arguments})" if arity else self.name(0)
        if kind <= 2:
            sign = self.rng.choice(["and", "or", "->"])
            return f"({self.truth(scope, depth - 1)} {sign} {self.truth(scope, depth - 1)})"
        if kind == 3:
            return f"not ({self.truth(scope, depth - 1)})"
        if kind == 4:
            return f"({self.element(scope)} in {self.set(scope, depth - 1)})"
        if kind == 5:
            sign = self.rng.choice(["=", "<=", "!="])
            return f"({self.set(scope, depth - 1)} {sign} {self.set(scope, depth - 1)})"
        if kind == 6:
            sign = self.rng.choice(["=", "<", "<="])
            return f"({self.number(scope, depth - 1)} {sign} {self.number(scope, depth - 1)})"
        x = self.variable()
        inner = self.truth({**scope, x: ""}, depth - 1)
        return f"({self.rng.choice(['some', 'all'])} {x} in {self.set(scope, depth - 1)}: {inner})"

    def number(self, scope: dict[str, str], depth: int) -> str:
        kind = self.rng.randint(0, 5) if depth > 0 else 0
        if kind == 0:
            return str(self.rng.randint(0, 3))
        if kind == 1:
            return f"({self.number(scope, depth - 1)} + {self.number(scope, depth - 1)})"
        if kind == 2:
            start, end = (self.set(scope, depth - 1) for _ in range(2))
            return f"distance({start}, {self.relation(scope, depth - 1)}, {end})"
        if kind == 3:
            both = self.number(scope, depth - 1), self.number(scope, depth - 1)
            return "(if {} then {} else {})".format(self.truth(scope, depth - 1), *both)
        x = self.variable()
        inner = {**scope, x: ""}
        if kind == 4:
            return f"(count {x} in {self.set(scope, depth - 1)}: {self.truth(inner, depth - 1)})"
        word = self.rng.choice(["sum", "min", "max"])
        where = f" where {self.truth(inner, depth - 1)}" if self.rng.random() < 0.5 else ""
        over, body = self.set(scope, depth - 1), self.number(inner, depth - 1)
        return f"({word} {x} in {over}{where}: {body})"


def untyped(domain: str) -> str:
    """All predicates take objects: expressions then fit together whatever they are of."""
    head, predicates, rest = domain.partition("(:predicates")
    declared, end, actions = rest.partition(")\n")
    for name in TYPES:
        declared = declared.replace(f"- {name}", "- object")
    return head + predicates + declared + end + actions


def interface_and_problem(seed: int) -> tuple[PddlInterface, PddlProblem]:
    """The domain and a task of a seed."""
    domain, task = texts(seed)
    pddl = read_domain(Source("domain", untyped(domain)))
    return make_interface(pddl), PddlProblem(ground(read_task(Source("task", task), pddl)))


def compare(seed: int) -> None:
    """Some features of some states, both ways."""
    rng = random.Random(seed)
    interface, problem = interface_and_problem(seed)
    make = Expressions(rng)
    numbers = [make.number({}, 4) for _ in range(5)]
    truths = [make.truth({}, 4) for _ in range(5)]
    text = "sketch s\nuse rooms\n"
    text += "".join(f"feature n{i} : nat = {e}\n" for i, e in enumerate(numbers))
    text += "".join(f"feature b{i} : bool = {e}\n" for i, e in enumerate(truths))
    text += "feature both : nat = n0 + n1\ngoal { both = 0 }\n"
    loaded = load_text(Source("s", text), {}, interface)
    assert loaded.ok, [(found.code, found.message, text) for found in loaded.diagnostics]
    quick, plain = compile_sketch(loaded.checked), compile_sketch(loaded.checked, plain=True)
    state, explainer = problem.initial, Explainer(loaded.checked)
    for _ in range(6):
        assert quick.evaluate(state) == plain.evaluate(state), text
        assert tuple(one.value for one in explainer.features(state)) == quick.evaluate(state), text
        followers = list(problem.successors(state))
        if not followers:
            break
        state = rng.choice(followers)[1]


@pytest.mark.parametrize("block", range(4))
def test_quick_and_plain_agree(block: int) -> None:
    for seed in range(block * 12, block * 12 + 12):
        compare(seed)


@pytest.mark.slow
def test_quick_and_plain_agree_on_many() -> None:
    for seed in range(5000, 6000):
        compare(seed)
