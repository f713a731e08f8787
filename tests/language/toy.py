"""A domain for tests: boxes and marks with arbitrary tables behind its functions, and random
sketches over it."""

from __future__ import annotations

from dataclasses import dataclass

from hypothesis import strategies as st

from sketchlang.domain import Domain, Nat

domain = Domain("toy")


@domain.sort
@dataclass(frozen=True)
class Box:
    number: int


@domain.sort
@dataclass(frozen=True)
class Mark:
    number: int


@dataclass
class State:
    """Tables that the functions read; `calls` counts them."""

    boxes: int
    marks: int
    seed: int
    calls: int = 0

    def draw(self, *key: int) -> int:
        """A number that follows from seed and key."""
        self.calls += 1
        value = self.seed
        for part in key:
            value = (value * 1103515245 + part * 12345 + 7) % 2147483648
        return value >> 8


@domain.function
def boxes(state: State) -> tuple[Box, ...]:
    """All boxes."""
    state.calls += 1
    return tuple(Box(i) for i in range(state.boxes))


@domain.function
def marks_of(state: State, box: Box) -> frozenset[Mark]:
    """Some marks for each box."""
    return frozenset(Mark(i) for i in range(state.marks) if state.draw(1, box.number, i) % 2)


@domain.function
def first(state: State) -> Box:
    """A box."""
    return Box(state.draw(2) % max(1, state.boxes))


@domain.function
def open_(state: State, box: Box) -> bool:
    """Whether a box is open."""
    return state.draw(3, box.number) % 2 == 0


@domain.function
def fits(state: State, box: Box, mark: Mark) -> bool:
    """Whether a mark fits a box."""
    return state.draw(4, box.number, mark.number) % 3 == 0


@domain.function
def weight(state: State, box: Box) -> Nat:
    """A number for each box."""
    return state.draw(5, box.number) % 4


@domain.function
def rank(state: State, mark: Mark) -> Nat:
    """A number for each mark."""
    return state.draw(6, mark.number) % 4


@domain.function
def scale(state: State, number: Nat) -> Nat:
    """A number for each number."""
    return state.draw(7, number) % 5


@domain.function
def raining(state: State) -> bool:
    """A truth value."""
    return state.draw(8) % 2 == 0


states = st.builds(State, st.integers(0, 4), st.integers(0, 3), st.integers(0, 2**31 - 1))

Scope = tuple[tuple[str, str], ...]
"""Local names with their types."""


@st.composite
def expression(  # noqa: PLR0912 (one case for every construct)
    draw: st.DrawFn, kind: str, scope: Scope, known: Scope, depth: int
) -> str:
    """A well-typed expression; `known` are features and definitions without parameters."""
    leaves = [name for name, type_ in (*scope, *known) if type_ == kind]
    boxes_here = [name for name, type_ in scope if type_ == "Box"]
    marks_here = [name for name, type_ in scope if type_ == "Mark"]
    inner = depth - 1

    def sub(wanted: str, names: Scope = scope) -> str:
        return draw(expression(wanted, names, known, inner))

    if kind == "Box":
        return draw(st.sampled_from([*boxes_here, "first"]))
    if kind == "bool":
        choices = ["true", "false", "raining", "raining()", *leaves]
        choices += [f"open_({box})" for box in boxes_here]
        choices += [f"fits({b}, {m})" for b in boxes_here for m in marks_here]
        if depth > 0:
            choices += ["not", "and", "or", "->", "compare", "equal", "in", "some", "all"]
    else:
        choices = ["0", "1", "2", *leaves]
        choices += [f"weight({box})" for box in boxes_here]
        choices += [f"rank({mark})" for mark in marks_here]
        if depth > 0:
            choices += ["+", "scale", "weight", "count", "sum", "min", "max"]
    choice: str = draw(st.sampled_from(choices))
    match choice:
        case "not":
            return f"not ({sub('bool')})"
        case "and" | "or":
            parts = [f"({sub('bool')})" for _ in range(draw(st.integers(2, 3)))]
            return f" {choice} ".join(parts)
        case "->":
            return f"({sub('bool')}) -> ({sub('bool')})"
        case "+":
            return " + ".join(f"({sub('nat')})" for _ in range(draw(st.integers(2, 3))))
        case "compare":
            sign = draw(st.sampled_from(["<", "<=", ">", ">=", "=", "!="]))
            return f"({sub('nat')}) {sign} ({sub('nat')})"
        case "equal":
            wanted = draw(st.sampled_from(["bool", "Box"]))
            sign = draw(st.sampled_from(["=", "!="]))
            return f"({sub(wanted)}) {sign} ({sub(wanted)})"
        case "in":
            return f"({sub('Box')}) in boxes"
        case "scale":
            return f"scale({sub('nat')})"
        case "weight":
            return f"weight({sub('Box')})"
        case "some" | "all" | "count" | "sum" | "min" | "max":
            variable = f"x{len(scope)}"
            marks = draw(st.booleans())
            over = f"marks_of({sub('Box')})" if marks else "boxes"
            names = (*scope, (variable, "Mark" if marks else "Box"))
            where = f" where {sub('bool', names)}" if draw(st.booleans()) else ""
            body = sub("bool" if choice in ("some", "all", "count") else "nat", names)
            default = ""
            if choice in ("min", "max") and draw(st.booleans()):
                default = f" default {sub('nat')}"
            return f"({choice} {variable} in {over}{where}: ({body}){default})"
    return choice


@st.composite
def sketches(draw: st.DrawFn) -> str:
    """A sketch with definitions and features, each of which may use those before it."""
    lines = ["sketch toy_sketch", "use toy"]
    known: Scope = ()
    for number in range(draw(st.integers(0, 2))):
        kind = draw(st.sampled_from(["bool", "nat"]))
        scope: Scope = (("p", "Box"),) if draw(st.booleans()) else ()
        body = draw(expression(kind, scope, known, 2))
        if scope:
            lines.append(f"define d{number}(p : Box) = {body}")
            known = (*known, (f"d{number}(first)", kind))
        else:
            lines.append(f"define d{number} = {body}")
            known = (*known, (f"d{number}", kind))
    for number in range(draw(st.integers(1, 4))):
        kind = draw(st.sampled_from(["bool", "nat"]))
        lines.append(f"feature f{number} : {kind} = {draw(expression(kind, (), known, 3))}")
        known = (*known, (f"f{number}", kind))
    return "\n".join(lines) + "\n"
