"""Integer solutions of homogeneous inequalities, by way of a linear programme (HiGHS).

Given rows a_i, look for integers x >= 0 with a_i x <= 0 for all i and a_i x <= -1 for as many
i as possible. Solutions can be added up and multiplied, so "as many as possible" is one set:
the programme is to make the sum of min(1, -a_i x) as large as it gets.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from sketchlang.analysis.limits import Budget, LimitReachedError

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
    matrix = _matrix(rows, columns)
    found = _most_rows(matrix, budget)
    if found is None:
        return None
    strict = matrix @ found < -0.5
    if not strict.any():
        return None
    candidates = [found]
    if matrix.shape[0] * columns <= SHORT:
        small = _smallest(matrix, strict, budget)
        if small is not None:
            candidates.insert(0, small)
    best: NDArray[np.int64] | None = None
    most = 0
    for solution in candidates:
        for scale in SCALES:
            rounded = np.rint(solution * scale).astype(np.int64)
            change = matrix @ rounded
            lowered = int((change < 0).sum())
            if (change <= 0).all() and lowered > most:
                best, most = rounded, lowered
            if most == int(strict.sum()):
                break
    return None if best is None else [int(x) for x in best]


def _matrix(rows: Sequence[Mapping[int, int]], columns: int) -> Any:
    import numpy as np
    from scipy.sparse import csr_array

    values = [value for row in rows for value in row.values()]
    places = [column for row in rows for column in row]
    ends = np.cumsum([0, *(len(row) for row in rows)])
    return csr_array(
        (np.array(values, np.int64), np.array(places, np.int64), ends), (len(rows), columns)
    )


def _most_rows(matrix: Any, budget: Budget) -> NDArray[np.float64] | None:
    """x that makes as many rows as possible at most -1."""
    import numpy as np
    from scipy.sparse import eye_array, hstack

    count, columns = matrix.shape
    cost = np.concatenate([np.zeros(columns), -np.ones(count)])
    bounds = [(0.0, None)] * columns + [(0.0, 1.0)] * count
    solution = _solve(cost, hstack([matrix, eye_array(count)]), np.zeros(count), bounds, budget)
    return None if solution is None else solution[:columns]


def _smallest(matrix: Any, strict: NDArray[np.bool_], budget: Budget) -> NDArray[np.float64] | None:
    """The x with the least sum that makes the same rows at most -1."""
    import numpy as np

    columns = matrix.shape[1]
    limits = np.where(strict, -1.0, 0.0)
    return _solve(np.ones(columns), matrix, limits, [(0.0, None)] * columns, budget)


def _solve(
    cost: Any, matrix: Any, limits: Any, bounds: Any, budget: Budget
) -> NDArray[np.float64] | None:
    from scipy.optimize import linprog

    left = budget.left()
    options = {} if left is None else {"time_limit": max(left, 0.01)}
    found = linprog(cost, A_ub=matrix, b_ub=limits, bounds=bounds, method="highs", options=options)
    budget.check()
    if found.status == 1 and left is not None:
        raise LimitReachedError("time", f"time limit of {budget.seconds:g} s")
    return found.x if found.status == 0 else None
