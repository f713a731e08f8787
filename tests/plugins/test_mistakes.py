"""A plug-in that raises, returns nonsense or contradicts itself is named with file and line."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from sketchlang.cli import cli

HERE = Path(__file__).parent

MISTAKES = {
    "a function raises": ('return at is not None and', "return 1 / 0 and", "ZeroDivisionError"),
    "a function returns nonsense": ("return at is not None and", "return at or", "expected True"),
    "sample raises": ("bases = BaseSampler(world)", "bases = BaseSampler(word)", "NameError"),
    "sample yields nonsense": ("yield push\n", 'yield "push"\n', "without name"),
    "applicable raises": ("if placement is None or", "if placement.there or", "AttributeError"),
    "applicable returns nonsense": ("return stays and", 'return "yes" or', "expected True or"),
    "after returns nonsense": (
        "return state.placed(self.object, self.target(state))",
        "return self.target(state)",
        "expected a state",
    ),
    "after loses an object": (
        "return state.placed(self.object, self.target(state))",
        "return state.placed(self.object, None)",
        "but the held one",
    ),
    "motion raises": ("tool = self.touch(world).tool", "tool = self.touch().tool", "TypeError"),
    "motion returns nothing": ('return Rejection("motion_plan", item.name)', "return None", ""),
    "motion returns nonsense": ("GripperMove(CLOSED),", '"close",', "expected finite poses"),
    "text returns nonsense": ('return f"push {world', 'return self or f"push {world', "a text"),
    "arguments are no data": ('"side": self.side,', '"side": {self.side},', "JSON"),
    "a method is missing": ("def applicable(self", "def possible(self", "no method applicable"),
    "a schema is not made": (
        "def sample(self",
        "def __init__(self, x): ...\n\n    def sample(self",
        "TypeError",
    ),
    "atoms raise": (
        "class Push(",
        "@domain.atom\ndef robots_at(state):\n    return [[]]\n\n\nclass Push(",
        "unhashable",
    ),
}  # fmt: skip


def run(folder: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[int, str]:
    monkeypatch.chdir(folder)
    arguments = ["run", "push.sketch", "crate.toml", "--domain", "plugin.py", "--k-max", "1"]
    done = CliRunner().invoke(cli, arguments)
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    return done.exit_code, done.output


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_named_with_file_and_line(tmp_path, monkeypatch, name) -> None:
    old, new, says = MISTAKES[name]
    text = (HERE / "push.py").read_text()
    assert old in text
    text = text.replace(old, new)
    if name == "motion returns nothing":
        text = text.replace("for q in arm.postures(before, start):", "for q in ():")
    (tmp_path / "plugin.py").write_text(text)
    sketch = (HERE / "push.sketch").read_text()
    if name == "atoms raise":
        sketch = sketch.replace("atoms robot_at", "atoms robots_at")
    (tmp_path / "push.sketch").write_text(sketch)
    shutil.copy(HERE / "crate.toml", tmp_path)
    code, output = run(tmp_path, monkeypatch)
    assert code == 2, output
    assert "plugin.py:" in output
    assert says in output
    assert "Traceback" not in output


def test_a_function_that_looks_at_what_it_says_to_ignore_is_named(tmp_path, monkeypatch) -> None:
    text = (HERE / "push.py").read_text()
    old = "@domain.function\ndef beside"
    assert old in text
    text = text.replace(old, '@domain.function(ignores="base")\ndef beside')
    (tmp_path / "plugin.py").write_text(text)
    shutil.copy(HERE / "push.sketch", tmp_path)
    shutil.copy(HERE / "crate.toml", tmp_path)
    code, output = run(tmp_path, monkeypatch)
    assert code == 2, output
    assert "beside (plugin.py:" in output
    assert "declare to ignore" in output
