"""Sends steps to controllers, one after the other, and stops where one fails.

What carries the messages is a `Bridge`; `runtime.export.rosbridge` is one.
"""

from __future__ import annotations

import queue
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Protocol

from runtime.export.goals import Goal
from runtime.export.steps import Step

ENOUGH = 1.5
"""A goal may take so many times as long as planned, and `patience` more."""

SETTLING = 5.0
"""Seconds in which controllers that were told to cancel should say that they have."""


@dataclass(frozen=True)
class Answer:
    """How a goal ended: `reason` says why where it failed."""

    succeeded: bool
    reason: str = ""


class Bridge(Protocol):
    """What carries goals to the controllers of a robot."""

    def send(self, goal: Goal, answered: Callable[[Answer], None]) -> Callable[[], None]:
        """Send a goal; `answered` is called once, from any thread, when it ended. Returns what
        cancels it."""

    def joint_values(self, timeout: float) -> Mapping[str, float] | None:
        """Where the robot's joints are by now; None if it has not said so in time."""


@dataclass(frozen=True)
class Failure:
    """Where and why it stopped: the step, the controller, a reason."""

    step: Step
    controller: str
    reason: str


Report = Callable[[Step, float | None], None]
"""Is told of every step: when it begins (None), and how many seconds it took."""


def send(
    steps: Sequence[Step], bridge: Bridge, report: Report, patience: float = 10.0
) -> Failure | None:
    """Send steps in order, each when all goals of the one before have succeeded. At the first
    failure the other goals of its step are cancelled, and nothing more is sent.

    A goal that takes longer than half as long again as planned, and `patience` seconds more,
    has failed.
    """
    for step in steps:
        report(step, None)
        began = time.monotonic()
        failure = _send_step(step, bridge, patience)
        if failure is not None:
            return failure
        report(step, time.monotonic() - began)
    return None


def _send_step(step: Step, bridge: Bridge, patience: float) -> Failure | None:
    answers: queue.Queue[tuple[int, Answer]] = queue.Queue()
    pending: dict[int, Callable[[], None]] = {}
    try:
        for number, goal in enumerate(step.goals):
            pending[number] = bridge.send(goal, partial(_put, answers, number))
        until = time.monotonic() + ENOUGH * _longest(step) + patience
        while pending:
            left = until - time.monotonic()
            try:
                number, answer = answers.get(timeout=max(left, 0.0))
            except queue.Empty:
                name = step.goals[min(pending)].controller.name
                return Failure(step, name, f"no result within {ENOUGH * _longest(step):.0f} s")
            if not answer.succeeded:
                del pending[number]
                return Failure(step, step.goals[number].controller.name, answer.reason)
            pending.pop(number, None)
        return None
    finally:
        # Also when the user interrupts: nothing goes on moving that nobody waits for.
        _cancel(pending, answers)


def _put(answers: queue.Queue[tuple[int, Answer]], number: int, answer: Answer) -> None:
    answers.put((number, answer))


def _longest(step: Step) -> float:
    return max((float(goal.motion.times[-1]) for goal in step.goals), default=0.0)


def _cancel(
    pending: dict[int, Callable[[], None]], answers: queue.Queue[tuple[int, Answer]]
) -> None:
    for cancel in pending.values():
        cancel()
    until = time.monotonic() + SETTLING
    while pending:
        try:
            number, _ = answers.get(timeout=max(until - time.monotonic(), 0.0))
        except queue.Empty:
            return
        pending.pop(number, None)
