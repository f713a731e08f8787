"""The table of slips in docs/slips.md: `python -m tests.language.slips` writes its last column."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from sketchlang.findings import findings
from sketchlang.loader import load_text
from sketchlang.source import Source

DOCUMENT = Path(__file__).parents[2] / "docs" / "slips.md"
SKETCH = {
    "sketch": "sketch s",
    "use": "use delivery",
    "feature H": "feature H : bool = some x in packages: held(x)",
    "feature n": "feature n : nat = count x in packages: not delivered(x)",
    "feature t": "feature t : nat = target_distance",
    "atoms": "atoms agent_at",
    "goal": "goal { n = 0 }",
    "rule": "rule r { n > 0 } -> { n--, H?, t? }",
}
"""The sketch in which one line is replaced; a slip in place of `more` is added at its end."""

BREAK = " ⏎ "
_CELLS = re.compile(r"(?<!\\)\|")


@dataclass(frozen=True)
class Slip:
    """A row of the table: what was written in place of which line, and what is said of it."""

    place: str
    text: str
    before: str
    now: str
    line: int


def slips() -> list[Slip]:
    """All rows of the document."""
    rows = []
    for number, line in enumerate(DOCUMENT.read_text(encoding="utf-8").splitlines()):
        cells = [cell.replace("\\|", "|").strip() for cell in _CELLS.split(line)]
        if len(cells) == 6 and cells[2].startswith("`"):
            text = cells[2].strip("`").strip().replace(BREAK, "\n")
            for sign, name in NAMED.items():
                text = text.replace(name, sign)
            rows.append(Slip(cells[1], text, cells[3], cells[4], number))
    return rows


NAMED = {"\u00a0": "<U+00A0>", "\u200b": "<U+200B>"}
"""Characters that a reader of the table could not see."""


def said(place: str, text: str) -> str:
    """What `check` says of the sketch with a slip: message and hint of the first finding, and
    how many others there are."""
    lines = {**SKETCH, place: text}
    found = findings(load_text(Source("t", "\n".join(lines.values()) + "\n")))
    if not found:
        return "nothing"
    first = found[0]
    others = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
    return (f"{first.message}. {first.hint}" if first.hint else first.message) + others


def row(slip: Slip) -> str:
    """A line of the table."""
    text = slip.text.replace("\n", BREAK)
    for sign, name in NAMED.items():
        text = text.replace(sign, name)
    quoted = f"`` {text} ``" if "`" in text else f"`{text}`"
    cells = [slip.place, quoted, slip.before, slip.now]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def main() -> None:
    lines = DOCUMENT.read_text(encoding="utf-8").splitlines()
    for slip in slips():
        now = said(slip.place, slip.text)
        lines[slip.line] = row(Slip(slip.place, slip.text, slip.before, now, slip.line))
    DOCUMENT.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
