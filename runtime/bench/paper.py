"""The figures that the paper reports (its Table 1 and Table 2), to stand beside ours."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PaperRow:
    """Planning and execution in minutes, averages over ten runs."""

    planning_min: float
    execution_min: float
    expanded: int
    subplans: int


SCENES = (
    "sorting/3t-02",
    "sorting/4t-07",
    "sorting/1t-20",
    "sorting/3t-25",
    "sorting/4t-28",
    "non_monotonic/2t-11",
    "words/tamp",
    "words/robot",
)

ROWS = {
    ("sorting/1t-20", "lazy-siiw-r"): PaperRow(3.16, 3.67, 60, 14),
    ("sorting/1t-20", "siw-r"): PaperRow(13.05, 3.73, 54, 14),
    ("sorting/3t-02", "lazy-siiw-r"): PaperRow(0.26, 1.21, 28, 4),
    ("sorting/3t-25", "lazy-siiw-r"): PaperRow(3.36, 3.95, 235, 10),
    ("sorting/3t-25", "siw-r"): PaperRow(21.6, 4.02, 198, 10),
    ("sorting/4t-07", "lazy-siiw-r"): PaperRow(2.35, 4.45, 185, 14),
    ("sorting/4t-28", "lazy-siiw-r"): PaperRow(6.52, 9.24, 630, 34),
    ("non_monotonic/2t-11", "lazy-siiw-r"): PaperRow(3.53, 8.10, 565, 30),
    ("non_monotonic/2t-11", "siw-r"): PaperRow(17.69, 7.96, 534, 30),
    ("words/tamp", "lazy-siiw-r"): PaperRow(2.26, 3.49, 243, 13),
    ("words/tamp", "siw-r"): PaperRow(8.07, 3.58, 216, 13),
    ("words/robot", "lazy-siiw-r"): PaperRow(2.26, 3.49, 243, 13),
    ("words/robot", "siw-r"): PaperRow(8.07, 3.58, 216, 13),
}
"""One row for both words: the paper reports them together."""
