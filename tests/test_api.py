"""docs/api.md does what it says, and `sketchlang` says what it offers."""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import Any

import sketchlang
from sketchlang import api

PAGE = Path(__file__).parents[1] / "docs" / "api.md"


def test_the_examples_of_the_page_run(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.M | re.S)
    assert len(blocks) == 5
    names: dict[str, Any] = {}
    for block in blocks:
        exec(compile(block, PAGE.name, "exec"), names)
    said = capsys.readouterr().out
    assert re.search(r"^4:10: error \[[a-z-]+\] ", said, re.M)
    assert "there is no scene" in said
    assert "did you mean 'sorting/4t-28'?" in said
    assert names["result"].solved
    assert "<html" in (tmp_path / "replay.html").read_text(encoding="utf-8")


def test_the_page_has_the_parameters_of_plan() -> None:
    (shown,) = re.findall(r"`plan\((.*?)\)`", PAGE.read_text(encoding="utf-8"), re.S)
    parameters, words = inspect.signature(api.plan).parameters, re.split(r",\s+", shown)
    assert [word.split("=")[0] for word in words if word != "*"] == list(parameters)
    for word in words:
        name, _, default = word.partition("=")
        if default:
            assert repr(parameters[name].default) == default


def test_an_improved_plan_takes_no_longer() -> None:
    found = [api.plan("pick_and_place", "sorting/3t-02", improve_steps=n) for n in (0, 8)]
    assert all(result.solved for result in found)
    assert found[1].plan.execution_time <= found[0].plan.execution_time


def test_what_is_offered_is_there_and_nothing_else() -> None:
    assert all(getattr(sketchlang, name) is not None for name in sketchlang.__all__)
    public = {
        name
        for name, thing in vars(api).items()
        if getattr(thing, "__module__", None) == "sketchlang.api" and not name.startswith("_")
    }
    assert public == set(sketchlang.__all__) - {"__version__"}


def test_check_is_the_function_whatever_has_been_imported() -> None:
    from sketchlang.checking.checker import CheckedSketch

    assert sketchlang.check is api.check
    assert CheckedSketch.__module__ == "sketchlang.checking.checker"
