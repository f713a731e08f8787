"""Runs in an environment that has dlplan, and nothing of this project: reads policies, states and
pairs of states as JSON, and writes feature values and the rules that pairs satisfy.

    {"policy": TEXT, "predicates": {NAME: ARITY}, "constants": [NAME], "objects": [NAME],
     "static": [[NAME, ARGUMENT...]], "states": [[[NAME, ARGUMENT...]]], "pairs": [[I, J]]}

becomes `{"values": [{FEATURE: VALUE}], "rules": [[NUMBER]], "seconds": S}` with rules counted from
0, and the processor time that the values took. Policies of the older dialect, whose features have
numbers, are written in the newer one first.
"""

from __future__ import annotations

import json
import re
import sys
import time
from typing import Any


def modern(text: str) -> str:
    """A policy in the dialect of features with names: `b0`, `n0` for the numbered ones."""
    if ":boolean_features" not in text:
        return text
    start = text.index("(:rule")
    head, rules = text[:start], text[start:]
    parts = head.split("(:numerical_features")
    sections = []
    for kind, name, part in zip("bn", ("booleans", "numericals"), parts, strict=True):
        found = []
        for number, feature in enumerate(re.findall(r'"([^"]*)"', part)):
            short = re.sub(r",(?=\))", "", re.sub(r"\s+", "", feature))
            found.append(f'({kind}{number} "{short}")')
        sections.append(f"(:{name} {' '.join(found)})")
    rules = re.sub(r"\(:([ce])_([bn])_(\w+)\s+(\d+)\)", r"(:\1_\2_\3 \2\4)", rules)
    return f"(:policy {' '.join(sections)} {rules}"


def answer(question: dict[str, Any]) -> dict[str, Any]:
    """What the library says."""
    from dlplan import core
    from dlplan import policy as policies

    vocabulary = core.VocabularyInfo()
    for name, arity in question["predicates"].items():
        vocabulary.add_predicate(name, arity)
    for name in question["constants"]:
        vocabulary.add_constant(name)
    instance = core.InstanceInfo(0, vocabulary)
    for name in question["objects"]:
        instance.add_object(name)
    for atom in question["static"]:
        instance.add_static_atom(atom[0], atom[1:])
    atoms: dict[tuple[str, ...], Any] = {}
    for found in question["states"]:
        for atom in found:
            if tuple(atom) not in atoms:
                atoms[tuple(atom)] = instance.add_atom(atom[0], atom[1:])
    states = [
        core.State(number, instance, [atoms[tuple(atom)] for atom in found])
        for number, found in enumerate(question["states"])
    ]
    factory = policies.PolicyFactory(core.SyntacticElementFactory(vocabulary))
    policy = factory.parse_policy(modern(question["policy"]))
    named = {f.get_key(): f for f in (*policy.get_booleans(), *policy.get_numericals())}
    caches = core.DenotationsCaches()
    begun = time.process_time()
    values = [
        {key: int(f.get_element().evaluate(state, caches)) for key, f in named.items()}
        for state in states
    ]
    seconds = time.process_time() - begun
    rules = sorted(policy.get_rules(), key=lambda rule: rule.get_index())
    satisfied = [
        [
            number
            for number, rule in enumerate(rules)
            if rule.evaluate_conditions(states[i]) and rule.evaluate_effects(states[i], states[j])
        ]
        for i, j in question["pairs"]
    ]
    return {"values": values, "rules": satisfied, "seconds": seconds}


if __name__ == "__main__":
    json.dump(answer(json.load(sys.stdin)), sys.stdout)
