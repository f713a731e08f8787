"""The few hot loops, compiled by numba.

Each kernel has a plain reference twin in `tests/runtime/reference.py`.
Poses are 3x4 matrices `[R | t]`; lengths are metres, angles radians.

No kernel uses linear algebra from a library or functions of C. Numba would still import all of
SciPy's linear algebra and a parser of C, a fifth of a second at every start, when its first
function is loaded: here it is told that there are none, and only while it asks.
"""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

from runtime.kernels.cache import announce, prepare

ASKS = {
    "numba.np.arraymath": ("scipy", "scipy.linalg"),
    "numba.core.typing.cffi_utils": ("cffi",),
}
"""Modules of Numba, and what each would like to have: the first that is not there yet is hidden."""


def _without_libraries() -> None:
    for module, libraries in ASKS.items():
        library = next((each for each in libraries if each not in sys.modules), None)
        if module in sys.modules or library is None:
            continue
        sys.modules[library] = None  # type: ignore[assignment]
        try:
            importlib.import_module(module)
        finally:
            del sys.modules[library]


_without_libraries()
prepare(Path(__file__).parent)
announce()
