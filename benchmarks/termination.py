"""How `sketchlang terminate` scales: time and memory of whole processes, and of their parts.

    python -m benchmarks.termination [--features 5,12,20] [--families chain,relay] [--repeat 9]
    python -m benchmarks.termination --sketches gray:20,closed:16,weighted_sum:60:2000,dense:24:200

A sketch is a family, its features and, where the family has them, its rules and a seed.
Each line is a sketch of `benchmarks/families.py`: its features, the verdict and the method,
seconds of the whole process (the least of several runs, start-up of Python included), and of
the processor, which other work on the machine disturbs less; seconds of `sketchlang check`
on the same file, and of the proof alone; the process's peak memory; the size of the
certificate, and the seconds of the whole process that verifies it.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from benchmarks.families import FAMILIES

ENVIRONMENT = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
"""Modules are compiled once, as they are for users, and not in each process."""

COMMAND = [sys.executable, "-c", "from sketchlang.cli import main; main()"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--features", default="5,12,20")
    parser.add_argument("--families", default="chain,relay,copies,endless")
    parser.add_argument("--sketches", help="in place of families and features")
    parser.add_argument("--repeat", type=int, default=9)
    parser.add_argument("--time-limit", type=float, default=60.0)
    arguments = parser.parse_args()
    cache = tempfile.TemporaryDirectory()
    ENVIRONMENT["PYTHONPYCACHEPREFIX"] = cache.name
    _run(["terminate", "--help"])
    print(f"Python alone: {_least(['-c', 'pass'], arguments.repeat):.3f} s")
    header = ("family", "features", "verdict", "method", "process s", "CPU s", "check s")
    header += ("proof s", "peak MB", "certificate kB", "verify s")
    print(("{:>12}  {:>9}  {:>15}  {:>16}" + "  {:>9}" * 5 + "  {:>14}  {:>8}").format(*header))
    sketches = arguments.sketches or ",".join(
        f"{family}:{features}"
        for family in arguments.families.split(",")
        for features in arguments.features.split(",")
    )
    for sketch in sketches.split(","):
        family, *numbers = sketch.split(":")
        _line(family, list(map(int, numbers)), arguments.repeat, arguments.time_limit)


def _line(family: str, numbers: list[int], repeat: int, limit: float) -> None:
    with tempfile.TemporaryDirectory() as folder:
        sketch = Path(folder, "it.sketch")
        sketch.write_text(FAMILIES[family](*numbers))
        proof = Path(folder, "proof.json")
        bound = ["--time-limit", str(limit)]
        plain = [_run(["terminate", str(sketch), *bound]) for _ in range(repeat)]
        check = min(_run(["check", str(sketch)]).wall for _ in range(repeat))
        told = _run(["terminate", str(sketch), *bound, "--json", "--certificate", str(proof)])
        found = json.loads(told.output)
        size, verify = 0.0, 0.0
        if proof.exists():
            size = proof.stat().st_size / 1024
            check_it = ["verify", str(proof), str(sketch)]
            verify = min(_run(check_it).wall for _ in range(repeat))
        print(
            f"{family:>12}  {':'.join(map(str, numbers)):>9}"
            f"  {found['verdict']:>15}  {found['method']:>16}"
            f"  {min(run.wall for run in plain):>9.3f}  {min(run.cpu for run in plain):>9.3f}"
            f"  {check:>9.3f}  {found['time_s']:>9.4f}  {plain[0].peak:>9.0f}"
            f"  {size:>14.1f}  {verify:>8.3f}",
            flush=True,
        )


class Run(NamedTuple):
    """Seconds, seconds of processor time, peak megabytes, standard output of a process."""

    wall: float
    cpu: float
    peak: float
    output: str


def _run(arguments: list[str]) -> Run:
    with tempfile.TemporaryFile("w+") as output:
        started = time.perf_counter()
        process = subprocess.Popen([*COMMAND, *arguments], stdout=output, env=ENVIRONMENT)
        _, _, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - started
        output.seek(0)
        cpu = usage.ru_utime + usage.ru_stime
        return Run(wall, cpu, usage.ru_maxrss / 1024, output.read())


def _least(arguments: list[str], repeat: int) -> float:
    seconds = []
    for _ in range(repeat):
        started = time.perf_counter()
        subprocess.run([sys.executable, *arguments], check=True, env=ENVIRONMENT)
        seconds.append(time.perf_counter() - started)
    return min(seconds)


if __name__ == "__main__":
    main()
