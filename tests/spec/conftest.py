"""Collects the Markdown files of this folder: one test for each heading."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.spec import runner


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    if file_path.suffix == ".md":
        return SpecFile.from_parent(parent, path=file_path)
    return None


class SpecFile(pytest.File):
    def collect(self) -> Iterator[pytest.Item]:
        for section in runner.sections(self.path):
            yield SpecItem.from_parent(self, name=section.title, section=section)


class SpecItem(pytest.Item):
    def __init__(self, *, section: runner.Section, **arguments: object) -> None:
        super().__init__(**arguments)  # type: ignore[arg-type]
        self.section = section

    def runtest(self) -> None:
        if not self.section.blocks:
            raise AssertionError("a section needs an example: what it says is not tested")
        runner.run_in_empty_directory(self.section)

    def reportinfo(self) -> tuple[Path, int, str]:
        return self.path, self.section.line - 1, self.section.title
