"""Where the checks write what they find."""

from __future__ import annotations

from dataclasses import dataclass, field

from sketchlang.diagnostics import Diagnostic, Label, Severity

WARNINGS = frozenset(
    {
        "always-false",
        "always-true",
        "copied-rule",
        "goal-against-invariant",
        "goal-rule",
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
        "unused-define",
        "unused-feature",
        "unused-parameter",
        "unused-variable",
    }
)
"""Codes of findings that do not keep a sketch from being used."""

MAX_FINDINGS = 200
"""So many findings are told of a file."""


@dataclass
class Report:
    """Diagnostics in the order in which they were found."""

    diagnostics: list[Diagnostic] = field(default_factory=list)
    muted: int = 0

    def add(
        self,
        code: str,
        message: str,
        primary: Label,
        *secondary: Label,
        hint: str | None = None,
    ) -> None:
        """Note a finding, unless the report is muted."""
        if self.muted or len(self.diagnostics) > MAX_FINDINGS:
            return
        if len(self.diagnostics) == MAX_FINDINGS:
            message = f"more than {MAX_FINDINGS} findings: further ones are left out"
            self.diagnostics.append(Diagnostic("too-many-errors", message, primary))
            return
        severity = Severity.WARNING if code in WARNINGS else Severity.ERROR
        self.diagnostics.append(Diagnostic(code, message, primary, secondary, hint, severity))
