"""What is known of the sketches that an editor has opened."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from sketchlang.analysis.limits import Budget
from sketchlang.analysis.termination import Verdict, decide_termination
from sketchlang.diagnostics import Diagnostic
from sketchlang.domain import Domain
from sketchlang.errors import InputError
from sketchlang.findings import further_warnings
from sketchlang.loader import SUFFIX, Loaded, given_domain, load_tree
from sketchlang.lsp.incremental import Parser
from sketchlang.lsp.symbols import Occurrence, occurrences
from sketchlang.reading import read_text
from sketchlang.source import Source

PROOF_SECONDS = 0.5
"""Time that hovering may take to find out whether the sketch terminates."""

MAX_RELATED = 300
"""Files of a workspace that are looked through for those that include another one."""


@dataclass(frozen=True)
class Document:
    """A version of a sketch, with what was found in it. Everything else is worked out on demand."""

    loaded: Loaded

    @property
    def source(self) -> Source:
        """The text, named by its path."""
        return self.loaded.source

    @property
    def domain(self) -> Domain | None:
        """The domain that the sketch uses, if it was found."""
        return self.loaded.checked.domain

    @cached_property
    def names(self) -> list[Occurrence]:
        """All names, those of included files too."""
        return occurrences(self.loaded.tree)

    @cached_property
    def warnings(self) -> list[Diagnostic]:
        """Findings of analyses, which take longer than the check."""
        return further_warnings(self.loaded) if self.loaded.ok else []

    @cached_property
    def verdict(self) -> Verdict | None:
        """Whether the sketch terminates; None where it has errors."""
        if not self.loaded.ok:
            return None
        return decide_termination(self.loaded.checked.model, Budget(seconds=PROOF_SECONDS))


@dataclass
class Workspace:
    """The opened sketches by path, and a file with a domain that they may use."""

    domain_file: str | None = None
    documents: dict[str, Document] = field(default_factory=dict)
    parsers: dict[str, Parser] = field(default_factory=dict)
    trouble: str | None = None
    _given: tuple[dict[str, Domain], Domain | None] = field(default_factory=lambda: ({}, None))
    _stamp: float = -1.0

    def look(self, path: str, text: str) -> Document:
        """Check a text that the editor has under a path."""
        parser = self.parsers.setdefault(path, Parser())
        parsed, diagnostics = parser.parse(Source(path, text))
        opened = {**self._opened(), os.path.realpath(path): text}
        loaded = load_tree(parsed, diagnostics, *self.given(), opened)
        self.documents[path] = Document(loaded)
        return self.documents[path]

    def close(self, path: str) -> None:
        """Forget a document."""
        self.documents.pop(path, None)
        self.parsers.pop(path, None)

    def given(self) -> tuple[dict[str, Domain], Domain | None]:
        """The domains of the given file, which is read again when it has changed."""
        if self.domain_file is None:
            return {}, None
        try:
            changed = os.stat(self.domain_file).st_mtime
            if changed != self._stamp:
                self._given = given_domain(self.domain_file)
                self._stamp = changed
            self.trouble = None
        except OSError as error:
            self.trouble = f"{self.domain_file}: {error.strerror or error}"
        except InputError as error:
            self.trouble = str(error)
        return self._given

    def dependants(self, path: str) -> list[str]:
        """The opened documents that include a file."""
        real = os.path.realpath(path)
        return [
            other
            for other, document in self.documents.items()
            if other != path and real in _included(document)
        ]

    def related(self, path: str, root: str | None) -> list[Document]:
        """All sketches that include a file, and itself: those that are open, and those below the
        workspace's folder."""
        real = os.path.realpath(path)
        found = dict(self.documents)
        folder = Path(root) if root else Path(path).parent
        for file in sorted(folder.rglob(f"*{SUFFIX}"))[:MAX_RELATED]:
            name = str(file)
            if name not in found and os.path.realpath(name) not in map(os.path.realpath, found):
                try:
                    text = read_text(file)
                except InputError:
                    continue
                parsed, diagnostics = Parser().parse(Source(name, text))
                found[name] = Document(
                    load_tree(parsed, diagnostics, *self.given(), self._opened())
                )
        return [
            document
            for name, document in found.items()
            if os.path.realpath(name) == real or real in _included(document)
        ]

    def _opened(self) -> Mapping[str, str]:
        return {
            os.path.realpath(path): document.source.text
            for path, document in self.documents.items()
        }


def _included(document: Document) -> set[str]:
    return {os.path.realpath(one.source.name) for one in document.names} - {
        os.path.realpath(document.source.name)
    }
