"""Runs on the workers of a dask.distributed scheduler, with the store of this process.

Results are written by one process, this one, once and by their key, as soon as they are there. A
worker that is killed costs the run that it was at: the scheduler gives it to another one. What
is in the store is never asked for again. Workers need this package, in the same version, and the
files under the same paths: they compare versions and refuse what differs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from runtime.bench.child import run_in_child
from runtime.bench.job import Job, Result, as_data
from runtime.bench.runner import Lost, keeper, pending
from runtime.bench.store import Store
from sketchlang.errors import InputError

CONNECTED = 30.0
"""Seconds in which a scheduler has to answer."""

AHEAD = 4
"""Runs that are handed out for each thread of a worker: a scheduler need not hold them all."""


def run_on(address: str, jobs: Iterable[Job], store: Store, done: Callable[[Result], None]) -> Lost:
    """Run jobs that have no result in a store yet on a cluster, and append each result when it is
    ready. Returns the jobs without a result, and why.

    Raises:
        InputError: dask.distributed is not installed, or there is no scheduler.
    """
    client = _client(address)
    todo, lost = pending(jobs, store)[::-1], Lost()
    keep = keeper(store, done)
    try:
        from distributed import as_completed

        at_work: dict[str, Job] = {}
        finished = as_completed([], with_results=True, raise_errors=False)
        while todo or at_work:
            while todo and len(at_work) < AHEAD * max(1, _threads(client)):
                job = todo.pop()
                future = client.submit(
                    run_in_child, as_data(job), job.folder, key=f"sketchlang-{job.digest}",
                    pure=False,
                )  # fmt: skip
                at_work[future.key] = job
                finished.add(future)
            future, answer = next(finished)
            job = at_work.pop(future.key)
            _take(job, future.status, answer, keep, lost)
            future.release()
    finally:
        client.close()  # what nobody waits for any more is given up by the scheduler
    return lost


def _take(
    job: Job, status: str, answer: Any, keep: Callable[[Job, dict[str, Any]], None], lost: Lost
) -> None:
    if status != "finished":
        lost.append((job, f"{status}: {_words(answer)}"))
        return
    fine, what = answer
    if fine:
        keep(job, what)
    else:
        lost.append((job, what))


def _words(answer: Any) -> str:
    """What an exception says that came from a cluster, alone or with where it was."""
    error = answer[1] if isinstance(answer, tuple) and len(answer) > 1 else answer
    return f"{type(error).__name__}: {error}".partition("\n")[0]


def _threads(client: Any) -> int:
    return sum(client.nthreads().values())


def _client(address: str) -> Any:
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            "--scheduler needs dask.distributed, which is not installed",
            hint="install sketchlang[dask]",
        ) from None
    try:
        return Client(address, timeout=CONNECTED, name="sketchlang-bench")
    except (OSError, ValueError, TypeError) as error:  # no answer, or no address
        raise InputError(
            f"--scheduler: {address} does not answer: {type(error).__name__}",
            hint="start one with `dask scheduler`, and workers with `dask worker ADDRESS`",
        ) from None
