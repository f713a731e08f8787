"""The cheapest assignment, against SciPy's; and that a run does not import what it need not."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from scipy.optimize import linear_sum_assignment

from runtime.assignment import SMALL, augmented, least_assignment


@pytest.mark.parametrize("size", [0, 1, 2, 7, 30])
def test_it_is_the_cheapest(size, rng) -> None:
    for _ in range(40):
        costs = rng.uniform(-5.0, 20.0, (size, size))
        costs[rng.random((size, size)) < 0.2] = 1e6
        rows, columns = linear_sum_assignment(costs)
        assert augmented(costs) == pytest.approx(costs[rows, columns].sum())


def test_large_tables_are_the_same(rng) -> None:
    costs = rng.uniform(0.0, 1.0, (SMALL + 5, SMALL + 5))
    assert least_assignment(costs) == pytest.approx(augmented(costs))


RUN = """
import sys
from runtime.report import make_report
from runtime.solve import open_task
from sketchlang.loader import load_sketch
task = open_task(load_sketch("pick_and_place").checked, "sorting/3t-02", 0)
assert make_report(task.solve())["execution_lower_bound_s"] > 0
heavy = ("scipy.optimize", "scipy.spatial", "scipy.sparse", "trimesh", "networkx", "fcl")
print([name for name in heavy if name in sys.modules])
"""


def test_a_run_on_boxes_imports_neither_scipy_nor_trimesh() -> None:
    root = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "-c", RUN], cwd=root, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"
