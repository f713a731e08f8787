"""Elements of description logic to expressions, and rules to rules.

The other tools let features change that a rule does not name; here they keep their value. So every
effect is written: `?` for what is not named, and nothing for what is said to stay.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from domains.pddl.interchange.model import Element, NotTranslatedError, Policy, Rule
from domains.pddl.interface import PddlInterface, sketch_name
from sketchlang.domain import Function
from sketchlang.syntax.grammar import words
from sketchlang.types import NAT

UNREACHABLE = 1_000_000_000
"""Stands for the infinite distance: one number, so that it equals itself."""


@dataclass
class Translator:
    """Makes the text of a sketch for a domain. Relations that need a name get one by `define`."""

    domain: PddlInterface
    file: str
    place: str
    defines: dict[str, str] = field(default_factory=dict)
    variables: int = 0

    def sketch(self, policy: Policy, title: str) -> str:
        """The whole text.

        Raises:
            NotTranslatedError: the language has no words for a part of it.
        """
        names = self._names(policy)
        features = [
            f"feature {names['b', name]} : bool = {self.boolean(element)}"
            for name, element in policy.booleans.items()
        ] + [
            f"feature {names['n', name]} : nat = {self.numerical(element)}"
            for name, element in policy.numericals.items()
        ]
        rules = [self._rule(number, rule, names) for number, rule in enumerate(policy.rules, 1)]
        defines = [f"define {name} = {text}" for text, name in self.defines.items()]
        parts = [f'sketch {title}\n\nuse "{self.file}"', *defines, *features, *rules]
        return "\n\n".join(parts) + "\n"

    def _names(self, policy: Policy) -> dict[tuple[str, str], str]:
        """Names of features that are names here, and no others' names."""
        taken = set(self.domain.functions) | set(words())
        found: dict[tuple[str, str], str] = {}
        for kind, features in (("b", policy.booleans), ("n", policy.numericals)):
            for name in features:
                spelled = re.sub(r"\W", "_", name)
                spelled = f"{kind}{spelled}" if not spelled[:1].isalpha() else spelled
                while spelled in taken:
                    spelled += "_"
                taken.add(spelled)
                found[kind, name] = spelled
        return found

    # Rules.

    def _rule(self, number: int, rule: Rule, names: dict[tuple[str, str], str]) -> str:
        conditions = [
            self._feature(feature, names, word)[1] + {"gt": " > 0", "eq": " = 0"}.get(word, "")
            for feature, word in rule.conditions
            if word != "neg"
        ] + [
            f"!{self._feature(feature, names, word)[1]}"
            for feature, word in rule.conditions
            if word == "neg"
        ]
        said = dict(self._effect(feature, word, names) for feature, word in rule.effects)
        effects = [said.get(name, f"{name}?") for name in names.values()]
        listed = ", ".join(effect for effect in effects if effect)
        return f"rule r{number} {{ {', '.join(conditions)} }} -> {{ {listed} }}"

    def _effect(
        self, feature: str, word: str, names: dict[tuple[str, str], str]
    ) -> tuple[str, str]:
        _, name = self._feature(feature, names, word)
        texts = {
            "pos": name, "neg": f"!{name}", "inc": f"{name}++", "dec": f"{name}--", "bot": "",
            "dec_bot": f"!{name}++", "inc_bot": f"!{name}--",
        }  # fmt: skip
        if word not in texts:
            raise NotTranslatedError(f"the effect `{word}` is not known", place=self.place)
        return name, texts[word]

    def _feature(
        self, feature: str, names: dict[tuple[str, str], str], word: str
    ) -> tuple[str, str]:
        """The kind and name of a feature: `b0` and `n0` are the numbered ones of old files."""
        for kind in "bn":
            if (kind, feature) in names:
                return kind, names[kind, feature]
        numbered = (feature[:1], feature[1:])
        if numbered in names:
            return numbered[0], names[numbered]
        raise NotTranslatedError(f"there is no feature `{feature}`", place=self.place)

    # Features.

    def boolean(self, element: Element) -> str:
        """A truth value."""
        match element.name, element.arguments:
            case "b_nullary", (str(name),):
                return self._predicate(name)[0]
            case "b_empty" | "b_nonempty", (Element() as part,):
                text = f"some {self._fresh()} in {self._elements(part)}: true"
                return text if element.name == "b_nonempty" else f"not ({text})"
            case "b_inclusion", (Element() as first, Element() as second):
                if first.name.startswith("r_"):
                    return f"{self.role(first)} <= {self.role(second)}"
                return f"{self._tight(first)} <= {self._tight(second)}"
        raise self._unknown(element)

    def numerical(self, element: Element) -> str:
        """A number."""
        x, y = self._fresh(), self._fresh()
        match element.name, element.arguments:
            case "n_count", (Element() as part,):
                if part.name.startswith("r_"):
                    role = self.named(part)
                    return f"sum {x} in object: count {y} in {role}({x}, _): true"
                return f"count {x} in {self.concept(part)}: true"
            case "n_concept_distance", (Element() as c, Element() as r, Element() as d):
                return self._distance(self.concept(c), self.named(r), self._tight(d))
            case "n_sum_concept_distance", (Element() as c, Element() as r, Element() as d):
                return self._concept_sum(c, self.named(r), self._tight(d))
            case "n_role_distance", (Element() as r, Element() as s, Element() as t):
                first, last = self.named(r), self.named(t)
                inner = self._distance(y, self.named(s), f"{last}({x}, _)")
                least = f"min {y} in {first}({x}, _): {inner} default {UNREACHABLE}"
                return f"min {x} in object: {least} default {UNREACHABLE}"
            case "n_sum_role_distance", (Element() as r, Element() as s, Element() as t):
                return self._role_sum(self.named(r), self.named(s), self.named(t))
        raise self._unknown(element)

    def _distance(self, start: str, role: str, end: str) -> str:
        near = f"some {self._fresh()} in {role}*({start}, _) & {end}: true"
        return f"(if {near} then distance({start}, {role}, {end}) else {UNREACHABLE})"

    def _concept_sum(self, start: Element, role: str, end: str) -> str:
        """How far it is from a set to each element of another: no way where it is none for one, or
        where there are none."""
        near, far, x = self._tight(start), f"({end})", self._fresh()
        beyond = f"some {self._fresh()} in {far} - {role}*({near}, _): true"
        none = f"{self._none(near)} or {self._none(far)}"
        total = f"sum {x} in {far}: distance({near}, {role}, {{ {x} }})"
        return f"if {none} or ({beyond}) then {UNREACHABLE} else {total}"

    def _role_sum(self, first: str, role: str, last: str) -> str:
        """How far it is from each `y` with `first(x, y)` to a nearest `z` with `last(x, z)`: no way
        where it is none for one, or where there are none."""
        x, y, z = self._fresh(), self._fresh(), self._fresh()
        near = f"some {z} in {role}*({y}, _) & {last}({x}, _): true"
        beyond = f"some {x} in object: some {y} in {first}({x}, _): not ({near})"
        none = f"{self._none(f'{first}(_, object)')} or {self._none(f'{last}(_, object)')}"
        inner = f"distance({y}, {role}, {last}({x}, _))"
        total = f"sum {x} in object: sum {y} in {first}({x}, _): {inner}"
        return f"if {none} or ({beyond}) then {UNREACHABLE} else {total}"

    def _none(self, elements: str) -> str:
        return f"not (some {self._fresh()} in {elements}: true)"

    def _elements(self, element: Element) -> str:
        """A concept; of a role, what it starts from: empty if the role is."""
        if element.name.startswith("r_"):
            return f"{self.named(element)}(_, object)"
        return self.concept(element)

    # Concepts.

    def concept(self, element: Element) -> str:  # noqa: PLR0912 (a case for each constructor)
        """A set."""
        x = self._fresh()
        match element.name, element.arguments:
            case "c_top", ():
                return "object"
            case "c_bot", ():
                return "object - object"
            case "c_primitive", (str(name), *rest):
                return self._projected(name, [*rest, "0"][0], False)
            case "c_goal", (str(name), str(truth)) if truth == "true":
                return self._projected(name, "0", True)
            case "c_one_of", (str(name),):
                return f"{{ {sketch_name(name.lower())} }}"
            case "c_and", (Element() as a, Element() as b):
                return f"{self._tight(a)} & {self._tight(b)}"
            case "c_or", (Element() as a, Element() as b):
                return f"{self._tight(a)} | {self._tight(b)}"
            case "c_diff", (Element() as a, Element() as b):
                return f"{self._tight(a)} - {self._tight(b)}"
            case "c_not", (Element() as a,):
                return f"object - {self._tight(a)}"
            case "c_some", (Element() as r, Element() as c):
                return f"{self.named(r)}(_, {self.concept(c)})"
            case "c_all", (Element() as r, Element() as c):
                return f"{{ {x} in object where {self.named(r)}({x}, _) <= {self._tight(c)} }}"
            case "c_equal" | "c_subset", (Element() as r, Element() as s):
                sign = "=" if element.name == "c_equal" else "<="
                return (
                    f"{{ {x} in object where {self.named(r)}({x}, _) {sign} "
                    f"{self.named(s)}({x}, _) }}"
                )
            case "c_projection", (Element() as r, str(place)):
                ends = "_, object" if place == "0" else "object, _"
                return f"{self.named(r)}({ends})"
        raise self._unknown(element)

    def _tight(self, element: Element) -> str:
        """A concept that binds tightly."""
        text = self.concept(element)
        loose = element.name in ("c_and", "c_or", "c_diff", "c_not", "c_bot")
        return f"({text})" if loose else text

    # Roles.

    def named(self, element: Element) -> str:
        """A role that can take arguments: a predicate, or a definition."""
        text = self.role(element)
        if re.fullmatch(r"(goal )?\w+", text):
            return text
        if text not in self.defines:
            self.defines[text] = f"role{len(self.defines) + 1}"
        return self.defines[text]

    def role(self, element: Element) -> str:  # noqa: PLR0912 (the same)
        """A relation."""
        x, y = self._fresh(), self._fresh()
        match element.name, element.arguments:
            case "r_top", ():
                return f"{{ {x} in object, {y} in object where {x} = {x} and {y} = {y} }}"
            case "r_primitive", (str(name), *rest):
                first, second = (str(place) for place in (rest or ("0", "1")))
                return self._relation(name, first, second, False)
            case "r_goal", (str(name), str(truth)) if truth == "true":
                return self._relation(name, "0", "1", True)
            case "r_and", (Element() as a, Element() as b):
                return f"{self.named(a)} & {self.named(b)}"
            case "r_or", (Element() as a, Element() as b):
                return f"{self.named(a)} | {self.named(b)}"
            case "r_diff", (Element() as a, Element() as b):
                return f"{self.named(a)} - {self.named(b)}"
            case "r_not", (Element() as a,):
                return f"{{ {x} in object, {y} in object where not {self.named(a)}({x}, {y}) }}"
            case "r_inverse", (Element() as a,):
                return f"inverse({self.role(a)})"
            case "r_compose", (Element() as a, Element() as b):
                return f"compose({self.role(a)}, {self.role(b)})"
            case "r_identity", (Element() as c,):
                return f"identity({self.concept(c)})"
            case "r_restrict", (Element() as a, Element() as c):
                return f"restrict({self.role(a)}, object, {self.concept(c)})"
            case "r_transitive_closure", (Element() as a,):
                return f"{self.named(a)}+"
            case "r_transitive_reflexive_closure", (Element() as a,):
                return f"{self.named(a)}*"
        raise self._unknown(element)

    # Predicates.

    def _predicate(self, name: str) -> tuple[str, Function]:
        """How a predicate is written, and its function; `p_g` is what the goal says of `p`."""
        spelled = sketch_name(name.lower())
        function = self.domain.functions.get(spelled)
        if function is not None:
            return spelled, function
        function = self.domain.functions.get(sketch_name(name.lower().removesuffix("_g")))
        if function is None or not name.lower().endswith("_g"):
            raise NotTranslatedError(f"the domain has no predicate `{name}`", place=self.place)
        return f"goal {function.name}", function

    def _projected(self, name: str, place: object, goal: bool) -> str:
        """What can stand in one place of a predicate."""
        written, function = self._predicate(name)
        written = f"goal {written}" if goal else written
        count = len(function.parameters)
        if self.domain.meanings[function].kind == "type" and written != "object":
            # A set of objects, which goes together with sets of other types.
            x = self._fresh()
            return f"{{ {x} in object where {x} in {written} }}"
        if count <= 1:
            return written
        ends = ", ".join("_" if str(i) == str(place) else "object" for i in range(count))
        return f"{written}({ends})"

    def _relation(self, name: str, first: str, second: str, goal: bool) -> str:
        written, function = self._predicate(name)
        written = f"goal {written}" if goal else written
        count = len(function.parameters)
        if count > 2:
            ends = ", ".join("_" if str(i) in (first, second) else "object" for i in range(count))
            written = f"{written}({ends})"
        elif count < 2 or function.result == NAT:
            raise NotTranslatedError(f"`{name}` is no relation", place=self.place)
        return written if int(first) < int(second) else f"inverse({written})"

    def _fresh(self) -> str:
        self.variables += 1
        return f"x{self.variables}"

    def _unknown(self, element: Element) -> NotTranslatedError:
        return NotTranslatedError(
            f"`{element.name}` with {len(element.arguments)} arguments is not known",
            place=self.place,
        )
