"""Policies of other tools: what their elements mean, by an evaluator of a few lines, is what the
translated features compute; and what rules do not name may change."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from domains.pddl.interchange import dlplan, runir
from domains.pddl.interchange.model import Element, Policy
from domains.pddl.interchange.translate import UNREACHABLE, Translator
from domains.pddl.state import State, atom_texts
from sketchlang.cli import cli
from sketchlang.compile import compile_sketch
from sketchlang.errors import InputError
from sketchlang.loader import load_text
from sketchlang.source import Source
from tests.pddl.random_tasks import PREDICATES
from tests.pddl.test_features import interface_and_problem

UNARY = [name for name, sorts in PREDICATES.items() if len(sorts) == 1]
BINARY = [name for name, sorts in PREDICATES.items() if len(sorts) == 2]


class Meaning:
    """Elements as sets of objects and of pairs."""

    def __init__(self, state: State) -> None:
        task = state.task
        self.objects = set(task.objects)
        self.atoms = {tuple(text.strip("()").split()) for text in atom_texts(state)}
        for name, found in task.static.items():
            self.atoms |= {(name, *(task.objects[v] for v in values)) for values in found}
        for name, found in task.goal_atoms.items():
            self.atoms |= {(f"{name}_g", *(task.objects[v] for v in values)) for values in found}

    def __call__(self, element: Element) -> Any:  # noqa: PLR0912 (a case for each constructor)
        name, arguments = element.name, element.arguments
        if name in ("c_primitive", "r_primitive"):
            predicate, *places = arguments
            rows = [atom[1:] for atom in self.atoms if atom[0] == predicate]
            chosen = {tuple(row[int(str(place))] for place in places) for row in rows}
            return {row[0] for row in chosen} if name == "c_primitive" else chosen
        x = [self(part) for part in arguments if isinstance(part, Element)]
        pairs = {(a, b) for a in self.objects for b in self.objects}
        match name:
            case "c_top":
                return self.objects
            case "c_bot":
                return set()
            case "r_top":
                return pairs
            case "c_and" | "r_and":
                return x[0] & x[1]
            case "c_or" | "r_or":
                return x[0] | x[1]
            case "c_diff" | "r_diff":
                return x[0] - x[1]
            case "c_not":
                return self.objects - x[0]
            case "r_not":
                return pairs - x[0]
            case "c_some":
                return {a for a, b in x[0] if b in x[1]}
            case "c_all":
                return {a for a in self.objects if all(c in x[1] for b, c in x[0] if b == a)}
            case "c_equal" | "c_subset":
                rows = {a: [{c for b, c in r if b == a} for r in x] for a in self.objects}
                same = name == "c_equal"
                return {a for a, (r, s) in rows.items() if (r == s if same else r <= s)}
            case "r_inverse":
                return {(b, a) for a, b in x[0]}
            case "r_identity":
                return {(a, a) for a in x[0]}
            case "r_restrict":
                return {(a, b) for a, b in x[0] if b in x[1]}
            case "r_compose":
                return {(a, d) for a, b in x[0] for c, d in x[1] if b == c}
            case "r_transitive_closure" | "r_transitive_reflexive_closure":
                found = set(x[0])
                while more := {(a, d) for a, b in found for c, d in found if b == c} - found:
                    found |= more
                return found | {(a, a) for a in self.objects if "reflexive" in name}
            case "b_empty":
                return int(not x[0])
            case "b_inclusion":
                return int(x[0] <= x[1])
            case "n_count":
                return len(x[0])
            case "n_concept_distance":
                return self.distance(*x)
            case "n_sum_concept_distance":
                if not x[0] or not x[2]:
                    return UNREACHABLE
                far = [self.distance(x[0], x[1], {b}) for b in x[2]]
                return UNREACHABLE if UNREACHABLE in far else sum(far)
            case "n_role_distance" | "n_sum_role_distance":
                first, relation, last = x
                ends = [(b, {d for c, d in last if c == a}) for a, b in first]
                far = [self.distance({b}, relation, end) for b, end in ends]
                if not first or not last:
                    return UNREACHABLE
                if name == "n_role_distance":
                    return min(far)
                return UNREACHABLE if UNREACHABLE in far else sum(far)
        raise AssertionError(name)

    @staticmethod
    def distance(start: set[str], relation: set[tuple[str, str]], end: set[str]) -> int:
        seen, number = set(start), 0
        while not seen & end:
            more = {b for a, b in relation if a in seen} - seen
            if not more:
                return UNREACHABLE
            seen, number = seen | more, number + 1
        return number


def draw(kind: str, rng: random.Random, depth: int) -> Element:
    """A random concept `c`, role `r`, Boolean `b` or numerical `n`, as dlplan writes them."""

    def some(kinds: str) -> tuple[Element, ...]:
        return tuple(draw(one, rng, depth - 1) for one in kinds)

    goal = rng.choice(["", "", "_g"])
    if kind == "c":
        if not depth:
            leaf = Element("c_primitive", (rng.choice(UNARY) + goal, "0"))
            return rng.choice([leaf, leaf, Element("c_top", ()), Element("c_bot", ())])
        forms = {"and": "cc", "or": "cc", "diff": "cc", "not": "c", "some": "rc", "all": "rc"}
        forms |= {"equal": "rr", "subset": "rr"}
    elif kind == "r":
        if not depth:
            places = rng.choice([("0", "1"), ("0", "1"), ("1", "0")])
            return Element("r_primitive", (rng.choice(BINARY) + goal, *places))
        forms = {"and": "rr", "or": "rr", "diff": "rr", "not": "r", "inverse": "r", "compose": "rr"}
        forms |= {"identity": "c", "restrict": "rc", "transitive_closure": "r"}
        forms |= {"transitive_reflexive_closure": "r"}
    elif kind == "b":
        forms = {"empty": rng.choice("cr"), "inclusion": rng.choice(["cc", "rr"])}
    else:
        forms = {
            "count": rng.choice("cr"),
            "concept_distance": "crc",
            "sum_concept_distance": "crc",
            "role_distance": "rrr",
            "sum_role_distance": "rrr",
        }
    name, kinds = rng.choice(list(forms.items()))
    return Element(f"{kind}_{name}", some(kinds))


def spelled(element: Element | str) -> str:
    """An element as dlplan writes it."""
    if isinstance(element, str):
        return element
    return f"{element.name}({','.join(map(spelled, element.arguments))})".removesuffix("()")


@pytest.mark.parametrize("block", range(3))
def test_features_mean_what_they_meant(block: int) -> None:
    for seed in range(block * 10, block * 10 + 10):
        rng = random.Random(seed)
        interface, problem = interface_and_problem(seed)
        booleans = [draw("b", rng, 3) for _ in range(3)]
        numericals = [draw("n", rng, 3) for _ in range(3)]
        listed = [" ".join(f'"{spelled(e)}"' for e in part) for part in (booleans, numericals)]
        text = f"(:policy (:boolean_features {listed[0]}) (:numerical_features {listed[1]}))"
        policy = dlplan.read(text, "policy")
        assert list(policy.booleans.values()) == booleans
        assert list(policy.numericals.values()) == numericals
        sketch = Translator(interface, "d.pddl", "policy").sketch(policy, "s")
        loaded = load_text(Source("s", sketch), {}, interface)
        assert loaded.ok, (sketch, loaded.diagnostics)
        compiled = compile_sketch(loaded.checked)
        state = problem.initial
        for _ in range(4):
            meaning = Meaning(state)
            expected = tuple(meaning(element) for element in [*booleans, *numericals])
            assert compiled.evaluate(state) == expected, sketch
            followers = list(problem.successors(state))
            if not followers:
                break
            state = rng.choice(followers)[1]


RULE = "(:rule (:conditions (:c_b_pos {b}) (:c_n_gt {n})) (:effects (:e_b_bot {b}) (:e_n_dec {n})))"
OLD = '(:policy (:boolean_features "b_nullary(done)") (:numerical_features "n_count(c_top)" '
OLD += '"n_count(c_bot)") {})'
NEW = '(:policy (:booleans (H "b_nullary(done)")) (:numericals (n "n_count(c_top)") '
NEW += '(m "n_count(c_bot)")) {})'
RUNIR = """
[boolean_features] <H> ::= @boolean_atomic_state "done"
[numerical_features] <n> ::= @numerical_count @concept_top <m> ::= @numerical_count @concept_bot
[policy_rules]
{ @positive_boolean_condition <H>, @greater_numerical_condition <n> }
-> { @unchanged_boolean_effect <H>, @decrease_numerical_effect <n> }
"""


@pytest.mark.parametrize(
    "policy",
    [
        dlplan.read(OLD.format(RULE.format(b=0, n=0)), "old"),
        dlplan.read(NEW.format(RULE.format(b="H", n="n")), "new"),
        runir.read(RUNIR, "runir"),
    ],
    ids=["numbers", "names", "runir"],
)
def test_what_a_rule_does_not_name_may_change(policy: Policy) -> None:
    interface, _ = interface_and_problem(0)
    text = Translator(interface, "d.pddl", "policy").sketch(policy, "s")
    model = load_text(Source("s", text), {}, interface).checked.model
    (rule,) = model.rules
    before = (1, 2, 3)
    assert rule.satisfied_by(before, (1, 1, 0))
    assert rule.satisfied_by(before, (1, 1, 9))
    assert not rule.satisfied_by(before, (0, 1, 3))
    assert not rule.satisfied_by(before, (1, 2, 3))
    assert not rule.satisfied_by((0, 2, 3), (0, 1, 3))


@pytest.mark.parametrize(
    "text",
    ["", "(:policy", "(:policy))", "(:policy (:rule (:conditions (:c_b_pos 0)) (:effects )))",
     '(:policy (:numericals (n "n_magic(c_top)")))', '(:policy (:numericals (n "n_count(")))',
     '(:policy (:booleans (b "b_nullary(nowhere)")))', "(:sketch)", "(:policy x)"],
)  # fmt: skip
def test_what_cannot_be_translated_is_said(text: str, tmp_path: Path) -> None:
    domain = tmp_path / "domain.pddl"
    domain.write_text("(define (domain d) (:predicates (p ?x)))")
    (tmp_path / "policy").write_text(text)
    words = ["import", "dlplan", str(tmp_path / "policy"), "--domain", str(domain)]
    result = CliRunner().invoke(cli, words)
    assert result.exit_code == 2, result.output
    assert result.stderr.startswith("error: ")
    interface, _ = interface_and_problem(0)
    with pytest.raises(InputError):
        Translator(interface, "d", "p").sketch(dlplan.read(text, "p"), "s")


def test_the_command_writes_a_sketch_and_never_over_what_it_reads(tmp_path: Path) -> None:
    domain, policy, out = (tmp_path / name for name in ("domain.pddl", "policy", "out.sketch"))
    domain.write_text("(define (domain d) (:predicates (p ?x) (done)))")
    policy.write_text(NEW.format(RULE.format(b="H", n="n")))
    words = ["import", "dlplan", str(policy), "--domain", str(domain), "--out"]
    for taken in (domain, policy):
        before = taken.read_text()
        assert CliRunner().invoke(cli, [*words, str(taken)]).exit_code == 2
        assert taken.read_text() == before
    assert CliRunner().invoke(cli, [*words, str(out)]).exit_code == 0
    assert CliRunner().invoke(cli, ["check", str(out)]).exit_code == 0
    assert "rule r1 { H, n > 0 } -> { n--, m? }" in out.read_text()
