"""Results as runs would have made them."""

from __future__ import annotations

from typing import Any

from runtime.bench.job import Job, Result, new_result


def job(seed: int, planner: str = "siw-r", scene: str = "sorting/3t-02", **more: Any) -> Job:
    return Job("pick_and_place", scene, planner, seed, 60.0, **more)


def result(of: Job, seconds: float | None = 1.0, **values: Any) -> Result:
    """What came of a run; None: it was not solved."""
    found = {
        "scene": of.scene, "planner": of.planner, "seed": of.seed, "solved": seconds is not None,
        "planning_time_s": 60.0 if seconds is None else seconds, "execution_time_s": 60.0,
        "expanded": 10, "generated": 20, "subplans": 4, "actions": 8, "objects_moved": 2,
        "peak_mb": 200, "cpu_time_s": 0.5,
        "profile": {"motion_plan": {"calls": 4, "successes": 2, "time_s": 0.1}},
    }  # fmt: skip
    if seconds is not None:
        found["valid"] = True
    return new_result(of, found | values)
