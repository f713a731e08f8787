"""Processes that work for us and never outlive us.

Each is told one piece of work at a time through a pipe. They end with their parent however it
ends: the kernel sends them a signal where it can, and everywhere a pipe that only the parent
holds open is closed. One that dies or does not stop costs its piece of work, not the others.
"""

from __future__ import annotations

import ctypes
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, Generic, TypeVar

J = TypeVar("J")
R = TypeVar("R")

PR_SET_PDEATHSIG = 1


@dataclass
class _Worker(Generic[J]):
    process: BaseProcess
    pipe: Connection
    job: J | None = None
    until: float = 0.0


def run_jobs(
    jobs: Iterable[J],
    processes: int,
    work: Callable[[J], R],
    done: Callable[[J, R], None],
    seconds: Callable[[J], float],
) -> list[tuple[J, str]]:
    """Work on jobs in so many processes, `done` with each result when it is ready.

    `work` is a function of a module. A process that takes more than `seconds` of a job is
    killed. Returns the jobs without a result, and why.
    """
    # The standard way of starting on all systems from Python 3.14 on, and safe with threads.
    context = multiprocessing.get_context("spawn")
    reader, writer = context.Pipe(duplex=False)
    pending, lost = deque(jobs), list[tuple[J, str]]()
    workers: list[_Worker[J]] = []
    try:
        while pending or any(worker.job is not None for worker in workers):
            idle = [worker for worker in workers if worker.job is None]
            while pending and (idle or len(workers) < processes):
                if not idle:
                    workers.append(_started(context, reader, work))
                    idle.append(workers[-1])
                _give(idle.pop(), pending, seconds)
            _await(workers)
            for worker in list(workers):
                if worker.job is not None and not _collect(worker, done, lost):
                    workers.remove(worker)
    finally:
        for worker in workers:
            worker.process.kill()
        for worker in workers:
            worker.process.join()
            worker.pipe.close()
        writer.close()
        reader.close()
    return lost


def _started(context: Any, life: Connection, work: Callable[[J], R]) -> _Worker[J]:
    ours, theirs = context.Pipe()
    process = context.Process(target=_serve, args=(theirs, life, work), daemon=True)
    process.start()
    theirs.close()
    return _Worker(process, ours)


def _give(worker: _Worker[J], pending: deque[J], seconds: Callable[[J], float]) -> None:
    worker.job = pending.popleft()
    worker.until = time.monotonic() + seconds(worker.job)
    with suppress(OSError):  # it has died: seen when its answer is waited for
        worker.pipe.send(worker.job)


def _await(workers: list[_Worker[J]]) -> None:
    busy = [worker for worker in workers if worker.job is not None]
    left = min(worker.until for worker in busy) - time.monotonic()
    wait([each for w in busy for each in (w.pipe, w.process.sentinel)], max(0.0, left))


def _collect(worker: _Worker[J], done: Callable[[J, R], None], lost: list[tuple[J, str]]) -> bool:
    """Take what a busy worker has ready; whether it can go on working."""
    job = worker.job
    assert job is not None
    try:
        if worker.pipe.poll():
            fine, answer = worker.pipe.recv()
            worker.job = None
            if fine:
                done(job, answer)
            else:
                lost.append((job, answer))
            return True
    except (EOFError, OSError):
        worker.process.join()
    if not worker.process.is_alive():
        lost.append((job, f"its process ended with status {worker.process.exitcode}"))
    elif time.monotonic() > worker.until:
        lost.append((job, "it did not stop in time"))
        worker.process.kill()
    else:
        return True
    worker.process.join()
    worker.pipe.close()
    return False


def _serve(pipe: Connection, life: Connection, work: Callable[[J], R]) -> None:
    """What a worker does: jobs, until there are no more or nobody wants them."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent, which ends us
    end_with_parent(life)
    with suppress(EOFError, OSError):
        while True:
            job = pipe.recv()
            try:
                pipe.send((True, work(job)))
            except OSError:
                raise
            except Exception as error:  # said by the parent, who goes on
                pipe.send((False, f"{type(error).__name__}: {error}"))


def end_with_parent(life: Connection) -> None:
    """End this process when the other end of a pipe is closed, which is when its parent ends."""

    def watch() -> None:
        with suppress(EOFError, OSError):
            life.recv_bytes()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
    end_with_parent_process()


def end_with_parent_process() -> None:
    """The same by a signal from the kernel, where it can."""
    if sys.platform == "linux":  # at once, also within long calls of native code
        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
