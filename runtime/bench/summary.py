"""What came of all runs that differ in their seed alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from runtime.bench.job import Result, key
from runtime.bench.statistics import Interval, binomial_interval, median_interval, quantile

MEASURED = (
    "expanded", "generated", "subplans", "actions", "objects_moved", "execution_time_s", "peak_mb",
    "cpu_time_s",
)  # fmt: skip
"""Of these the median over the solved runs is told."""


@dataclass(frozen=True)
class Case:
    """What is run with several seeds."""

    sketch: str
    scene: str
    planner: str
    robot: str
    timeout: float


@dataclass(frozen=True)
class Summary:
    """The runs of a case. Times are of planning, in seconds; where a run was not solved, it counts
    as infinite. `share` is the exact binomial interval of the share solved, `interval` that of the
    median, by order statistics (None: too few runs)."""

    case: Case
    runs: int
    solved: int
    certified: int
    share: Interval
    median: float
    quartiles: Interval
    interval: Interval | None
    worst: float
    measured: dict[str, float]

    def as_data(self) -> dict[str, Any]:
        """Plain data for JSON: what is infinite is null."""
        data = asdict(self)
        data = data.pop("case") | data | data.pop("measured")
        return {name: _finite(value) for name, value in data.items()}


def case_of(result: Result) -> Case:
    """The case of a result."""
    job = key(result)
    return Case(job.sketch, job.scene, job.planner, job.robot, job.timeout)


def grouped(results: Sequence[Result]) -> dict[Case, list[Result]]:
    """Results by case, in the order in which cases come."""
    found: dict[Case, list[Result]] = {}
    for result in results:
        found.setdefault(case_of(result), []).append(result)
    return found


def seconds_of(result: Result) -> float:
    """How long it took to solve a run; infinite where it was not solved."""
    return float(result["planning_time_s"]) if result["solved"] else math.inf


def summarise(results: Sequence[Result]) -> list[Summary]:
    """A summary of every case."""
    return [_summary(case, group) for case, group in grouped(results).items()]


def _summary(case: Case, group: list[Result]) -> Summary:
    solved = [result for result in group if result["solved"]]
    seconds = [seconds_of(result) for result in group]
    measured = {}
    for name in MEASURED:
        values = [float(result[name]) for result in solved if name in result]
        if values:
            measured[name] = quantile(values, 0.5)
    return Summary(
        case,
        len(group),
        len(solved),
        sum(bool(result.get("valid")) for result in solved),
        binomial_interval(len(solved), len(group)),
        quantile(seconds, 0.5),
        (quantile(seconds, 0.25), quantile(seconds, 0.75)),
        median_interval(seconds),
        max(seconds),
        measured,
    )


def _finite(value: Any) -> Any:
    if isinstance(value, tuple | list):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and math.isinf(value) else value
