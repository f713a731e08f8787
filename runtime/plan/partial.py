"""Partial plans: what a run reached that did not reach the goal, and where that is kept.

A file that is asked for with --out only ever holds a plan that reaches the goal. What an unsolved
run reached goes beside it, under a name of its own, so that no script takes it for a plan.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from runtime.plan.model import Failure
from runtime.search.siw_r import Outcome

MARK = "unsolved"
"""What stands in the name of a partial plan's file, and in the comments of a PDDL one."""

LOOKED_AT = 4096
"""Bytes of a file in which it says that it is a partial plan."""


def failure_of(outcome: Outcome, names: Sequence[str]) -> Failure:
    """The failure of an unsolved outcome of a sketch with features of these names."""
    stuck = {} if outcome.stuck is None else dict(zip(names, outcome.stuck, strict=True))
    return Failure(outcome.reason or "", stuck, tuple(outcome.why))


def partial_path(out: Path) -> Path:
    """Where what an unsolved run reached is kept, beside the file of its plan."""
    return out.with_name(f"{out.stem}.{MARK}{out.suffix}")


def may_write(path: Path) -> bool:
    """Whether a partial plan may be written under a name: nothing is there but another one."""
    if not path.exists():
        return True
    try:
        with path.open("rb") as file:
            start = file.read(LOOKED_AT)
    except OSError:
        return False
    return b'"failure":' in start or f"; {MARK}:".encode() in start
