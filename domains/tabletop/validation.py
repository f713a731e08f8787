"""A plan certified: its motions by the judge, and its features, rules and goal by its sketch."""

from __future__ import annotations

from dataclasses import replace

from domains.tabletop.actions.retrace import retrace
from domains.tabletop.scene.load import load_scene
from domains.tabletop.world import TabletopWorld
from runtime.judge.certify import certify
from runtime.judge.findings import Certificate, Finding
from runtime.judge.run_of_sketch import Snapshots, moment_faults, run_faults
from runtime.plan.model import Plan
from runtime.robot.load import load_robot
from sketchlang.compile import CompiledSketch
from sketchlang.library import find_scene


def validate(
    plan: Plan,
    scene: str | None = None,
    robot: str | None = None,
    sketch: CompiledSketch | None = None,
) -> Certificate:
    """The verdict on a plan; scene and robot are those that it names, if none are given. With a
    sketch, the plan must be a run of it.

    Raises:
        InputError: scene or robot cannot be read, or an action's arguments are none.
    """
    path, name = find_scene(scene or plan.scene)
    loaded, model = load_scene(path, name), load_robot(robot or plan.robot)
    if sketch is None:
        return certify(plan, loaded.world, model)
    snapshots = Snapshots(plan)
    certificate = certify(plan, loaded.world, model, snapshots)
    if not certificate.valid:
        return certificate
    moments = retrace(plan, TabletopWorld.of(loaded, model), sketch)
    faults = [*moment_faults(moments, snapshots.moments), *run_faults(plan, sketch.model, moments)]
    return replace(certificate, findings=tuple(Finding(None, fault) for fault in faults))
