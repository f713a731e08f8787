"""Tables as data: what they say, apart from how they are written."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from runtime.bench.statistics import Interval


@dataclass(frozen=True)
class Table:
    """Rows of texts under column names. The first `labels` columns tell what a row is about;
    `notes` say how its numbers came about."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    labels: int = 2
    notes: tuple[str, ...] = ()


def varying(
    columns: Sequence[str], labels: Sequence[Sequence[str]]
) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Those columns of labels in which something differs, at least the last but one and the last
    (scene and planner), with the labels."""
    kept = [
        i
        for i in range(len(columns))
        if columns[i] in ("scene", "planner") or len({label[i] for label in labels}) > 1
    ]
    return tuple(columns[i] for i in kept), [tuple(label[i] for i in kept) for label in labels]


def seconds(value: float, limit: float | None = None) -> str:
    """Seconds in three digits or so; `> LIMIT` for what took longer."""
    if math.isinf(value):
        return "-" if limit is None else f"> {limit:g}"
    if value >= 99.95:
        return f"{value:.0f}"
    return f"{value:.1f}" if value >= 9.995 else f"{value:.2f}"


def span(interval: Interval | None, limit: float | None = None) -> str:
    """An interval of seconds."""
    if interval is None:
        return "-"
    low, high = interval
    if math.isinf(low):
        return seconds(low, limit)
    return f"{seconds(low)}-{seconds(high) if math.isfinite(high) else ''}"


def percent(interval: Interval) -> str:
    """An interval of shares in per cent."""
    return f"{100 * interval[0]:.0f}-{100 * interval[1]:.0f} %"


def count(value: float | None) -> str:
    """A whole number, or nothing."""
    return "" if value is None else f"{value:.0f}"
