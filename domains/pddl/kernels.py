"""The loops over operators and atoms, on states as arrays of 64-bit words."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from runtime.kernels.compiled import njit

Words = NDArray[np.uint64]
Ints = NDArray[np.int64]
Bytes = NDArray[np.uint8]

FALSE, ADDS, DELETES = 1, 2, 3
"""Where the lists of an operator, or of one of its conditional changes, are: bits that have to be
true, that have to be false, that become true and that become false."""

LISTS = 4

CHECKED, CONDITIONAL, SPENT = 1, 2, 4
"""Marks of operators: something has to be false, something changes under a condition, and nothing
new can come of it any more in a search of width 1."""


@njit(cache=True)
def has(words: Words, place: int) -> bool:
    """Whether a bit is 1."""
    return bool((words[place >> 6] >> np.uint64(place & 63)) & np.uint64(1))


@njit(cache=True)
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


@njit(cache=True)
def forbidden(words: Words, row: int, first: Ints, bits: Ints) -> bool:
    """Whether a state has a bit that has to be 0."""
    for at in range(first[LISTS * row + FALSE], first[LISTS * row + FALSE + 1]):
        if has(words, bits[at]):
            return True
    return False


@njit(cache=True)
def holds(words: Words, row: int, first: Ints, bits: Ints) -> bool:
    """Whether the condition of a conditional change holds."""
    for at in range(first[LISTS * row], first[LISTS * row + 1]):
        if not has(words, bits[at]):
            return False
    return not forbidden(words, row, first, bits)


@njit(cache=True)
def follow(
    before: Words, after: Words, operator: int, first: Ints, bits: Ints, conditional: Ints
) -> None:
    """Write the state after an operator. What it adds and deletes becomes true."""
    after[:] = before
    begin, end = conditional[operator], conditional[operator + 1]
    one = np.uint64(1)
    for side in (DELETES, ADDS):
        for number in range(begin - 1, end):
            row = operator if number < begin else number
            if number >= begin and not holds(before, row, first, bits):
                continue
            for at in range(first[LISTS * row + side], first[LISTS * row + side + 1]):
                place = bits[at]
                if side == ADDS:
                    after[place >> 6] |= one << np.uint64(place & 63)
                else:
                    after[place >> 6] &= ~(one << np.uint64(place & 63))


@njit(cache=True)
def literals(words: Words, mask: Words, negated: Words, out: Words) -> None:
    """What novelty is about: the atoms of a mask, and after them the negations of some."""
    width = mask.shape[0]
    for at in range(width):
        out[at] = words[at] & mask[at]
    if out.shape[0] > width:
        for at in range(width):
            out[width + at] = ~words[at] & negated[at]


@njit(cache=True)
def lowest(word: np.uint64) -> int:
    """The place of a word's lowest 1."""
    place = 0
    if not word & np.uint64(0xFFFFFFFF):
        word >>= np.uint64(32)
        place += 32
    if not word & np.uint64(0xFFFF):
        word >>= np.uint64(16)
        place += 16
    if not word & np.uint64(0xFF):
        word >>= np.uint64(8)
        place += 8
    while not word & np.uint64(1):
        word >>= np.uint64(1)
        place += 1
    return place


@njit(cache=True)
def is_new(known: Words, now: Words, seen: Words, k: int) -> bool:
    """Whether a state has k literals that were never true together. `known` are those of the
    state before it, which was added. `seen[0]`, or for k = 2 `seen[i]` for a literal i, are the
    literals that were seen (together with it)."""
    width = now.shape[0]
    if k == 1:
        for at in range(width):
            if now[at] & ~seen[0, at]:
                return True
    else:
        for at in range(width):
            fresh = now[at] & ~known[at]
            while fresh:
                row = seen[at * 64 + lowest(fresh)]
                for other in range(width):
                    if now[other] & ~row[other]:
                        return True
                fresh &= fresh - np.uint64(1)
    return False


@njit(cache=True)
def add(now: Words, seen: Words, k: int) -> None:
    """Remember what is true in a state."""
    width = now.shape[0]
    if k == 1:
        for at in range(width):
            seen[0, at] |= now[at]
        return
    for at in range(width):
        rest = now[at]
        while rest:
            row = seen[at * 64 + lowest(rest)]
            for other in range(width):
                row[other] |= now[other]
            rest &= rest - np.uint64(1)


@njit(cache=True)
def may_be_new(
    words: Words,
    operator: int,
    first: Ints,
    bits: Ints,
    mask: Words,
    negated: Words,
    seen: Words,
    k: int,
) -> bool:
    """Whether an operator without conditional changes can make a literal true that was false,
    and for k = 1 that was not seen: a quick look that spares most states. With k = 1, what can
    bring nothing new once never does again."""
    width = mask.shape[0]
    for at in range(first[LISTS * operator + ADDS], first[LISTS * operator + ADDS + 1]):
        place = bits[at]
        if has(mask, place) and not (has(seen[0], place) if k == 1 else has(words, place)):
            return True
    if seen.shape[1] > width:
        for at in range(first[LISTS * operator + DELETES], first[LISTS * operator + DELETES + 1]):
            place = bits[at]
            if has(negated, place) and not (
                has(seen[0], place + 64 * width) if k == 1 else not has(words, place)
            ):
                return True
    return False


@njit(cache=True)
def expand(
    bit: Ints,
    skip: Ints,
    start: Ints,
    operators: Ints,
    first: Ints,
    bits: Ints,
    conditional: Ints,
    mask: Words,
    negated: Words,
    seen: Words,
    k: int,
    marks: Bytes,
    states: Words,
    origin: Ints,
    head: int,
    tail: int,
    most: int,
    room: Ints,
) -> tuple[int, int, int, int]:
    """Expand states of a queue by IW(k), from `head` on, until `most` have been added or as many
    operators tried as 64 times that. The queue is `states[:tail]`; `origin[i]` is what state i
    was made of: state, operator, and how many operators had been tried in the whole search, of
    which `origin[0, 2]` keeps count. `marks` are those of operators.

    Returns the new head and tail, operators tried, and how many states there was no room for: if
    any, the state at `head` has not been expanded.
    """
    known = np.empty(seen.shape[1], np.uint64)
    now = np.empty(seen.shape[1], np.uint64)
    tried, begun = origin[0, 2], tail
    limit = tried + 64 * most
    while head < tail and tail - begun < most and tried < limit:
        words = states[head]
        found = applicable(words, bit, skip, start, operators, room)
        if tail + found > states.shape[0]:
            origin[0, 2] = tried
            return head, tail, tried, tail + found - states.shape[0]
        literals(words, mask, negated, known)
        for at in range(found):
            operator = room[at]
            signs = marks[operator]
            if signs & CHECKED and forbidden(words, operator, first, bits):
                continue
            tried += 1
            if signs & SPENT:
                continue
            if not signs & CONDITIONAL and not may_be_new(
                words, operator, first, bits, mask, negated, seen, k
            ):
                if k == 1:
                    marks[operator] |= SPENT
                continue
            after = states[tail]
            follow(words, after, operator, first, bits, conditional)
            literals(after, mask, negated, now)
            if not is_new(known, now, seen, k):
                continue
            add(now, seen, k)
            origin[tail, 0] = head
            origin[tail, 1] = operator
            origin[tail, 2] = tried
            tail += 1
        head += 1
    origin[0, 2] = tried
    return head, tail, tried, 0


@njit(cache=True)
def follow_all(
    before: Words, chosen: Ints, first: Ints, bits: Ints, conditional: Ints, after: Words
) -> None:
    """The states after some operators."""
    for number in range(chosen.shape[0]):
        follow(before, after[number], chosen[number], first, bits, conditional)
