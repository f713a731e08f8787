"""The formats of findings."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema  # type: ignore[import-untyped,unused-ignore]
import pytest
from click.testing import CliRunner

from sketchlang.cli.check import FORMATS
from sketchlang.cli.check import command as check
from sketchlang.diagnostics import Diagnostic, Label
from sketchlang.render import full
from sketchlang.source import Source, Span

TEXT = """\
sketch s
feature n : nat
feature n : nat
goal { n = 0, k }
rule r { n > 0 } -> { n--, n-- }
"""
CODES = ["duplicate-feature", "undefined-feature", "repeated-effect"]

# The parts of SARIF 2.1.0 (OASIS, section 3) that are written, with what the standard says
# about them. The official schema allows more properties, none of which are used.
REGION = {
    "type": "object",
    "required": ["startLine"],
    "additionalProperties": False,
    "properties": {
        name: {"type": "integer", "minimum": 1}
        for name in ("startLine", "startColumn", "endLine", "endColumn")
    },
}
MESSAGE = {
    "type": "object",
    "required": ["text"],
    "additionalProperties": False,
    "properties": {"text": {"type": "string", "minLength": 1}, "markdown": {"type": "string"}},
}
LOCATION = {
    "type": "object",
    "additionalProperties": False,
    "properties": {
        "id": {"type": "integer", "minimum": -1},
        "message": MESSAGE,
        "physicalLocation": {
            "type": "object",
            "required": ["artifactLocation"],
            "additionalProperties": False,
            "properties": {
                "artifactLocation": {
                    "type": "object",
                    "additionalProperties": False,
                    "properties": {"uri": {"type": "string", "format": "uri-reference"}},
                },
                "region": REGION,
            },
        },
    },
}
RESULT = {
    "type": "object",
    "required": ["message"],
    "additionalProperties": False,
    "properties": {
        "ruleId": {"type": "string"},
        "ruleIndex": {"type": "integer", "minimum": -1},
        "level": {"enum": ["none", "note", "warning", "error"]},
        "message": MESSAGE,
        "locations": {"type": "array", "items": LOCATION},
        "relatedLocations": {"type": "array", "uniqueItems": True, "items": LOCATION},
    },
}
RULE = {
    "type": "object",
    "required": ["id"],
    "additionalProperties": False,
    "properties": {"id": {"type": "string"}, "shortDescription": MESSAGE, "help": MESSAGE},
}
SARIF = {
    "type": "object",
    "required": ["version", "runs"],
    "additionalProperties": False,
    "properties": {
        "$schema": {"type": "string", "format": "uri"},
        "version": {"const": "2.1.0"},
        "runs": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["tool"],
                "additionalProperties": False,
                "properties": {
                    "tool": {
                        "type": "object",
                        "required": ["driver"],
                        "additionalProperties": False,
                        "properties": {
                            "driver": {
                                "type": "object",
                                "required": ["name"],
                                "additionalProperties": False,
                                "properties": {
                                    "name": {"type": "string"},
                                    "version": {"type": "string"},
                                    "rules": {
                                        "type": "array",
                                        "uniqueItems": True,
                                        "items": RULE,
                                    },
                                },
                            }
                        },
                    },
                    "columnKind": {"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
                    "results": {"type": ["array", "null"], "items": RESULT},
                },
            },
        },
    },
}


@pytest.fixture
def output(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """What `check` prints for TEXT in every format."""
    monkeypatch.chdir(tmp_path)
    Path("a b.sketch").write_text(TEXT, encoding="utf-8")
    printed = {}
    for name in FORMATS:
        result = CliRunner().invoke(check, ["--format", name, "a b.sketch"])
        assert result.exit_code == 1
        printed[name] = result.output
    return printed


def test_concise(output: dict[str, str]) -> None:
    lines = output["concise"].splitlines()
    assert lines[0] == (
        "a b.sketch:3:9: error[duplicate-feature] `n` is declared twice "
        "(Rename or remove one of them.)"
    )
    assert [line.partition("[")[2].partition("]")[0] for line in lines] == CODES


def test_json(output: dict[str, str]) -> None:
    value = json.loads(output["json"])
    assert [found["code"] for found in value["diagnostics"]] == CODES
    assert (value["errors"], value["warnings"]) == (2, 1)
    for found in value["diagnostics"]:
        place = found["primary"]
        lines = TEXT.splitlines()
        marked = lines[place["line"] - 1][place["column"] - 1 : place["end_column"] - 1]
        assert marked == TEXT[place["start"] : place["end"]]


def test_github(output: dict[str, str]) -> None:
    lines = output["github"].splitlines()
    assert lines[0] == (
        "::error file=a b.sketch,line=3,col=9,title=duplicate-feature,endLine=3,endColumn=10::"
        "`n` is declared twice%0ARename or remove one of them."
    )
    assert lines[2].startswith("::warning ")


def test_sarif(output: dict[str, str]) -> None:
    value = json.loads(output["sarif"])
    jsonschema.Draft7Validator.check_schema(SARIF)
    jsonschema.validate(value, SARIF, cls=jsonschema.Draft7Validator)
    (run,) = value["runs"]
    rules = run["tool"]["driver"]["rules"]
    assert [result["ruleId"] for result in run["results"]] == CODES
    for result in run["results"]:
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
        uri = result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
        assert uri == "a%20b.sketch"


def test_no_findings() -> None:
    for name in FORMATS:
        result = CliRunner().invoke(check, ["--format", name, "pick_and_place"])
        assert result.exit_code == 0
        if name in ("json", "sarif"):
            json.loads(result.stdout)


def test_colours_only_where_asked_for() -> None:
    source = Source("t", "rule ä { 中 }\n")
    found = Diagnostic("some-code", "wrong", Label(source, Span(9, 10), "here"))
    plain = full.render(found)
    assert "\x1b" not in plain
    coloured = full.render(found, colour=True)
    assert "\x1b[" in coloured
    # A wide character takes two columns.
    assert plain.splitlines()[4] == "  |          ^^ here"


def test_control_characters_do_not_reach_the_terminal() -> None:
    source = Source("t", "goal {\x1b[2J\x07\t} x\n")
    found = Diagnostic("some-code", "wrong", Label(source, Span(14, 15)))
    plain = full.render(found)
    assert "\x1b" not in plain
    assert "\x07" not in plain


def test_long_lines_are_cut() -> None:
    source = Source("t", "goal { " + "a, " * 500 + "b }")
    found = Diagnostic("some-code", "wrong", Label(source, Span(1000, 1003)))
    lines = full.render(found).splitlines()
    assert max(map(len, lines)) < 140
    shown, marks = lines[3], lines[4]
    start = marks.index("^")
    assert shown[start : start + 3] == source.text[1000:1003]
