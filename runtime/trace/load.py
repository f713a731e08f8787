"""The trace that a user names: of a trace file, or of a plan file with what it refers to."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from runtime.plan.node import read_json
from runtime.plan.read import plan_of
from runtime.plan.write import FORMAT as PLAN_FORMAT
from runtime.robot.load import load_robot
from runtime.trace.make import trace_of_plan
from runtime.trace.model import Trace
from runtime.trace.read import trace_of
from runtime.trace.sketch import load_trace_sketch
from runtime.world.world import World


def load_trace(
    path: Path,
    find_world: Callable[[str], World],
    scene: str | None = None,
    robot: str | None = None,
    sketch: str | None = None,
    domain_file: str | None = None,
) -> Trace:
    """The trace of a plan or trace file. Scene, robot and sketch are for plans that do not
    name built-in ones, `domain_file` is the Python file of a domain that the sketch needs;
    `find_world` gives the world of a scene by its name or path.

    Raises:
        InputError: what is wrong with the file, and where.
    """
    data = read_json(path)
    if not isinstance(data.value, dict) or data.value.get("format") != PLAN_FORMAT:
        return trace_of(data)
    plan = plan_of(data)
    return trace_of_plan(
        plan,
        find_world(scene or plan.scene),
        load_robot(robot or plan.robot),
        load_trace_sketch(sketch or plan.sketch, domain_file),
    )
