"""How many random sketches that terminate are proved without a list of their valuations.

    python -m benchmarks.proof_share [--features 6,9,12,16,20] [--sketches 200]

Sketches are those of a random family of `benchmarks/families.py`, with as many rules as
features, half as many and twice as many in turn, until so many of them terminate. Each line has, of
these: how many rule elimination proves alone, how many with potentials as well, how many
`terminate` proves while it tells at most half of the features apart at a time, so with a few
of the valuations of the sketch; with more than half; and with all of them, which is a list of all
valuations. The last columns say how many others did not terminate, and how many were not
decided within `--time-limit` seconds.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from benchmarks.families import FAMILIES
from sketchlang.analysis.bits import bounded_mask, rule_bits
from sketchlang.analysis.elimination import eliminate
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.potential import potential
from sketchlang.analysis.proof import Node, Ranks, Split, Step, Tree
from sketchlang.analysis.termination import NonTerminating, Terminating, decide_termination
from sketchlang.loader import load_text
from sketchlang.model import SketchModel
from sketchlang.source import Source

COLUMNS = ("features", "terminate", "elimination", "potentials", "up to half", "more", "all")
OTHERS = ("endless", "undecided")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--features", default="6,9,12,16,20")
    parser.add_argument("--sketches", type=int, default=200, help="terminating ones of each size")
    parser.add_argument("--time-limit", type=float, default=20.0, help="seconds a proof")
    parser.add_argument("--family", choices=("dense", "mixed"), default="mixed")
    arguments = parser.parse_args()
    print("  ".join(f"{name:>13}" for name in (*COLUMNS, *OTHERS)))
    for features in map(int, arguments.features.split(",")):
        counts = _counts(arguments.family, features, arguments.sketches, arguments.time_limit)
        cells = (features, *(counts[name] for name in (*COLUMNS[1:], *OTHERS)))
        print("  ".join(f"{cell:>13}" for cell in cells), flush=True)


def _counts(family: str, features: int, wanted: int, time_limit: float) -> dict[str, int]:
    counts = dict.fromkeys((*COLUMNS, *OTHERS), 0)
    seed = 0
    while counts["terminate"] < wanted:
        rules = (features, features // 2, 2 * features)[seed % 3]
        model = load_text(
            Source("it.sketch", FAMILIES[family](features, rules, seed))
        ).checked.model
        seed += 1
        verdict = decide_termination(model, Budget(time_limit))
        if not isinstance(verdict, Terminating):
            counts["endless" if isinstance(verdict, NonTerminating) else "undecided"] += 1
            continue
        counts["terminate"] += 1
        counts["elimination"] += verdict.method == "rule-elimination"
        counts["potentials"] += _by_potentials(model)
        asked, named = _features_asked(verdict.steps).bit_count(), _features_named(model)
        counts["all" if asked == named else "more" if 2 * asked > named else "up to half"] += 1
    return counts


def _by_potentials(model: SketchModel) -> bool:
    """Whether rule elimination and potentials in turn leave no rule."""
    bounded = bounded_mask(model)
    left = [rule for rule in rule_bits(model) if not rule.dead]
    while left:
        kept = eliminate(left, bounded).left
        left = [rule for rule in left if rule.index in kept]
        found = potential(left, bounded, Budget()) if left else None
        if found is None:
            break
        left = [rule for rule in left if rule.index not in found.rules]
    return not left


def _features_named(model: SketchModel) -> int:
    """How many features the rules name."""
    mask = 0
    for rule in rule_bits(model):
        mask |= rule.needs | rule.touched
    return mask.bit_count()


def _features_asked(steps: Sequence[Step]) -> int:
    """The features (a mask) that are told apart at a time, where these are most."""
    most = 0
    for step in steps:
        here = 0
        if isinstance(step, Ranks):
            here = sum(1 << feature for feature in step.features)
        elif isinstance(step, Split):
            inside = [_features_asked(block.steps) for block in step.blocks]
            here = _asked(step.tree) | max(inside, key=int.bit_count, default=0)
        most = max(most, here, key=int.bit_count)
    return most


def _asked(tree: Tree) -> int:
    """The features of a decision tree, as a mask."""
    if not isinstance(tree, Node):
        return 0
    mask, waiting, seen = 0, [tree], {id(tree)}
    while waiting:
        node = waiting.pop()
        mask |= 1 << node.feature
        for below in (node.low, node.high):
            if isinstance(below, Node) and id(below) not in seen:
                seen.add(id(below))
                waiting.append(below)
    return mask


if __name__ == "__main__":
    main()
