"""Sketches as policies of other tools.

There, what a rule's effects do not name may change: so everything that keeps its value is named,
and what is `?` here is left out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import product

from domains.pddl.interchange import runir
from domains.pddl.interchange.elements import element
from domains.pddl.interchange.express import Expresser
from domains.pddl.interchange.model import Element, NotTranslatedError
from domains.pddl.interface import PddlInterface
from sketchlang.checking.checker import CheckedSketch
from sketchlang.errors import CollectedInputError, InputError
from sketchlang.model import Effect, Kind, Rule

_WORDS = {
    Effect.SET: "pos",
    Effect.CLEAR: "neg",
    Effect.DEC: "dec",
    Effect.INC: "inc",
    Effect.NOT_INC: "dec_bot",
    Effect.NOT_DEC: "inc_bot",
}
_OPPOSITE = {"pos": "neg", "neg": "pos"}


@dataclass(frozen=True)
class Feature:
    """A feature as the other tools have it. `turned`: it is true there where it is false here.
    `measured`: it is `distance` itself, which is infinite there where here it is a number."""

    name: str
    kind: Kind
    element: Element
    turned: bool = False
    measured: bool = False


@dataclass(frozen=True)
class Exported:
    """The text of a policy, and what of the sketch it does not say."""

    text: str
    notes: tuple[str, ...]


def features_of(checked: CheckedSketch, domain: PddlInterface) -> list[Feature]:
    """The features of a sketch without variables.

    Raises:
        InputError: what has no such form; all of it, with its places.
    """
    expresser = Expresser(domain.meanings, domain.types)
    _refuse_ambiguous(domain)
    found: list[Feature] = []
    failed: list[InputError] = []
    for feature, node in zip(checked.model.features, checked.definitions, strict=True):
        try:
            if node is None:
                raise NotTranslatedError("it has no definition")
            if feature.kind is Kind.BOOL:
                made, positive = expresser.boolean(node)
                found.append(Feature(feature.name, feature.kind, made, not positive))
            else:
                made = expresser.number(node)
                measured = node.kind == "distance"
                found.append(Feature(feature.name, feature.kind, made, measured=measured))
        except NotTranslatedError as error:
            text = f"feature `{feature.name}` cannot be said there: {error.message}"
            failed.append(InputError(text, place=error.place))
    if failed:
        raise CollectedInputError(failed)
    return found


def _refuse_ambiguous(domain: PddlInterface) -> None:
    """`p_g` is what the goal says of `p`."""
    names = set() if domain.pddl is None else set(domain.pddl.predicates)
    both = sorted(name for name in names if f"{name}_g" in names)
    if both:
        raise NotTranslatedError(
            f"there, `{both[0]}_g` is what the goal says of `{both[0]}`, and the domain has both"
        )


def notes_of(checked: CheckedSketch, features: list[Feature]) -> Iterator[str]:
    """What a policy does not say of a sketch."""
    model = checked.model
    if model.goal is not None:
        yield "the sketch's goal is left out: there, the task's own goal counts"
    for invariant in model.invariants:
        yield f"the invariant `{invariant.text}` is left out"
    if checked.atoms:
        yield "`atoms` is left out: there, novelty is about all atoms"
    for feature in features:
        if feature.element.name == "n_concept_distance" and feature.measured:
            yield (
                f"`{feature.name}` is infinite there where there is no way; here it is a number "
                "above all distances, which may change with the relation"
            )


def literals(rule: Rule, features: list[Feature]) -> tuple[list[Pair], list[Pair]]:
    """Conditions and effects: features, and what is said of them as in `model.Rule`."""
    conditions, effects = [], []
    for index, wanted in sorted(rule.conditions.items()):
        feature = features[index]
        if feature.kind is Kind.BOOL:
            conditions.append((feature, "pos" if wanted != feature.turned else "neg"))
        else:
            conditions.append((feature, "gt" if wanted else "eq"))
    for index, feature in enumerate(features):
        effect = rule.effects.get(index)
        if effect is Effect.ANY:
            continue
        word = "bot" if effect is None else _WORDS[effect]
        effects.append((feature, _OPPOSITE.get(word, word) if feature.turned else word))
    return conditions, effects


Pair = tuple[Feature, str]


def to_dlplan(checked: CheckedSketch, domain: PddlInterface) -> Exported:
    """A policy of dlplan, in the dialect whose features have names.

    Raises:
        InputError: what has no such form.
    """
    features = features_of(checked, domain)

    def listed(kind: Kind) -> str:
        return " ".join(
            f'({feature.name} "{_spelled(feature.element)}")'
            for feature in features
            if feature.kind is kind
        )

    def side(sign: str, pairs: list[Pair]) -> str:
        return " ".join(
            f"(:{sign}_{'b' if feature.kind is Kind.BOOL else 'n'}_{word} {feature.name})"
            for feature, word in pairs
        )

    lines = ["(:policy", f"(:booleans {listed(Kind.BOOL)})", f"(:numericals {listed(Kind.NAT)})"]
    for rule in checked.model.rules:
        conditions, effects = literals(rule, features)
        lines.append(
            f"(:rule (:conditions {side('c', conditions)}) (:effects {side('e', effects)}))"
        )
    return Exported("\n".join([*lines, ")"]) + "\n", tuple(notes_of(checked, features)))


def _spelled(part: Element | str) -> str:
    if isinstance(part, str):
        return part
    return f"{part.name}({','.join(map(_spelled, part.arguments))})".removesuffix("()")


# Runir has fewer constructors: the others are made of them.

_SPLIT = {"dec_bot": ("dec", "bot"), "inc_bot": ("inc", "bot")}
_CONSTRUCTORS = {found: (word, kinds) for word, (found, kinds) in runir.CONSTRUCTORS.items()}
_LITERALS = {
    (found, Kind.BOOL if "boolean" in word else Kind.NAT, word.endswith("condition")): word
    for word, found in runir.LITERALS.items()
}


def to_runir(checked: CheckedSketch, domain: PddlInterface) -> Exported:
    """A policy of runir. A rule with `!n++` or `!n--` becomes two.

    Raises:
        InputError: what has no such form.
    """
    features = []
    for feature in features_of(checked, domain):
        made, turned = feature.element, feature.turned
        if made.name == "b_inclusion":
            first, second = made.arguments
            sign = "r" if isinstance(first, Element) and first.name.startswith("r_") else "c"
            made = element("b_empty", element(f"{sign}_diff", first, second))
        if made.name == "b_empty":
            made, turned = element("b_nonempty", *made.arguments), not turned
        features.append(replace(feature, element=made, turned=turned))
    lines = []
    for kind, title in ((Kind.BOOL, "boolean"), (Kind.NAT, "numerical")):
        lines.append(f"[{title}_features]")
        lines += [
            f"<{feature.name}> ::= {_prefixed(feature.element)}"
            for feature in features
            if feature.kind is kind
        ]
    lines.append("[policy_rules]")
    for rule in checked.model.rules:
        conditions, effects = literals(rule, features)
        ways = [_SPLIT.get(word, (word,)) for _, word in effects]
        for words in product(*ways):
            chosen = [(feature, word) for (feature, _), word in zip(effects, words, strict=True)]
            lines.append(f"{{ {_listed(conditions, True)} }} -> {{ {_listed(chosen, False)} }}")
    return Exported("\n".join(lines) + "\n", tuple(notes_of(checked, features)))


def _listed(pairs: list[Pair], condition: bool) -> str:
    return ", ".join(
        f"@{_LITERALS[word, feature.kind, condition]} <{feature.name}>" for feature, word in pairs
    )


def _prefixed(part: Element) -> str:
    """An element with its constructor before its arguments."""
    arguments = part.arguments
    match part.name, arguments:
        case "c_diff" | "r_diff", (first, Element() as second):
            sign = part.name[0]
            return _prefixed(Element(f"{sign}_and", (first, element(f"{sign}_not", second))))
        case "c_primitive" | "r_primitive", (str(name), *places):
            return _predicate(part, name, [str(place) for place in places])
    if part.name not in _CONSTRUCTORS:
        raise NotTranslatedError(f"runir has no word for `{part.name}`")
    word, _ = _CONSTRUCTORS[part.name]
    ends = (f'"{a}"' if isinstance(a, str) else _prefixed(a) for a in arguments)
    return " ".join([f"@{word}", *ends])


def _predicate(part: Element, name: str, places: list[str]) -> str:
    sign = part.name[0]
    kind = {"c": "concept", "r": "role"}[sign]
    goal = name.endswith("_g")
    plain = (
        f'@{kind}_atomic_goal "{name.removesuffix("_g")}" true'
        if goal
        else f'@{kind}_atomic_state "{name}"'
    )
    match sign, places:
        case ("c", ["0"]) | ("r", ["0", "1"]):
            return plain
        case "r", ["1", "0"]:
            return f"@role_inverse {plain}"
    raise NotTranslatedError(f"runir has no word for the places {', '.join(places)} of `{name}`")


Exporter = Callable[[CheckedSketch, PddlInterface], Exported]
