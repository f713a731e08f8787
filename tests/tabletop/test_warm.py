"""Kernels are compiled, or loaded, before the clock of a search starts."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """
import gc, sys
from numba.core.dispatcher import Dispatcher
from runtime.search.limits import Limits
from runtime.solve import open_task
from sketchlang.loader import load_sketch

def compiled():
    return {
        f"{each.py_func.__name__}{signature}"
        for each in gc.get_objects() if isinstance(each, Dispatcher)
        for signature in each.signatures
    }

task = open_task(load_sketch("pick_and_place").checked, sys.argv[1])
task.reporting.warm_up()
before = compiled()
assert len(before) > 20
task.solve(Limits(timeout=60.0))
print(*compiled() - before, sep="\\n")
"""


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["sorting/3t-02", "sorting/4t-07", "kitchen/tidy"])
def test_nothing_is_compiled_while_a_scene_is_planned(scene) -> None:
    root = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, scene], cwd=root, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == ""
