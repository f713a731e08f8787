"""Comments that were not meant as comments."""

from __future__ import annotations

import re

from sketchlang.checking.report import Report
from sketchlang.diagnostics import Fix, Label
from sketchlang.source import Span
from sketchlang.syntax.tree import Tree

_INCLUDE = re.compile(r"#(?:include|import)\b\s*[<\"'](?P<path>[^<>\"']*)[>\"']\s*")


def note_includes(parsed: Tree, report: Report) -> None:
    """Note lines of C, `#include <FILE>`: here they are comments, and nothing is included."""
    for comment in parsed.comments:
        match = _INCLUDE.fullmatch(comment.text)
        if match is not None:
            span = Span(comment.start, comment.end)
            text = f'include "{match["path"]}"'
            report.add(
                "commented-include",
                "this is a comment: it includes nothing",
                Label(parsed.source, span),
                hint=f"Write `{text}`.",
                fix=Fix(span, text),
            )
