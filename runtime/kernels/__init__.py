"""The few hot loops, compiled by numba.

Each kernel has a plain reference twin in `tests/runtime/reference.py`.
Poses are 3x4 matrices `[R | t]`; lengths are metres, angles radians.

No kernel uses linear algebra from a library. numba would still import all of SciPy's, a fifth
of a second at every start, when its first function is loaded: here it is told that there is
none, and only while it asks.
"""

from __future__ import annotations

import sys
from pathlib import Path

from runtime.kernels.cache import prepare


def _without_linear_algebra() -> None:
    if "scipy" in sys.modules or "numba.np.arraymath" in sys.modules:
        return
    sys.modules["scipy"] = None  # type: ignore[assignment]
    try:
        import numba.np.arraymath  # noqa: F401
    finally:
        del sys.modules["scipy"]


_without_linear_algebra()
prepare(Path(__file__).parent)
