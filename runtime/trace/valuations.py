"""What the features are worth at each moment of a trace.

Features are functions of a state, and a state changes at moments: where the fingers have closed
on an object or let it go, or else where an action is done. In between, what the present action is
about to change is *pending*.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from runtime.trace.model import Trace, TraceAction

Values = Mapping[str, int]


@dataclass(frozen=True)
class Valuation:
    """From `time` on the features have these values; from `begun` on, something is at work that
    makes them so."""

    begun: float
    time: float
    values: Values


def valuations(trace: Trace) -> tuple[Valuation, ...]:
    """The valuations of a trace, by time; each holds until the next one. Empty where a trace has
    no subgoals."""
    found: list[Valuation] = []
    for number, subgoal in enumerate(trace.subgoals):
        # What was sensed or planned with: after a subplan that was broken off, a new truth.
        found.append(Valuation(subgoal.start, subgoal.start, subgoal.before))
        own = [action for action in trace.actions if action.subgoal == number]
        found += [
            Valuation(action.start, changed_at(trace, action), action.values)
            for action in own[:-1]
            if action.values is not None
        ]
        begun, time = subgoal.end, subgoal.end
        if own:
            begun, time = own[-1].start, changed_at(trace, own[-1])
        found.append(Valuation(begun, time, subgoal.after))
    found.sort(key=lambda valuation: valuation.time)
    return tuple(found)


def changed_at(trace: Trace, action: TraceAction) -> float:
    """When an action has changed the state: with its last grip or release, else at its end."""
    grips = [
        grip.time
        for grip in trace.grips
        if grip.object == action.object and action.start <= grip.time <= action.end
    ]
    return max(grips, default=action.end)


def values_at(found: Sequence[Valuation], time: float) -> Values:
    """The values that hold at a time: those of the last valuation that is not after it."""
    now: Values = found[0].values if found else {}
    for valuation in found:
        if valuation.time > time:
            break
        now = valuation.values
    return now
