"""How `sketchlang terminate` scales: time and memory of whole processes, and of their parts.

    python benchmarks/termination.py [--features 5,12,20] [--families chain,relay] [--repeat 9]

Each line is a sketch of `benchmarks/families.py`: its features, the verdict and the method,
seconds of the whole process (the least of several runs, start-up of Python included),
the same for `sketchlang check`, seconds of the proof alone, the process's peak memory, and
size of the certificate with the seconds of the whole process that verifies it.
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

from families import FAMILIES

ENVIRONMENT = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
"""Modules are compiled once, as they are for users, and not in each process."""

COMMAND = [sys.executable, "-c", "from sketchlang.cli import main; main()"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--features", default="5,12,20")
    parser.add_argument("--families", default="chain,relay,copies,endless")
    parser.add_argument("--repeat", type=int, default=9)
    parser.add_argument("--time-limit", type=float, default=60.0)
    arguments = parser.parse_args()
    cache = tempfile.TemporaryDirectory()
    ENVIRONMENT["PYTHONPYCACHEPREFIX"] = cache.name
    _run(["terminate", "--help"])
    print(f"Python alone: {_least(['-c', 'pass'], arguments.repeat):.3f} s")
    header = ("family", "features", "verdict", "method", "process s", "check s", "proof s")
    header += ("peak MB", "certificate kB", "verify s")
    print(("{:>9}  {:>8}  {:>15}  {:>16}" + "  {:>9}" * 4 + "  {:>14}  {:>8}").format(*header))
    for family in arguments.families.split(","):
        for features in map(int, arguments.features.split(",")):
            _line(family, features, arguments.repeat, arguments.time_limit)


def _line(family: str, features: int, repeat: int, limit: float) -> None:
    with tempfile.TemporaryDirectory() as folder:
        sketch = Path(folder, "it.sketch")
        sketch.write_text(FAMILIES[family](features))
        proof = Path(folder, "proof.json")
        terminate = ["terminate", str(sketch), "--time-limit", str(limit)]
        seconds, found, peak = [], {}, 0.0
        for _ in range(repeat):
            took, output, peak = _run([*terminate, "--json", "--certificate", str(proof)])
            seconds.append(took)
            found = json.loads(output)
        check = min(_run(["check", str(sketch)])[0] for _ in range(repeat))
        size, verify = 0.0, 0.0
        if proof.exists():
            size = proof.stat().st_size / 1024
            verify = min(_run(["verify", str(proof), str(sketch)])[0] for _ in range(repeat))
        print(
            f"{family:>9}  {features:>8}  {found['verdict']:>15}  {found['method']:>16}"
            f"  {min(seconds):>9.3f}  {check:>9.3f}  {found['time_s']:>9.4f}"
            f"  {peak:>9.0f}  {size:>14.1f}  {verify:>8.3f}",
            flush=True,
        )


def _run(arguments: list[str]) -> tuple[float, str, float]:
    """Seconds, standard output and peak megabytes of one run of the command line."""
    with tempfile.TemporaryFile("w+") as output:
        started = time.perf_counter()
        process = subprocess.Popen([*COMMAND, *arguments], stdout=output, env=ENVIRONMENT)
        _, _, usage = os.wait4(process.pid, 0)
        took = time.perf_counter() - started
        output.seek(0)
        return took, output.read(), usage.ru_maxrss / 1024


def _least(arguments: list[str], repeat: int) -> float:
    seconds = []
    for _ in range(repeat):
        started = time.perf_counter()
        subprocess.run([sys.executable, *arguments], check=True, env=ENVIRONMENT)
        seconds.append(time.perf_counter() - started)
    return min(seconds)


if __name__ == "__main__":
    main()
