"""Files are written as a whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from runtime.files import write_text
from sketchlang.errors import InputError


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


def test_a_link_stays_a_link(tmp_path) -> None:
    (tmp_path / "elsewhere").mkdir()
    target, link = tmp_path / "elsewhere" / "file.txt", tmp_path / "link.txt"
    target.write_text("old")
    link.symlink_to(target)
    write_text(link, "new")
    assert link.is_symlink()
    assert target.read_text() == "new"


def test_a_link_to_nothing_makes_its_target(tmp_path) -> None:
    link = tmp_path / "link.txt"
    link.symlink_to("file.txt")
    write_text(link, "new")
    assert link.is_symlink()
    assert (tmp_path / "file.txt").read_text() == "new"


def test_a_pipe_is_written_to(tmp_path) -> None:
    path = tmp_path / "pipe"
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_text(path, "text")
        assert os.read(reader, 100) == b"text"
    finally:
        os.close(reader)
    assert path.is_fifo()


def test_a_terminal_is_written_to() -> None:
    # Not /dev/null: where this fails for root, every program would lose that.
    reader, writer = os.openpty()
    try:
        write_text(Path(os.ttyname(writer)), "text")
        assert os.read(reader, 100) == b"text"
    finally:
        os.close(reader)
        os.close(writer)


def test_a_folder_is_not_replaced(tmp_path) -> None:
    with pytest.raises(InputError, match="cannot be written"):
        write_text(tmp_path, "text")


def test_permissions_are_those_of_a_new_file(tmp_path) -> None:
    write_text(tmp_path / "one.txt", "text")
    (tmp_path / "two.txt").write_text("text")
    modes = {(tmp_path / name).stat().st_mode for name in ("one.txt", "two.txt")}
    assert len(modes) == 1
