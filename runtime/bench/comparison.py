"""Two sets of results compared pair by pair: the same sketch, scene, robot and seed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from runtime.bench.job import Job, Result, key
from runtime.bench.statistics import (
    RESAMPLES,
    Interval,
    quantile,
    ratio_of_medians,
    sign_test,
    wilcoxon,
)
from runtime.bench.summary import seconds_of
from runtime.bench.table import Table, seconds
from sketchlang.errors import InputError
from sketchlang.suggest import did_you_mean

CHOSEN = ("sketch", "scene", "planner", "robot")
"""What results can be chosen by, besides their file."""

LEAST = 1e-4
"""Seconds: what is reported as less counts as this much, so that there are ratios."""


@dataclass(frozen=True)
class Compared:
    """What pairs of runs tell. Of the pairs that both solve: the medians of the planning times,
    their ratio B/A with its interval, in how many A or B is quicker, and the two-sided
    probabilities of the sign test and of Wilcoxon's signed-rank test on the logarithms of the
    ratios. `p_solved` is that of the sign test on the runs that one of them alone solves."""

    pairs: int
    both: int
    only_a: int
    only_b: int
    p_solved: float
    median_a: float | None = None
    median_b: float | None = None
    ratio: float | None = None
    interval: Interval | None = None
    a_quicker: int = 0
    b_quicker: int = 0
    p_sign: float | None = None
    p_wilcoxon: float | None = None

    def as_data(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)


def choice_of(words: str) -> dict[str, str]:
    """What `planner=NAME,scene=NAME` chooses.

    Raises:
        InputError: it is not written so.
    """
    found = {}
    for word in filter(None, words.split(",")):
        name, equals, value = word.partition("=")
        if not equals or name not in CHOSEN:
            hint = did_you_mean(name, CHOSEN) or f"write one of {', '.join(CHOSEN)}, `=` and a name"
            raise InputError(f"results cannot be chosen by {word!r}", hint=hint)
        found[name] = value
    return found


def chosen(results: Sequence[Result], choice: Mapping[str, str]) -> list[Result]:
    """The results of a choice; of a run that was repeated with other versions, the last."""
    found: dict[tuple[object, ...], Result] = {}
    for result in results:
        job = key(result)
        if all(getattr(job, name) == value for name, value in choice.items()):
            same = (*(getattr(job, name) for name in CHOSEN), job.seed, job.timeout)
            found.pop(same, None)
            found[same] = result
    return list(found.values())


def paired(
    a: Sequence[Result], b: Sequence[Result], free: set[str]
) -> dict[str, list[tuple[Result, Result]]]:
    """Pairs of results by scene that are alike but for what `free` names.

    Raises:
        InputError: several results of one side belong to the same pair.
    """

    def table(results: Sequence[Result], side: str) -> dict[tuple[object, ...], Result]:
        found: dict[tuple[object, ...], Result] = {}
        for result in results:
            job: Job = key(result)
            alike = (*(getattr(job, name) for name in CHOSEN if name not in free), job.seed)
            if alike in found:
                differs = [n for n in (*CHOSEN, "timeout") if _differs(found[alike], result, n)]
                raise InputError(
                    f"{side} has several results of one run, with different {differs[0]}",
                    hint=f"choose: {side}=FILE:{differs[0]}=NAME" if differs[0] in CHOSEN else None,
                )
            found[alike] = result
        return found

    of_a, of_b = table(a, "A"), table(b, "B")
    pairs: dict[str, list[tuple[Result, Result]]] = {}
    for alike, result in of_a.items():
        if alike in of_b:
            pairs.setdefault(key(result).scene, []).append((result, of_b[alike]))
    return pairs


def _differs(one: Result, other: Result, name: str) -> bool:
    return bool(getattr(key(one), name) != getattr(key(other), name))


def compared(pairs: Sequence[tuple[Result, Result]]) -> Compared:
    """What some pairs tell, at least one."""
    times = [(seconds_of(a), seconds_of(b)) for a, b in pairs]
    only_a = sum(math.isfinite(a) and math.isinf(b) for a, b in times)
    only_b = sum(math.isinf(a) and math.isfinite(b) for a, b in times)
    both = [(max(a, LEAST), max(b, LEAST)) for a, b in times if math.isfinite(a + b)]
    p_solved = sign_test(only_a, only_b)
    if not both:
        return Compared(len(pairs), 0, only_a, only_b, p_solved)
    ratio, interval = ratio_of_medians(both)
    a_quicker, b_quicker = sum(a < b for a, b in both), sum(b < a for a, b in both)
    return Compared(
        len(pairs), len(both), only_a, only_b, p_solved,
        quantile([a for a, _ in both], 0.5), quantile([b for _, b in both], 0.5),
        ratio, interval, a_quicker, b_quicker, sign_test(a_quicker, b_quicker),
        wilcoxon([math.log(b / a) for a, b in both]),
    )  # fmt: skip


def tables(found: Mapping[str, Compared]) -> list[Table]:
    """Comparisons by scene, and of all together, as tables."""
    solved = tuple(
        (scene, str(c.pairs), str(c.both), str(c.only_a), str(c.only_b), _p(c.p_solved))
        for scene, c in found.items()
    )
    times = tuple(
        (
            scene,
            seconds(c.median_a or 0.0),
            seconds(c.median_b or 0.0),
            f"{c.ratio:.2f}",
            f"{c.interval[0]:.2f}-{c.interval[1]:.2f}",
            f"{c.a_quicker}:{c.b_quicker}",
            _p(c.p_sign),
            _p(c.p_wilcoxon),
        )
        for scene, c in found.items()
        if c.ratio is not None and c.interval is not None
    )
    return [
        Table(
            "Solved by A and B",
            ("scene", "pairs", "both", "only A", "only B", "p"),
            solved,
            1,
            ("p: exact two-sided sign test on the runs that only one of them solves.",),
        ),
        Table(
            "Planning, seconds, where both solve",
            ("scene", "A", "B", "B/A", "95 %", "quicker", "p sign", "p rank"),
            times,
            1,
            (
                "Medians; B/A: their ratio, with the interval of a bootstrap of pairs "
                f"({RESAMPLES} samples). quicker: pairs in which A, and in which B, takes less. "
                "p: exact sign test; Wilcoxon's signed-rank test on the logarithms of the ratios.",
            ),
        ),
    ]


def _p(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:.3f}" if value >= 0.001 else f"{value:.0e}"
