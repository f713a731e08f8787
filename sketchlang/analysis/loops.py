"""Long cycles as nested loops: a grammar that says the same in a few lines.

Repeats in a row become a power, and the pair of neighbours that is seen most often becomes a
name, again and again (Larsson and Moffat, Off-line Dictionary-Based Compression, 2000). A
Gray code of 2^n steps becomes some n lines.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from sketchlang.analysis.limits import Budget


@dataclass(frozen=True, slots=True)
class Part:
    """`times` a rule in a row, or, with `loop`, a whole loop of this number."""

    number: int
    times: int
    loop: bool


@dataclass(frozen=True, slots=True)
class Loops:
    """The parts of a cycle, and of the loops that it names, each with its steps in all."""

    cycle: tuple[Part, ...]
    loops: tuple[tuple[int, tuple[Part, ...]], ...]


def nested_loops(rules: Sequence[int], budget: Budget) -> Loops:
    """A sequence of rules as nested loops.

    Raises:
        LimitReachedError: a limit of the budget was reached.
    """
    # Symbols: a rule r is (r, 1, False); names are numbers of `bodies`.
    sequence = [Part(rule, 1, False) for rule in rules]
    bodies: list[tuple[Part, ...]] = []
    while True:
        budget.check()
        sequence = _collapsed(sequence)
        pairs: Counter[tuple[Part, Part]] = Counter()
        last: tuple[Part, Part] | None = None
        for pair in pairwise(sequence):
            # In a a a there is one pair of a, not two.
            last = None if pair == last else pair
            pairs[pair] += last is not None
        if not pairs:
            break
        best, count = pairs.most_common(1)[0]
        if count < 2:
            break
        name = Part(len(bodies), 1, True)
        bodies.append(best)
        sequence = _replaced(sequence, best, name)
    return _tidied(sequence, bodies)


def _collapsed(sequence: Sequence[Part]) -> list[Part]:
    result: list[Part] = []
    for part in sequence:
        if result and (result[-1].number, result[-1].loop) == (part.number, part.loop):
            result[-1] = Part(part.number, result[-1].times + part.times, part.loop)
        else:
            result.append(part)
    return result


def _replaced(sequence: Sequence[Part], pair: tuple[Part, Part], name: Part) -> list[Part]:
    result: list[Part] = []
    i = 0
    while i < len(sequence):
        if i + 1 < len(sequence) and (sequence[i], sequence[i + 1]) == pair:
            result.append(name)
            i += 2
        else:
            result.append(sequence[i])
            i += 1
    return result


def _tidied(sequence: Sequence[Part], bodies: Sequence[tuple[Part, ...]]) -> Loops:
    """Names that are used once, and once in a row, are written out; the others numbered anew."""
    uses: Counter[int] = Counter()
    for body in (sequence, *bodies):
        uses.update(part.number for part in body if part.loop)
    repeated = {
        part.number for body in (sequence, *bodies) for part in body if part.loop and part.times > 1
    }

    def written(body: Sequence[Part]) -> tuple[Part, ...]:
        result: list[Part] = []
        for part in body:
            if part.loop and uses[part.number] == 1 and part.number not in repeated:
                result += written(bodies[part.number])
            else:
                result.append(part)
        return tuple(result)

    steps: list[int] = []
    for body in bodies:
        steps.append(sum(p.times * (steps[p.number] if p.loop else 1) for p in body))
    kept = [n for n in range(len(bodies)) if uses[n] > 1 or n in repeated]
    number = {old: new for new, old in enumerate(kept)}

    def numbered(body: Sequence[Part]) -> tuple[Part, ...]:
        return tuple(
            Part(number[part.number], part.times, True) if part.loop else part
            for part in written(body)
        )

    return Loops(numbered(sequence), tuple((steps[n], numbered(bodies[n])) for n in kept))
