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


class _Directions:
    """For every feature: who may set its bit, who may clear it, who may leave it 0 or 1."""

    def __init__(self, rules: Collection[RuleBits]) -> None:
        self._found: dict[tuple[int, int], frozenset[int]] = {}
        self._moves = {rule.index: rule.moves() for rule in rules}
        touched = may_set = may_clear = 0
        for rule in rules:
            touched |= rule.needs | rule.touched
        for _, sets, clears, _ in self._moves.values():
            may_set |= sets
            may_clear |= clears
        self.features = list(members(touched))
        self.one_way = list(members(touched & ~(may_set & may_clear)))
        """The marked features: no rule sets the bit, or none clears it."""

    def setters(self, feature: int) -> frozenset[int]:
        return self._which(1, feature)

    def clearers(self, feature: int) -> frozenset[int]:
        return self._which(2, feature)

    def _which(self, move: int, feature: int) -> frozenset[int]:
        found = self._found.get((move, feature))
        if found is None:
            chosen = (i for i, moves in self._moves.items() if moves[move] >> feature & 1)
            found = self._found[move, feature] = frozenset(chosen)
        return found

    def stays(self, feature: int, rule: int) -> tuple[int, ...]:
        """The bits that a rule can keep."""
        zero, _, _, one = self._moves[rule]
        return (*((0,) if zero >> feature & 1 else ()), *((1,) if one >> feature & 1 else ()))

    def changers(self, feature: int) -> tuple[int, ...]:
        """The rules that are sure to change the bit."""
        bit = 1 << feature
        return tuple(i for i, moves in self._moves.items() if not (moves[0] | moves[3]) & bit)


def _flip(rules: Collection[RuleBits]) -> Split | None:
    """R2: two blocks, before and after the feature has changed for good."""
    directions = _Directions(rules)
    for feature in directions.one_way:
        if directions.changers(feature):
            return _monotone_split([feature], directions, rules, {})
    return None


def _with_marked(rules: Collection[RuleBits], bounded: int) -> Split | None:
    """R3: blocks for the truth values of some marked features, R1 and R2 within them."""
    directions = _Directions(rules)
    marked = directions.one_way
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
) -> Iterable[Collection[int]]:
    """For each change that the rule is sure to make, the rules that may undo it."""
    for feature in members(rule.falls):
        yield {i for i, other in rules.items() if other.may_rise >> feature & 1}
    for feature in members(rule.rises & bounded):
        yield {i for i, other in rules.items() if other.may_fall >> feature & 1}
    for feature in directions.features:
        if not directions.stays(feature, rule.index):
            sets = rule.index in directions.setters(feature)
            yield (directions.clearers if sets else directions.setters)(feature)


def _excluding(
    index: int, opponents: Collection[int], marked: list[int], directions: _Directions
) -> list[int] | None:
    """Marked features that keep a rule and all its opponents apart, or None."""
    used: list[int] = []
    for opponent in sorted(opponents):
        for feature in sorted(marked, key=lambda f: f not in used):
            if not set(directions.stays(feature, index)) & set(directions.stays(feature, opponent)):
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
                if all(bit in directions.stays(f, rule.index) for f, bit in fixed.items())
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
        first = 0 if not directions.clearers(feature) else 1
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
