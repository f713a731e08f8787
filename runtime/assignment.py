"""The cheapest assignment (shortest augmenting paths with potentials; Kuhn 1955, Jonker & Volgenant
1987).

SciPy has the same and is used for large tables. For small ones its import, a quarter of a
second, would be longer than all of a plan's search.
"""

from __future__ import annotations

import numpy as np

from runtime.robot.model import Floats

SMALL = 80
"""Rows up to which the time of SciPy's import is more than what it saves."""


def least_assignment(costs: Floats) -> float:
    """The least sum of entries of a square table (n, n), one in each row and each column."""
    if len(costs) > SMALL:
        from scipy.optimize import linear_sum_assignment

        rows, columns = linear_sum_assignment(costs)
        return float(costs[rows, columns].sum())
    return augmented(costs)


def augmented(costs: Floats) -> float:
    """The same by paths, one row more at a time. Column 0 is where each path starts."""
    n = len(costs)
    row_price, price = np.zeros(n + 1), np.zeros(n + 1)
    row_of, before = np.zeros(n + 1, dtype=np.int64), np.zeros(n + 1, dtype=np.int64)
    for row in range(1, n + 1):
        row_of[0], column = row, 0
        slack, done = np.full(n + 1, np.inf), np.zeros(n + 1, dtype=np.bool_)
        while True:
            done[column] = True
            here = row_of[column]
            reduced = np.append(np.inf, costs[here - 1] - row_price[here] - price[1:])
            better = ~done & (reduced < slack)
            slack[better], before[better] = reduced[better], column
            nearest = int(np.where(done, np.inf, slack).argmin())
            step = slack[nearest]
            row_price[row_of[done]] += step
            price[done] -= step
            slack[~done] -= step
            column = nearest
            if row_of[column] == 0:
                break
        while column:
            row_of[column] = row_of[before[column]]
            column = int(before[column])
    return float(-price[0])
