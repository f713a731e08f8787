"""Hovering over variables: the sort of what they range over, however the set is written."""

from __future__ import annotations

from pathlib import Path

import pytest

from sketchlang.lsp import hover
from sketchlang.lsp.state import Workspace

TEXT = """\
sketch s
use blocks
define wrong = {{ b in blocks where misplaced(b) }}
feature n : nat = count v in {set}: true
"""


@pytest.mark.parametrize(
    "written",
    [
        "blocks",
        "wrong",
        "blocks - wrong",
        "wrong & blocks | wrong",
        "{ x in wrong where held(x) }",
        "on(_, blocks)",
        "goal on(blocks, _)",
        "if (some x in blocks: held(x)) then wrong else blocks",
    ],
)
def test_a_variable_has_the_sort_of_its_set(written: str, tmp_path: Path) -> None:
    document = Workspace().look(str(tmp_path / "s.sketch"), TEXT.format(set=written))
    assert document.loaded.ok, document.loaded.diagnostics
    (found,) = [
        one
        for one in document.names
        if one.target.name == "v" and one.target.kind == "variable" and one.declares
    ]
    shown = hover.text(document, found)
    assert shown is not None
    assert "v : Block" in shown
