"""The checker of certificates must not depend on what it checks."""

from __future__ import annotations

import ast
import inspect
from pathlib import Path

import pytest

import sketchlang.analysis.verify as checker


def test_the_checker_imports_nothing_of_the_prover() -> None:
    assert checker.__file__ is not None
    folder = Path(checker.__file__).parent
    parts = [path.name for path in folder.glob("verify*.py")]
    assert set(parts) >= {"verify.py", "verify_read.py"}
    allowed = {f"sketchlang.analysis.{Path(name).stem}" for name in parts}
    allowed |= {"sketchlang.model", "sketchlang.analysis.fingerprint"}
    for name in [*parts, "fingerprint.py"]:
        tree = ast.parse((folder / name).read_text(encoding="utf-8"))
        imported = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
        own = {module for module in imported if module and module.startswith("sketchlang")}
        assert own <= allowed


def test_the_checker_can_be_read_in_one_sitting() -> None:
    assert checker.__file__ is not None
    assert len(Path(checker.__file__).read_text(encoding="utf-8").splitlines()) < 320


@pytest.mark.parametrize("step", ["drop", "potential", "ranks", "split"])
def test_a_step_is_checked_in_a_few_lines(step: str) -> None:
    assert len(inspect.getsource(getattr(checker.Checker, step)).splitlines()) < 40
