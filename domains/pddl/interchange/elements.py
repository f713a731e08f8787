"""Elements of description logic from predicates and other elements, and looks at expressions."""

from __future__ import annotations

from collections.abc import Iterator

from domains.pddl.features.compiler import Meaning
from domains.pddl.interchange.model import Element
from domains.pddl.interchange.translate import UNREACHABLE
from sketchlang.checking.typed import MANY, ONE, OPEN, Node

TOP, BOTTOM = Element("c_top", ()), Element("c_bot", ())


def element(name: str, *arguments: Element | str) -> Element:
    """An element; unions and intersections with everything or nothing are left out."""
    if name == "c_and" and TOP in arguments:
        (other,) = [part for part in arguments if part != TOP] or [TOP]
        assert isinstance(other, Element)
        return other
    if name == "r_restrict" and arguments[1] == TOP:
        assert isinstance(arguments[0], Element)
        return arguments[0]
    inner = arguments[0] if arguments else None
    if name in ("c_not", "r_inverse") and isinstance(inner, Element):
        if inner.name == name:
            found = inner.arguments[0]
            assert isinstance(found, Element)
            return found
        if name == "r_inverse" and inner.name == "r_primitive":
            predicate, first, second = inner.arguments
            return Element("r_primitive", (predicate, second, first))
    return Element(name, arguments)


def is_infinite_distance(node: Node) -> bool:
    """`if some x in R*(A, _) & B: true then distance(A, R, B) else 1000000000`, by which imported
    policies say that a distance is infinite."""
    condition, distance, otherwise = node.parts
    if distance.kind != "distance" or (otherwise.kind, otherwise.value) != (
        "constant",
        UNREACHABLE,
    ):
        return False
    start, relation, end = distance.parts
    over = condition.parts[0] if condition.kind == "some" else condition
    if over.kind != "&" or len(over.parts) != 2 or over.parts[1] is not end:
        return False
    if any(part.kind != "constant" or not part.value for part in condition.parts[1:]):
        return False
    near = over.parts[0]
    return (
        near.kind == "apply*"
        and near.parts[0] is relation
        and near.parts[1] is start
        and (near.value in ((ONE, OPEN), (MANY, OPEN)))
    )


def level_of(node: Node) -> int:
    """The level of a binder's variable."""
    assert isinstance(node.value, int)
    return node.value


def name_of(meaning: Meaning) -> str:
    """A predicate's name there: with `_g` where it is the goal's."""
    return f"{meaning.name}_g" if meaning.goal else meaning.name


def primitive(meaning: Meaning, first: int, second: int) -> Element:
    """The role between two places of a predicate."""
    return element("r_primitive", name_of(meaning), str(first), str(second))


def between(start: Element, role: Element, end: Element) -> Element:
    """The pairs of a role from one set to another."""
    found = element("r_restrict", role, end)
    if start == TOP:
        return found
    return element("r_inverse", element("r_restrict", element("r_inverse", found), start))


def conjuncts(*nodes: Node) -> Iterator[Node]:
    """Conditions taken apart, without what is always true."""
    for node in nodes:
        if node.kind == "and":
            yield from conjuncts(*node.parts)
        elif node.kind != "constant" or not node.value:
            yield node
