"""Any world as a trace, under physics, as a model and on a page: solids of every kind."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import trimesh

from domains.tabletop.scene.worlds import find_world
from runtime.export.model import glb
from runtime.judge.certify import certify
from runtime.judge.extents import homogeneous
from runtime.judge.footing import above
from runtime.show.browser import Browser, find_browser
from runtime.show.page import page
from runtime.trace.kinematics import Tree, guided_at, links_at, object_at
from runtime.trace.make import trace_of_plan, trace_robot
from runtime.trace.model import Trace, TraceSketch
from runtime.trace.read import read_trace
from runtime.trace.write import to_json, write_trace
from runtime.world.body import Body, Part
from runtime.world.goals import AnyOf, IsHeld, RestsAt, RestsOn, Spelled
from runtime.world.poses import identity, upright
from runtime.world.solids import Box, Capsule, Cylinder, Hull, Solid, Sphere
from runtime.world.world import Movable, World
from tests.runtime.judge.gantry import AIR, TOP, Script, cube, drawer, gantry, table_world, top_of

SKETCH = TraceSketch("none", (("none.sketch", "rule"),), (), ())

LYING = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])

SOLIDS: list[Solid] = [
    Cylinder(0.03, 0.1),
    Sphere(0.03),
    Capsule(0.02, 0.1),
    Hull(((0.04, 0.04, -0.03), (-0.04, 0.04, -0.03), (-0.04, -0.04, -0.03), (0.04, -0.04, -0.03),
          (0.01, 0.0, 0.03))),
]  # fmt: skip


def zoo() -> World:
    """A table with a solid of each kind, a body of two, and a drawer."""
    things = [cube("a", -0.3, 0.0), cube("b", -0.3, 0.0, TOP + AIR + 0.04 + AIR)]
    for i, solid in enumerate(SOLIDS):
        pose = upright(-0.1 + 0.15 * i, 0.2, TOP + AIR + solid.half[2], 0.3)
        if isinstance(solid, Capsule):
            pose[:, :3], pose[2, 3] = LYING, TOP + AIR + solid.radius
        body = Body((Part(solid, identity()),), 0.1, (0.0, 0.0, 0.0))
        things.append(Movable(type(solid).__name__.lower(), body, pose, "blue"))
    parts = (
        Part(Box((0.1, 0.1, 0.02)), upright(0, 0, 0.01, 0)),
        Part(Cylinder(0.02, 0.1), upright(0.02, 0, 0.07, 0)),
    )
    lamp = Body(parts, 0.2, (0.005, 0.0, 0.03))
    things.append(Movable("lamp", lamp, upright(0.0, -0.2, TOP + AIR, 1.0), label="L"))
    goals = (
        RestsOn("a", "table"),
        AnyOf((IsHeld("a"), RestsAt("b", "top of a", 0.0, 0.0, 0.01, 0.5, 0.1, 4))),
        Spelled("L", "table", 0.1, 0.01),
    )
    world = table_world(*things, fixed=[drawer(0.3, -0.3, 0.15)], goals=goals)
    return replace(world, supports=(world.supports[0], top_of(things[0])))


def worked() -> Script:
    """The upper cube of a tower is put on the table, and the drawer pushed."""
    world = zoo()
    script = Script(world).over(-0.3, 0.0, TOP + AIR + 0.04 + AIR + 0.02).take("b", 0.04)
    script.over(-0.3, -0.2, TOP + AIR + 0.02)
    script.put("b", "table", upright(-0.3, -0.2, TOP + AIR, 0.0), 0.06)
    script.to(-0.3, -0.2, 0.8).fingers(0.0).over(0.239, -0.3, TOP + 0.06)
    return script.to(0.339, -0.3, TOP + 0.06, "drawer", world.fixed[1].pose).home()


@pytest.fixture(scope="module")
def zoo_trace() -> Trace:
    script = worked()
    return trace_of_plan(script.plan(), script.world, gantry(), replace_rules(SKETCH))


def replace_rules(sketch: TraceSketch) -> TraceSketch:
    """The sketch with the rule that hand-written plans name."""
    from runtime.trace.model import RuleText

    return replace(sketch, rules=(RuleText("rule", 0, 0, 4),))


def test_the_plan_is_sound_but_for_its_goals() -> None:
    script = worked()
    lacks = [finding.message for finding in certify(script.plan(), script.world, gantry()).findings]
    assert lacks == ["goal not reached: a is not held and b is not on top of a"]


def test_a_world_is_read_as_it_was_written(zoo_trace, tmp_path) -> None:
    path = tmp_path / "trace.json"
    write_trace(zoo_trace, path)
    again = read_trace(path)
    assert alike(to_json(again), to_json(zoo_trace))
    assert again.world.goals == zoo_trace.world.goals
    assert again.world.fixed[1].guide == zoo_trace.world.fixed[1].guide


def alike(a: Any, b: Any) -> bool:
    """Whether plain data are the same, numbers up to their rounding."""
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(alike(a[key], b[key]) for key in a)
    if isinstance(a, list):
        return len(a) == len(b) and all(map(alike, a, b))
    return a == b or abs(a - b) < 3e-6


def test_bodies_are_where_the_plan_has_them(zoo_trace) -> None:
    links = links_at(zoo_trace, Tree(zoo_trace.robot), zoo_trace.duration)
    b = zoo_trace.world.index("b")
    end = object_at(zoo_trace, links, b, zoo_trace.duration)
    assert end[:3] == pytest.approx(upright(-0.3, -0.2, TOP + AIR, 0.0), abs=1e-6)
    pushed = guided_at(zoo_trace, "drawer", zoo_trace.duration)[:3, 3]
    assert pushed == pytest.approx(zoo_trace.world.fixed[1].pose[:, 3] + [0.1, 0, 0], abs=1e-6)
    poses = {i: homogeneous(thing.pose) for i, thing in enumerate(zoo_trace.world.movables)}
    assert above(zoo_trace.world, poses, [zoo_trace.world.index("a")]) == {b}


def test_a_model_has_the_volumes_of_the_solids(zoo_trace) -> None:
    scene = trimesh.load_scene(io.BytesIO(glb(zoo_trace, 0.0)), file_type="glb")
    for thing in zoo_trace.world.movables:
        expected = sum(part.solid.volume for part in thing.body.parts)
        mesh = scene.geometry[thing.name]
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
        assert mesh.volume == pytest.approx(expected, rel=0.03), thing.name


@pytest.mark.skipif(find_browser() is None, reason="there is no Chromium")
def test_a_page_shows_the_same_bodies_at_the_same_places(zoo_trace, tmp_path) -> None:
    path = tmp_path / "page.html"
    path.write_text(page(zoo_trace), encoding="utf-8")
    tree = Tree(zoo_trace.robot)
    with Browser(320, 200) as browser:
        browser.open(path)
        for time in (0.0, zoo_trace.duration / 3, zoo_trace.duration):
            browser.evaluate(f"replay.seek({time}); replay.draw()")
            links = links_at(zoo_trace, tree, time)
            for index, place in enumerate(browser.evaluate("replay.state.objects")):
                expected = object_at(zoo_trace, links, index, time)[:3, 3]
                assert place == pytest.approx(expected.tolist(), abs=1e-4)
        volumes = browser.evaluate("replay.volumes")
    for thing, volume in zip(zoo_trace.world.movables, volumes, strict=True):
        expected_volume = sum(part.solid.volume for part in thing.body.parts)
        assert volume == pytest.approx(expected_volume, rel=0.03), thing.name


@pytest.mark.parametrize("name", ["zoo", "kitchen/tidy", "stack/pyramid", "kit/parts"])
def test_under_physics_everything_stays_where_it_stands(name) -> None:
    pytest.importorskip("pybullet")
    from runtime.physics.settling import drop
    from runtime.physics.simulation import Physics

    world = zoo() if name == "zoo" else find_world(name)
    poses = {i: homogeneous(thing.pose) for i, thing in enumerate(world.movables)}
    physics = Physics(world, trace_robot(gantry()))
    try:
        for _ in range(240):
            physics.step()
        for index, pose in poses.items():
            wanted = pose[:3, 3] - [0, 0, drop(world, poses, index)]
            off = np.linalg.norm(physics.object_pose(index)[:3] - wanted)
            assert off < 0.005, (world.movables[index].name, off)
    finally:
        physics.close()


def test_a_gantry_is_executed() -> None:
    """Another robot than the built-in one, its hand from above: within a centimetre."""
    pytest.importorskip("pybullet")
    from runtime.physics.execute import execute

    world = table_world(cube("a", 0, 0), cube("b", 0.2, 0), goals=[RestsOn("b", "top of a")])
    script = Script(world).over(0.2, 0, TOP + AIR + 0.02).take("b", 0.04)
    up = TOP + AIR + 0.04 + AIR
    script.over(0, 0, up + 0.02).put("b", "top of a", upright(0, 0, up, 0.0), 0.06).home()
    assert script.verdict().findings == ()
    trace = trace_of_plan(script.plan(), world, gantry(), replace_rules(SKETCH))
    report, _ = execute(trace)
    assert report.success, (report.unmet, report.slips, report.objects)
    assert not report.touches
