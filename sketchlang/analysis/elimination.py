"""Rule elimination: a quick proof that looks at rules only, not at the policy graph.

Sound, not complete: what it leaves goes to Sieve. Rules are taken away one after another,

R1  if they lower a nat that no remaining rule may raise (or raise a bounded one that no
    remaining rule may lower);
R2  if they change the truth value of a feature in one direction and no remaining rule can
    change it back;
R3  as R1 and R2, where the rules that stand against it need another truth value of a
    marked feature: one that the remaining rules change in one direction only, so that in
    the long run it changes no more and the two cannot both be in use.

R1 and R2 go back to the argument of the paper's section on sketch termination ("feature v
is decreased in the second sketch rule but is not increased in any of the four").
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass

from sketchlang.analysis.bits import RuleBits, members
from sketchlang.analysis.proof import Block, Drop, Node, Split, Step, Tree

MOST_MARKED = 6
"""R3 makes two blocks of each marked feature it uses; beyond this Sieve finds less to say."""


@dataclass(frozen=True, slots=True)
class Elimination:
    """The steps that were found, and the rules that they leave."""

    steps: tuple[Step, ...]
    left: frozenset[int]


def eliminate(rules: Iterable[RuleBits], bounded: int) -> Elimination:
    """Takes away what R1, R2 and R3 can, the simplest first."""
    left = list(rules)
    steps: list[Step] = []
    while left:
        step = drop(left, bounded) or _flip(left) or _with_marked(left, bounded)
        if step is None:
            break
        gone = frozenset(step.rules if isinstance(step, Drop) else step.drops)
        left = [rule for rule in left if rule.index not in gone]
        steps.append(step)
    return Elimination(tuple(steps), frozenset(rule.index for rule in left))


def drop(rules: Collection[RuleBits], bounded: int) -> Drop | None:
    """R1: the first nat that some of the rules change strictly and none changes back."""
    falls = rises = may_fall = may_rise = 0
    for rule in rules:
        falls |= rule.falls
        rises |= rule.rises
        may_fall |= rule.may_fall
        may_rise |= rule.may_rise
    for feature in members(falls & ~may_rise):
        chosen = tuple(rule.index for rule in rules if rule.falls >> feature & 1)
        return Drop(feature, chosen)
    for feature in members(rises & bounded & ~may_fall):
        chosen = tuple(rule.index for rule in rules if rule.rises >> feature & 1)
        return Drop(feature, chosen, upwards=True)
    return None


@dataclass(frozen=True, slots=True)
class _Directions:
    """For every feature: who may set its bit, who may clear it, who may leave it 0 or 1."""

    setters: dict[int, set[int]]
    clearers: dict[int, set[int]]
    stays: dict[int, dict[int, tuple[int, ...]]]  # feature -> rule -> bits it can keep

    @classmethod
    def of(cls, rules: Collection[RuleBits]) -> _Directions:
        touched = 0
        for rule in rules:
            touched |= rule.needs | rule.sets | rule.clears | rule.free | rule.sinks | rule.climbs
        setters: dict[int, set[int]] = {}
        clearers: dict[int, set[int]] = {}
        stays: dict[int, dict[int, tuple[int, ...]]] = {}
        for feature in members(touched):
            pairs = {rule.index: rule.pairs(feature) for rule in rules}
            setters[feature] = {index for index, pair in pairs.items() if (0, 1) in pair}
            clearers[feature] = {index for index, pair in pairs.items() if (1, 0) in pair}
            stays[feature] = {
                index: tuple(bit for bit in (0, 1) if (bit, bit) in pair)
                for index, pair in pairs.items()
            }
        return cls(setters, clearers, stays)

    def one_way(self) -> list[int]:
        """The marked features: no rule sets the bit, or none clears it."""
        return [f for f in self.setters if not self.setters[f] or not self.clearers[f]]


def _flip(rules: Collection[RuleBits]) -> Split | None:
    """R2: two blocks, before and after the feature has changed for good."""
    directions = _Directions.of(rules)
    for feature in directions.one_way():
        stays = directions.stays[feature]
        gone = tuple(index for index, bits in stays.items() if not bits)
        if gone:
            return _monotone_split([feature], directions, rules, {})
    return None


def _with_marked(rules: Collection[RuleBits], bounded: int) -> Split | None:
    """R3: blocks for the truth values of some marked features, R1 and R2 within them."""
    directions = _Directions.of(rules)
    marked = directions.one_way()
    if not marked:
        return None
    by_index = {rule.index: rule for rule in rules}
    for rule in rules:
        for opponents in _opponents(rule, by_index, directions, bounded):
            used = _excluding(rule.index, opponents, marked, directions)
            if used is not None and len(used) <= MOST_MARKED:
                split = _monotone_split(used, directions, rules, {"bounded": bounded})
                if split.drops:
                    return split
    return None


def _opponents(
    rule: RuleBits, rules: dict[int, RuleBits], directions: _Directions, bounded: int
) -> Iterable[set[int]]:
    """For each change that the rule is sure to make, the rules that may undo it."""
    for feature in members(rule.falls):
        yield {i for i, other in rules.items() if other.may_rise >> feature & 1}
    for feature in members(rule.rises & bounded):
        yield {i for i, other in rules.items() if other.may_fall >> feature & 1}
    for feature, stays in directions.stays.items():
        if not stays[rule.index]:
            sets = rule.index in directions.setters[feature]
            yield (directions.clearers if sets else directions.setters)[feature]


def _excluding(
    index: int, opponents: set[int], marked: list[int], directions: _Directions
) -> list[int] | None:
    """Marked features that keep a rule and all its opponents apart, or None."""
    used: list[int] = []
    for opponent in sorted(opponents):
        for feature in sorted(marked, key=lambda f: f not in used):
            stays = directions.stays[feature]
            if not set(stays[index]) & set(stays[opponent]):
                if feature not in used:
                    used.append(feature)
                break
        else:
            return None
    return sorted(used)


def _monotone_split(
    features: list[int],
    directions: _Directions,
    rules: Collection[RuleBits],
    inner: dict[str, int],
) -> Split:
    """Blocks for all truth values of features that change in one direction only.

    With the earlier value of each feature as digit 0 and the later one as digit 1, no rule
    lowers a digit; so the digits read as a number never fall either.
    """
    blocks: list[Block] = []
    left: set[int] = set()

    def build(position: int, fixed: dict[int, int]) -> Tree:
        if position == len(features):
            staying = [
                rule
                for rule in rules
                if all(bit in directions.stays[f][rule.index] for f, bit in fixed.items())
            ]
            found = (
                _inside(staying, inner["bounded"])
                if inner
                else Elimination((), frozenset(rule.index for rule in staying))
            )
            left.update(found.left)
            blocks.append(Block(tuple(rule.index for rule in staying), found.steps))
            return len(blocks) - 1
        feature = features[position]
        first = 0 if not directions.clearers[feature] else 1
        earlier = build(position + 1, fixed | {feature: first})
        later = build(position + 1, fixed | {feature: 1 - first})
        return Node(feature, *((earlier, later) if first == 0 else (later, earlier)))

    tree = build(0, {})
    gone = tuple(rule.index for rule in rules if rule.index not in left)
    return Split(tree, tuple(blocks), gone)


def _inside(rules: list[RuleBits], bounded: int) -> Elimination:
    """R1 and R2 on the rules of one block."""
    left = list(rules)
    steps: list[Step] = []
    while left:
        step = drop(left, bounded) or _flip(left)
        if step is None:
            break
        gone = frozenset(step.rules if isinstance(step, Drop) else step.drops)
        left = [rule for rule in left if rule.index not in gone]
        steps.append(step)
    return Elimination(tuple(steps), frozenset(rule.index for rule in left))
