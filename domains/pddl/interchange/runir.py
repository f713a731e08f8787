"""Reads general policies of runir and mimir: constructors before their arguments, with `@`."""

from __future__ import annotations

import re

from domains.pddl.interchange.model import Element, NotTranslatedError, Policy, Rule
from sketchlang.errors import InputError

_TOKEN = re.compile(r'\s*(<[^>\s]+>|::=|->|\[[a-z_]+\]|"[^"]*"|@\w+|[{},]|[^\s{},<>"\[\]]+)')
MAX_DEPTH = 200

# Constructor: the name in dlplan, and what its arguments are: `e` element, `n` name, `t` truth.
CONSTRUCTORS = {
    "concept_bot": ("c_bot", ""),
    "concept_top": ("c_top", ""),
    "concept_atomic_state": ("c_primitive", "n"),
    "concept_atomic_goal": ("c_goal", "nt"),
    "concept_intersection": ("c_and", "ee"),
    "concept_union": ("c_or", "ee"),
    "concept_negation": ("c_not", "e"),
    "concept_value_restriction": ("c_all", "ee"),
    "concept_existential_quantification": ("c_some", "ee"),
    "concept_role_value_map_containment": ("c_subset", "ee"),
    "concept_role_value_map_equality": ("c_equal", "ee"),
    "concept_nominal": ("c_one_of", "n"),
    "role_universal": ("r_top", ""),
    "role_atomic_state": ("r_primitive", "n"),
    "role_atomic_goal": ("r_goal", "nt"),
    "role_intersection": ("r_and", "ee"),
    "role_union": ("r_or", "ee"),
    "role_complement": ("r_not", "e"),
    "role_inverse": ("r_inverse", "e"),
    "role_composition": ("r_compose", "ee"),
    "role_transitive_closure": ("r_transitive_closure", "e"),
    "role_reflexive_transitive_closure": ("r_transitive_reflexive_closure", "e"),
    "role_restriction": ("r_restrict", "ee"),
    "role_identity": ("r_identity", "e"),
    "boolean_atomic_state": ("b_nullary", "n"),
    "boolean_nonempty": ("b_nonempty", "e"),
    "numerical_count": ("n_count", "e"),
    "numerical_distance": ("n_concept_distance", "eee"),
}
"""Constructors: the name in dlplan, and what their arguments are."""

LITERALS = {
    "positive_boolean_condition": "pos",
    "negative_boolean_condition": "neg",
    "greater_numerical_condition": "gt",
    "equal_numerical_condition": "eq",
    "positive_boolean_effect": "pos",
    "negative_boolean_effect": "neg",
    "unchanged_boolean_effect": "bot",
    "increase_numerical_effect": "inc",
    "decrease_numerical_effect": "dec",
    "unchanged_numerical_effect": "bot",
}


def read(text: str, place: str) -> Policy:
    """The policy of a text.

    Raises:
        InputError: what is wrong with it, or not known here.
    """
    return _Reader(text, place).policy()


class _Reader:
    def __init__(self, text: str, place: str) -> None:
        self.place = place
        self.words = _TOKEN.findall(text)
        self.next = 0

    def fail(self, message: str) -> InputError:
        return InputError(message, place=self.place)

    def peek(self) -> str:
        return self.words[self.next] if self.next < len(self.words) else ""

    def take(self, wanted: str | None = None) -> str:
        word = self.peek()
        if not word or (wanted is not None and word != wanted):
            raise self.fail(f"expected {wanted or 'more'}, found {word or 'the end'}")
        self.next += 1
        return word

    def policy(self) -> Policy:
        features: dict[str, dict[str, Element]] = {
            "[boolean_features]": {},
            "[numerical_features]": {},
        }
        rules: list[Rule] = []
        while self.peek():
            section = self.take()
            if section in features:
                while self.peek().startswith("<"):
                    name = self.take().strip("<>")
                    self.take("::=")
                    features[section][name] = self.element(0)
            elif section == "[policy_rules]":
                while self.peek() == "{":
                    conditions = self.literals()
                    self.take("->")
                    rules.append(Rule(conditions, self.literals()))
            else:
                raise self.fail(f"there is no section {section}")
        booleans, numericals = features.values()
        return Policy(booleans, numericals, tuple(rules))

    def element(self, depth: int) -> Element:
        """A constructor and its arguments."""
        word = self.take()
        found = CONSTRUCTORS.get(word.removeprefix("@"))
        if found is None or depth > MAX_DEPTH:
            raise NotTranslatedError(f"`{word}` is not known", place=self.place)
        name, kinds = found
        arguments: list[Element | str] = []
        for kind in kinds:
            argument = self.element(depth + 1) if kind == "e" else self.take().strip('"')
            arguments.append(argument)
        return Element(name, tuple(arguments))

    def literals(self) -> tuple[tuple[str, str], ...]:
        """`{ @condition <feature>, ... }`"""
        found = []
        self.take("{")
        while self.peek() != "}":
            word = self.take().removeprefix("@")
            if word not in LITERALS:
                raise self.fail(f"`{word}` is no condition or effect")
            found.append((self.take().strip("<>"), LITERALS[word]))
            if self.peek() == ",":
                self.take()
        self.take("}")
        return tuple(found)
