"""`sketchlang test`: what is planted is found, and what is right is not complained of."""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest
from click.testing import CliRunner, Result

from sketchlang.cli import cli
from sketchlang.loader import builtin_sketch

QUICK = ("--states", 400, "--subproblems", 20, "--time-limit", 20)

SMALL = {"blocks": ("blocks/three", "blocks/clear"), "delivery": ("delivery/one",)}
"""Scenes in which what is planted can be seen."""


def run(*arguments: object) -> Result:
    result = CliRunner().invoke(cli, [str(argument) for argument in arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result


def outcome(*arguments: object) -> dict[str, Any]:
    result = run("test", *arguments, *QUICK, "--json")
    assert result.exit_code < 2, result.output
    found: dict[str, Any] = json.loads(result.stdout)
    assert result.exit_code == int(any(finding["error"] for finding in found["findings"]))
    return found


def kinds(found: dict[str, Any]) -> set[str]:
    return {finding["kind"] for finding in found["findings"]}


@pytest.mark.parametrize(
    ("name", "one", "several"),
    [
        # Bonet and Geffner, AAAI 2021, Table 1; None: no bound.
        ("delivery_s0", 2, None),
        ("delivery_s1", 2, None),
        ("delivery_s2", 1, None),
        ("delivery_s4", 2, 2),
        ("delivery_s5", 1, 1),
        ("delivery_s6", 2, None),
        ("delivery_s7", 2, None),
        ("delivery_s8", 0, 0),
        ("delivery_policy", 0, 0),
    ],
)
@pytest.mark.slow
def test_published_widths(name: str, one: int, several: int | None) -> None:
    found = outcome(name, "--scenes", "delivery/one", "--scenes", "delivery/four")
    assert [scene["width"] for scene in found["scenes"]] == [one, several]
    assert [scene["complete"] for scene in found["scenes"]] == [True, False]
    assert not any(finding["error"] for finding in found["findings"])
    assert "endless" not in kinds(found)


@pytest.mark.parametrize(("name", "width"), [("delivery_s2", 1), ("delivery_s4", 2)])
def test_width_of_one_package(name: str, width: int) -> None:
    found = outcome(name, "--scenes", "delivery/one")
    assert (found["width"], found["scenes"][0]["complete"]) == (width, True)


def test_the_third_sketch_does_not_terminate() -> None:
    assert kinds(outcome("delivery_s3", "--scenes", "delivery/one")) == {"endless"}


@pytest.mark.parametrize("name", ["blocks_clear", "blocks_towers", "delivery_policy"])
def test_no_false_alarm(name: str) -> None:
    assert outcome(name)["findings"] == []


def planted(tmp_path: Path, name: str, old: str, new: str) -> dict[str, Any]:
    path = builtin_sketch(name)
    assert path is not None
    text = path.read_text()
    assert old in text
    changed = tmp_path / "changed.sketch"
    changed.write_text(text.replace(old, new, 1))
    if name.startswith("delivery"):
        features = path.with_name("delivery_features.sketch")
        (tmp_path / features.name).write_text(features.read_text())
    scenes = SMALL[name.partition("_")[0]]
    return outcome(changed, *(option for scene in scenes for option in ("--scenes", scene)))


@pytest.mark.parametrize(
    ("name", "old", "new", "kind", "word"),
    [
        ("blocks_towers", "invariant H", "invariant u > 0 -> H\ninvariant H", "invariant", "-> H"),
        ("blocks_towers", "invariant H -> m > 0", "invariant not H", "invariant", "not H"),
        ("blocks_clear", "goal", "invariant n > 0 or H\n\ngoal", "invariant", "n > 0 or H"),
        (
            "blocks_towers",
            "rule put_aside { H, u > 0 }",
            "rule put_aside { H, m = 0 }",
            "never-fires",
            "put_aside",
        ),
        ("blocks_clear", "rule put_aside { H, n > 0 } -> { !H }", "", "uncovered", "{H, n > 0}"),
        ("blocks_towers", "goal { !H, m = 0 }", "goal { H, m = 0 }", "dead-end", "dead end"),
        ("delivery_policy", "p = 0 }", "p = 0, t = 0 }", "uncovered", "t > 0"),
        ("delivery_policy", "rule pick { !H, p = 0 }", "rule pick { H, p = 0 }", "uncovered", "!H"),
        ("delivery_s5", "{ !H }", "{ !H, n = 0 }", "never-fires", "pick"),
        ("delivery_s4", "n--", "n++", "never-fires", "deliver"),
    ],
)
def test_planted_falsehoods(
    tmp_path: Path, name: str, old: str, new: str, kind: str, word: str
) -> None:
    found = planted(tmp_path, name, old, new)
    assert any(one["kind"] == kind and word in one["text"] for one in found["findings"]), found


COUNTER = dedent("""\
    from sketchlang.domain import Domain, Nat

    domain = Domain("counter", summary="Counts up, or up to seven.")

    class Problem:
        initial = (0, 0)

        def successors(self, state):
            up, capped = state
            yield "up", (up + 1, capped)
            if capped < 7:
                yield "capped", (up, capped + 1)

    @domain.function
    def up(state) -> Nat:
        return state[0]

    @domain.function
    def capped(state) -> Nat:
        return state[1]

    @domain.atom
    def values(state):
        yield state

    @domain.scenes
    def load(path, options):
        return Problem()
""")


@pytest.mark.parametrize(
    ("name", "bounded"), [("up", False), pytest.param("capped", True, marks=pytest.mark.slow)]
)
def test_a_feature_that_rises_and_rises_is_not_bounded(
    tmp_path: Path, name: str, bounded: bool
) -> None:
    (tmp_path / "counter.py").write_text(COUNTER)
    (tmp_path / "scene.toml").write_text("")
    sketch = tmp_path / "it.sketch"
    sketch.write_text(
        f"sketch it\nuse counter\nbounded feature n : nat = {name}\natoms values\n"
        "rule more { } -> { n++ }\n"
    )
    found = outcome(
        sketch, "--domain", tmp_path / "counter.py", "--scenes", tmp_path / "scene.toml"
    )
    assert ("bounded" in kinds(found)) != bounded


def test_findings_are_written_and_replayed(tmp_path: Path) -> None:
    sketch = tmp_path / "it.sketch"
    path = builtin_sketch("blocks_towers")
    assert path is not None
    sketch.write_text(path.read_text().replace("invariant H", "invariant u > 0 -> H\ninvariant H"))
    folder = tmp_path / "findings"
    result = run("test", sketch, *QUICK, "--out", folder)
    assert result.exit_code == 1
    (file,) = folder.glob("*-invariant.json")
    written = json.loads(file.read_text())
    result = run("test", sketch, "--replay", file)
    assert result.exit_code == 0, result.output
    last = result.output.splitlines()[-1]
    assert all(f"{name} = {value}" in last for name, value in written["values"].items())
    file.write_text(json.dumps(written | {"samples": [[1, 2, 3]] * len(written["actions"])}))
    assert "`samples` is not as it should be" in run("test", sketch, "--replay", file).stderr
    file.write_text(json.dumps(written | {"actions": ["fly"], "samples": [None]}))
    result = run("test", sketch, "--replay", file)
    assert result.exit_code == 2
    assert "'fly', is not possible" in result.stderr
    file.write_text("{}")
    assert run("test", sketch, "--replay", file).exit_code == 2


def test_users_mistakes(tmp_path: Path) -> None:
    bare = tmp_path / "bare.sketch"
    bare.write_text("sketch s\nfeature n : nat\nrule r { n > 0 } -> { n-- }\n")
    for arguments in (
        (bare,),
        (tmp_path / "missing.sketch",),
        ("blocks_clear", "--scenes", "no/such"),
        ("blocks_clear", "--time-limit", "nan"),
        ("blocks_clear", "--k-max", 9),
        ("gripper",),
    ):
        result = run("test", *arguments)
        assert result.exit_code == 2, arguments
        assert "Traceback" not in result.output


def test_the_smallest_scenes_of_a_domain_are_taken_where_none_is_named() -> None:
    """Also where its scenes lie in folders of other names, and no state space has an end."""
    done = run("test", "pick_and_place", "--json", "--time-limit", 12, "--states", 60)
    assert done.exit_code == 0, done.output
    scenes = json.loads(done.stdout)["scenes"]
    assert len(scenes) == 4
    assert all(scene["states"] > 0 and not scene["complete"] for scene in scenes)
