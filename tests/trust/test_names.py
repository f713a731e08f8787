"""Names of others in every place where a name can stand: nothing harmful comes out."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner

from sketchlang.analysis.graph import dot, mermaid, svg
from sketchlang.analysis.graph.drawing import Arrow, Box, Drawing
from sketchlang.cli import cli
from sketchlang.diagnostics import Diagnostic, Label, Severity
from sketchlang.errors import InputError
from sketchlang.render import as_json, concise, console, full, github, sarif
from sketchlang.source import Source, Span
from tests.trust.hostile import harm, names
from tests.trust.workspace import ROOT

NAMES = list(names(1000))

COMMANDS = [
    *(["check", "--format", form] for form in ("full", "concise", "json", "github", "sarif")),
    ["terminate"],
    ["fmt", "--diff"],
]


def findings() -> list[Diagnostic]:
    """Findings with a name in every place of each."""
    found = []
    for a, b, c in triples():
        label = Label(Source(a, f"rule {b}\n{c}"), Span(0, 4), b)
        other = Label(Source(b, c + "\n" + a), Span(0, 1), a)
        found.append(Diagnostic("undefined-name", c, label, (other,), b, Severity.WARNING))
        found.append(Diagnostic("undefined-name", a, label))
    return found


def triples() -> list[tuple[str, ...]]:
    return [tuple(NAMES[i : i + 3]) for i in range(0, len(NAMES) - 2, 3)]


def test_in_findings() -> None:
    found = findings()
    # `:::` points to a second file; no CI service knows a command `:`.
    text = "\n".join(full.render(one) for one in found)
    assert harm(text, own=("::: ",)) is None
    assert harm(concise.render(found)) is None
    assert harm(console.render(found, NAMES[:3], colour=False), own=("::: ",)) is None
    for name in NAMES:
        assert harm(console.summary([], [name])) is None
    text = github.render(found)
    assert harm(text, own=("::error file=", "::warning file=")) is None
    assert len(text.splitlines()) == len(found)
    for render in (as_json.render, sarif.render):
        text = render(found)
        assert harm(text) is None
        json.loads(text)
        text.encode()


def test_in_messages_about_files_and_keys() -> None:
    for a, b, c in triples():
        error = InputError(a, place=b, hint=c)
        assert harm(str(error)) is None
        assert len(str(error).split("\n")) == 2


def test_in_drawings() -> None:
    for a, b, c in triples():
        boxes = [Box("a", (a, b)), Box("b", (c,), step=1)]
        drawing = Drawing(a, boxes, [Arrow("a", "b", b, 1), Arrow("a", "a", c)], [(1, c)])
        for write in (dot.write, mermaid.write, svg.write):
            assert harm(write(drawing)) is None
        root = ElementTree.fromstring(svg.write(drawing))
        tags = {element.tag.partition("}")[2] for element in root.iter()}
        assert tags <= {"svg", "rect", "defs", "marker", "path", "text", "g", "title"}
        # As many lines as with plain names: no name opens a statement of its own.
        plain = Drawing("t", [Box("a", ("l", "m")), Box("b", ("n",), step=1)],
                        [Arrow("a", "b", "x", 1), Arrow("a", "a", "y")], [(1, "z")])  # fmt: skip
        for write in (dot.write, mermaid.write):
            assert len(write(drawing).split("\n")) == len(write(plain).split("\n"))


def test_in_traces(plan_file: Path, tmp_path) -> None:
    from domains.tabletop.scene.worlds import find_world
    from runtime.export.model import glb
    from runtime.show.moments import moments
    from runtime.show.page import page
    from runtime.trace.load import load_trace
    from runtime.trace.write import dumps

    trace = load_trace(plan_file, find_world)
    for start in range(0, len(NAMES), 100):
        some = NAMES[start : start + 100]
        long = "".join(some)
        subgoals = tuple(
            replace(trace.subgoals[i % len(trace.subgoals)], rule=name)
            for i, name in enumerate(some)
        )
        named = zip(trace.world.movables, some, strict=False)
        objects = tuple(replace(thing, name=name) for thing, name in named)
        world = replace(trace.world, name=long, movables=objects)
        sketch = replace(trace.sketch, name=long)
        bad = replace(trace, subgoals=subgoals, world=world, sketch=sketch)
        assert harm(dumps(bad)) is None
        text = page(bad)
        # Of the page, what is not the program's own script and style.
        own = re.sub(r"<(script|style)>.*?</\1>", "", text, flags=re.S)
        assert harm(own) is None
        data = re.findall(r'<script type="application/json" id="payload">(.*?)</script>', own)
        shown = json.loads(data[0])[0]["trace"]
        # Line breaks and tabs in a name are spaces on a page.
        rules = " ".join(goal["rule"] for goal in shown["subgoals"]).translate({9: " ", 10: " "})
        assert harm(f"rules: {rules}") is None
        for name, _ in moments(bad):
            assert (tmp_path / f"{name}.png").resolve().parent == tmp_path.resolve()
            assert harm(name) is None
            assert len(name) < 200
        assert harm(json.dumps(_glb_names(glb(bad, 0.0)), ensure_ascii=False)) is None


def _glb_names(data: bytes) -> list[str]:
    length = int.from_bytes(data[12:16], "little")
    return [node.get("name", "") for node in json.loads(data[20 : 20 + length])["nodes"]]


def test_on_the_command_line(tmp_path, monkeypatch) -> None:
    (tmp_path / "in" / "here").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "in" / "here")
    some = [name for name in NAMES if "\0" not in name][:60]
    for name in some:
        for arguments in (
            ["check", name],
            ["fmt", f"{name}.sketch"],
            [name],
            ["check", f"--{name}"],
            ["explain", name],
            ["graph", "pick_and_place", "--view", name],
            ["new", "domain", name],
            ["run", "pick_and_place", name],
            ["verify", name, name],
        ):
            done = CliRunner().invoke(cli, arguments)
            assert done.exit_code in (0, 1, 2), (arguments, done.output)
            assert harm(done.output) is None
            assert "a bug in" not in done.output


def test_as_files_that_exist(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    folder = Path(tmp_path)
    for name in NAMES[:150]:
        if "\0" in name or "/" in name or len(name) > 200 or name in ("..", "-"):
            continue
        path = folder / f"{name}.sketch"
        path.write_text("sketch s\nfeature n : nat\nrule r { n > 0 } -> { m-- }\n")
        for command in COMMANDS:
            done = CliRunner().invoke(cli, [*command, path.name])
            assert harm(done.output, own=("::error file=", "::warning file=")) is None
            assert "a bug in" not in done.output
        path.unlink()


@pytest.mark.slow
def test_in_a_scene_from_plan_to_bag(tmp_path) -> None:
    pytest.importorskip("pybullet")
    text = (ROOT / "domains" / "sorting" / "scenes" / "3t-02.toml").read_text(encoding="utf-8")
    old = sorted(set(re.findall(r'name = "([^"]+)"', text)))
    usable = [name for name in NAMES if "\udc80" not in name and "\0" not in name]
    for number in range(3):
        bad = dict(zip(old, usable[7 * number + 3 :], strict=False))
        changed = text
        for name, other in bad.items():
            changed = changed.replace(f'"{name}"', json.dumps(other))
        scene = tmp_path / "scene.toml"
        scene.write_text(changed, encoding="utf-8")
        before = {path for path in tmp_path.parent.rglob("*") if "escaped" in path.name}
        plan, given = str(tmp_path / "plan.json"), ["--scene", str(scene)]
        for arguments in (
            ["run", "pick_and_place", str(scene), "--out", plan],
            ["validate", plan, *given],
            ["replay", plan, *given, "--png", str(tmp_path / "png"), "--html", str(tmp_path / "h")],
            ["export", plan, *given, "--glb", str(tmp_path / "g"), "--bag", str(tmp_path / "bag")],
            ["execute", plan, *given],
        ):
            done = CliRunner().invoke(cli, arguments)
            assert done.exit_code == 0, done.output
            assert harm(done.output) is None
        shutil.rmtree(tmp_path / "bag")
        assert before == {path for path in tmp_path.parent.rglob("*") if "escaped" in path.name}
