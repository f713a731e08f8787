"""What has to be taken away first: objects in the way, those in the way of these, and so on.

A way to an object is free once every object that bars it has been taken away; such a one can be
taken away once a way to it is free. Knuth's generalisation of Dijkstra's algorithm gives each
object a set to be taken away before it, the objects with the smallest sets first. It is nearly
always a smallest one; to find one always is as hard as covering by sets.

Sets of objects are bits, 63 a word. Headings are those of `swept`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from domains.tabletop.features.swept import HEADINGS

if TYPE_CHECKING:
    from domains.tabletop.world import Ints

WORD = 63
NEVER = 1 << 30
"""The size of a set that does not exist: the object cannot be taken away."""


@dataclass(frozen=True, eq=False)
class Clearing:
    """For each object what to take away before it: `sets` (n, W) and their `sizes` (n,), which
    are `NEVER` for objects that cannot be taken away."""

    sets: Ints
    sizes: Ints


def clearing_of(barred: Ints, counts: Ints, extra: Ints, present: Ints) -> Clearing:
    """What to take away before each object.

    `barred` (F, n, n) and `counts` (F, n, K) are those of each family of approaches, `extra`
    (F, n) the headings that one more object, number n, bars besides; that one is taken to be
    free itself.
    """
    sets, sizes = _clear(barred, counts, extra, present)
    return Clearing(sets, sizes)


def members(row: Ints) -> list[int]:
    """The objects in a set (W,)."""
    return [
        WORD * word + bit
        for word, bits in enumerate(row.tolist())
        for bit in range(WORD)
        if (bits >> bit) & 1
    ]


@njit(cache=True)
def _clear(barred, counts, extra, present):  # type: ignore[no-untyped-def]
    families, n, _ = barred.shape
    words = n // WORD + 1
    sets = np.zeros((n, words), dtype=np.int64)
    sizes = np.full(n, NEVER, dtype=np.int64)
    done = np.zeros(n, dtype=np.bool_)
    # For each way: how many that bar it are still to be reckoned, and what to take away for it.
    pending = counts.astype(np.int64)
    unions = np.zeros((families, n, HEADINGS, words), dtype=np.int64)
    for f in range(families):
        for i in range(n):
            for k in range(HEADINGS):
                if (extra[f, i] >> k) & 1:
                    unions[f, i, k, n // WORD] |= 1 << (n % WORD)
                if pending[f, i, k] == 0 and present[i]:
                    _offer(unions[f, i, k], i, sets, sizes)
    while True:
        j = _smallest(sizes, done)
        if j < 0:
            return sets, sizes
        done[j] = True
        for f in range(families):
            for i in range(n):
                if barred[f, i, j] and present[i] and not done[i]:
                    _take_away(j, barred[f, i, j], i, pending[f, i], unions[f, i], sets, sizes)


@njit(cache=True)
def _smallest(sizes, done):  # type: ignore[no-untyped-def]
    """The object with the smallest set of those that are not done, -1 where none can be."""
    best = -1
    for i in range(len(sizes)):
        if not done[i] and sizes[i] < NEVER and (best < 0 or sizes[i] < sizes[best]):
            best = i
    return best


@njit(cache=True)
def _take_away(j, bits, i, pending, unions, sets, sizes):  # type: ignore[no-untyped-def]
    """Reckon with taking away an object for the headings to another one that it bars."""
    for k in range(HEADINGS):
        if (bits >> k) & 1:
            for w in range(sets.shape[1]):
                unions[k, w] |= sets[j, w]
            unions[k, j // WORD] |= 1 << (j % WORD)
            pending[k] -= 1
            if pending[k] == 0:
                _offer(unions[k], i, sets, sizes)


@njit(cache=True)
def _offer(union, i, sets, sizes):  # type: ignore[no-untyped-def]
    """Take a set for an object where it is smaller than the one known."""
    size = _bits(union)
    if size < sizes[i]:
        sizes[i] = size
        sets[i] = union


@njit(cache=True)
def least_clearing(  # type: ignore[no-untyped-def]
    index, pick, pick_reachable, place, place_reachable, counted, sets, sizes, modulus, turn
):  # fmt: skip
    """The fewest objects to be taken away before one can be picked up along one heading and put
    down along one at a site of its goal: how many, `NEVER` if there is no way, and all that are
    in one of the sets (W,) of so many.

    `pick` (n,) and `place` (S, n) are headings that each object bars, `counted` (n,) tells
    which objects are there. The heading at the site is that to the object plus `turn`,
    modulo `modulus`. What needs the object itself out of the way first does not count.
    """
    best = NEVER
    found = np.zeros(sets.shape[1], dtype=np.int64)
    before = np.zeros((HEADINGS, sets.shape[1]), dtype=np.int64)
    after = np.zeros((HEADINGS, sets.shape[1]), dtype=np.int64)
    pickable = _close(index, pick, pick_reachable, counted, sets, sizes, before)
    for i in range(place.shape[0]):
        placeable = _close(index, place[i], place_reachable[i], counted, sets, sizes, after)
        for k in range(HEADINGS):
            if not (pickable >> k) & 1 or _bits(before[k]) > best:
                continue
            for m in range((k + turn) % modulus, HEADINGS, modulus):
                if (placeable >> m) & 1 and _bits(after[m]) <= best:
                    size = _bits(before[k] | after[m])
                    if size < best:
                        best = size
                        found[:] = 0
                    if size == best:
                        found |= before[k] | after[m]
        if best == 0:
            break
    return best, found


@njit(cache=True)
def _close(index, barred, reachable, counted, sets, sizes, closed):  # type: ignore[no-untyped-def]
    """Bits of the headings that can be made free, and in `closed` (K, W) what to take away."""
    closed[:] = 0
    open_ = reachable
    for j in range(len(counted)):
        bits = barred[j] & open_
        if bits == 0 or not counted[j]:
            continue
        if j < sets.shape[0] and (
            sizes[j] >= NEVER or (sets[j, index // WORD] >> (index % WORD)) & 1
        ):
            open_ &= ~bits
            continue
        for k in range(HEADINGS):
            if (bits >> k) & 1:
                closed[k, j // WORD] |= 1 << (j % WORD)
                if j < sets.shape[0]:
                    for w in range(sets.shape[1]):
                        closed[k, w] |= sets[j, w]
    return open_


@njit(cache=True)
def _bits(words):  # type: ignore[no-untyped-def]
    """How many bits of some words are set."""
    count = 0
    for word in words:
        while word:
            word &= word - 1
            count += 1
    return count
