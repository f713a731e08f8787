"""Files are written as a whole or not at all."""

from __future__ import annotations

import pytest

from runtime.errors import InputError
from runtime.files import write_text


def test_a_file_is_replaced(tmp_path) -> None:
    path = tmp_path / "file.txt"
    path.write_text("old")
    write_text(path, "new ☕\n")
    assert path.read_text(encoding="utf-8") == "new ☕\n"
    assert [entry.name for entry in tmp_path.iterdir()] == ["file.txt"]


def test_text_that_cannot_be_written_leaves_the_old_file(tmp_path) -> None:
    path = tmp_path / "file.txt"
    path.write_text("old")
    with pytest.raises(UnicodeEncodeError):
        write_text(path, "\ud800")
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["file.txt"]


def test_a_missing_folder_is_an_input_error_with_its_path(tmp_path) -> None:
    path = tmp_path / "missing" / "file.txt"
    with pytest.raises(InputError) as caught:
        write_text(path, "text")
    assert caught.value.place == str(path)
