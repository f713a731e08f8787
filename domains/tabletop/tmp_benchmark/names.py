"""Names of a PDDL file for things of an XML file: the two abbreviate differently.

`stick_red4` is `rs4`, `target_green1` is `gt1`, `disc2` is `d2`, `block_a` is `a`, `red_tray` is
`red-tray`. A name stands for the one thing that it can stand for.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

_WORDS = re.compile(r"[a-z]+|\d+")


def _plain(name: str) -> list[str]:
    return _WORDS.findall(name.lower())


def _same(short: list[str], words: list[str]) -> bool:
    return short == words


def _last(short: list[str], words: list[str]) -> bool:
    return len(short) < len(words) and words[-len(short) :] == short


def _initials(short: list[str], words: list[str]) -> bool:
    letters = "".join(word for word in short if word.isalpha())
    initials = "".join(word[0] for word in words if word.isalpha())
    numbers = [[word for word in all_ if word.isdigit()] for all_ in (short, words)]
    return sorted(letters) == sorted(initials) and numbers[0] == numbers[1]


WAYS: tuple[Callable[[list[str], list[str]], bool], ...] = (_same, _last, _initials)
"""From the surest: the same words, the last words, the initials in any order with the number."""


def candidates(name: str, things: Iterable[str]) -> list[str]:
    """The things that a name can stand for by the surest way in which there is one."""
    short, named = _plain(name), [(thing, _plain(thing)) for thing in things]
    for way in WAYS:
        found = [thing for thing, words in named if way(short, words)]
        if found:
            return found
    return []
