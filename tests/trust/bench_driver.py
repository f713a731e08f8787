"""A benchmark whose runs are quick: `python -m tests.trust.bench_driver STORE RUNS [WORK]`.

Prints the numbers of its processes and of every run that is kept.
"""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from typing import Any

from runtime.bench import store
from runtime.bench.job import Job
from runtime.bench.runner import run_all
from sketchlang.cli.last import prepare_process


def job(number: int) -> Job:
    return Job("pick_and_place", "sorting/3t-02", "siw-r", number, 60.0)


def values(job: Job) -> dict[str, Any]:
    """What a run is said to have found."""
    return {
        "scene": job.scene, "planner": job.planner, "seed": job.seed, "solved": True,
        "valid": True, "planning_time_s": 0.5, "execution_time_s": 60.0, "expanded": 10,
        "subplans": 4, "objects_moved": 2, "peak_mb": 200, "findings": [], "pid": os.getpid(),
        "profile": {"motion_plan": {"calls": 4, "successes": 2, "time_s": 0.01}},
    }  # fmt: skip


def endless(job: Job) -> dict[str, Any]:
    """Says that it is at work, and is for ever."""
    print("working", os.getpid(), flush=True)
    while True:
        signal.pause()


def uneven(job: Job) -> dict[str, Any]:
    """Fails in several ways, by the number of the run."""
    match job.seed % 4:
        case 1:
            raise ValueError("no\nsuch luck")
        case 2:
            os.kill(os.getpid(), signal.SIGSEGV)
        case 3:
            endless(job)
    return values(job)


WORKS = {"values": values, "endless": endless}


def main() -> None:
    # Who starts the tests in the background may have told them to ignore these.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    prepare_process()
    path, count, work = Path(sys.argv[1]), int(sys.argv[2]), (sys.argv[3:] or ["values"])[0]
    with store.opened(path) as results:
        print("open", flush=True)
        run_all(
            map(job, range(count)), results, 2,
            lambda result: print("kept", result["seed"], flush=True), WORKS[work],
        )  # fmt: skip
    print("done", flush=True)


if __name__ == "__main__":
    main()
