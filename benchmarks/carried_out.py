"""Plans of tabletop scenes as traces, and what comes of them in PyBullet: for several tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from runtime.plan.model import Plan
from runtime.trace.make import trace_of_plan
from runtime.trace.model import Trace
from runtime.trace.sketch import load_trace_sketch

if TYPE_CHECKING:
    from domains.tabletop.world import TabletopWorld
    from runtime.physics.execute import Report

SKETCH = "pick_and_place"
"""The sketch that plans are made with."""


def trace_of(world: TabletopWorld, plan: Plan) -> Trace:
    """What happens when a plan is carried out in its world."""
    return trace_of_plan(plan, world.scene.world, world.robot, load_trace_sketch(SKETCH))


def carried_out(trace: Trace) -> tuple[Report, float]:
    """What came of it under physics, and how far the worst object ended from where it should be,
    metres."""
    from runtime.physics.execute import execute

    report, _ = execute(trace)
    return report, max((pose.error for pose in report.objects), default=0.0)
