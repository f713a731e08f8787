"""Kernels are compiled once; from then on their machine code does the same without the compiler."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from runtime.kernels import kept
from runtime.kernels.kept import Kept, Key
from runtime.kernels.native import MachineCode

ROOT = Path(__file__).parents[3]

KERNELS = """
import numpy as np
from runtime.kernels.compiled import njit

SCALE = 2.0

@njit(inline="always")
def scaled(x):
    return x * SCALE

@njit()
def total(rows):
    out = np.zeros(rows.shape[1])
    for k in range(rows.shape[0]):
        for i in range(rows.shape[1]):
            out[i] += scaled(rows[k, i])
    return out, rows.shape[0]

@njit()
def part(n):
    if n < 0:
        raise ValueError("less than nothing")
    return 12 // n
"""

CALLS = """
import sys
import numpy as np
from kernels import part, total

rows = np.arange(12.0).reshape(3, 4)
fixed = rows.copy()
fixed.flags.writeable = False
for each in (rows, rows.T, rows[:, ::2], fixed, rows.astype(np.int32)):
    print(total(each))
print(part(5), part(np.int64(5)))
for n in (-1, 0):
    try:
        part(n)
    except Exception as error:
        print(type(error).__name__, *error.args)
print("numba" in sys.modules, file=sys.stderr)
"""


@pytest.fixture
def call(tmp_path):
    """Runs the calls with some text of the kernels: what is printed, and whether the compiler was
    needed."""

    def run(kernels: str = KERNELS) -> tuple[str, bool]:
        (tmp_path / "kernels.py").write_text(kernels)
        done = subprocess.run(
            [sys.executable, "-c", CALLS],
            env={
                **os.environ,
                "NUMBA_CACHE_DIR": str(tmp_path / "kept"),
                "PYTHONPATH": os.pathsep.join([str(ROOT), str(tmp_path)]),
                "PYTHONDONTWRITEBYTECODE": "1",
            },
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stdout, done.stderr.splitlines()[-1] == "True"

    return run


def file_of(folder: Path) -> Path:
    """The file in which something is kept."""
    (found,) = (folder / "kept").glob("kernels-*.bin")
    return found


def test_the_second_time_the_compiler_is_not_there(call, tmp_path) -> None:
    first, compiled = call()
    assert compiled
    assert "[24., 30., 36., 42.]" in first
    assert call() == (first, False)
    assert call(KERNELS.replace("def total", "# a remark\ndef total")) == (first, False)
    changed, compiled = call(KERNELS.replace("SCALE = 2.0", "SCALE = 3.0"))
    assert compiled
    assert "[36., 45., 54., 63.]" in changed
    path = file_of(tmp_path)
    sound = path.read_bytes()
    for place in (300, len(sound) - 9):  # in the index, in a piece
        path.write_bytes(sound[:place] + bytes([sound[place] ^ 1]) + sound[place + 1 :])
        assert call(KERNELS.replace("SCALE = 2.0", "SCALE = 3.0")) == (changed, True), place
    assert call(KERNELS.replace("SCALE = 2.0", "SCALE = 3.0")) == (changed, False)
    assert not [each for each in path.parent.iterdir() if each.name.startswith("tmp")]


def entries(number: int) -> dict[Key, MachineCode]:
    """Something that looks like machine code."""
    return {
        Key(f"kernel_{k}", "f" * 24, ("float64", ("tuple", "bool"))): MachineCode(
            f"kernel_{k}", bytes([k]) * 999, "entry", "own", {"own": ("<f8",), "other": ()}
        )
        for k in range(number)
    }


def test_what_several_processes_add_is_kept(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(kept, "_try", lambda path: None)
    monkeypatch.setattr(kept, "_forget_others", lambda key: None)
    path = tmp_path / "kernels.bin"
    one, another = Kept(path), Kept(path)
    written = entries(4)
    first, second, third, fourth = written
    one.new |= {first: written[first], second: written[second]}
    another.new |= {third: written[third]}
    one.write()
    another.write()
    found = Kept(path)
    assert {key: found[key] for key in found} == {
        key: written[key] for key in (first, second, third)
    }
    changed = first._replace(fingerprint="0" * 24)
    found.new[changed] = written[fourth]
    found.write()
    assert set(Kept(path)) == {changed, second, third}


def test_what_cannot_be_linked_is_not_kept(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(kept, "_forget_others", lambda key: None)
    path = tmp_path / "kernels.bin"
    writer = Kept(path)
    writer.new |= entries(1)
    writer.write()  # the process that tries it ends with a fault of LLVM
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("length", [0, 10, 40, 70])
def test_a_file_that_was_cut_counts_as_none(length, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(kept, "_try", lambda path: None)
    monkeypatch.setattr(kept, "_forget_others", lambda key: None)
    path = tmp_path / "kernels.bin"
    writer = Kept(path)
    writer.new |= entries(2)
    writer.write()
    path.write_bytes(path.read_bytes()[:length])
    assert list(Kept(path)) == []
