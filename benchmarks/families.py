"""Families of sketches that grow with the number of their features, as sketch files."""

from __future__ import annotations

from collections.abc import Sequence


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


def gray(features: int) -> str:
    """A Gray code counter of Booleans: its policy graph is one path through half of all
    valuations. As hard as it gets: nothing but the whole graph shows that it ends."""
    bits = [f"b{i}" for i in range(features - 1)]
    rules = []
    for value, sign in ((False, "!"), (True, "")):
        flip = "!" if value else ""
        rules.append((f"even{int(value)}", ["!p", sign + bits[0]], ["p", flip + bits[0]]))
        for i in range(len(bits) - 1):
            if value and i == len(bits) - 2:
                continue
            lower = [f"!{bit}" for bit in bits[:i]]
            conditions = ["p", *lower, bits[i], sign + bits[i + 1]]
            rules.append((f"odd{i}_{int(value)}", conditions, ["!p", flip + bits[i + 1]]))
    return _sketch("gray", ["p", *bits], [], rules)


FAMILIES = {"chain": chain, "relay": relay, "copies": copies, "endless": endless, "gray": gray}


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
        lines.append(f"rule {rule} {{ {', '.join(conditions)} }} -> {{ {', '.join(effects)} }}")
    return "\n".join(lines) + "\n"
