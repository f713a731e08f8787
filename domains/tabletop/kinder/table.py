"""What came of many problems, as the table of a benchmark."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from statistics import median

from domains.tabletop.kinder.run import Record

HEAD = "environment", "success", "planned", "planning s", "worst", "steps", "refused"
ALL = "all"


def table(records: Sequence[Record]) -> list[str]:
    """One line an environment, in the order in which they were run, and one for all. Planning is
    in CPU seconds, median and worst; steps and refused ones are the median and the sum of the
    problems that were solved."""
    rows = [HEAD, *_rows(records)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(HEAD))]
    lines = []
    for row in rows:
        first, *rest = (
            cell.ljust(w) if i == 0 else cell.rjust(w)
            for i, (cell, w) in enumerate(zip(row, widths, strict=True))
        )
        lines.append("  ".join([first, *rest]).rstrip())
    return lines


def _rows(records: Sequence[Record]) -> Iterator[tuple[str, ...]]:
    names = list(dict.fromkeys(record.env for record in records))
    for name in names:
        yield _row(name, [record for record in records if record.env == name])
    if len(names) > 1:
        yield _row(ALL, records)


def _row(name: str, records: Sequence[Record]) -> tuple[str, ...]:
    solved = [record for record in records if record.success]
    times = [record.planning_s for record in records]
    return (
        name,
        f"{len(solved)}/{len(records)}",
        f"{sum(record.planned for record in records)}/{len(records)}",
        f"{median(times):.2f}",
        f"{max(times):.2f}",
        f"{median(record.steps for record in solved):.0f}" if solved else "-",
        str(sum(record.refused for record in solved)),
    )
