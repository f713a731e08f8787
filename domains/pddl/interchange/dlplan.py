"""Reads policies of dlplan: the older dialect, whose features have numbers, and the newer one,
whose features have names."""

from __future__ import annotations

import re

from domains.pddl.interchange.model import Element, Policy, Rule
from sketchlang.errors import InputError

_TOKEN = re.compile(r'\s*(?:;[^\n]*\n\s*)*([()]|"[^"]*"|[^\s()";]+)')
_PART = re.compile(r"\s*([(),]|[^\s(),]+)")
MAX_DEPTH = 200

Tree = list["Tree | str"]


def read(text: str, place: str) -> Policy:
    """The policy of a text.

    Raises:
        InputError: what is wrong with it.
    """
    reader = _Reader(place)
    trees = reader.trees(text)
    if len(trees) != 1 or not isinstance(trees[0], list) or trees[0][:1] != [":policy"]:
        raise reader.fail("expected `(:policy ...)`")
    booleans: dict[str, Element] = {}
    numericals: dict[str, Element] = {}
    rules: list[Rule] = []
    for part in trees[0][1:]:
        if not isinstance(part, list) or not part:
            raise reader.fail(f"unknown part {part!r} of a policy")
        match part[0]:
            case ":boolean_features" | ":booleans":
                reader.features(part[1:], booleans)
            case ":numerical_features" | ":numericals":
                reader.features(part[1:], numericals)
            case ":rule":
                rules.append(reader.rule(part[1:]))
            case _:
                raise reader.fail(f"unknown part {part[0]!r} of a policy")
    return Policy(booleans, numericals, tuple(rules))


class _Reader:
    def __init__(self, place: str) -> None:
        self.place = place

    def fail(self, message: str) -> InputError:
        return InputError(message, place=self.place)

    def trees(self, text: str) -> Tree:
        """Nested lists of words; quoted texts keep their quotes."""
        stack: list[Tree] = [[]]
        place = 0
        text = text.rstrip() + "\n"
        while place < len(text.rstrip()):
            match = _TOKEN.match(text, place)
            if match is None:
                break
            place = match.end()
            if match[1] == "(":
                stack.append([])
                if len(stack) > MAX_DEPTH:
                    raise self.fail(f"more than {MAX_DEPTH} parentheses within each other")
            elif match[1] == ")":
                if len(stack) == 1:
                    raise self.fail("a parenthesis closes nothing")
                done = stack.pop()
                stack[-1].append(done)
            else:
                stack[-1].append(match[1])
        if len(stack) > 1:
            raise self.fail("a parenthesis is never closed")
        return stack[0]

    def features(self, parts: Tree, found: dict[str, Element]) -> None:
        """`"..." "..."`, numbered from 0, or `(name "...")`."""
        for number, part in enumerate(parts):
            match part:
                case str() if part.startswith('"'):
                    found[str(number)] = self.element(part.strip('"'))
                case [str(name), str(text)] if text.startswith('"'):
                    found[name] = self.element(text.strip('"'))
                case _:
                    raise self.fail(f"expected a feature, found {part!r}")

    def element(self, text: str) -> Element:
        """`c_and(c_primitive(p,0),c_top)`"""
        words = _PART.findall(text)
        stack: list[tuple[str, list[Element | str]]] = [("", [])]
        number = 0
        while number < len(words):
            word = words[number]
            if word == ")":
                if len(stack) == 1:
                    raise self.fail(f"a parenthesis closes nothing in `{text}`")
                name, arguments = stack.pop()
                stack[-1][1].append(Element(name, tuple(arguments)))
            elif word not in ("(", ","):
                if words[number + 1 : number + 2] == ["("]:
                    stack.append((word, []))
                    number += 1
                else:
                    plain = re.fullmatch(r"[cr]_(top|bot)", word)
                    stack[-1][1].append(Element(word, ()) if plain else word)
            number += 1
        (_, found), *rest = stack
        if rest or len(found) != 1 or not isinstance(found[0], Element):
            raise self.fail(f"`{text}` is no element")
        return found[0]

    def rule(self, parts: Tree) -> Rule:
        """`(:conditions (:c_b_pos 0)) (:effects (:e_n_dec 0))`"""
        sides: dict[str, tuple[tuple[str, str], ...]] = {}
        for part in parts:
            if not isinstance(part, list) or part[:1] not in ([":conditions"], [":effects"]):
                raise self.fail("a rule has `(:conditions ...)` and `(:effects ...)`")
            found = []
            for literal in part[1:]:
                match literal:
                    case [str(word), str(feature)] if re.fullmatch(r":[ce]_[bn]_\w+", word):
                        # Numbers count Booleans and numericals apart.
                        kind = word[3] if feature.isdigit() else ""
                        found.append((kind + feature, word[5:]))
                    case _:
                        raise self.fail(f"expected a condition or effect, found {literal!r}")
            sides[str(part[0])] = tuple(found)
        return Rule(sides.get(":conditions", ()), sides.get(":effects", ()))
