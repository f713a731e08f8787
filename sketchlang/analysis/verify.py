"""An independent checker of termination certificates.

It shares nothing with the prover but the sketch model and the fingerprint, and can be read
on its own. What it establishes is this. Let a run be an infinite sequence of valuations in
which each pair of neighbours satisfies a rule, with no goal among them and all invariants
true. `Checker.proof` is given a region (a set of valuations) and rules, and returns rules
such that a run that stays in the region and uses only the rules given uses, in the long
run, only rules returned:

- A step "lowers n" names rules that all have `n--`, while no rule at hand has `n++`, `n?` or
  `!n--`. From any moment on n never rises, so these rules fire at most n more times. "raises
  n" is the same upside down for n declared bounded.
- A step "potential" gives features integer weights, so that no rule at hand can raise the
  weighted sum and those named are sure to lower it. The sum is bounded below: numbers have
  positive weights unless they are bounded, and truth values are 0 or 1. So it falls finitely
  often.
- A step "ranks" orders all valuations of the features that the rules at hand have, in
  rounds; `verify_ranks.py` says how that takes all of these rules away.
- A step "split" sorts the region into numbered blocks by a decision tree. The checker makes
  sure that no rule leads from a block to one with a lower number. So a run comes to stay
  in one block, and there uses rules with an edge inside it: the block's own proof applies.
  A leaf `null` says that no run comes here: the answers on its path contain the goal or make
  an invariant false.

If `proof` returns no rule for the whole sketch, no run exists: the sketch terminates.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sketchlang.analysis.fingerprint import digest, fingerprint
from sketchlang.analysis.verify_read import (
    RefusedError,
    a_text,
    an_integer,
    an_object,
    read_certificate,
    refuse,
)
from sketchlang.analysis.verify_tree import Answer, Question, follow, subtree_key, truth
from sketchlang.model import Effect, Kind, Rule, SketchModel

__all__ = ["RefusedError", "read_certificate", "verify"]

FORMAT = "sketchlang-termination-certificate"
METHODS = {1: ("rule-elimination", "sieve"), 2: ("rule-elimination", "potentials", "sieve")}
"""The versions of the format that are known, and the methods that they have words for."""

RAISING = (Effect.INC, Effect.ANY, Effect.NOT_DEC)
LOWERING = (Effect.DEC, Effect.ANY, Effect.NOT_INC)


def verify(certificate: Any, model: SketchModel) -> None:
    """Returns if the certificate is valid for the sketch, else raises `RefusedError`."""
    content = an_object(
        certificate, "certificate", "format version sketch fingerprint method proof digest"
    )
    if a_text(content["format"], "format") != FORMAT:
        refuse(f"not a termination certificate (format {content['format']!r})")
    version = an_integer(content["version"], "version")
    if version not in METHODS:
        known = " and ".join(map(str, METHODS))
        refuse(f"version {version} of the format, this checker knows {known}")
    if a_text(content["method"], "method") not in METHODS[version]:
        refuse(f"version {version} of the format has no method {content['method']!r}")
    a_text(content["sketch"], "sketch")
    if content["fingerprint"] != fingerprint(model):
        refuse("it is for another sketch, or for another version of this one (fingerprint)")
    if content["digest"] != digest({k: v for k, v in content.items() if k != "digest"}):
        refuse("it has been altered since it was written (digest)")
    checker = Checker(model, version)
    left = checker.proof(content["proof"], [], checker.possible_rules(), "step ")
    if left:
        refuse(f"at its end {_list(left)} may still fire for ever")


class Checker:
    """Checks steps for one sketch. `where` in all methods names the step for messages."""

    def __init__(self, model: SketchModel, version: int) -> None:
        self.model = model
        self.version = version
        self.rules = {rule.name: rule for rule in model.rules}
        self.features = {feature.name: i for i, feature in enumerate(model.features)}

    def possible_rules(self) -> set[str]:
        """Rules that can fire at all: not, for example, `{ n = 0 } -> { n-- }`."""
        features = range(len(self.model.features))
        return {
            name for name, rule in self.rules.items() if all(self.pairs(rule, f) for f in features)
        }

    def proof(
        self, steps: Any, region: list[tuple[Answer, int]], rules: set[str], where: str
    ) -> set[str]:
        """The rules that a list of steps leaves. The region is where each tree has its leaf."""
        if not isinstance(steps, list):
            refuse(f"{where}: a list of steps is expected")
        for number, step in enumerate(steps, start=1):
            here = f"{where}{number}"
            if isinstance(step, dict) and "split" in step:
                gone = self.split(step, region, rules, here)
            elif isinstance(step, dict) and "potential" in step and self.version > 1:
                gone = self.potential(step, rules, here)
            elif isinstance(step, dict) and "ranks" in step and self.version > 1:
                gone = self.ranks(step, rules, here)
            else:
                gone = self.drop(step, rules, here)
            if not gone:
                refuse(f"{here}: takes no rule away")
            rules = rules - gone
        return rules

    def drop(self, step: Any, rules: set[str], where: str) -> set[str]:
        upwards = isinstance(step, dict) and "raises" in step
        change = "raises" if upwards else "lowers"
        step = an_object(step, where, f"{change} rules")
        feature = self.feature(step[change], where)
        declared = self.model.features[feature]
        if declared.kind is not Kind.NAT:
            refuse(f"{where}: {declared.name} is not a nat")
        if upwards and not declared.bounded:
            refuse(f"{where}: {declared.name} is not declared bounded")
        named = self.named(step["rules"], where)
        strict = Effect.INC if upwards else Effect.DEC
        able = {name for name in rules if self.rules[name].effects.get(feature) is strict}
        if named != able:
            refuse(f"{where}: {_list(able)} {change} {declared.name} here, not {_list(named)}")
        against = LOWERING if upwards else RAISING
        for name in sorted(rules):
            if self.rules[name].effects.get(feature) in against:
                refuse(f"{where}: {name} may change {declared.name} back")
        return named

    def potential(self, step: Any, rules: set[str], where: str) -> set[str]:
        step = an_object(step, where, "potential rules")
        weights = step["potential"]
        if not isinstance(weights, dict):
            refuse(f"{where}: an object of weights is expected")
        named = self.named(step["rules"], where)
        changes = dict.fromkeys(rules, 0)
        for key, weight in weights.items():
            feature = self.feature(key.removesuffix(" > 0"), where)
            nat = self.model.features[feature].kind is Kind.NAT
            if key.endswith(" > 0") and not nat:
                refuse(f"{where}: {key!r} is said of a nat only")
            number = nat and not key.endswith(" > 0")
            for name in rules:
                changes[name] += self.most(name, feature, number, an_integer(weight, where), where)
        for name in sorted(rules):
            if changes[name] > 0:
                refuse(f"{where}: {name} may raise the sum")
        able = {name for name in rules if changes[name] < 0}
        if named != able:
            refuse(f"{where}: {_list(able)} lowers the sum here, not {_list(named)}")
        return named

    def most(self, name: str, feature: int, number: bool, weight: int, where: str) -> int:
        """The most by which a rule can change a feature's value (or truth) times a weight."""
        rule, declared = self.rules[name], self.model.features[feature]
        if not number:
            return max(weight * (after - before) for before, after in self.pairs(rule, feature))
        if weight < 0 and not declared.bounded:
            refuse(f"{where}: {declared.name} is not declared bounded, its weight is negative")
        effect = rule.effects.get(feature)
        if weight and effect in (RAISING if weight > 0 else LOWERING):
            refuse(f"{where}: {name} may change {declared.name} by any number")
        return -abs(weight) if effect is (Effect.DEC if weight > 0 else Effect.INC) else 0

    def ranks(self, step: Any, rules: set[str], where: str) -> set[str]:
        from sketchlang.analysis.verify_ranks import check_ranks

        step = an_object(step, where, "ranks tables rules")
        if not isinstance(step["ranks"], list) or not isinstance(step["tables"], list):
            refuse(f"{where}: lists of features and of tables are expected")
        features = [self.feature(name, where) for name in step["ranks"]]
        if features != sorted(set(features)):
            refuse(f"{where}: the features are out of order")
        for name in sorted(rules):
            rule = self.rules[name]
            if not {*rule.conditions, *rule.effects} <= set(features):
                refuse(f"{where}: {name} has a feature that the tables do not have")
        if self.named(step["rules"], where) != rules:
            refuse(f"{where}: the rules that it takes away are {_list(rules)}")
        at_hand = {name: self.rules[name] for name in sorted(rules)}
        check_ranks(self.model, features, step["tables"], at_hand, self.pairs, where)
        return rules

    def split(
        self, step: Any, region: list[tuple[Answer, int]], rules: set[str], where: str
    ) -> set[str]:
        step = an_object(step, where, "split blocks rules")
        blocks = step["blocks"]
        if not isinstance(blocks, list):
            refuse(f"{where}: a list of blocks is expected")
        tree = self.tree(step["split"], len(blocks), {}, {}, where)
        staying: list[set[str]] = [set() for _ in blocks]
        for name in sorted(rules):
            for before, after in self.edges(self.rules[name], region, tree):
                if after < before:
                    refuse(f"{where}: {name} leads back from block {before} to block {after}")
                if after == before:
                    staying[before].add(name)
        left: set[str] = set()
        for number, (block, inside) in enumerate(zip(blocks, staying, strict=True)):
            here = f"{where}, block {number}"
            block = an_object(block, here, "rules proof")
            if self.named(block["rules"], here) != inside:
                refuse(f"{here}: the rules that can stay in it are {_list(inside)}")
            left |= self.proof(block["proof"], [*region, (tree, number)], inside, f"{here}, step ")
        if self.named(step["rules"], where) != rules - left:
            refuse(f"{where}: the rules that it takes away are {_list(rules - left)}")
        return rules - left

    def edges(
        self, rule: Rule, region: list[tuple[Answer, int]], tree: Answer
    ) -> set[tuple[int, int]]:
        """The blocks of the tree (before, after) that a rule connects within the region.

        Features are independent of each other in a rule. So all trees are walked at once,
        feature by feature, for the valuation before and the one after.
        """
        trees: tuple[Answer, ...] = (*(outer for outer, _ in region), tree)
        wanted = tuple(leaf for _, leaf in region)
        states = {(trees, trees)}
        for f in range(len(self.model.features)):
            pairs = self.pairs(rule, f)
            states = {
                (follow(before, f, bit_before), follow(after, f, bit_after))
                for before, after in states
                for bit_before, bit_after in pairs
            }
        return {
            (before[-1], after[-1])
            for before, after in states
            if before[:-1] == wanted == after[:-1]
            and isinstance(before[-1], int)
            and isinstance(after[-1], int)
        }

    def pairs(self, rule: Rule, feature: int) -> list[tuple[bool, bool]]:
        """Truth values of one feature before and after that a rule allows."""
        condition = rule.conditions.get(feature)
        effect = rule.effects.get(feature)
        result = []
        for before in (False, True):
            for after in (False, True):
                match effect:
                    case None:
                        allowed = after == before
                    case Effect.SET | Effect.INC:
                        allowed = after
                    case Effect.CLEAR:
                        allowed = not after
                    case Effect.DEC:
                        allowed = before
                    case Effect.NOT_INC:
                        allowed = before or not after
                    case Effect.NOT_DEC:
                        allowed = after or not before
                    case Effect.ANY:
                        allowed = True
                if allowed and condition in (None, before):
                    result.append((before, after))
        return result

    def tree(
        self,
        value: Any,
        blocks: int,
        answers: dict[int, bool],
        known: dict[tuple[int, int, int], Question],
        where: str,
    ) -> Answer:
        """Reads a decision tree and checks its leaves; `answers` are those on the path."""
        if isinstance(value, list) and len(value) == 3:
            feature = self.feature(value[0], where)
            if any(feature <= earlier for earlier in answers):
                refuse(f"{where}: the tree asks for {value[0]} out of order")
            low = self.tree(value[1], blocks, answers | {feature: False}, known, where)
            high = self.tree(value[2], blocks, answers | {feature: True}, known, where)
            question = Question(feature, low, high)
            return known.setdefault((feature, subtree_key(low), subtree_key(high)), question)
        if isinstance(value, int) and not isinstance(value, bool) and 0 <= value < blocks:
            return value
        if value is not None:
            refuse(f"{where}: {value!r} is no leaf of a tree with {blocks} blocks")
        goal = self.model.goal
        if goal is not None and all(answers.get(f) == wanted for f, wanted in goal.items()):
            return None
        if not any(truth(inv.formula, answers) is False for inv in self.model.invariants):
            refuse(f"{where}: it leaves out valuations that a run may pass")
        return None

    def feature(self, name: Any, where: str) -> int:
        if not isinstance(name, str) or name not in self.features:
            refuse(f"{where}: the sketch has no feature {name!r}")
        return self.features[name]

    def named(self, names: Any, where: str) -> set[str]:
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            refuse(f"{where}: a list of rule names is expected")
        for name in names:
            if name not in self.rules:
                refuse(f"{where}: the sketch has no rule {name!r}")
        if len(set(names)) < len(names):
            refuse(f"{where}: a rule is named twice")
        return set(names)


def _list(names: Sequence[str] | set[str]) -> str:
    return ", ".join(sorted(names)) or "none"
