"""Did you mean ...?"""

from __future__ import annotations

from collections.abc import Iterable


def distance(a: str, b: str) -> int:
    """Edits (insert, delete, replace, swap neighbours) that turn one word into the other."""
    before: list[int] = []
    last = list(range(len(b) + 1))
    for i, x in enumerate(a, 1):
        row = [i]
        for j, y in enumerate(b, 1):
            cost = min(last[j] + 1, row[-1] + 1, last[j - 1] + (x != y))
            if i > 1 and j > 1 and x == b[j - 2] and a[i - 2] == y:
                cost = min(cost, before[j - 2] + 1)
            row.append(cost)
        before, last = last, row
    return last[-1]


def closest(word: str, candidates: Iterable[str]) -> str | None:
    """The candidate that a writer of `word` most likely meant, or None."""
    if len(word) > 60:
        return None
    best: tuple[int, str] | None = None
    folded = word.lower()
    for candidate in sorted(set(candidates)):
        if abs(len(candidate) - len(word)) > 3 or candidate == word:
            continue
        edits = distance(folded, candidate.lower())
        if edits <= max(1, min(len(word), len(candidate)) // 3) and (not best or edits < best[0]):
            best = (edits, candidate)
    # A name of one letter is an edit away from any other one.
    if best and len(word) == 1 and best[1].lower() != folded:
        return None
    return best[1] if best else None


def did_you_mean(word: str, candidates: Iterable[str]) -> str | None:
    """A hint, or None where nothing is close."""
    best = closest(word, candidates)
    return f"Did you mean `{best}`?" if best else None
