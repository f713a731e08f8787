"""The loops over operators and atoms, on states as arrays of 64-bit words."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Words = NDArray[np.uint64]
Ints = NDArray[np.int64]


@njit(cache=True)  # type: ignore[untyped-decorator]
def applicable(
    words: Words, bit: Ints, skip: Ints, start: Ints, operators: Ints, room: Ints
) -> int:
    """Put the numbers of the operators that find all they need into `room`, and count them."""
    found = 0
    node = 0
    nodes = bit.shape[0]
    while node < nodes:
        place = bit[node]
        if place >= 0 and not (words[place >> 6] >> np.uint64(place & 63)) & np.uint64(1):
            node = skip[node]
            continue
        for at in range(start[node], start[node + 1]):
            room[found] = operators[at]
            found += 1
        node += 1
    return found
