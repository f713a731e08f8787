"""Tests of paths and of whole motions: how many there are in some plans, and what they take.

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
KINDS = ("path_collides", "first_hit")
ROUNDS = 5


def asked(kind: str) -> list[tuple[Any, ...]]:
    """The questions of one kind that come up while the scenes are planned."""
    test, questions = getattr(advance, kind), []

    def keeping(*question: Any) -> int:
        questions.append(tuple(np.copy(q) if isinstance(q, np.ndarray) else q for q in question))
        return int(test(*question))

    checked = load_sketch("pick_and_place").checked
    setattr(advance, kind, keeping)
    try:
        for scene in SCENES:
            open_task(checked, scene, 0).solve(Limits(timeout=60.0))
    finally:
        setattr(advance, kind, test)
    return questions


def main() -> None:
    """Print a line for each kind of test."""
    for kind in KINDS:
        questions = asked(kind)
        test = getattr(advance, kind)
        free = sum(test(*question) < 0 for question in questions)
        seconds = []
        for _ in range(ROUNDS):
            begun = process_time()
            for question in questions:
                test(*question)
            seconds.append(process_time() - begun)
        each = 1e6 * min(seconds) / len(questions)
        print(f"{kind}: {len(questions)} tests, {free} free, {each:.0f} us each")


if __name__ == "__main__":
    main()
