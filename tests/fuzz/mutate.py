"""Changes to the bytes of a file: blind ones, and ones that know numbers, words and nesting."""

from __future__ import annotations

import random
import re
from collections.abc import Sequence

NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
WORD = re.compile(rb"[A-Za-z_][A-Za-z_0-9]*")
STRING = re.compile(rb'"(?:[^"\\\n]|\\.)*"')
BRACKETS = re.compile(rb"\{[^{}]*\}|\[[^\[\]]*\]|\([^()]*\)")
NUMBERS = (b"0", b"-0.0", b"-1", b"1e308", b"1e999", b"-1e999", b"NaN", b"nan", b"inf", b"-inf",
           b"1e-320", b"9" * 400, b"9" * 5000, b"0x10", b"true", b"null", b'"1"', b"[]", b"{}",
           b"2147483648", b"9223372036854775808", b"0.1e1", b"1_0", b"3")  # fmt: skip
STRINGS = (b'""', b'"\\u0000"', b'"\\ud800"', b'"\\u202e"', b'"a\\nb"', b'"../x"', b'"/dev/zero"',
           b'"-"', b'"' + b"x" * 300 + b'"', b"null", b"0", b'"\xff"', b'"::error::x"')  # fmt: skip
PARTS = (b"[" * 2000, b"{" * 2000, b"(" * 2000, b"<a>" * 2000, b"\0", b"\xff\xfe", b"\x1b[2J",
         b".a" * 60, b"\n\n\n", b"#", b"//", b"<!DOCTYPE a>", "\u202e".encode(),
         b"=", b",")  # fmt: skip


def mutated(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """The bytes with one to four changes; `others` are files of the same format."""
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3, 4))):
        data = _once(data, rng, others)
    return data


def _once(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    place = rng.randrange(len(data) + 1)
    match rng.randrange(11):
        case 0:
            return data[:place] + bytes([rng.randrange(256)]) + data[place + 1 :]
        case 1:
            return data[:place] + data[place + rng.choice((1, 5, 50, 500)) :]
        case 2:
            return data[:place]
        case 3:
            part = data[place : place + rng.choice((1, 10, 100, 1000))]
            return data[:place] + part * rng.choice((2, 2, 50)) + data[place:]
        case 4:
            return data[:place] + rng.choice(PARTS) + data[place:]
        case 5:
            other = rng.choice(others)
            start = rng.randrange(len(other) + 1)
            return data[:place] + other[start : start + rng.choice((10, 100, 1000))] + data[place:]
        case 6 | 7:
            return _replaced(data, NUMBER, rng.choice(NUMBERS), rng)
        case 8:
            return _replaced(data, STRING, rng.choice(STRINGS), rng)
        case 9:
            words = WORD.findall(rng.choice(others)) or [b"x"]
            return _replaced(data, WORD, rng.choice(words), rng)
        case _:
            found = BRACKETS.findall(rng.choice(others)) or [b""]
            return _replaced(data, BRACKETS, rng.choice((b"", rng.choice(found))), rng)


def _replaced(data: bytes, pattern: re.Pattern[bytes], new: bytes, rng: random.Random) -> bytes:
    found = list(pattern.finditer(data))
    if not found:
        return data
    old = rng.choice(found)
    return data[: old.start()] + new + data[old.end() :]
