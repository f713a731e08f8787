"""`check` answers within a blink: what it imports, and how long it takes."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks import check_time

ROOT = Path(__file__).parents[2]
SCRIPT = """
import sys
from sketchlang.cli import main
try:
    main()
finally:
    names = {name.partition(".")[0] for name in sys.modules} - sys.stdlib_module_names
    print(*sorted(names - {"__main__"}), file=sys.stderr)
"""
# `runtime` is there for the classes of the domain; it must not bring more along.
ALLOWED = {"click", "domains", "grammars", "lark", "runtime", "sketchlang"}
# What the installation itself may load before anything else.
SITE = {"_distutils_hack", "sitecustomize", "usercustomize"}


@pytest.mark.parametrize("sketch", ["pick_and_place", "driverlog/driverlog"])
def test_what_check_imports(sketch: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, "check", f"domains/{sketch}.sketch"],
        capture_output=True,
        text=True,
        cwd=ROOT,
        check=True,
    )
    names = {name for name in done.stderr.split() if not name.startswith("__editable__")}
    assert names - SITE <= ALLOWED


def test_a_large_sketch_is_checked_within_three_tenths_of_a_second(tmp_path: Path) -> None:
    path = tmp_path / "large.sketch"
    path.write_text(check_time.sketch(rules=100, features=30), encoding="utf-8")
    # The other core may be busy: one quiet run out of a few is enough.
    times = (check_time.seconds(path, tmp_path / "cache") for _ in range(10))
    assert any(time < 0.3 for time in times)
