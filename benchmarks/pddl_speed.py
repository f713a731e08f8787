"""States that the search of PDDL tasks expands in a second of processor time, features included.

    python -m benchmarks.pddl_speed driverlog TASKS/driverlog/p15.pddl childsnack TASKS/.../p10.pddl

Arguments are pairs of a sketch and a task. Each task is read, its kernels are warmed up, and then
it is solved; the best of `--runs` fresh runs counts. With `--python`, which has dlplan (see
`benchmarks/policies.py`), and `--policies`, a folder with policies like `driverlog_1.txt`, a line
says of how many states a second dlplan, called from Python, evaluates a policy's features: a
search in Python that uses it cannot be quicker.
"""

from __future__ import annotations

import argparse
import json
import random
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from benchmarks.policies import ask, question, walked
from domains.pddl.interface import domain_beside
from runtime.search.limits import Limits
from runtime.solve import open_task
from sketchlang.loader import load_sketch, pddl_domain

PEER = Path(__file__).with_name("mimir_peer.py")


def ours(sketch: str, path: str, runs: int) -> str:
    """A row of the table."""
    best: tuple[float, int, int] | None = None
    domain = pddl_domain(str(domain_beside(path)))
    checked = load_sketch(sketch, None, domain).checked
    for _ in range(runs):
        task = open_task(checked, path, 0)
        task.reporting.warm_up()
        begun = time.process_time()
        outcome = task.solve(Limits(timeout=600), "siw-r").outcome
        seconds = time.process_time() - begun
        assert outcome.solved, outcome.reason
        found = seconds, outcome.effort.expanded, outcome.effort.generated
        best = min(best or found, found)
    assert best is not None
    seconds, expanded, generated = best
    return (
        f"| {sketch} {Path(path).stem} | {expanded} | {generated} | {1000 * seconds:.0f} "
        f"| {expanded / seconds:.0f} | {generated / seconds:.0f} |"
    )


def theirs(policy: Path, path: str, python: str) -> str:
    """How quick the other library evaluates a policy's features of states of a task."""
    interface = pddl_domain(str(domain_beside(path)))
    assert interface.load is not None
    problem = interface.load(path, None)  # type: ignore[arg-type]
    states, _ = walked(problem, random.Random(0))
    told = ask(python, question(policy.read_text(), problem, states, []))
    rate = len(states) / told["seconds"]
    return (
        f"dlplan, {policy.name} on {len(states)} states of {Path(path).stem}: {rate:.0f} a second"
    )


def native(path: str, python: str) -> list[str]:
    """How quick the searches of mimir are on a task, each in a row of the table."""
    command = [python, str(PEER), str(domain_beside(path)), path, "5"]
    answer = subprocess.run(command, check=True, capture_output=True)
    rows = []
    for told in map(json.loads, answer.stdout.splitlines()):
        expanded, generated, seconds = told["expanded"], told["generated"], told["seconds"]
        rows.append(
            f"| mimir {told['search']}, {Path(path).stem} | {expanded} | {generated} "
            f"| {1000 * seconds:.0f} | {expanded / seconds:.0f} | {generated / seconds:.0f} |"
        )
    return rows


def main(arguments: Sequence[str]) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("pairs", nargs="+")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--python")
    parser.add_argument("--policies", type=Path)
    parser.add_argument("--mimir")
    options = parser.parse_args(arguments)
    pairs = list(zip(options.pairs[::2], options.pairs[1::2], strict=True))
    print("| task | expanded | generated | ms | expanded a second | generated a second |")
    print("|---|---|---|---|---|---|")
    for sketch, path in pairs:
        print(ours(sketch, path, options.runs), flush=True)
        for row in native(path, options.mimir) if options.mimir else ():
            print(row, flush=True)
    if options.python and options.policies:
        for sketch, path in pairs:
            for policy in sorted(options.policies.rglob(f"{sketch}_*.txt"))[:1]:
                print(theirs(policy, path, options.python), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
