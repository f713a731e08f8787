"""Tests of motions, of the arm alone and of the whole robot: what they take in some plans.

    python -m benchmarks.path_tests

Plans some scenes, keeps the tests that were asked for, and times them again. To compare two
commits, run it in a work tree of each, in turn.
"""

from __future__ import annotations

from time import process_time
from typing import Any

import numpy as np

from runtime.kernels import advance
from runtime.search.limits import Limits
from runtime.solve import open_task
from sketchlang.loader import load_sketch

SCENES = ("sorting/4t-28", "sorting/1t-20", "words/tamp")
ROUNDS = 5


def asked() -> list[tuple[Any, ...]]:
    """The questions that come up while the scenes are planned."""
    test, questions = advance.first_hit, []

    def keeping(*question: Any) -> int:
        questions.append(tuple(np.copy(q) if isinstance(q, np.ndarray) else q for q in question))
        return int(test(*question))

    checked = load_sketch("pick_and_place").checked
    advance.first_hit = keeping
    try:
        for scene in SCENES:
            open_task(checked, scene, 0).solve(Limits(timeout=60.0))
    finally:
        advance.first_hit = test
    return questions


def main() -> None:
    """Print how many tests there are, how many find nothing, and microseconds for each."""
    questions = asked()
    free = sum(advance.first_hit(*question) < 0 for question in questions)
    seconds = []
    for _ in range(ROUNDS):
        begun = process_time()
        for question in questions:
            advance.first_hit(*question)
        seconds.append(process_time() - begun)
    each = 1e6 * min(seconds) / len(questions)
    print(f"{len(questions)} tests, {free} free, {each:.0f} us each")


if __name__ == "__main__":
    main()
