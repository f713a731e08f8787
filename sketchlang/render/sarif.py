"""SARIF 2.1.0, the format of code-scanning services (OASIS standard)."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any
from urllib.parse import quote

from sketchlang.diagnostics import Diagnostic, Label
from sketchlang.escape import dumps
from sketchlang.pages import pages
from sketchlang.version import __version__

SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)


def render(diagnostics: Sequence[Diagnostic]) -> str:
    """All findings as one run, with the rules that they break."""
    known = pages()
    codes = sorted({found.code for found in diagnostics})
    rules = []
    for code in codes:
        rule: dict[str, Any] = {"id": code}
        page = known.get(code)
        if page is not None:
            rule["shortDescription"] = {"text": page.summary}
            rule["help"] = {"text": page.body, "markdown": page.body}
        rules.append(rule)
    value = {
        "$schema": SCHEMA,
        "version": "2.1.0",
        "runs": [
            {
                "tool": {"driver": {"name": "sketchlang", "version": __version__, "rules": rules}},
                "columnKind": "unicodeCodePoints",
                "results": [_result(found, codes.index(found.code)) for found in diagnostics],
            }
        ],
    }
    return dumps(value, indent=2) + "\n"


def _result(found: Diagnostic, rule: int) -> dict[str, Any]:
    message = found.message if found.hint is None else f"{found.message}\n{found.hint}"
    result: dict[str, Any] = {
        "ruleId": found.code,
        "ruleIndex": rule,
        "level": found.severity.value,
        "message": {"text": message},
        "locations": [_location(found.primary)],
    }
    if found.secondary:
        result["relatedLocations"] = [
            {"id": number, **_location(label)} for number, label in enumerate(found.secondary, 1)
        ]
    return result


def _location(label: Label) -> dict[str, Any]:
    row, column = label.source.position(label.span.start)
    end_row, end_column = label.source.position(label.span.end)
    location: dict[str, Any] = {
        "physicalLocation": {
            "artifactLocation": {"uri": quote(os.fsencode(label.source.name))},
            "region": {
                "startLine": row,
                "startColumn": column,
                "endLine": end_row,
                "endColumn": end_column,
            },
        }
    }
    if label.text:
        location["message"] = {"text": label.text}
    return location
