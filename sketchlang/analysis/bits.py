"""Rules as operations on valuations, and valuations as integers.

A valuation is one bit a feature: bit f is 1 where the Boolean is true or the nat is > 0
(the paper calls it an abstract state). The policy graph has an edge for each way in which a
rule can change a valuation, and for each feature on its own the ways are few:

    effect          bit before -> after
    p, n++          anything -> 1
    !p              anything -> 0
    n--             1 -> 0 or 1
    ?               anything -> anything
    !n++            0 -> 0,  1 -> 0 or 1
    !n--            0 -> 0 or 1,  1 -> 1
    not named       unchanged

`RuleBits` holds these as masks, so that the successors of a valuation under a rule are
`base | s` for every subset `s` of a mask of free bits: nobody has to list 2^n of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sketchlang.model import Effect, Kind, Rule, SketchModel

RAISES = frozenset({Effect.INC, Effect.ANY, Effect.NOT_DEC})
"""Effects under which a nat may rise."""

LOWERS = frozenset({Effect.DEC, Effect.ANY, Effect.NOT_INC})
"""Effects under which a nat may fall."""


@dataclass(frozen=True, slots=True)
class RuleBits:
    """One rule as masks over feature bits.

    The rule applies to valuations v with `v & needs == wants` (its conditions, and a 1 for
    every nat that it lowers by `n--`). Of the features named in the effects each is in one
    of `sets`, `clears`, `free`, `sinks` (1 may become 0) and `climbs` (0 may become 1).
    `falls`, `rises`, `may_fall` and `may_rise` are about values, nats only: strict change,
    and possible change. A rule is `dead` if its own conditions make an effect impossible.
    """

    index: int
    needs: int
    wants: int
    sets: int
    clears: int
    free: int
    sinks: int
    climbs: int
    falls: int
    rises: int
    may_fall: int
    may_rise: int
    dead: bool

    @property
    def touched(self) -> int:
        """The features that the rule may change."""
        return self.sets | self.clears | self.free | self.sinks | self.climbs

    def moves(self) -> tuple[int, int, int, int]:
        """The features whose bit may go 0 -> 0, 0 -> 1, 1 -> 0 and 1 -> 1, as masks.

        Features that the rule does not name stay as they are: the masks have no end.
        """
        from_0, from_1 = ~(self.needs & self.wants), ~(self.needs & ~self.wants)
        return (
            from_0 & ~self.sets,
            from_0 & (self.sets | self.free | self.climbs),
            from_1 & (self.clears | self.free | self.sinks),
            from_1 & ~self.clears,
        )

    def fan(self, valuation: int) -> tuple[int, int]:
        """`(base, free)`: the successors of a valuation are `base | s`, s a subset of `free`."""
        free = self.free | (self.sinks & valuation) | (self.climbs & ~valuation)
        return (valuation & ~(self.clears | free)) | self.sets, free

    def pairs(self, feature: int) -> tuple[tuple[int, int], ...]:
        """The (before, after) bits of one feature that the rule allows."""
        bit = 1 << feature
        result = []
        for before in (0, bit):
            if (before ^ self.wants) & self.needs & bit:
                continue
            base, free = self.fan(before)
            if free & bit:
                result += [(int(before > 0), 0), (int(before > 0), 1)]
            else:
                result.append((int(before > 0), int(base & bit > 0)))
        return tuple(result)


def rule_bits(model: SketchModel) -> tuple[RuleBits, ...]:
    """All rules of a sketch as masks, in order."""
    nats = sum(1 << f for f, feature in enumerate(model.features) if feature.kind is Kind.NAT)
    return tuple([_masks(index, rule, nats) for index, rule in enumerate(model.rules)])


_UNCHANGED = dict.fromkeys(Effect, 0)  # in the order in which `_masks` unpacks them


def _masks(index: int, rule: Rule, nats: int) -> RuleBits:
    # Small proofs take as long as this does.
    needs = wants = 0
    for feature, positive in rule.conditions.items():
        bit = 1 << feature
        needs |= bit
        if positive:
            wants |= bit
    by_effect = _UNCHANGED.copy()
    for feature, effect in rule.effects.items():
        by_effect[effect] |= 1 << feature
    sets, clears, lowered, raised, sinks, climbs, any_ = by_effect.values()
    return RuleBits(
        index=index,
        needs=needs | lowered,
        wants=wants | lowered,
        sets=sets | raised,
        clears=clears,
        free=any_ | lowered,
        sinks=sinks,
        climbs=climbs,
        falls=lowered,
        rises=raised,
        may_fall=nats & (lowered | any_ | sinks),
        may_rise=nats & (raised | any_ | climbs),
        dead=bool(lowered & needs & ~wants),
    )


def bounded_mask(model: SketchModel) -> int:
    """The features that are declared bounded."""
    return sum(1 << f for f, feature in enumerate(model.features) if feature.bounded)


def subsets(mask: int) -> Iterator[int]:
    """All subsets of a mask, 0 first."""
    subset = 0
    while True:
        yield subset
        subset = (subset - mask) & mask
        if not subset:
            return


def members(mask: int) -> Iterator[int]:
    """The features in a mask, in order."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low
