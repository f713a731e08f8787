"""A process that does one run after another for a worker of a cluster: JSON lines in and out.

It is a process of its own, so that a run that crashes, hangs or takes all memory costs itself and
not the worker, and so that runs of several threads of a worker do not share random numbers. It
ends with the worker, however that ends.
"""

from __future__ import annotations

import json
import os
import platform
import select
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from typing import Any

from runtime.bench.job import Job, as_data, job_of
from runtime.bench.pool import end_with_parent_process
from runtime.bench.runner import one_core, run_job, seconds_for
from runtime.bench.versions import HOME, difference, versions_of


class Child:
    """One such process, as the worker sees it."""

    def __init__(self) -> None:
        one_core()
        paths = [str(HOME), *filter(None, [os.environ.get("PYTHONPATH")])]
        self.process = subprocess.Popen(
            [sys.executable, "-m", "runtime.bench.child"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        )

    def work(self, job: Job) -> tuple[bool, Any]:
        """What came of a run, and whether it is a result or the reason why there is none."""
        assert self.process.stdin is not None
        with suppress(OSError):  # it has died: seen when its answer is read
            line = json.dumps({"job": as_data(job), "folder": job.folder}) + "\n"
            self.process.stdin.write(line.encode())
            self.process.stdin.flush()
        answer = self._line(seconds_for(job))
        if answer is None:
            self.process.kill()
            return False, "it did not stop in time"
        if not answer.endswith(b"\n"):
            return False, f"its process ended with status {self.process.wait()}"
        fine, what = json.loads(answer)
        return fine, what

    def _line(self, seconds: float) -> bytes | None:
        """The next line, what there is of it at the end, or None if it takes too long."""
        assert self.process.stdout is not None
        handle, until, found = self.process.stdout.fileno(), time.monotonic() + seconds, b""
        while not found.endswith(b"\n"):
            left = max(0.0, until - time.monotonic())
            if not select.select([handle], [], [], left)[0]:
                return None
            more = os.read(handle, 1 << 16)
            if not more:
                break
            found += more
        return found

    @property
    def alive(self) -> bool:
        """Whether it can be given more work."""
        return self.process.poll() is None

    def stop(self) -> None:
        """End it."""
        self.process.kill()
        self.process.wait()


_children = threading.local()


def run_in_child(data: dict[str, Any], folder: str) -> tuple[bool, Any]:
    """One run, in the process that belongs to this thread of a worker: a result, or the reason why
    there is none."""
    child: Child | None = getattr(_children, "one", None)
    if child is None or not child.alive:
        child = _children.one = Child()
    return child.work(job_of(data, folder))


def answer(line: str) -> tuple[bool, Any]:
    """What came of the run in a line, in this process."""
    asked = json.loads(line)
    job = job_of(asked["job"], asked["folder"])
    try:
        other = difference(job.versions, versions_of(job))
        if other is not None:
            return False, f"{platform.node()} has another version of: {other}"
        return True, run_job(job)
    except Exception as error:  # said by the one who asked, who goes on
        return False, f"{type(error).__name__}: {error}"


def main() -> None:
    """Answer line by line until nobody asks any more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent, which ends us
    end_with_parent_process()
    # What libraries print is not to stand among the answers.
    with os.fdopen(os.dup(1), "w") as out:
        os.dup2(2, 1)
        for line in sys.stdin:
            out.write(json.dumps(answer(line)) + "\n")
            out.flush()


if __name__ == "__main__":
    main()
