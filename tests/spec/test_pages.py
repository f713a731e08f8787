"""The pages of `sketchlang explain`: their examples do what they say."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import sketchlang
from sketchlang.checking.report import WARNINGS
from sketchlang.pages import FILES, pages
from sketchlang.syntax.examples import mistakes
from sketchlang.syntax.phrases import phrases
from tests.spec import runner

PACKAGE = Path(sketchlang.__file__).parent
SECTIONS = [
    section for name in FILES for section in runner.sections(PACKAGE / "pages" / f"{name}.md")
]
# Their examples would have thousands of lines; tests/language/test_limits.py has them.
WITHOUT_EXAMPLE = {"nested-too-deeply", "file-too-large", "too-many-errors", "too-many-warnings"}
# Said by `run`, which needs more than a sketch.
AT_RUN_TIME = {"no-domain", "feature-without-definition"}


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.title)
def test_example(section: runner.Section) -> None:
    runner.run_in_empty_directory(section)
    code = section.title
    outputs = [block.text for block in section.blocks if block.kind == "output"]
    if code in WITHOUT_EXAMPLE | AT_RUN_TIME:
        assert not outputs
    else:
        assert f"{pages()[code].severity}[{code}]" in outputs[0]


def test_every_code_has_a_page() -> None:
    """Codes are string constants: every one in the sources has its page, and no others."""
    used = set(mistakes().values())
    makers = "add|Mistake|RejectedError|Diagnostic|_twice|_duplicate"
    pattern = re.compile(rf'(?:{makers})\(\s*"([a-z]+(?:-[a-z]+)+|shadowing|uncovered)"')
    for path in PACKAGE.rglob("*.py"):
        if "cli" not in path.parts:
            used |= set(pattern.findall(path.read_text(encoding="utf-8")))
    used |= {phrase.code for phrase in phrases()}
    used |= {"file-too-large", "too-many-errors", "too-many-warnings"}
    used |= {"duplicate-feature", "duplicate-define", "copied-rule", "subsumed-rule"}
    assert used == set(pages())
    assert len(used) >= 40


def test_severities() -> None:
    warnings = {code for code, page in pages().items() if page.severity == "warning"}
    # Coverage is no part of the check of a sketch by itself.
    assert warnings == WARNINGS | {"uncovered", "unusable-rule"}
