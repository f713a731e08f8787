"""What is read: regular files of a sensible size, whatever a user names."""

from __future__ import annotations

import io
import os
import socket
import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import pytest

from sketchlang import reading
from sketchlang.errors import InputError

READERS: dict[str, Callable[[Path], object]] = {
    "bytes": reading.read_bytes,
    "text": reading.read_text,
    "toml": reading.read_toml,
    "json": reading.read_json,
    "xml": reading.read_xml,
}
every_reader = pytest.mark.parametrize("read", READERS.values(), ids=READERS)


@every_reader
def test_what_is_no_regular_file_is_refused_at_once(read, tmp_path) -> None:
    pipe, folder, link = tmp_path / "pipe", tmp_path / "folder", tmp_path / "link"
    os.mkfifo(pipe)
    folder.mkdir()
    link.symlink_to(pipe)
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(tmp_path / "socket"))
        for path, word in (
            (pipe, "pipe"),
            (link, "pipe"),
            (folder, "directory"),
            (tmp_path / "socket", "socket"),
            (Path("/dev/zero"), "device"),
        ):
            with pytest.raises(InputError, match=word) as caught:
                read(path)
            assert caught.value.place == str(path)


@every_reader
@pytest.mark.parametrize("name", ["none", "x" * 300, "a\0b", "file/below"])
def test_names_that_lead_nowhere(read, name, tmp_path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError):
        read(tmp_path / name)


@every_reader
def test_a_large_file_is_not_read(read, tmp_path) -> None:
    path = tmp_path / "large"
    with path.open("wb") as file:
        file.truncate(1 << 30)
    tracemalloc.start()
    try:
        with pytest.raises(InputError, match="is larger than"):
            read(path)
        assert tracemalloc.get_traced_memory()[1] < 10 << 20
    finally:
        tracemalloc.stop()


def test_files_that_say_they_are_empty_are_read_up_to_the_limit() -> None:
    path = Path("/proc/self/status")
    assert path.stat().st_size == 0
    assert reading.read_bytes(path)
    with pytest.raises(InputError, match="is larger than"):
        reading.read_bytes(path, limit=100)


@pytest.mark.parametrize("part", ["a", '"a b"', "'.'", "a "])
@pytest.mark.parametrize("form", ["{} = 1", "[{}]", "[[{}]]", "x = {{ {} = 1 }}", "  {}=1"])
def test_keys_of_very_many_parts_are_refused_before_they_are_parsed(part, form, tmp_path) -> None:
    path = tmp_path / "keys.toml"
    path.write_text("first = 1\n" + form.format(".".join([part] * 100_000)))
    with pytest.raises(InputError, match="more than 50 parts"):
        reading.read_toml(path)


@pytest.mark.parametrize(
    "text",
    [
        ".".join(["a"] * 40) + " = 1",
        "x = [" + "1.5, " * 1000 + "]",
        "x = 1 # " + "and so on. " * 1000,
        "x = '" + "." * 1000 + "'",
        'x = "' + "a sentence. " * 1000 + '"',
        "x = 1 # " + '"' * 100_000,
        "x = 1 # " + "-" * 500_000,
        "x = 1 # " + "a " * 200_000,
    ],
    ids=range(8),
)
def test_other_dots_are_no_keys(text, tmp_path) -> None:
    path = tmp_path / "dots.toml"
    path.write_text(text)
    assert reading.read_toml(path)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("deep.toml", "x = " + "[" * 50_000),
        ("deep.json", "[" * 50_000),
        ("digits.toml", "x = " + "9" * 5_000),
        ("digits.json", "9" * 5_000),
        ("cut.json", '{"a": 1'),
        ("cut.xml", "<robot>"),
        ("deep.xml", "<a>" * 50_000),
        ("laughs.xml", '<!DOCTYPE a [<!ENTITY b "bb"><!ENTITY c "&b;&b;">]><a>&c;</a>'),
    ],
)
def test_data_out_of_shape_is_one_line(name, text, tmp_path) -> None:
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        READERS[path.suffix[1:]](path)
    assert str(caught.value).splitlines()[0].startswith(str(path))
    assert len(str(caught.value).partition("\n  hint:")[0].splitlines()) == 1


def test_standard_input_has_a_limit(monkeypatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"x" * 11)))
    with pytest.raises(InputError, match="is larger than"):
        reading.read_standard_input(10)


def test_standard_input_may_be_closed(monkeypatch) -> None:
    monkeypatch.setattr(sys, "stdin", None)
    with pytest.raises(InputError, match="closed"):
        reading.read_standard_input(10)


def test_files_are_known_by_all_their_names(tmp_path) -> None:
    path, soft, hard, other = (tmp_path / name for name in ("file", "soft", "hard", "other"))
    path.write_text("text")
    other.write_text("text")
    soft.symlink_to(path)
    hard.hardlink_to(path)
    with reading.recording() as inputs:
        reading.read_text(soft)
        for name in (path, soft, hard, tmp_path / ".." / tmp_path.name / "file"):
            assert inputs.name_of(name) == str(soft)
        assert inputs.name_of(other) is None
        assert inputs.name_of(tmp_path / "none") is None
    assert reading.inputs().name_of(path) is None
