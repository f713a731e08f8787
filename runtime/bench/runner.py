"""Run many plannings in parallel processes and keep every result as soon as it is there."""

from __future__ import annotations

import json
import multiprocessing
import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from sketchlang.errors import InputError


@dataclass(frozen=True, order=True)
class Job:
    """One planning: everything that its result depends on, given the version."""

    sketch: str
    scene: str
    planner: str
    seed: int
    timeout: float


def read_results(path: Path) -> list[dict[str, Any]]:
    """The results stored so far; a last line that was cut off is left out.

    Raises:
        InputError: the file is not one of results.
    """
    if not path.exists():
        return []
    results = []
    lines = path.read_text(encoding="utf-8").split("\n")
    for number, line in enumerate(lines):
        if not line.strip():
            continue
        try:
            result = json.loads(line)
            result["job"]["scene"]
        except (json.JSONDecodeError, KeyError, TypeError):
            if number == len(lines) - 1:
                break  # the process was killed while it wrote
            raise InputError(
                "is not a line of results", place=f"{path}: line {number + 1}"
            ) from None
        results.append(result)
    return results


def key(result: dict[str, Any]) -> Job:
    """The job that a stored result belongs to."""
    return Job(**result["job"])


def run_all(
    jobs: Iterable[Job], path: Path, processes: int, done: Callable[[dict[str, Any]], None]
) -> None:
    """Run jobs that have no result in the file yet and append each result when it is ready.

    Every line is written and flushed at once: whoever kills this loses only what is running.
    """
    finished = {key(result) for result in read_results(path)}
    pending = [job for job in jobs if job not in finished]
    _end_last_line(path)
    # Planning times are those of one core.
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    context = multiprocessing.get_context("spawn")
    with (
        path.open("a", encoding="utf-8") as file,
        ProcessPoolExecutor(processes, mp_context=context) as pool,
    ):
        try:
            for future in _as_ready(pool, pending, processes):
                result = future.result()
                file.write(json.dumps(result) + "\n")
                file.flush()
                os.fsync(file.fileno())
                done(result)
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _as_ready(
    pool: ProcessPoolExecutor, jobs: Iterable[Job], processes: int
) -> Iterator[Future[dict[str, Any]]]:
    """Futures as they complete, no more submitted than can run."""
    waiting: set[Future[dict[str, Any]]] = set()
    for job in jobs:
        waiting.add(pool.submit(run_job, job))
        if len(waiting) >= processes:
            ready, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            yield from ready
    while waiting:
        ready, waiting = wait(waiting, return_when=FIRST_COMPLETED)
        yield from ready


def _end_last_line(path: Path) -> None:
    """Drop a last line that was cut off."""
    if path.exists():
        data = path.read_bytes()
        if data and not data.endswith(b"\n"):
            path.write_bytes(data[: data.rfind(b"\n") + 1])


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
    report["job"] = asdict(job)
    moved = {getattr(a, "object", None) for s in result.outcome.subgoals for a in s.actions[-1:]}
    report["objects_moved"] = len(moved - {None})
    if result.solved:
        verdict = result.plan.validate()
        report["valid"] = verdict.valid
        report["findings"] = [finding.message for finding in verdict.findings]
    report["peak_mb"] = round(peak_memory_mb())
    return report
