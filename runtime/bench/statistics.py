"""Medians, intervals and tests of results, exact where that is possible.

A run that was not solved counts as infinitely long, so that nobody gains by giving up. Intervals
have 95 per cent unless said otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

LEVEL = 0.95
RESAMPLES = 2000
"""Of a bootstrap."""

SEED = 0
"""Of a bootstrap: the same results give the same interval."""

Interval = tuple[float, float]


def quantile(values: Sequence[float], share: float) -> float:
    """The value below which a share of the values lies, between two of them by their distance."""
    ordered = sorted(values)
    place = share * (len(ordered) - 1)
    low = math.floor(place)
    part = place - low
    if part == 0 or ordered[low] == ordered[low + 1]:
        return ordered[low]
    return ordered[low] + part * (ordered[low + 1] - ordered[low])


def binomial_interval(successes: int, runs: int, level: float = LEVEL) -> Interval:
    """The exact interval of Clopper and Pearson (1934) for a share."""
    tail = (1 - level) / 2
    low = 0.0 if successes == 0 else _root(lambda p: _at_least(successes, runs, p) - tail)
    high = 1.0 if successes == runs else _root(lambda p: tail - _at_most(successes, runs, p))
    return low, high


def _at_least(k: int, n: int, p: float) -> float:
    return math.fsum(_exactly(i, n, p) for i in range(k, n + 1))


def _at_most(k: int, n: int, p: float) -> float:
    return math.fsum(_exactly(i, n, p) for i in range(k + 1))


def _exactly(k: int, n: int, p: float) -> float:
    """By logarithms, for the numbers themselves are too large for thousands of runs."""
    ways = math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1)
    return math.exp(ways + k * math.log(p) + (n - k) * math.log1p(-p))


def _root(rising: Callable[[float], float]) -> float:
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if rising(middle) < 0 else (low, middle)
    return (low + high) / 2


def median_interval(values: Sequence[float], level: float = LEVEL) -> Interval | None:
    """Two of the values between which the median lies, by the binomial distribution alone: no
    shape of the distribution is assumed. None where there are too few, below six for 95 %."""
    ordered, n = sorted(values), len(values)
    tail, rank = 1, 0
    most = (1 - level) / 2
    while (tail + math.comb(n, rank + 1)) / (1 << n) <= most:
        rank += 1
        tail += math.comb(n, rank)
    return (ordered[rank], ordered[n - 1 - rank]) if tail / (1 << n) <= most else None


def sign_test(better: int, worse: int) -> float:
    """The exact two-sided probability of a split at least as uneven, were both as likely."""
    n, k = better + worse, min(better, worse)
    return min(1.0, 2 * sum(math.comb(n, i) for i in range(k + 1)) / (1 << n))


def wilcoxon(differences: Sequence[float]) -> float | None:
    """The two-sided probability of Wilcoxon's signed-rank test; None where nothing differs."""
    from scipy.stats import wilcoxon as signed_rank

    found = [d for d in differences if d != 0]
    return float(signed_rank(found).pvalue) if found else None


def ratio_of_medians(
    pairs: Sequence[tuple[float, float]], level: float = LEVEL
) -> tuple[float, Interval]:
    """The median of the second over that of the first, and its interval: a bootstrap that draws
    whole pairs (percentiles of `RESAMPLES` samples). All values are above 0."""
    values = np.array(pairs, dtype=float)
    rng = np.random.default_rng(SEED)
    drawn = values[rng.integers(len(values), size=(RESAMPLES, len(values)))]
    ratios = np.median(drawn[:, :, 1], axis=1) / np.median(drawn[:, :, 0], axis=1)
    low, high = np.quantile(ratios, [(1 - level) / 2, (1 + level) / 2])
    first, second = np.median(values, axis=0)
    return float(second / first), (float(low), float(high))
