"""Machine code is used again only for what it was made of."""

from __future__ import annotations

from types import FunctionType

import pytest

from runtime.kernels.compiled import Kernel

SOURCE = '''
import math
import numpy as np
import others
SCALE = 2.0
TABLE = np.arange(4.0)

@kernel
def inner(x):
    """Says something."""
    return x * SCALE + TABLE[1]  # a remark

@kernel
def outer(x):
    total = 0.0
    for k in range(3):
        total += inner(x) + math.cos(k) + others.LIMIT
    return total

@kernel
def again(n):
    return 1 if n == 0 else again(n - 1)
'''


def fingerprints(source: str, monkeypatch, limit: float = 1.0, **options) -> dict[str, str | None]:
    """Those of the kernels of a module."""
    import sys
    from types import ModuleType

    others = ModuleType("others")
    others.LIMIT = limit
    monkeypatch.setitem(sys.modules, "others", others)

    def kernel(function: FunctionType) -> Kernel:
        return Kernel(function, {"inline": "never", **options}, True)

    names = {"kernel": kernel, "__name__": "made"}
    exec(compile(source, "made.py", "exec"), names)
    return {name: each.fingerprint for name, each in names.items() if isinstance(each, Kernel)}


def test_remarks_and_places_change_nothing(monkeypatch) -> None:
    before = fingerprints(SOURCE, monkeypatch)
    moved = "\n\n" + SOURCE.replace("# a remark", "# another").replace("something", "anything")
    assert fingerprints(moved, monkeypatch) == before
    assert len(set(before.values())) == 3


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("SCALE = 2.0", "SCALE = 3.0"),
        ("SCALE = 2.0", "SCALE = 2"),
        ("np.arange(4.0)", "np.arange(5.0)"),
        ("np.arange(4.0)", "np.arange(4)"),
        ("TABLE[1]", "TABLE[2]"),
        ("x * SCALE", "x + SCALE"),
    ],
)
def test_what_a_kernel_does_and_what_it_calls_count(old, new, monkeypatch) -> None:
    before = fingerprints(SOURCE, monkeypatch)
    after = fingerprints(SOURCE.replace(old, new), monkeypatch)
    changed = {name for name in before if before[name] != after[name]}
    assert changed == {"inner", "outer"}


def test_constants_of_other_modules_and_options_count(monkeypatch) -> None:
    before = fingerprints(SOURCE, monkeypatch)
    after = fingerprints(SOURCE, monkeypatch, limit=2.0)
    assert {name for name in before if before[name] != after[name]} == {"outer"}
    inlined = fingerprints(SOURCE, monkeypatch, inline="always")
    assert not set(inlined.values()) & set(before.values())


@pytest.mark.parametrize("thing", ["object()", "[1, 2]", "{}"])
def test_what_may_be_another_thing_the_next_time_is_not_kept(thing, monkeypatch) -> None:
    found = fingerprints(SOURCE.replace("SCALE = 2.0", f"SCALE = {thing}"), monkeypatch)
    assert found["inner"] is None
    assert found["outer"] is None
    assert found["again"] is not None
