"""Random small PDDL tasks, as texts: types, constants, quantifiers, conditional effects."""

from __future__ import annotations

import random

TYPES = {"thing": "object", "box": "thing", "ball": "thing", "room": "object"}
PREDICATES = {
    "lit": ("room",),
    "in": ("thing", "room"),
    "on": ("thing", "thing"),
    "full": ("box",),
    "done": (),
    "joined": ("room", "room"),  # no action changes it
    "heavy": ("thing",),  # nor this
}
STATIC = ("joined", "heavy")
OBJECTS = {"box": 2, "ball": 2, "room": 2}


class Maker:
    """Draws the parts of a domain and a task from a generator."""

    def __init__(self, seed: int) -> None:
        self.rng = random.Random(seed)
        self.used = 0

    def domain(self) -> str:
        """The text of a domain."""
        types = " ".join(f"{name} - {above}" for name, above in TYPES.items())
        predicates = " ".join(
            f"({name} {' '.join(f'?x{i} - {t}' for i, t in enumerate(sorts))})"
            for name, sorts in PREDICATES.items()
        )
        actions = "\n".join(self.action(number) for number in range(self.rng.randint(1, 4)))
        return (
            f"(define (domain rooms) (:requirements :adl)\n(:types {types})\n"
            f"(:constants hall - room)\n(:predicates {predicates})\n{actions})\n"
        )

    def task(self) -> str:
        """The text of a task."""
        listed = [(f"{t}{i}", t) for t, count in OBJECTS.items() for i in range(count)]
        names = dict(listed) | {"hall": "room"}
        facts = []
        for predicate, sorts in PREDICATES.items():
            for _ in range(self.rng.randint(0, 4)):
                terms = [self.object(names, sort) for sort in sorts]
                facts.append(f"({' '.join((predicate, *terms))})")
        return (
            "(define (problem p) (:domain rooms)\n(:objects "
            + " ".join(f"{name} - {sort}" for name, sort in listed)
            + f")\n(:init {' '.join(dict.fromkeys(facts))})\n(:goal {self.condition(names, 2)}))\n"
        )

    def object(self, names: dict[str, str], sort: str) -> str:
        """A name of a sort or one below it."""
        return self.rng.choice([name for name, own in names.items() if _below(own, sort)])

    def action(self, number: int) -> str:
        """The text of an action."""
        scope = {"hall": "room"}
        for i in range(self.rng.randint(0, 3)):
            scope[f"?v{i}"] = self.rng.choice(list(TYPES))
        parameters = " ".join(f"{n} - {t}" for n, t in scope.items() if n.startswith("?"))
        effects = " ".join(self.effect(scope) for _ in range(self.rng.randint(1, 3)))
        return (
            f"(:action act{number} :parameters ({parameters})\n"
            f" :precondition {self.condition(scope, 2)}\n :effect (and {effects}))"
        )

    def atom(self, scope: dict[str, str], changing: bool = False) -> str:
        """An atom over the names of a scope; `(done)` where nothing else can be said."""
        names = [name for name in PREDICATES if not (changing and name in STATIC)]
        for _ in range(5):
            name = self.rng.choice(names)
            options = [
                [n for n, own in scope.items() if _below(own, sort)] for sort in PREDICATES[name]
            ]
            if all(options):
                return f"({' '.join((name, *map(self.rng.choice, options)))})"
        return "(done)"

    def condition(self, scope: dict[str, str], depth: int) -> str:
        """A condition."""
        kind = self.rng.randint(0, 9) if depth else self.rng.randint(0, 4)
        if kind <= 2:
            return self.atom(scope)
        if kind == 3:
            return f"(not {self.atom(scope)})"
        if kind == 4:
            both = self.rng.choices(list(scope), k=2)
            equal = f"(= {both[0]} {both[1]})"
            return equal if self.rng.random() < 0.5 else f"(not {equal})"
        if kind <= 7:
            word = self.rng.choice(["and", "and", "or", "imply"])
            count = 2 if word == "imply" else self.rng.randint(0 if word == "and" else 1, 3)
            parts = " ".join(self.condition(scope, depth - 1) for _ in range(count))
            return f"({word} {parts})"
        if kind == 8:
            return f"(not {self.condition(scope, depth - 1)})"
        name, sort = self.variable()
        inner = self.condition({**scope, name: sort}, depth - 1)
        return f"({self.rng.choice(['forall', 'exists'])} ({name} - {sort}) {inner})"

    def variable(self) -> tuple[str, str]:
        """A fresh variable with its type."""
        self.used += 1
        return f"?q{self.used}", self.rng.choice(list(TYPES))

    def effect(self, scope: dict[str, str]) -> str:
        """An effect, perhaps of all objects, perhaps under a condition."""
        if self.rng.random() < 0.3:
            name, sort = self.variable()
            return f"(forall ({name} - {sort}) {self.effect({**scope, name: sort})})"
        literal = self.atom(scope, changing=True)
        if self.rng.random() < 0.4:
            literal = f"(not {literal})"
        if self.rng.random() < 0.4:
            return f"(when {self.condition(scope, 1)} {literal})"
        return literal


def _below(sort: str, above: str) -> bool:
    while sort != above and sort in TYPES:
        sort = TYPES[sort]
    return sort == above


def texts(seed: int) -> tuple[str, str]:
    """Domain and task of a seed."""
    maker = Maker(seed)
    return maker.domain(), maker.task()
