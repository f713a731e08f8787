"""The moments of a trace of which there are pictures."""

from __future__ import annotations

from collections.abc import Iterator

from runtime.trace.model import Trace
from sketchlang.escape import file_part


def moments(trace: Trace) -> Iterator[tuple[str, float]]:
    """Names and times of the pictures: the start, the end of each subgoal, the end, which is
    called `failure` where a partial plan ends."""
    yield "start", 0.0
    for number, subgoal in enumerate(trace.subgoals, 1):
        yield f"subgoal-{number:02d}-{file_part(subgoal.rule)}", subgoal.end
    partial = trace.source == "plan" and any(event.kind == "verdict" for event in trace.events)
    yield "failure" if partial else "end", trace.duration
