"""Names as an attacker would choose them, and what must not be left of them."""

from __future__ import annotations

import random
import unicodedata
from collections.abc import Iterator

PIECES = (
    "\x1b[31m", "\x1b]0;title\x07", "\x1b[2J", "\n", "\r", "\r\n", "\x00", "\x7f", "\x9b31m",
    "\u202e", "\u2066", "\u200b", "\u2028", "\u2029", "\x85", "\udc80", "\x08" * 3,
    "\n::error::owned", "::error file=a::owned", " ::set-output name=a::b", "\n##[error]owned",
    "##vso[task.complete]", "../", "/../../../escaped", "..", "/etc/passwd", "C:\\x",
    "<script>alert(1)</script>", "</script>", "<!--", "]]>", "&lt;", '"', "'", "`", "\\", "\\n",
    '"]; evil [label="', "|", "${x}", "$(x)", "%0A::error::owned", "%s", "{0}", "a", "box", "ü",
   "木",    " ", "\t", "\u00a0", "e\u0301", "x" * 300,
)  # fmt: skip
HARMFUL = {"Cc", "Cf", "Cs", "Zl", "Zp"}
COMMANDS = ("::", "##[", "##vso[")


def names(count: int, seed: int = 0) -> Iterator[str]:
    """Hostile names: every piece alone, then mixtures of them."""
    rng = random.Random(seed)
    yield from PIECES[:count]
    for _ in range(count - len(PIECES)):
        yield "".join(rng.choices(PIECES, k=rng.randint(1, 4)))


def harm(text: str, own: tuple[str, ...] = ()) -> str | None:
    """What a text for a terminal or a log would do, None for nothing. `own` are commands to CI
    services that lines may begin with because the program means them."""
    for line in text.split("\n"):
        for c in line:
            if unicodedata.category(c) in HARMFUL:
                return f"{c!r} in {line!r}"
        start = line.lstrip()
        if start.startswith(COMMANDS) and not start.startswith(own or ("no such",)):
            return f"a command: {line!r}"
    return None
