"""Integer solutions of homogeneous inequalities, by way of a linear programme (HiGHS).

Given rows a_i, look for integers x >= 0 with a_i x <= 0 for all i and a_i x <= -1 for as many
i as possible. Solutions can be added up and multiplied, so "as many as possible" is one set:
the programme is to make the sum of min(1, -a_i x) as large as it gets.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from sketchlang.analysis.limits import Budget
from sketchlang.analysis.programme import Matrix, solve

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

SCALES = (1, 2, 3, 4, 5, 6, 8, 10, 12, 20, 24, 60, 100, 1_000, 10_000, 1_000_000)
"""Factors before rounding, small ones first: short numbers read better."""

SHORT = 40_000
"""Rows times columns up to which a second programme looks for small numbers."""


def integer_weights(
    rows: Sequence[Mapping[int, int]], columns: int, budget: Budget
) -> list[int] | None:
    """The integers, or None if no row can be made negative (or only by huge numbers).

    Raises:
        LimitReachedError: the time of the budget is over.
    """
    import numpy as np

    budget.check()
    matrix = Matrix.of(rows, columns)
    found = _most_rows(matrix, budget)
    if found is None:
        return None
    strict = matrix.times(found) < -0.5
    if not strict.any():
        return None
    candidates = [found]
    if len(rows) * columns <= SHORT:
        small = _smallest(matrix, strict, budget)
        if small is not None:
            candidates.insert(0, small)
    best: NDArray[np.int64] | None = None
    most = 0
    for solution in candidates:
        for scale in SCALES:
            rounded = np.rint(solution * scale).astype(np.int64)
            change = matrix.times(rounded)
            lowered = int((change < 0).sum())
            if (change <= 0).all() and lowered > most:
                best, most = rounded, lowered
            if most == int(strict.sum()):
                break
    return None if best is None else [int(x) for x in best]


def _most_rows(matrix: Matrix, budget: Budget) -> NDArray[np.float64] | None:
    """x that makes as many rows as possible at most -1."""
    import numpy as np

    count, columns = matrix.shape
    cost = np.concatenate([np.zeros(columns), -np.ones(count)])
    most = np.concatenate([np.full(columns, np.inf), np.ones(count)])
    solution = solve(cost, matrix.with_slack(), np.zeros(count), most, budget)
    return None if solution is None else solution[:columns]


def _smallest(
    matrix: Matrix, strict: NDArray[np.bool_], budget: Budget
) -> NDArray[np.float64] | None:
    """The x with the least sum that makes the same rows at most -1."""
    import numpy as np

    columns = matrix.shape[1]
    limits = np.where(strict, -1.0, 0.0)
    return solve(np.ones(columns), matrix, limits, np.full(columns, np.inf), budget)
