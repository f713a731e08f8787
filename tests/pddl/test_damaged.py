"""Damaged files: a message with its place, and nothing else."""

from __future__ import annotations

import random
import re

import pytest

from domains.pddl.ground.task import ground
from domains.pddl.interface import make_interface
from domains.pddl.syntax.lists import MAX_DEPTH
from domains.pddl.syntax.read import read_domain, read_task
from sketchlang.errors import InputError
from sketchlang.source import Source
from tests.pddl.random_tasks import texts

PIECES = ["(", ")", "()", "?x", "-", ";", "and", ":action", "(not", "either", "\x00", "é", "9" * 30]


def damaged(text: str, rng: random.Random) -> str:
    """A text with one to three things wrong."""
    for _ in range(rng.randint(1, 3)):
        start = rng.randrange(len(text) + 1)
        end = min(len(text), start + rng.randint(0, 12))
        match rng.randrange(5):
            case 0:
                text = text[:start] + text[end:]
            case 1:
                text = text[:start] + rng.choice(PIECES) + text[start:]
            case 2:
                text = text[:start] + text[start:end] * 2 + text[end:]
            case 3:
                text = text[:start]
            case _:
                words = text.split(" ")
                first, second = (rng.randrange(len(words)) for _ in range(2))
                words[first], words[second] = words[second], words[first]
                text = " ".join(words)
    return text


def look(seed: int) -> bool:
    """Read a damaged task of a seed; whether something was wrong with it."""
    rng = random.Random(seed)
    domain, task = texts(seed % 40)
    broken = [domain, task]
    which = rng.randrange(2)
    broken[which] = damaged(broken[which], rng)
    place = None
    try:
        read = read_domain(Source("domain.pddl", broken[0]))
        make_interface(read)
        ground(read_task(Source("task.pddl", broken[1]), read))
    except InputError as error:
        place = str(error.place)
    assert place is None or re.match(r"(domain|task)\.pddl:\d+:\d+$", place), place
    return place is not None


def test_damaged_files() -> None:
    found = sum(look(seed) for seed in range(300))
    assert found > 150


@pytest.mark.slow
def test_five_thousand_damaged_files() -> None:
    assert sum(look(seed) for seed in range(10_000, 15_000)) > 2500


def message(text: str) -> str:
    """What is wrong with a domain."""
    with pytest.raises(InputError) as caught:
        read_domain(Source("d.pddl", text))
    return str(caught.value)


def test_messages_say_where_and_what() -> None:
    start = "(define (domain d) (:predicates (p ?x) (q))\n"
    hint = "\n  hint: It begins `(define (domain NAME)`."
    assert message("") == "d.pddl:1:1: the file is empty" + hint
    assert message(start).startswith("d.pddl:1:1: this parenthesis is never closed")
    assert message(start + "))").startswith("d.pddl:2:2: this parenthesis closes nothing")
    assert "d.pddl:2:2: a domain has no section `:acton`" in message(start + "(:acton a))")
    assert "Did you mean `:action`?" in message(start + "(:acton a))")
    body = "(:action a :parameters (?x) :precondition {} :effect (q)))"
    assert "`p` takes 1 argument, 2 given" in message(start + body.replace("{}", "(p ?x ?x)"))
    assert "there is no variable `?y`" in message(start + body.replace("{}", "(p ?y)"))
    assert "there is no predicate `r`" in message(start + body.replace("{}", "(r)"))
    assert "there is no type `t`" in message(start + body.replace("(?x)", "(?x - t)"))
    for section in (":durative-action", ":derived", ":constraints"):
        assert "not supported" in message(start + f"({section} x))")
    assert "not supported" in message(start + "(:action a :effect (decrease (q) 1)))")
    deep = "(and " * (MAX_DEPTH + 1) + ")" * (MAX_DEPTH + 1)
    assert "parentheses within each other" in message(start + body.replace("{}", deep))


def test_a_task_that_is_too_large_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("domains.pddl.ground.reach.MAX_DERIVED", 10_000)
    domain = read_domain(
        Source("d", "(define (domain d) (:predicates (p ?a ?b ?c) (q))"
               "(:action a :parameters (?a ?b ?c) :effect (p ?a ?b ?c)))")
    )  # fmt: skip
    names = " ".join(f"o{i}" for i in range(40))
    text = f"(define (problem t) (:domain d) (:objects {names}) (:init) (:goal (q)))"
    task = read_task(Source("t", text), domain)
    with pytest.raises(InputError, match="too large"):
        ground(task)
