"""Summaries as CSV and JSON, for other programs: one row, or object, a case."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from typing import Any

from runtime.bench.summary import MEASURED, Summary

COLUMNS = (
    "sketch", "scene", "planner", "robot", "timeout", "runs", "solved", "certified", "share_low",
    "share_high", "median", "quartile_1", "quartile_3", "median_low", "median_high", "worst",
    *MEASURED,
)  # fmt: skip

PAIRS = {
    "share": ("share_low", "share_high"),
    "quartiles": ("quartile_1", "quartile_3"),
    "interval": ("median_low", "median_high"),
}


def flat(summary: Summary) -> dict[str, Any]:
    """A summary with one value a column; what is not known or infinite is None."""
    data = summary.as_data()
    for name, (low, high) in PAIRS.items():
        data[low], data[high] = data.pop(name) or (None, None)
    return {column: data.get(column) for column in COLUMNS}


def as_csv(summaries: Sequence[Summary]) -> list[str]:
    """A header and a line a case, as RFC 4180 has them."""
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(map(flat, summaries))
    return text.getvalue().rstrip("\n").split("\n")


def as_json(suite: str, summaries: Sequence[Summary], lost: Sequence[dict[str, Any]]) -> str:
    """One object: the cases, and the runs without a result."""
    data = {
        "suite": suite,
        "intervals": {
            "share": "exact binomial (Clopper-Pearson), 95 %",
            "median": "order statistics (exact binomial), 95 %; null: fewer than six runs",
        },
        "cases": [flat(summary) for summary in summaries],
        "without_result": list(lost),
    }
    return json.dumps(data, indent=1)
