"""A process that plans again and again does not grow."""

from __future__ import annotations

import gc
import subprocess
import sys

import pytest

from runtime.collector import GROWTH, spared
from tests.trust.workspace import ROOT


class Knot:
    """Refers to itself: only the collector can take it away."""

    def __init__(self) -> None:
        self.itself = self


def test_what_refers_to_itself_is_taken_away() -> None:
    gc.collect()
    with spared():
        pass
    before = len(gc.get_objects())
    for _ in range(40):
        knots = [Knot() for _ in range(GROWTH // 10)]
        with spared():
            del knots
    assert len(gc.get_objects()) < before + 3 * GROWTH
    gc.collect()


RUNS = """
from runtime.search.limits import Limits
from runtime.solve import open_task
from sketchlang.loader import load_sketch

def resident():
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS")) / 1024

checked = load_sketch("pick_and_place").checked
for number in range(300):
    assert open_task(checked, "sorting/3t-02", number).solve(Limits(timeout=60.0)).solved
    if number == 9:
        tenth = resident()
print(resident() - tenth)
"""


@pytest.mark.slow
def test_three_hundred_plans_stay_within_20_mb() -> None:
    done = subprocess.run(
        [sys.executable, "-c", RUNS], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert float(done.stdout) < 20.0
