"""Run many plannings in parallel processes and keep every result as soon as it is there."""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any

from runtime.bench.job import Job, Result, new_result
from runtime.bench.pool import run_jobs
from runtime.bench.store import Store

GRACE = 300.0
"""Seconds that a run may take beyond its time limit: kernels are compiled, plans certified."""

Lost = list[tuple[Job, str]]
"""Jobs without a result, and why."""


def seconds_for(job: Job) -> float:
    """How long a job may take all in all."""
    return job.timeout + GRACE


def pending(jobs: Iterable[Job], store: Store) -> list[Job]:
    """The jobs that have no result in a store yet, each once."""
    return [job for job in dict.fromkeys(jobs) if job not in store.results]


def keeper(store: Store, done: Callable[[Result], None]) -> Callable[[Job, dict[str, Any]], None]:
    """Keeps a result: it is on the disk before anybody is told of it."""

    def keep(job: Job, values: dict[str, Any]) -> None:
        result = new_result(job, values)
        store.append(result)
        done(result)

    return keep


def one_core() -> None:
    """Planning times are those of one core: for processes that are started from now on."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
        os.environ.setdefault(name, "1")


def run_all(
    jobs: Iterable[Job],
    store: Store,
    processes: int,
    done: Callable[[Result], None],
    work: Callable[[Job], dict[str, Any]] | None = None,
) -> Lost:
    """Run jobs that have no result in a store yet and append each result when it is ready.

    Whoever kills this loses only what is running. Returns the jobs without a result, and why.
    """
    one_core()
    todo = pending(jobs, store)
    return run_jobs(todo, processes, work or run_job, keeper(store, done), seconds_for)


def run_job(job: Job) -> dict[str, Any]:
    """Plan once, certify the plan, and say what came out. Runs in a process of its own."""
    from runtime.report import make_report
    from runtime.search.limits import Limits
    from runtime.solve import open_task
    from sketchlang.analysis.limits import peak_memory_mb
    from sketchlang.loader import PDDL, load_sketch, pddl_domain_of

    scene, file = job.located(job.scene), job.located(job.domain)
    domain = pddl_domain_of(scene) if scene.endswith(PDDL) else None
    checked = load_sketch(job.located(job.sketch), file or None, domain).checked
    task = open_task(checked, scene, job.seed, job.located(job.robot) or None)
    task.reporting.warm_up()
    before = time.process_time()
    result = task.solve(Limits(timeout=job.timeout, k_max=job.k_max), job.planner)
    report = make_report(result)
    report["cpu_time_s"] = round(time.process_time() - before, 4)
    subgoals = result.outcome.subgoals
    moved = {getattr(action, "object", None) for s in subgoals for action in s.actions}
    report["objects_moved"] = len(moved - {None})
    widths = Counter(0 if len(s.actions) == 1 else s.width for s in subgoals)
    report["widths"] = {str(width): count for width, count in sorted(widths.items())}
    if result.solved:
        verdict = result.plan.validate()
        report["valid"] = verdict.valid
        report["findings"] = [finding.message for finding in verdict.findings]
    report["peak_mb"] = round(peak_memory_mb())
    return report
