"""What rules say taken together: effects that cannot happen, rules that say nothing new.

A rule is the set of pairs (values before, values after) that satisfy it, and that set is a
product: every feature has its own pairs, whatever the others do. The pairs of one feature
only compare the two numbers with each other and with 0, so numbers up to 2 stand for all.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import cache
from itertools import product

from sketchlang.checking.invariants import Stated
from sketchlang.checking.report import Report
from sketchlang.diagnostics import Label
from sketchlang.model import Effect, Feature, Kind, Rule
from sketchlang.source import Source, Span

Pairs = frozenset[tuple[int, int]]
_RANGE = {Kind.BOOL: range(2), Kind.NAT: range(3)}

MAX_COMPARED = 2000
"""So many rules of a sketch are compared with each other, which takes half a second."""

_PAIR_BITS = 9


@cache
def pairs(kind: Kind, condition: bool | None, effect: Effect | None) -> Pairs:
    """The changes that a rule with this condition and effect allows one feature."""
    return frozenset(
        (before, after)
        for before, after in product(_RANGE[kind], repeat=2)
        if condition is None or (before > 0) == condition
        if (before == after if effect is None else effect.allows(before, after))
    )


@cache
def _as_bits(allowed: Pairs) -> int:
    return sum(1 << 3 * before + after for before, after in allowed)


class Relations:
    """The checks that need whole rules.

    `places` tells where the parts of each rule were written. `faulty` rules, of which parts
    are missing because they are wrong, are left alone.
    """

    def __init__(
        self,
        features: Sequence[Feature],
        rules: Sequence[Rule],
        places: Sequence[RulePlace],
        faulty: Collection[str],
        report: Report,
    ) -> None:
        self.features = features
        self.rules = rules
        self.places = places
        self.faulty = faulty
        self.report = report
        self.pairs = [
            {
                f: pairs(features[f].kind, rule.conditions.get(f), rule.effects.get(f))
                for f in {*rule.conditions, *rule.effects}
            }
            for rule in rules
        ]

    def check(
        self,
        goal: Mapping[int, bool] | None,
        goal_place: Label | None,
        stated: Stated,
    ) -> None:
        """All checks: the goal, then rule by rule."""
        if goal is not None and goal_place is not None:
            stated.against_goal(goal, goal_place)
        sensible = [
            number
            for number, rule in enumerate(self.rules)
            if rule.name not in self.faulty and self._effects_happen(number)
        ]
        for number in sensible:
            self._redundant_effects(number)
            self._stays(number)
            self._at_goal(number, goal)
            place = self.places[number]
            label = Label(place.source, place.name)
            stated.against_rule(self.rules[number], label)
        self._subsumed(sensible)

    def _effects_happen(self, number: int) -> bool:
        rule, place = self.rules[number], self.places[number]
        possible = True
        for f, effect in rule.effects.items():
            if self.pairs[number][f]:
                continue
            possible = False
            name = self.features[f].name
            labels = [Label(place.source, place.conditions[f], "it is 0 here")]
            self.report.add(
                "impossible-effect",
                f"`{name}{effect.value.strip('!n')}` cannot happen: `{name}` is 0 before",
                Label(place.source, place.effects[f]),
                *labels,
                hint=f"Let the condition be `{name} > 0`, or change the effect.",
            )
        return possible

    def _redundant_effects(self, number: int) -> None:
        place = self.places[number]
        for f in self.rules[number].effects:
            kept = pairs(self.features[f].kind, self.rules[number].conditions.get(f), None)
            if self.pairs[number][f] == kept:
                name = self.features[f].name
                self.report.add(
                    "redundant-effect",
                    f"this effect only says that `{name}` stays as it is",
                    Label(place.source, place.effects[f]),
                    Label(place.source, place.conditions[f], "because of this condition"),
                    hint="Leave it out: a feature that is not named keeps its value.",
                )

    def _stays(self, number: int) -> None:
        """Whether a state can be its own subgoal."""
        if all(any(a == b for a, b in allowed) for allowed in self.pairs[number].values()):
            rule, place = self.rules[number], self.places[number]
            self.report.add(
                "satisfied-at-once",
                f"rule `{rule.name}` is satisfied without any change",
                Label(place.source, place.block),
                hint="Name an effect that must change something, for example `n--`.",
            )

    def _at_goal(self, number: int, goal: Mapping[int, bool] | None) -> None:
        rule, place = self.rules[number], self.places[number]
        if goal and all(rule.conditions.get(f) == value for f, value in goal.items()):
            self.report.add(
                "goal-rule",
                f"rule `{rule.name}` is for goal states only, where nothing is left to do",
                Label(place.source, place.name),
            )

    def _subsumed(self, sensible: Sequence[int]) -> None:
        """Every rule that allows nothing that another one does not allow."""
        compared = sensible[:MAX_COMPARED]
        bits = {number: self._bits(number) for number in compared}
        for number in compared:
            narrow = bits[number]
            for other in compared:
                wide = bits[other]
                if narrow | wide != wide or other == number:
                    continue
                if narrow == wide and other > number:
                    continue
                self._tell_subsumed(number, other, narrow == wide)
                break

    def _bits(self, number: int) -> int:
        """The rule's pairs as one number, a bit for each pair of values of each feature.

        A rule covers another one if it has all the bits that the other one has. A feature
        that a rule does not name keeps its value there.
        """
        bits = 0
        for f, feature in enumerate(self.features):
            allowed = self.pairs[number].get(f)
            if allowed is None:
                allowed = pairs(feature.kind, None, None)
            bits = bits << _PAIR_BITS | _as_bits(allowed)
        return bits

    def _tell_subsumed(self, number: int, other: int, same: bool) -> None:
        place, first = self.places[number], self.places[other]
        name, general = self.rules[number].name, self.rules[other].name
        if same:
            message = f"rule `{name}` says the same as rule `{general}`"
        else:
            message = f"rule `{name}` allows nothing that rule `{general}` does not allow"
        self.report.add(
            "copied-rule" if same else "subsumed-rule",
            message,
            Label(place.source, place.name),
            Label(first.source, first.name, "the other rule"),
            hint="Remove one of them." if same else f"Remove `{name}`.",
        )


class RulePlace:
    """Where the parts of a rule stand in its file."""

    __slots__ = ("block", "conditions", "effects", "name", "source")

    def __init__(
        self,
        source: Source,
        name: Span,
        block: Span,
        conditions: Mapping[int, Span],
        effects: Mapping[int, Span],
    ) -> None:
        self.source = source
        self.name = name
        self.block = block
        self.conditions = conditions
        self.effects = effects
