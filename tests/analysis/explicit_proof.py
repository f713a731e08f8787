"""What a certificate proves, worked out on sets of valuations and lists of edges.

The checker under test walks decision trees; this one applies the definitions of
docs/certificates.md to every valuation there is.
"""

from __future__ import annotations

from itertools import product
from typing import Any

from sketchlang.model import Effect, Kind, SketchModel, holds
from tests.analysis.reference import Edge, Valuation, leads


class Explicit:
    """The policy graph without regard to goal and invariants: certificates name those."""

    def __init__(self, model: SketchModel) -> None:
        self.model = model
        self.names = [feature.name for feature in model.features]
        self.valuations = set(product((0, 1), repeat=len(model.features)))
        self.edges: set[Edge] = {
            (before, r, after)
            for before in self.valuations
            for r, rule in enumerate(model.rules)
            if rule.applies(before)
            for after in self.valuations
            if leads(model, before, rule, after)
        }

    def proves(self, proof: Any) -> bool:
        """Whether the steps leave no rule, and each of them is right."""
        try:
            possible = {self.model.rules[r].name for _, r, _ in self.edges}
            return not self._left(proof, self.valuations, possible)
        except (AssertionError, KeyError, ValueError, TypeError, IndexError):
            return False

    def _left(self, steps: Any, region: set[Valuation], rules: set[str]) -> set[str]:
        assert isinstance(steps, list)
        for step in steps:
            assert isinstance(step, dict)
            kinds = {"split": self._split, "potential": self._potential}
            check = next((kinds[key] for key in step if key in kinds), self._drop)
            gone = check(step, region, rules)
            assert gone
            rules = rules - gone
        return rules

    def _drop(self, step: Any, region: set[Valuation], rules: set[str]) -> set[str]:
        (change,) = set(step) - {"rules"}
        feature = self.names.index(step[change])
        declared = self.model.features[feature]
        assert declared.kind is Kind.NAT
        if change == "lowers":
            strict, against = Effect.DEC, {Effect.INC, Effect.ANY, Effect.NOT_DEC}
        else:
            assert change == "raises"
            assert declared.bounded
            strict, against = Effect.INC, {Effect.DEC, Effect.ANY, Effect.NOT_INC}
        effects = {
            rule.name: rule.effects.get(feature) for rule in self.model.rules if rule.name in rules
        }
        assert not against & set(effects.values())
        able = {name for name, effect in effects.items() if effect is strict}
        assert sorted(step["rules"]) == sorted(able)
        return able

    def _potential(self, step: Any, region: set[Valuation], rules: set[str]) -> set[str]:
        """Edge by edge for truth values, and by the meaning of effects for numbers."""
        assert set(step) == {"potential", "rules"}
        numbers, truths = {}, {}
        for key, weight in step["potential"].items():
            assert type(weight) is int
            name = key.split()[0]
            feature = self.names.index(name)
            if key == name and self.model.features[feature].kind is Kind.NAT:
                assert weight >= 0 or self.model.features[feature].bounded
                numbers[feature] = weight
            else:
                nat = self.model.features[feature].kind is Kind.NAT
                assert key == (f"{name} > 0" if nat else name)
                truths[feature] = weight
        most: dict[str, int] = {}
        for before, r, after in self.edges:
            rule = self.model.rules[r]
            change = sum(w * (after[f] - before[f]) for f, w in truths.items())
            for f, weight in numbers.items():
                allows = rule.effects[f].allows if f in rule.effects else int.__eq__
                # From high up, can the number get closer to where the sum is larger?
                changes = [d for d in (-1, 0, 1) if allows(5, 5 + d)]
                worst = max((weight * d for d in changes), default=0)
                assert worst <= 0 or rule.name not in rules
                change += worst
            most[rule.name] = max(most.get(rule.name, change), change)
        assert all(most[name] <= 0 for name in rules)
        able = {name for name in rules if most[name] < 0}
        assert sorted(step["rules"]) == sorted(able)
        return able

    def _split(self, step: Any, region: set[Valuation], rules: set[str]) -> set[str]:
        assert set(step) == {"split", "blocks", "rules"}
        self._in_order(step["split"], -1)
        block = {v: self._leaf(step["split"], v) for v in self.valuations}
        for v, number in block.items():
            assert number is None or 0 <= number < len(step["blocks"])
            if number is None:
                invariants = [invariant.formula for invariant in self.model.invariants]
                assert self.model.is_goal(v) or not all(holds(f, v) for f in invariants)
        staying: list[set[str]] = [set() for _ in step["blocks"]]
        for before, r, after in self.edges:
            first, last = block[before], block[after]
            name = self.model.rules[r].name
            inside = before in region and after in region
            if name in rules and inside and first is not None and last is not None:
                assert first <= last
                if first == last:
                    staying[first].add(name)
        left: set[str] = set()
        for number, part in enumerate(step["blocks"]):
            assert set(part) == {"rules", "proof"}
            assert sorted(part["rules"]) == sorted(staying[number])
            where = {v for v in region if block[v] == number}
            left |= self._left(part["proof"], where, staying[number])
        assert sorted(step["rules"]) == sorted(rules - left)
        return rules - left

    def _in_order(self, tree: Any, last: int) -> None:
        if isinstance(tree, list):
            name, low, high = tree
            assert self.names.index(name) > last
            self._in_order(low, self.names.index(name))
            self._in_order(high, self.names.index(name))

    def _leaf(self, tree: Any, valuation: Valuation) -> int | None:
        while isinstance(tree, list):
            name, low, high = tree
            tree = high if valuation[self.names.index(name)] else low
        assert tree is None or type(tree) is int
        return tree
