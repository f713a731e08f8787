"""The checker of certificates must not depend on what it checks."""

from __future__ import annotations

import ast
from pathlib import Path

import sketchlang.analysis.verify as checker


def test_the_checker_imports_nothing_of_the_prover() -> None:
    assert checker.__file__ is not None
    folder = Path(checker.__file__).parent
    for name in ("verify.py", "fingerprint.py"):
        tree = ast.parse((folder / name).read_text(encoding="utf-8"))
        imported = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
        own = {module for module in imported if module and module.startswith("sketchlang")}
        assert own <= {"sketchlang.model", "sketchlang.analysis.fingerprint"}


def test_the_checker_can_be_read_in_one_sitting() -> None:
    assert checker.__file__ is not None
    assert len(Path(checker.__file__).read_text(encoding="utf-8").splitlines()) < 300
