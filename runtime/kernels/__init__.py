"""The few hot loops, compiled by numba.

Each kernel has a plain reference twin in `tests/runtime/reference.py`.
Poses are 3x4 matrices `[R | t]`; lengths are metres, angles radians.
"""

from pathlib import Path

from runtime.kernels.cache import prepare

prepare(Path(__file__).parent)
