"""Steps as one JSON object, for whoever sends them on himself."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from runtime.export.messages import stamp
from runtime.export.steps import Step
from runtime.trace.model import Trace

FORMAT = "sketchlang-steps"
VERSION = 1


def steps_to_json(trace: Trace, steps: Sequence[Step], frame: str) -> dict[str, Any]:
    """All that a sender needs: for each step its goals, by controller, action and type."""
    return {
        "format": FORMAT,
        "version": VERSION,
        "tool_version": trace.tool_version,
        "robot": trace.robot.name,
        "scene": trace.world.name,
        "frame": frame,
        "steps": [
            {
                "step": step.number,
                "actions": list(step.actions),
                "text": step.text,
                "rule": step.rule,
                "start": round(step.start, 6),
                "duration": round(step.duration, 6),
                "grip": step.grip
                and {
                    "event": "grasp" if step.grip.attach else "release",
                    "object": step.grip.object,
                },
                "goals": [
                    {
                        "controller": goal.controller.name,
                        "action": goal.controller.action,
                        "type": goal.type,
                        "duration": stamp(float(goal.motion.times[-1])),
                        "goal": goal.message,
                    }
                    for goal in step.goals
                ],
            }
            for step in steps
        ],
    }
