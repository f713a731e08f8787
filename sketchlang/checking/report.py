"""Where the checks write what they find."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

from sketchlang.diagnostics import Diagnostic, Fix, Label, Severity

WARNINGS = frozenset(
    {
        "always-false",
        "always-true",
        "commented-include",
        "copied-rule",
        "empty-goal",
        "goal-against-invariant",
        "goal-rule",
        "idle-invariant",
        "no-goal",
        "no-rules",
        "no-title",
        "odd-condition",
        "redundant-effect",
        "repeated-atom",
        "repeated-condition",
        "repeated-effect",
        "rule-against-invariant",
        "satisfied-at-once",
        "shadowing",
        "subsumed-rule",
        "too-many-warnings",
        "unused-define",
        "unused-feature",
        "unused-parameter",
        "unused-variable",
    }
)
"""Codes of findings that do not keep a sketch from being used."""

MAX_FINDINGS = 200
"""Errors and warnings of a file that are listed, of each."""


@dataclass
class Report:
    """Diagnostics in the order in which they were found."""

    diagnostics: list[Diagnostic] = field(default_factory=list)
    muted: int = 0
    counts: Counter[Severity] = field(default_factory=Counter)

    def add(
        self,
        code: str,
        message: str,
        primary: Label,
        *secondary: Label,
        hint: str | None = None,
        fix: Fix | None = None,
    ) -> None:
        """Note a finding, unless the report is muted."""
        if self.muted:
            return
        severity = Severity.WARNING if code in WARNINGS else Severity.ERROR
        self.counts[severity] += 1
        if self.counts[severity] <= MAX_FINDINGS:
            found = Diagnostic(code, message, primary, secondary, hint, severity, fix)
            self.diagnostics.append(found)
        elif self.counts[severity] == MAX_FINDINGS + 1:
            many = "too-many-warnings" if severity is Severity.WARNING else "too-many-errors"
            message = f"more than {MAX_FINDINGS} {severity.value}s: further ones are left out"
            self.diagnostics.append(Diagnostic(many, message, primary, severity=severity))
