"""Integer solutions of homogeneous inequalities, by way of a linear programme (HiGHS).

Given rows a_i, look for integers x >= 0 with a_i x <= 0 for all i and a_i x <= -1 for as many
i as possible. Solutions can be added up and multiplied, so "as many as possible" is one set:
the programme is to make the sum of min(1, -a_i x) as large as it gets.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
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
    matrix = _Matrix.of(rows, columns)
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


@dataclass(frozen=True, eq=False)
class _Matrix:
    """A sparse matrix, row by row: entry k is `values[k]` at `rows[k]`, `places[k]`."""

    shape: tuple[int, int]
    values: NDArray[np.int64]
    rows: NDArray[np.int64]
    places: NDArray[np.int64]

    @classmethod
    def of(cls, rows: Sequence[Mapping[int, int]], columns: int) -> _Matrix:
        import numpy as np

        values = [value for row in rows for value in row.values()]
        places = [column for row in rows for column in row]
        numbers = [number for number, row in enumerate(rows) for _ in row]
        arrays = (np.array(each, np.int64) for each in (values, numbers, places))
        return cls((len(rows), columns), *arrays)

    def times(self, x: NDArray[Any]) -> NDArray[Any]:
        """The product with a column; exact for integers."""
        import numpy as np

        product = np.zeros(self.shape[0], dtype=x.dtype)
        np.add.at(product, self.rows, self.values * x[self.places])
        return product

    def with_slack(self) -> _Matrix:
        """The same with one more column for each row, in which only that row has a 1."""
        import numpy as np

        count, columns = self.shape
        own = np.arange(count)
        rows = np.concatenate([self.rows, own])
        order = np.argsort(rows, kind="stable")
        return _Matrix(
            (count, columns + count),
            np.concatenate([self.values, np.ones(count, np.int64)])[order],
            rows[order],
            np.concatenate([self.places, columns + own])[order],
        )


def _most_rows(matrix: _Matrix, budget: Budget) -> NDArray[np.float64] | None:
    """x that makes as many rows as possible at most -1."""
    import numpy as np

    count, columns = matrix.shape
    cost = np.concatenate([np.zeros(columns), -np.ones(count)])
    most = np.concatenate([np.full(columns, np.inf), np.ones(count)])
    solution = _solve(cost, matrix.with_slack(), np.zeros(count), most, budget)
    return None if solution is None else solution[:columns]


def _smallest(
    matrix: _Matrix, strict: NDArray[np.bool_], budget: Budget
) -> NDArray[np.float64] | None:
    """The x with the least sum that makes the same rows at most -1."""
    import numpy as np

    columns = matrix.shape[1]
    limits = np.where(strict, -1.0, 0.0)
    return _solve(np.ones(columns), matrix, limits, np.full(columns, np.inf), budget)


def _solve(
    cost: NDArray[np.float64],
    matrix: _Matrix,
    limits: NDArray[np.float64],
    most: NDArray[np.float64],
    budget: Budget,
) -> NDArray[np.float64] | None:
    """x from 0 to `most` with the least cost for which no row exceeds its limit, or None.

    Raises:
        LimitReachedError: the time of the budget is over.
    """
    # Not by way of SciPy, which brings the same solver and takes 0.3 s to import.
    import highspy
    import numpy as np

    count, columns = matrix.shape
    programme = highspy.HighsLp()
    programme.num_col_, programme.num_row_ = columns, count
    programme.col_cost_ = cost
    programme.col_lower_, programme.col_upper_ = np.zeros(columns), most
    programme.row_lower_, programme.row_upper_ = np.full(count, -np.inf), limits
    programme.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    programme.a_matrix_.start_ = np.searchsorted(matrix.rows, np.arange(count + 1))
    programme.a_matrix_.index_ = matrix.places
    programme.a_matrix_.value_ = matrix.values.astype(float)
    solver = highspy.Highs()
    solver.setOptionValue("output_flag", False)
    left = budget.left()
    if left is not None:
        solver.setOptionValue("time_limit", max(left, 0.01))
    solver.passModel(programme)
    solver.run()
    budget.check()
    status = solver.getModelStatus()
    if status == highspy.HighsModelStatus.kTimeLimit:
        raise LimitReachedError("time", f"time limit of {budget.seconds:g} s")
    if status != highspy.HighsModelStatus.kOptimal:
        return None
    return np.array(solver.getSolution().col_value)
