"""Families of sketches that grow with the number of their features, as sketch files."""

from __future__ import annotations

import random
import string
from collections.abc import Callable, Sequence
from functools import partial


def chain(features: int) -> str:
    """Lexicographic: rule i lowers n_i and may change every n_j before it."""
    rules = []
    for i in range(features):
        conditions = [f"n{i} > 0", *(f"n{j} = 0" for j in range(i))]
        effects = [f"n{i}--", *(f"n{j}?" for j in range(i))]
        rules.append((f"lower{i}", conditions, effects))
    return _sketch("chain", [], [f"n{i}" for i in range(features)], rules)


def relay(features: int) -> str:
    """The same, but each step is in two moves as in pick-and-place, and rule `aside` may
    raise everything: only the policy graph shows that it never comes after a `pick`."""
    nats = [f"n{i}" for i in range(features - 2)]
    rules = []
    for i, nat in enumerate(nats):
        conditions = ["!H", f"{nat} > 0", *(f"{other} = 0" for other in nats[:i])]
        effects = ["H", "I", f"{nat}--", *(f"{other}?" for other in nats[:i])]
        rules.append((f"pick{i}", conditions, effects))
    rules.append(("aside", ["H", "!I"], ["!H", "I?", *(f"{nat}?" for nat in nats)]))
    rules.append(("place", ["H", "I"], ["!H", "I?"]))
    return _sketch("relay", ["H", "I"], nats, rules)


def copies(features: int) -> str:
    """Pick-and-place several times over, side by side, five features each."""
    booleans, nats, rules = [], [], []
    for c in range(features // 5):
        h, i, m, u, v = (f"{name}{c}" for name in "HImuv")
        booleans += [h, i]
        nats += [m, u, v]
        rules += [
            (
                f"pick_clear{c}",
                [f"!{h}", f"{m} > 0", f"{u} = 0"],
                [h, i, f"{m}--", f"{u}?", f"!{v}++"],
            ),
            (
                f"clear_way{c}",
                [f"!{h}", f"{m} > 0", f"{u} > 0"],
                [h, f"{i}?", f"{m}?", f"{u}?", f"{v}--"],
            ),
            (f"put_aside{c}", [h, f"!{i}"], [f"!{h}", f"{i}?", f"{m}?"]),
            (f"put_at_goal{c}", [h, i], [f"!{h}", f"{i}?"]),
        ]
    return _sketch("copies", booleans, nats, rules)


def endless(features: int) -> str:
    """The chain with a last rule that raises the first nat again: it does not terminate."""
    text = chain(features).replace("sketch chain", "sketch endless")
    zero = ", ".join(f"n{i} = 0" for i in range(features))
    return text + f"rule again {{ {zero} }} -> {{ n{features - 1}++ }}\n"


def gray(features: int, closed: bool = False) -> str:
    """A Gray code counter of Booleans: its policy graph is one path through half of all
    valuations. As hard as it gets: nothing but the whole graph shows that it ends.

    The closed code goes on from its last valuation to its first, so it does not terminate.
    """
    bits = [f"b{i}" for i in range(features - 1)]
    rules = []
    for value, sign in ((False, "!"), (True, "")):
        flip = "!" if value else ""
        rules.append((f"even{int(value)}", ["!p", sign + bits[0]], ["p", flip + bits[0]]))
        for i in range(len(bits) - 1):
            if value and i == len(bits) - 2 and not closed:
                continue
            lower = [f"!{bit}" for bit in bits[:i]]
            conditions = ["p", *lower, bits[i], sign + bits[i + 1]]
            rules.append((f"odd{i}_{int(value)}", conditions, ["!p", flip + bits[i + 1]]))
        if closed:
            # From the last word only the highest bit is left to turn, and the same way back.
            conditions = ["p", *(f"!{bit}" for bit in bits[:-1]), sign + bits[-1]]
            rules.append((f"last{int(value)}", conditions, ["!p", flip + bits[-1]]))
    return _sketch("gray", ["p", *bits], [], rules)


def weighted_sum(features: int, rules: int | None = None, seed: int = 0) -> str:
    """Booleans with random weights from 1 to 1000. Each rule tests and turns three or four of
    them so that the sum of the weights of those that are true falls."""
    rng = random.Random(seed)
    # Short names: a file may have 100,000 characters.
    bits = _names(features)
    weights = [rng.randint(1, 1000) for _ in bits]
    made: dict[tuple[tuple[int, bool], ...], None] = {}
    while len(made) < (25 * features if rules is None else rules):
        chosen = sorted(rng.sample(range(features), rng.choice((3, 4))))
        before = [rng.random() < 0.5 for _ in chosen]
        change = sum(
            -weights[b] if true else weights[b] for b, true in zip(chosen, before, strict=True)
        )
        if change > 0:
            before = [not true for true in before]
        if change:
            made[tuple(zip(chosen, before, strict=True))] = None
    return _sketch(
        "weighted_sum",
        bits,
        [],
        [
            (
                f"r{number}",
                [("" if true else "!") + bits[b] for b, true in rule],
                [("!" if true else "") + bits[b] for b, true in rule],
            )
            for number, rule in enumerate(made)
        ],
    )


def ring(features: int) -> str:
    """Booleans in a ring, each of which may turn to what both of its neighbours are."""
    bits = [f"b{i}" for i in range(features)]
    rules = []
    for i, bit in enumerate(bits):
        left, right = bits[i - 1], bits[(i + 1) % features]
        rules.append((f"clear{i}", ["!" + left, bit, "!" + right], ["!" + bit]))
        rules.append((f"set{i}", [left, "!" + bit, right], [bit]))
    return _sketch("ring", bits, [], rules)


def token(features: int) -> str:
    """Booleans in a ring: one that is true may make the next one true instead of itself."""
    bits = [f"b{i}" for i in range(features)]
    rules = []
    for i, bit in enumerate(bits):
        after = bits[(i + 1) % features]
        rules.append((f"pass{i}", [bit, f"!{after}"], [f"!{bit}", after]))
    return _sketch("token", bits, [], rules)


def dense(features: int, rules: int | None = None, seed: int = 0) -> str:
    """Random rules over Booleans and nats, most of which test and change a few of them; each
    lowers a nat or turns a Boolean for certain."""
    rng = random.Random(seed)
    nats = [f"n{i}" for i in range(features // 2)]
    bits = [f"b{i}" for i in range(features - len(nats))]
    made = []
    for number in range(8 * features if rules is None else rules):
        conditions, effects = {}, {}
        for name in [*nats, *bits]:
            if rng.random() < 0.2:
                conditions[name] = rng.random() < 0.5
            if rng.random() < 0.1:
                choices = ("{}--", "{}--", "{}++", "{}?") if name in nats else ("{}", "!{}")
                effects[name] = rng.choice(choices).format(name)
        sure = rng.choice([*nats, *bits])
        if sure in nats:
            effects[sure] = f"{sure}--"
        else:
            true = conditions.setdefault(sure, rng.random() < 0.5)
            effects[sure] = f"!{sure}" if true else sure
        for name, effect in effects.items():
            if effect.endswith("--"):
                conditions[name] = True
        tests = [_condition(name, true, name in nats) for name, true in conditions.items()]
        made.append((f"r{number}", tests, list(effects.values())))
    return _sketch("dense", bits, nats, made)


def mixed(features: int, rules: int | None = None, seed: int = 0) -> str:
    """Random rules with all effects, each about three features, often a goal, an invariant, and
    nats that are bounded. Some effects are sure to happen, so that some sketches terminate."""
    rng = random.Random(seed)
    nats = [f"n{i}" for i in range(features // 2)]
    bits = [f"b{i}" for i in range(features - len(nats))]
    names = [*nats, *bits]
    made = []
    for number in range(features if rules is None else rules):
        conditions = {name: rng.random() < 0.5 for name in names if rng.random() < 3 / features}
        effects = {}
        for name in names:
            if rng.random() < 3 / features:
                kinds = ("{}--", "{}--", "{}++", "!{}++", "!{}--", "{}?")
                choices = kinds if name in nats else ("{}", "!{}", "{}?")
                effects[name] = rng.choice(choices).format(name)
        for name, effect in effects.items():
            if effect == f"{name}--":
                conditions[name] = True
            elif effect in (name, f"!{name}"):
                conditions[name] = effect != name
        tests = [_condition(name, true, name in nats) for name, true in conditions.items()]
        made.append((f"r{number}", tests, list(effects.values())))
    text = _sketch("mixed", bits, nats, made)
    for name in nats:
        if rng.random() < 0.25:
            text = text.replace(f"feature {name} ", f"bounded feature {name} ")
    some = rng.sample(names, 4)
    if rng.random() < 0.5:
        text += f"goal {{ {_condition(some[0], rng.random() < 0.5, some[0] in nats)} }}\n"
    if rng.random() < 0.5:
        facts = [_condition(name, rng.random() < 0.5, name in nats) for name in some[1:3]]
        text += "invariant " + " or ".join(fact.replace("!", "not ") for fact in facts) + "\n"
    return text


def _names(count: int) -> list[str]:
    letters = string.ascii_letters
    return [letters[i] if i < len(letters) else f"x{i}" for i in range(count)]


def _condition(name: str, true: bool, nat: bool) -> str:
    if nat:
        return f"{name} > 0" if true else f"{name} = 0"
    return name if true else f"!{name}"


FAMILIES: dict[str, Callable[..., str]] = {
    "chain": chain,
    "relay": relay,
    "copies": copies,
    "endless": endless,
    "gray": gray,
    "closed": partial(gray, closed=True),
    "weighted_sum": weighted_sum,
    "ring": ring,
    "token": token,
    "dense": dense,
    "mixed": mixed,
}
"""By name; some take a number of rules and a seed as well."""


def _sketch(
    name: str,
    booleans: Sequence[str],
    nats: Sequence[str],
    rules: Sequence[tuple[str, Sequence[str], Sequence[str]]],
) -> str:
    lines = [f"sketch {name}"]
    lines += [f"feature {feature} : bool" for feature in booleans]
    lines += [f"feature {feature} : nat" for feature in nats]
    for rule, conditions, effects in rules:
        lines.append(f"rule {rule} {{ {','.join(conditions)} }} -> {{ {','.join(effects)} }}")
    return "\n".join(lines) + "\n"
