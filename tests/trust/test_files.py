"""Files are written as a whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from sketchlang import reading
from sketchlang.errors import InputError
from sketchlang.files import check_output, check_outputs, replacing, write_bytes, write_text


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


def test_permissions_of_the_old_file_are_kept(tmp_path) -> None:
    path = tmp_path / "file.txt"
    path.write_text("old")
    path.chmod(0o640)
    write_text(path, "new")
    assert path.stat().st_mode & 0o777 == 0o640


def test_a_pipe_that_nobody_reads_is_not_waited_for(tmp_path) -> None:
    path = tmp_path / "pipe"
    os.mkfifo(path)
    with pytest.raises(InputError, match="nobody reads from it"):
        write_text(path, "text")


def test_a_full_device_is_an_input_error() -> None:
    with pytest.raises(InputError, match="No space left"):
        write_bytes(Path("/dev/full"), b"x" * 100_000)


def test_a_loop_of_links_stays_as_it_is(tmp_path) -> None:
    path = tmp_path / "loop"
    path.symlink_to(path)
    for write in (check_output, lambda path: write_text(path, "text")):
        with pytest.raises(InputError, match="cannot be written"):
            write(path)
    assert path.is_symlink()
    assert [entry.name for entry in tmp_path.iterdir()] == ["loop"]


@pytest.mark.parametrize("name", ["x" * 300, "a\0b", "none/file", "folder", "loop"])
def test_what_cannot_be_written_is_found_before_the_work(name, tmp_path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    with pytest.raises(InputError):
        check_output(tmp_path / name)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["folder", "loop"]


def names_of(path: Path) -> list[Path]:
    """A file by path, symbolic link and hard link."""
    soft, hard = path.with_name("soft"), path.with_name("hard")
    soft.symlink_to(path)
    hard.hardlink_to(path)
    return [path, path.parent / ".." / path.parent.name / path.name, soft, hard]


def test_nothing_is_written_over_what_is_read(tmp_path) -> None:
    path = tmp_path / "file.txt"
    path.write_text("old")
    with reading.recording():
        reading.read_bytes(path)
        for name in names_of(path):
            for write in (lambda name: write_text(name, "new"), check_output):
                with pytest.raises(InputError, match="would overwrite what is read"):
                    write(name)
            with pytest.raises(InputError), replacing(name):
                pytest.fail("the block was entered")
        assert path.read_text() == "old"
        write_text(path, "new", over_input=True)
    assert path.read_text() == "new"


def test_outputs_are_told_apart(tmp_path) -> None:
    path, link = tmp_path / "file", tmp_path / "link"
    link.symlink_to(path)
    with pytest.raises(InputError, match=r"--b: .* would overwrite what --a writes"):
        check_outputs({"--a": path, "--b": link})
    check_outputs({"--a": path, "--b": tmp_path / "other", "--c": None})
