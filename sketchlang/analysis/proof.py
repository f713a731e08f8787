"""Proofs of termination: what the prover makes, certificates store, and people read.

A proof is a sequence of steps about a set R of rules and a region of valuations. Each
step takes away rules that no infinite run through the region can use for ever:

- `Drop`: a nat that some rules lower and no rule raises. They fire finitely often, since
  a counter cannot become negative (or, for a bounded nat, the same upside down).
- `Potential`: a weighted sum of features that some rules lower and no rule raises.
- `Ranks`: no rule leads back in an order of all valuations, in rounds.
- `Split`: the region is cut into blocks, numbered so that no rule leads from a block to an
  earlier one. An infinite run comes to stay in one of them; there it can only use rules
  with an edge inside the block, and the block has steps of its own.

It is a proof of termination when no rules are left. Single valuations as blocks make it
as strong as Sieve; a sketch that rule elimination proves needs hardly any blocks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple


@dataclass(frozen=True, slots=True)
class Node:
    """A question in a decision tree: is the feature true (> 0)? Questions go by index."""

    feature: int
    low: Tree
    high: Tree


Tree = int | None | Node
"""Numbers of blocks at the leaves; None where no run passes: a goal, or an invariant fails."""


@dataclass(frozen=True, slots=True)
class Drop:
    """`rules` fire finitely often: each lowers `feature`, and nothing that is left raises it.

    With `upwards` each raises it, nothing lowers it, and the feature is bounded.
    """

    feature: int
    rules: tuple[int, ...]
    upwards: bool = False


class Term(NamedTuple):
    """`weight` times a feature's value, or with `of_truth` times its truth value (0 or 1)."""

    feature: int
    of_truth: bool
    weight: int


@dataclass(frozen=True, slots=True)
class Potential:
    """`rules` fire finitely often: each lowers the sum of the terms, and no rule raises it.

    Terms of numbers have positive weights, or negative ones where the nat is bounded.
    """

    terms: tuple[Term, ...]
    rules: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Block:
    """One block of a split: the rules with an edge inside it, and how they go."""

    rules: tuple[int, ...]
    steps: tuple[Step, ...] = ()


@dataclass(frozen=True, slots=True)
class Split:
    """`drops` are the rules that are left in no block."""

    tree: Tree
    blocks: tuple[Block, ...]
    drops: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Ranks:
    """All rules go, because of ranks of all valuations of some features.

    A table has four bytes (little-endian) a valuation, bit i of its number is `features[i]`;
    the largest number stands where no infinite run passes. No rule leads to a lower rank. In
    the next table, which refines the one before, that need hold only for rules that could
    keep their rank, without those that lower a nat which none of them may raise there.
    """

    features: tuple[int, ...]
    tables: tuple[bytes, ...]
    rules: tuple[int, ...]


Step = Drop | Potential | Split | Ranks
