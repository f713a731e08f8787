"""Intervals and tests against SciPy and against their definitions."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from runtime.bench.statistics import (
    binomial_interval,
    median_interval,
    quantile,
    ratio_of_medians,
    sign_test,
    wilcoxon,
)

NUMBERS = st.lists(st.floats(0.001, 1000.0), min_size=1, max_size=30)


@given(values=NUMBERS, share=st.sampled_from([0.0, 0.25, 0.5, 0.75, 1.0]))
def test_quantiles_are_those_of_numpy(values, share) -> None:
    assert quantile(values, share) == pytest.approx(float(np.quantile(values, share)))


def test_quantiles_of_runs_that_never_ended() -> None:
    assert quantile([1.0, 2.0, math.inf], 0.5) == 2.0
    assert quantile([1.0, math.inf], 0.5) == math.inf
    assert quantile([math.inf, math.inf, math.inf], 0.25) == math.inf


@pytest.mark.parametrize(("k", "n"), [(0, 1), (1, 1), (3, 10), (10, 10), (299, 300), (5000, 9000)])
def test_the_interval_of_a_share_is_that_of_scipy(k, n) -> None:
    expected = stats.binomtest(k, n).proportion_ci(method="exact")
    assert binomial_interval(k, n) == pytest.approx((expected.low, expected.high), abs=1e-9)


@pytest.mark.parametrize("n", [1, 5, 6, 9, 10, 25, 100, 3000])
def test_the_interval_of_a_median_has_the_rank_of_the_binomial_distribution(n) -> None:
    """The greatest rank r for which fewer than r values below the median are as rare as that."""
    found = median_interval(list(range(n)))
    rank = int(stats.binom.ppf(0.025, n, 0.5)) - 1  # the next one is the first that is too likely
    if rank < 0:
        assert found is None
        return
    assert stats.binom.cdf(rank, n, 0.5) <= 0.025 < stats.binom.cdf(rank + 1, n, 0.5)
    assert found == (rank, n - 1 - rank)


@pytest.mark.parametrize(("better", "worse"), list(product([0, 1, 5, 12], repeat=2)))
def test_the_sign_test_is_the_binomial_test(better, worse) -> None:
    expected = stats.binomtest(better, better + worse).pvalue if better + worse else 1.0
    assert sign_test(better, worse) == pytest.approx(expected)


def test_the_rank_test_leaves_out_what_is_equal() -> None:
    assert wilcoxon([0.0, 0.0]) is None
    # All five of one sign: two of the 32 ways to give signs.
    assert wilcoxon([0.0, 1.0, 2.0, 3.0, 4.0, 5.0]) == pytest.approx(2 / 32)


def test_the_ratio_of_medians_has_its_interval_around_it() -> None:
    rng = np.random.default_rng(1)
    first = rng.lognormal(size=200)
    pairs = [(float(a), float(2 * a * rng.lognormal(0, 0.1))) for a in first]
    ratio, (low, high) = ratio_of_medians(pairs)
    assert low < ratio < high
    assert low < 2.0 < high
    assert high - low < 1.0
    assert ratio_of_medians([(1.0, 3.0)] * 4) == (3.0, (3.0, 3.0))
