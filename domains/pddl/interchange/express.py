"""Expressions to elements of description logic, which has no variables: a condition on one variable
becomes a concept, one on two a role. What has no such form is named."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import cast

from domains.pddl.features.called import function_of
from domains.pddl.features.compiler import Meaning
from domains.pddl.interchange.elements import (
    BOTTOM,
    TOP,
    between,
    conjuncts,
    element,
    is_infinite_distance,
    level_of,
    name_of,
    primitive,
)
from domains.pddl.interchange.model import Element, NotTranslatedError
from domains.pddl.syntax.model import OBJECT
from sketchlang.checking.typed import ONE, OPEN, Node
from sketchlang.domain import Function


@dataclass(frozen=True)
class Expresser:
    """Writes the expressions of a sketch over a PDDL domain. `meanings` tells what its functions
    are in PDDL, `sorts` maps names of sorts to those of types."""

    meanings: Mapping[Function, Meaning]
    sorts: Mapping[str, str]

    # Features.

    def boolean(self, node: Node) -> tuple[Element, bool]:
        """A truth value: an element, and whether the feature is true where that is true."""
        match node.kind:
            case "not":
                found, positive = self.boolean(node.parts[0])
                return found, not positive
            case "some" | "all":
                return element("b_empty", self._chosen(node)), node.kind == "all"
            case "subset":
                first, second = node.parts
                if first.type.is_relation:
                    return element("b_inclusion", self.role(first), self.role(second)), True
                return element("b_inclusion", self.concept(first), self.concept(second)), True
            case "call" if not node.parts:
                meaning = self._meaning(node)
                if meaning.kind == "predicate":
                    return element("b_nullary", name_of(meaning)), True
            case "image" | "apply" | "apply+" | "apply*" | "call" if not node.free:
                # One end is left open, and there has to be something at it.
                return element("b_empty", self._first_end(node)), False
        raise self._fail(node)

    def number(self, node: Node) -> Element:
        """A number."""
        match node.kind:
            case "count":
                return element("n_count", self._chosen(node))
            case "sum":
                over, condition, body = node.parts
                level = level_of(node)
                if body.kind == "count":
                    start = element("c_and", self.concept(over), self.holds(condition, level))
                    role = self._links(body, level)
                    return element("n_count", between(start, role, TOP))
            case "if" if is_infinite_distance(node):
                return self.number(node.parts[1])
            case "distance":
                source, relation, target = node.parts
                ends = self.concept(source), self.concept(target)
                return element("n_concept_distance", ends[0], self.role(relation), ends[1])
        raise self._fail(node)

    # Sets.

    def concept(self, node: Node) -> Element:
        """A set without variables, or an element as the set of it alone."""
        if node.free:
            raise self._fail(node)
        match node.kind:
            case "call":
                meaning = self._meaning(node)
                if meaning.kind == "constant":
                    return element("c_one_of", meaning.name)
                if meaning.kind == "type":
                    return self._type(meaning.name)
            case "image":
                return self._image(node, None)
            case "apply" | "apply+" | "apply*":
                return self._apply(node, None)
            case "list":
                found, *others = [self.concept(part) for part in node.parts]
                for other in others:
                    found = element("c_or", found, other)
                return found
            case "set":
                over, condition = node.parts
                return element("c_and", self.concept(over), self.holds(condition, level_of(node)))
            case "|" | "&" | "-":
                return self._folded({"|": "c_or", "&": "c_and", "-": "c_diff"}, node, self.concept)
        raise self._fail(node)

    def _type(self, name: str) -> Element:
        return TOP if name == OBJECT else element("c_primitive", name, "0")

    def _chosen(self, node: Node) -> Element:
        """What a quantifier goes through and its conditions hold of; of `all`, the exceptions."""
        over, condition, body = node.parts
        level = level_of(node)
        found = element("c_and", self.concept(over), self.holds(condition, level))
        inner = self.holds(body, level)
        if node.kind == "all":
            inner = BOTTOM if inner == TOP else element("c_not", inner)
        return element("c_and", found, inner)

    def holds(self, node: Node, level: int) -> Element:  # noqa: PLR0912 (a case for each kind)
        """What a condition on the variable of a level is true of."""
        if node.kind == "constant":
            return TOP if node.value else BOTTOM
        if node.free != {level}:
            raise self._fail(node)
        match node.kind:
            case "not":
                return element("c_not", self.holds(node.parts[0], level))
            case "and" | "or":
                name = f"c_{node.kind}"
                found, *others = [self.holds(part, level) for part in node.parts]
                for other in others:
                    found = element(name, found, other)
                return found
            case "->":
                before, after = [self.holds(part, level) for part in node.parts]
                return element("c_or", element("c_not", before), after)
            case "in" if node.parts[0].kind == "variable" and not node.parts[1].free:
                return self.concept(node.parts[1])
            case "=" if any(part.kind == "variable" for part in node.parts):
                closed = [part for part in node.parts if not part.free]
                if len(closed) == 1:
                    return self.concept(closed[0])
            case "call" | "image":
                return self._image(node, level)
            case "apply" | "apply+" | "apply*":
                return self._apply(node, level)
            case "subset" | "same":
                return self._compared(node, level)
            case "some":
                return element("c_some", self._links(node, level), TOP)
            case "all":
                over, condition, body = node.parts
                role = self._linked(over, condition, None, level, level_of(node))
                return element("c_all", role, self.holds(body, level_of(node)))
        raise self._fail(node)

    def _compared(self, node: Node, level: int) -> Element:
        """`p(x, _) <= q(x, _)`, or `<= A`."""
        first, second = node.parts
        if level in first.free and level in second.free:
            name = "c_subset" if node.kind == "subset" else "c_equal"
            return element(name, self.row(first, level), self.row(second, level))
        if node.kind == "subset" and level in first.free:
            return element("c_all", self.row(first, level), self.concept(second))
        raise self._fail(node)

    # Predicates and relations with arguments.

    def _image(self, node: Node, level: int | None) -> Element:
        """A predicate with something in some places: what fits in the place that is open, or that
        the variable of a level has."""
        meaning = self._meaning(node)
        pattern = node.value[1] if node.kind == "image" else (ONE,) * len(node.parts)  # type: ignore[index]
        if meaning.kind != "predicate":
            raise self._fail(node)
        given = iter(node.parts)
        own: list[int] = []
        ends: dict[int, Element] = {}
        for place, word in enumerate(pattern):
            if word == OPEN:
                own.append(place)
                continue
            part = next(given)
            if word == ONE and level is not None and part.kind == "variable":
                own.append(place)
            else:
                end = self.concept(part)
                if end != TOP:
                    ends[place] = end
        if len(own) != 1 or len(ends) > 1:
            raise self._fail(node)
        (place,) = own
        if not ends:
            return element("c_primitive", name_of(meaning), str(place))
        ((other, end),) = ends.items()
        return element("c_some", primitive(meaning, place, other), end)

    def _apply(self, node: Node, level: int | None) -> Element:
        """A relation or its closure, with one end open or the variable of a level."""
        relation, *arguments = node.parts
        given = iter(arguments)
        words = cast(tuple[str, str], node.value)
        sides = [None if word == OPEN else next(given) for word in words]
        free = [side is None or (level is not None and side.kind == "variable") for side in sides]
        if sum(free) != 1:
            raise self._fail(node)
        end = sides[1 if free[0] else 0]
        assert end is not None
        role = self.role(relation)
        role = role if free[0] else element("r_inverse", role)
        target = self.concept(end)
        if node.kind == "apply":
            return element("c_some", role, target)
        found = element("c_some", element("r_transitive_closure", role), target)
        return found if node.kind == "apply+" else element("c_or", found, target)

    def _first_end(self, node: Node) -> Element:
        """`p(A, B)`: the elements of `A` from which there is a way."""
        if node.kind in ("image", "call"):
            meaning = self._meaning(node)
            if meaning.kind == "predicate" and len(node.parts) == 1:
                return element(
                    "c_and",
                    self.concept(node.parts[0]),
                    element("c_primitive", name_of(meaning), "0"),
                )
            if meaning.kind == "predicate" and len(node.parts) == 2:
                start, end = (self.concept(part) for part in node.parts)
                way = element("c_some", primitive(meaning, 0, 1), end)
                return element("c_and", start, way)
            raise self._fail(node)
        relation, first, last = node.parts
        role, start, end = self.role(relation), self.concept(first), self.concept(last)
        if node.kind != "apply":
            role = element("r_transitive_closure", role)
        way = element("c_some", role, end)
        return element("c_and", start, element("c_or", way, end) if node.kind == "apply*" else way)

    def row(self, node: Node, level: int) -> Element:
        """The role from the variable of a level to the elements of a set."""
        match node.kind:
            case "image" if len(node.parts) >= 1:
                meaning = self._meaning(node)
                pattern = node.value[1]  # type: ignore[index]
                places = [place for place, word in enumerate(pattern) if word == OPEN]
                given = dict(zip(
                    [p for p, word in enumerate(pattern) if word != OPEN], node.parts, strict=True
                ))  # fmt: skip
                own = [p for p, part in given.items() if part.kind == "variable"]
                rest = [part for p, part in given.items() if p not in own]
                if len(given) == len(places) == 1 and not own:
                    ((at, through),) = given.items()
                    step = primitive(meaning, at, places[0])
                    return element("r_compose", self.row(through, level), step)
                single = len(own) == 1 and len(places) == 1 and pattern[own[0]] == ONE
                if single and all(self.concept(part) == TOP for part in rest):
                    return primitive(meaning, own[0], places[0])
            case "apply" | "apply+" | "apply*" if len(node.parts) == 2:
                relation, argument = node.parts
                if argument.kind == "variable" and not relation.free:
                    role = self.role(relation)
                    if node.value != (ONE, OPEN):
                        role = element("r_inverse", role)
                    closed = element("r_transitive_closure", role)
                    if node.kind == "apply*":
                        return element("r_or", closed, element("r_identity", TOP))
                    return role if node.kind == "apply" else closed
            case "&" | "-":
                first, *others = node.parts
                found = self.row(first, level)
                for other in others:
                    if level in other.free:
                        name = {"&": "r_and", "-": "r_diff"}[node.kind]
                        found = element(name, found, self.row(other, level))
                    else:
                        end = self.concept(other)
                        end = end if node.kind == "&" else element("c_not", end)
                        found = element("r_restrict", found, end)
                return found
            case "|":
                return self._folded({"|": "r_or"}, node, lambda part: self.row(part, level))
        raise self._fail(node)

    # Relations.

    def role(self, node: Node) -> Element:
        """A relation without variables."""
        if node.free:
            raise self._fail(node)
        parts = node.parts
        match node.kind:
            case "image":
                meaning = self._meaning(node)
                pattern = node.value[1]  # type: ignore[index]
                places = [place for place, word in enumerate(pattern) if word == OPEN]
                if len(places) == 2 and all(self.concept(part) == TOP for part in parts):
                    return primitive(meaning, places[0], places[1])
            case "closure+":
                return element("r_transitive_closure", self.role(parts[0]))
            case "closure*":
                members = self._type(self.sorts[node.type.name])
                closed = element("r_transitive_closure", self.role(parts[0]))
                return element("r_or", closed, element("r_identity", members))
            case "inverse":
                return element("r_inverse", self.role(parts[0]))
            case "identity":
                return element("r_identity", self.concept(parts[0]))
            case "compose":
                return self._folded({"compose": "r_compose"}, node, self.role)
            case "restrict":
                end = self.concept(parts[2]) if len(parts) == 3 else TOP
                return between(self.concept(parts[1]), self.role(parts[0]), end)
            case "pairs":
                level = level_of(node)
                role = self._linked(parts[1], parts[2], None, level, level + 1)
                return between(self.concept(parts[0]), role, TOP)
            case "|" | "&" | "-":
                return self._folded({"|": "r_or", "&": "r_and", "-": "r_diff"}, node, self.role)
        raise self._fail(node)

    def _links(self, node: Node, level: int) -> Element:
        """The role from the variable of a level to what an inner quantifier chooses."""
        over, condition, body = node.parts
        return self._linked(over, condition, body, level, level_of(node))

    def _linked(
        self, over: Node, condition: Node, body: Node | None, level: int, inner: int
    ) -> Element:
        """The role from one variable to those elements of a set that conditions hold of. What
        is said of the first variable alone belongs to all of its pairs."""
        role: Element | None = None
        start, end = TOP, TOP
        if level in over.free:
            role = self.row(over, level)
        else:
            end = self.concept(over)
        for part in conjuncts(condition, *([body] if body is not None else [])):
            if part.free == {level}:
                start = element("c_and", start, self.holds(part, level))
            elif part.free <= {inner}:
                end = element("c_and", end, self.holds(part, inner))
            else:
                link = self.link(part, level, inner)
                role = link if role is None else element("r_and", role, link)
        return between(start, role or element("r_top"), end)

    def link(self, node: Node, level: int, inner: int) -> Element:  # noqa: PLR0912 (the same)
        """The role of a condition on two variables."""
        if node.free != {level, inner}:
            raise self._fail(node)
        match node.kind:
            case "not":
                return element("r_not", self.link(node.parts[0], level, inner))
            case "and" | "or":
                return self._folded(
                    {"and": "r_and", "or": "r_or"}, node, lambda p: self.link(p, level, inner)
                )
            case "=":
                return element("r_identity", TOP)
            case "call" | "image" if len(node.parts) == 2:
                meaning = self._meaning(node)
                places = {part.value: at for at, part in enumerate(node.parts)}
                if all(part.kind == "variable" for part in node.parts):
                    return primitive(meaning, places[level], places[inner])
                if node.kind == "image":
                    return self._linked_through(node, meaning, level, inner)
            case "apply" | "apply+" | "apply*" if len(node.parts) == 3:
                relation, first, last = node.parts
                if first.kind == last.kind == "variable":
                    role = self.role(relation)
                    if node.kind != "apply":
                        role = element("r_transitive_closure", role)
                    if node.kind == "apply*":
                        role = element("r_or", role, element("r_identity", TOP))
                    return role if first.value == level else element("r_inverse", role)
            case "in" if node.parts[0].kind == "variable":
                if node.parts[0].value == inner:
                    return self.row(node.parts[1], level)
                return element("r_inverse", self.row(node.parts[1], inner))
        raise self._fail(node)

    def _linked_through(self, node: Node, meaning: Meaning, level: int, inner: int) -> Element:
        """`p(x, q(y, _))`: one step from one variable, and one back to the other."""
        for place in (0, 1):
            own, many = node.parts[place], node.parts[1 - place]
            if own.kind == "variable" and own.value not in many.free:
                step = primitive(meaning, place, 1 - place)
                other = inner if own.value == level else level
                back = element("r_inverse", self.row(many, other))
                found = element("r_compose", step, back)
                return found if own.value == level else element("r_inverse", found)
        raise self._fail(node)

    # Help.

    def _folded(
        self, names: dict[str, str], node: Node, each: Callable[[Node], Element]
    ) -> Element:
        found, *others = [each(part) for part in node.parts]
        for other in others:
            found = element(names[node.kind], found, other)
        return found

    def _meaning(self, node: Node) -> Meaning:
        function = function_of(node)
        found = None if function is None else self.meanings.get(function)
        if found is None or found.kind == "goals":
            raise self._fail(node)
        return found

    def _fail(self, node: Node) -> NotTranslatedError:
        line, column = node.place.source.position(node.place.span.start)
        return NotTranslatedError(
            f"`{node.text}` has no form without variables",
            place=f"{node.place.source.name}:{line}:{column}",
        )
