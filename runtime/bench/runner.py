"""Run many plannings in parallel processes and keep every result as soon as it is there."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from typing import Any

from runtime.bench.pool import run_jobs
from runtime.bench.store import Job, Result, Store, new_result

GRACE = 300.0
"""Seconds that a run may take beyond its time limit: kernels are compiled, plans certified."""


def run_all(
    jobs: Iterable[Job],
    store: Store,
    processes: int,
    done: Callable[[Result], None],
    work: Callable[[Job], dict[str, Any]] | None = None,
) -> list[tuple[Job, str]]:
    """Run jobs that have no result in a store yet and append each result when it is ready.

    Whoever kills this loses only what is running. Returns the jobs without a result, and why.
    """
    pending = [job for job in dict.fromkeys(jobs) if job not in store.results]
    # Planning times are those of one core.
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
        os.environ.setdefault(name, "1")

    def keep(job: Job, values: dict[str, Any]) -> None:
        result = new_result(job, values)
        store.append(result)
        done(result)

    return run_jobs(pending, processes, work or run_job, keep, lambda job: job.timeout + GRACE)


def run_job(job: Job) -> dict[str, Any]:
    """Plan once, certify the plan, and say what came out. Runs in a process of its own."""
    from runtime.report import make_report
    from runtime.search.limits import Limits
    from runtime.solve import open_task
    from sketchlang.analysis.limits import peak_memory_mb
    from sketchlang.loader import load_sketch

    task = open_task(load_sketch(job.sketch).checked, job.scene, job.seed)
    result = task.solve(Limits(timeout=job.timeout), job.planner)
    report = make_report(result)
    moved = {getattr(a, "object", None) for s in result.outcome.subgoals for a in s.actions[-1:]}
    report["objects_moved"] = len(moved - {None})
    if result.solved:
        verdict = result.plan.validate()
        report["valid"] = verdict.valid
        report["findings"] = [finding.message for finding in verdict.findings]
    report["peak_mb"] = round(peak_memory_mb())
    return report
