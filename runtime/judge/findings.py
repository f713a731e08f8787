"""What a judge says of a plan."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """Something wrong with a plan: in which action (from 0), what."""

    action: int | None
    message: str


@dataclass(frozen=True)
class Certificate:
    """The verdict on a plan, and what was looked at to reach it."""

    findings: tuple[Finding, ...]
    samples: int
    actions: int

    @property
    def valid(self) -> bool:
        """Whether nothing was found."""
        return not self.findings
