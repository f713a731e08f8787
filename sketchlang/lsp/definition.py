"""Where what a name stands for is declared: in the sketch, in a file it includes, in Python."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from sketchlang.diagnostics import Label
from sketchlang.loader import builtin_sketch
from sketchlang.lsp.state import Document
from sketchlang.lsp.symbols import Occurrence
from sketchlang.source import Source, Span
from sketchlang.syntax import tree


def place(document: Document, found: Occurrence) -> Label | None:
    """The declaration of what a name stands for. The source is named by its path."""
    domain = document.domain
    match found.target.kind:
        case "include":
            return _included(found)
        case "function" | "atoms" | "sort" if domain is not None:
            declared: dict[str, Any] = {
                **{name: one.call for name, one in domain.functions.items()},
                **(domain.atoms if found.target.kind == "atoms" else {}),
                **(domain.sorts if found.target.kind == "sort" else {}),
            }
            return _python(declared.get(found.target.name))
        case "domain" if domain is not None and domain.name == found.target.name:
            first = next(iter(domain.functions.values()), None)
            return _file(first.call) if first is not None else None
    for one in document.names:
        if one.declares and one.target == found.target:
            return Label(one.source, one.span)
    return None


def _included(found: Occurrence) -> Label | None:
    item = found.item
    if not isinstance(item, tree.Include):
        return None
    if item.tree is not None and os.path.exists(item.tree.source.name):
        return Label(item.tree.source, Span(0, 0))
    path = None if item.quoted else builtin_sketch(item.target)
    return Label(Source(str(path), ""), Span(0, 0)) if path is not None else None


def _python(declared: Callable[..., Any] | type | None) -> Label | None:
    """The `def` or `class` line of something in Python."""
    if declared is None:
        return None
    try:
        declared = inspect.unwrap(declared)
        path = inspect.getsourcefile(declared)
        lines, first = inspect.getsourcelines(declared)
    except (OSError, TypeError):
        return None
    if path is None:
        return None
    skip = next(
        (i for i, line in enumerate(lines) if line.lstrip().startswith(("def ", "class "))), 0
    )
    text = Path(path).read_text(encoding="utf-8", errors="replace")
    start = sum(len(line) for line in text.splitlines(keepends=True)[: first - 1 + skip])
    return Label(Source(os.path.abspath(path), text), Span(start, start))


def _file(declared: Callable[..., Any]) -> Label | None:
    label = _python(declared)
    return Label(label.source, Span(0, 0)) if label is not None else None
