"""Kernels are compiled before the clock of a search starts, with those that few scenes ask for."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """
import sys
from numba.core import event
from runtime.search.limits import Limits
from runtime.solve import open_task
from sketchlang.loader import load_sketch

task = open_task(load_sketch("pick_and_place").checked, sys.argv[1])
with event.install_recorder("numba:compile") as before:
    task.reporting.warm_up()
with event.install_recorder("numba:compile") as later:
    task.solve(Limits(timeout=60.0))
print(len(before.buffer) // 2, *(str(each.data["dispatcher"]) for _, each in later.buffer))
"""


@pytest.mark.slow
def test_nothing_is_compiled_while_a_scene_is_planned(tmp_path) -> None:
    """Not where nothing was compiled ever before, nor in the scenes after that one."""
    root = Path(__file__).parents[2]
    compiled = []
    for scene in ("sorting/3t-02", "sorting/4t-07", "kitchen/tidy"):
        done = subprocess.run(
            [sys.executable, "-c", SCRIPT, scene],
            cwd=root,
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)},
            capture_output=True,
            text=True,
            check=True,
        )
        number, *later = done.stdout.split()
        compiled.append(int(number))
        assert not later, (scene, later)
    assert compiled[0] > 20
