"""Linear programmes, solved by HiGHS."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sketchlang.analysis.limits import Budget, LimitReachedError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Matrix:
    """A sparse matrix, row by row: entry k is `values[k]` at `rows[k]`, `places[k]`."""

    shape: tuple[int, int]
    values: NDArray[np.int64]
    rows: NDArray[np.int64]
    places: NDArray[np.int64]

    @classmethod
    def of(cls, rows: Sequence[Mapping[int, int]], columns: int) -> Matrix:
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

    def with_slack(self) -> Matrix:
        """The same with one more column for each row, in which only that row has a 1."""
        import numpy as np

        count, columns = self.shape
        own = np.arange(count)
        rows = np.concatenate([self.rows, own])
        order = np.argsort(rows, kind="stable")
        return Matrix(
            (count, columns + count),
            np.concatenate([self.values, np.ones(count, np.int64)])[order],
            rows[order],
            np.concatenate([self.places, columns + own])[order],
        )


def solve(
    cost: NDArray[np.float64],
    matrix: Matrix,
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
