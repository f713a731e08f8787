"""What has to be taken away first: objects in the way, those in the way of these, and so on.

A way to an object is free once every object that bars it has been taken away; such a one can be
taken away once a way to it is free. The *cost* of an object is

    cost(i) = min over the ways to i of the sum of 1 + cost(j) over the objects j that bar it,

the least solution of these equations (Knuth's generalisation of Dijkstra's algorithm). Where
nothing that bars is barred itself, that is the number of objects in the way. An object in the way
of two others counts twice. In return the costs keep what sketches rely on, and smallest sets
of objects, which would be hard to find besides, would not do better: taking an object away
raises no cost, and lowers that of each object in whose way it counts.
"""

from __future__ import annotations

import numpy as np

from domains.tabletop.features.swept import HEADINGS, UNREACHABLE
from runtime.kernels.compiled import njit

WORD = 63
"""Objects a word in a set of objects."""

NEVER = 1 << 40
"""The cost of an object that cannot be taken away."""

MOST = 100_000
"""Costs are cut off there: more would only be told apart by who counts them."""


@njit(cache=True)
def clearing_costs(barred, counts, extra, present):  # type: ignore[no-untyped-def]
    """The cost of taking away each object (n,).

    `barred` (F, n, n) and `counts` (F, n, K) are those of each family of approaches, `extra`
    (F, n) the headings that one more object bars besides, which is free itself.
    """
    families, n, _ = barred.shape
    costs = np.full(n, NEVER, dtype=np.int64)
    done = np.zeros(n, dtype=np.bool_)
    # For each way: how many that bar it are still to be reckoned with, and the cost so far.
    pending = counts.astype(np.int64)
    sums = np.zeros((families, n, HEADINGS), dtype=np.int64)
    for f in range(families):
        for i in range(n):
            for k in range(HEADINGS):
                sums[f, i, k] = (extra[f, i] >> k) & 1
                if pending[f, i, k] == 0 and present[i]:
                    costs[i] = min(costs[i], sums[f, i, k])
    while True:
        j = _cheapest(costs, done)
        if j < 0:
            return costs
        done[j] = True
        for f in range(families):
            for i in range(n):
                if barred[f, i, j] and present[i] and not done[i]:
                    found = _reckon(costs[j], barred[f, i, j], pending[f, i], sums[f, i])
                    costs[i] = min(costs[i], found)


@njit(cache=True)
def _cheapest(costs, done):  # type: ignore[no-untyped-def]
    """The object with the least cost of those that are not done, -1 where none is left."""
    best = -1
    for i in range(len(costs)):
        if not done[i] and costs[i] < NEVER and (best < 0 or costs[i] < costs[best]):
            best = i
    return best


@njit(cache=True)
def _reckon(cost, bits, pending, sums):  # type: ignore[no-untyped-def]
    """Reckon with an object of some cost that bars some headings; the least cost of a heading
    that is complete by that."""
    best = NEVER
    for k in range(HEADINGS):
        if (bits >> k) & 1:
            sums[k] = min(MOST, sums[k] + 1 + cost)
            pending[k] -= 1
            if pending[k] == 0:
                best = min(best, sums[k])
    return best


@njit(cache=True)
def least_cost(pick, pick_reachable, place, place_reachable, costs, modulus, turn):  # type: ignore[no-untyped-def]
    """The least cost of a heading to an object and one to a site of its goal: the sum of 1 + cost
    over the objects that bar either, `NEVER` if there is no way.

    `pick` (n,) and `place` (S, n) are headings that each object bars, `costs` (n,) those of
    the objects, below 0 for what does not count. The heading at the site is that to the object
    plus `turn`, modulo `modulus`. Returned with it is which objects bar such headings (n,).
    """
    words = len(costs) // WORD + 1
    before = np.zeros((HEADINGS, words), dtype=np.int64)
    after = np.zeros((HEADINGS, words), dtype=np.int64)
    out = np.zeros(HEADINGS, dtype=np.int64)
    into = np.zeros(HEADINGS, dtype=np.int64)
    # Where any heading goes with any, those that the same objects bar are one.
    first_out = np.ones(HEADINGS, dtype=np.bool_)
    first_into = np.ones(HEADINGS, dtype=np.bool_)
    _weigh(pick, pick_reachable, costs, before, out)
    if modulus == 1:
        _mark_first(before, out, first_out)
    best = NEVER
    found = np.zeros(words, dtype=np.int64)
    for i in range(place.shape[0]):
        _weigh(place[i], place_reachable[i], costs, after, into)
        if modulus == 1:
            _mark_first(after, into, first_into)
        for k in range(HEADINGS):
            if not first_out[k] or out[k] > best or out[k] >= NEVER:
                continue
            for m in range((k + turn) % modulus, HEADINGS, modulus):
                if not first_into[m] or into[m] > best or into[m] >= NEVER:
                    continue
                cost = out[k] + into[m] - _shared(before[k], after[m], costs)
                if cost < best:
                    best = cost
                    found[:] = 0
                if cost == best:
                    found |= before[k] | after[m]
        if best == 0:
            break
    return best, _listed(found, len(costs))


@njit(cache=True)
def _mark_first(sets, sums, first):  # type: ignore[no-untyped-def]
    """Write which headings (K,) are the first with their cost, `sums` (K,), and what bars them,
    `sets` (K, W)."""
    for k in range(HEADINGS):
        first[k] = True
        for other in range(k):
            same = first[other] and sums[other] == sums[k]
            w = 0
            while same and w < sets.shape[1]:
                same = sets[other, w] == sets[k, w]
                w += 1
            if same:
                first[k] = False
                break


@njit(cache=True)
def _weigh(barred, reachable, costs, sets, sums):  # type: ignore[no-untyped-def]
    """For each heading, what bars it, as bits in `sets` (K, W), and its cost in `sums` (K,)."""
    sets[:] = 0
    for k in range(HEADINGS):
        sums[k] = 0 if (reachable >> k) & 1 else NEVER
    for j in range(len(costs)):
        bits = barred[j] & reachable
        if bits == 0 or costs[j] < 0:
            continue
        for k in range(HEADINGS):
            if (bits >> k) & 1:
                sets[k, j // WORD] |= 1 << (j % WORD)
                sums[k] = min(NEVER, sums[k] + 1 + costs[j])


@njit(cache=True)
def _shared(a, b, costs):  # type: ignore[no-untyped-def]
    """The cost of what is in both of two sets."""
    total = 0
    for w in range(len(a)):
        both = a[w] & b[w]
        j = w * WORD
        while both:
            if both & 1:
                total += 1 + costs[j]
            both >>= 1
            j += 1
    return total


@njit(cache=True)
def _listed(words, n):  # type: ignore[no-untyped-def]
    """Which objects are in a set (n,)."""
    found = np.zeros(n, dtype=np.bool_)
    for j in range(n):
        found[j] = (words[j // WORD] >> (j % WORD)) & 1
    return found


@njit(cache=True)
def all_to_clear(chosen, barred, counts, costs):  # type: ignore[no-untyped-def]
    """Some objects (n,), what bars the cheapest ways to them, and so on: (n,)."""
    families, n, _ = barred.shape
    found = chosen.copy()
    todo = [j for j in range(n) if found[j]]
    while len(todo) > 0:
        i = todo.pop()
        if costs[i] == 0 or costs[i] >= NEVER:
            continue
        for f in range(families):
            sums = np.zeros(HEADINGS, dtype=np.int64)
            for j in range(n):
                for k in range(HEADINGS):
                    if (barred[f, i, j] >> k) & 1 and costs[j] >= 0:
                        sums[k] = min(NEVER, sums[k] + 1 + costs[j])
            for k in range(HEADINGS):
                if counts[f, i, k] >= UNREACHABLE or min(sums[k], MOST) != costs[i]:
                    continue
                for j in range(n):
                    if (barred[f, i, j] >> k) & 1 and costs[j] >= 0 and not found[j]:
                        found[j] = True
                        todo.append(j)
    return found
