"""What it brings that each box advances at its own pace in path tests.

    python -m benchmarks.path_tests

Plans some scenes, keeps the path tests that were asked for, and times them again: with every
box looked at only when it is due (`runtime.kernels.arm.TOGETHER` as it is), and with all boxes
looked at whenever one is. Each in a process of its own, as the kernels are compiled for it.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from time import perf_counter
from typing import Any

import numpy as np

from sketchlang.domain import LoadOptions

SCENES = ("sorting/4t-28", "sorting/1t-20", "words/tamp")
ALWAYS = 1.0  # as long as a line: everything is due with everything else


def measure(together: float | None) -> None:
    """Print how many path tests there are, how many pass, and microseconds for each."""
    from runtime.kernels import arm

    if together is not None:
        arm.TOGETHER = together
    from domains.tabletop.problem import load_problem
    from runtime.search.limits import Limits
    from runtime.search.siw_r import lazy_siiw_r
    from sketchlang.compile import compile_sketch
    from sketchlang.library import find_scene
    from sketchlang.loader import load_sketch

    test, questions = arm.path_collides, []

    def keeping(*question: Any) -> int:
        questions.append(tuple(np.copy(q) if isinstance(q, np.ndarray) else q for q in question))
        return int(test(*question))

    compiled = compile_sketch(load_sketch("pick_and_place").checked)
    arm.path_collides = keeping
    for scene in SCENES:
        path, name = find_scene(scene)
        problem = load_problem(str(path), LoadOptions(name))
        lazy_siiw_r(compiled, problem, Limits(), np.random.default_rng(0))
    started = perf_counter()
    free = sum(test(*question) < 0 for question in questions)
    print(len(questions), free, 1e6 * (perf_counter() - started) / len(questions))


def main() -> None:
    """Print both ways and their ratio."""
    found = []
    for how, together in (("its own pace", None), ("all together", ALWAYS)):
        with tempfile.TemporaryDirectory() as folder:
            arguments = ["--child"] if together is None else ["--child", str(together)]
            done = subprocess.run(
                [sys.executable, "-m", "benchmarks.path_tests", *arguments],
                env={**os.environ, "NUMBA_CACHE_DIR": folder},
                capture_output=True,
                text=True,
                check=True,
            )
        number, free, each = done.stdout.split()
        found.append(float(each))
        print(f"{how}: {number} path tests, {free} free, {float(each):.0f} us each")
    print(f"ratio {found[1] / found[0]:.1f}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--child"]:
        measure(float(sys.argv[2]) if len(sys.argv) > 2 else None)
    else:
        main()
