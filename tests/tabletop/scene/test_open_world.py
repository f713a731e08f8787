"""Scenes of any solid on any support: where things come to rest, and what is refused."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from domains.tabletop.scene.load import load_scene
from domains.tabletop.scene.model import AnyGoal, HeldGoal, PoseGoal, RegionGoal, Scene
from runtime.lines import lines_of
from runtime.world import goals as wanted
from runtime.world.mesh import body_mesh
from runtime.world.poses import apply, compose
from runtime.world.world import FLOOR
from sketchlang.errors import CollectedInputError, InputError
from tests.tabletop.scene.texts import write_scene

ROOM = """robot_start = [0.0, 0.0, 0.0]

[[table]]
name = "bench"
at = [1.0, 0.0]
size = [0.6, 1.0]
top = 0.7
thickness = 0.05

[[shelf]]
name = "rack"
at = [-1.0, 0.0]
yaw = 90.0
size = [1.0, 0.4]
boards = [0.3, 0.8]
thickness = 0.02

[[bin]]
name = "bin"
at = [1.0, -0.3]
yaw = 30.0
size = [0.3, 0.2]
height = 0.12
wall = 0.01
"""
CUBE = '\n[[object]]\nname = "cube"\nsize = [0.05, 0.05, 0.05]\nat = [0.9, 0.3]\nyaw = 20.0\n'
GOAL = '\n[[goal]]\nobject = "cube"\non = "rack/2"\n'


def thing(name: str, keys: str) -> str:
    return f'\n[[object]]\nname = "{name}"\n{keys}\n'


def read(folder: Path, *parts: str) -> Scene:
    return load_scene(write_scene(folder, "".join(parts)))


def problems(folder: Path, *parts: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        read(folder, *parts)
    error = caught.value
    every = error.errors if isinstance(error, CollectedInputError) else (error,)
    return [str(e).replace(str(folder), "") for e in every]


def lowest(scene: Scene, name: str) -> float:
    movable = scene.world.movables[scene.world.index(name)]
    return float(apply(movable.pose, body_mesh(movable.body).vertices)[:, 2].min())


def support_of(scene: Scene, name: str) -> str:
    return scene.supports[scene.objects[scene.world.index(name)].rests.support].name


# -- furniture ---------------------------------------------------------------------------------


def test_supports_have_their_heights_regions_and_clearances(tmp_path) -> None:
    scene = read(tmp_path, ROOM, CUBE, GOAL)
    supports = {s.name: s for s in scene.supports}
    assert list(supports) == ["bench", "rack/1", "rack/2", "bin", FLOOR, "cube"]
    assert supports["bench"].pose[2, 3] == pytest.approx(0.702)
    assert supports["rack/1"].half == pytest.approx((0.48, 0.2))
    assert supports["rack/1"].clearance == pytest.approx(0.5 - 0.02 - 0.002)
    assert supports["rack/2"].clearance == math.inf
    assert supports["bin"].pose[2, 3] == pytest.approx(0.702 + 0.01 + 0.002)
    assert supports["bin"].half == pytest.approx((0.14, 0.09))
    assert supports[FLOOR].pose[2, 3] == pytest.approx(0.002)
    assert supports["cube"].owner == "cube"


def test_a_table_with_a_thickness_leaves_room_below(tmp_path) -> None:
    scene = read(tmp_path, ROOM, CUBE, GOAL)
    bench = next(f for f in scene.world.fixed if f.name == "bench")
    points = apply(bench.pose, body_mesh(bench.body).vertices)
    assert points[:, 2].min() == pytest.approx(0.65)
    assert points[:, 2].max() == pytest.approx(0.7)


@pytest.mark.parametrize(("sides", "solids"), [("true", 4), ("false", 2)])
def test_shelves_have_boards_and_sides(tmp_path, sides, solids) -> None:
    room = ROOM.replace("boards =", f"sides = {sides}\nboards =")
    rack = next(f for f in read(tmp_path, room, CUBE, GOAL).world.fixed if f.name == "rack")
    assert len(rack.body.parts) == solids
    points = apply(rack.pose, body_mesh(rack.body).vertices)
    assert points[:, 2].max() == pytest.approx(0.8)
    assert points[:, 2].min() == pytest.approx(0.0 if sides == "true" else 0.28)


# -- how things rest ---------------------------------------------------------------------------

RESTING = {
    "cylinder": ('shape = "cylinder"\nradius = 0.03\nheight = 0.1\nat = [0.9, 0.1]', 0.702),
    "lying can": (
        'shape = "cylinder"\nradius = 0.03\nheight = 0.1\nat = [0.9, 0.1]\nrpy = [0, 90, 40]',
        0.702,
    ),
    "ball": ('shape = "sphere"\nradius = 0.03\nat = [0.9, 0.1]', 0.702),
    "pill": (
        'shape = "capsule"\nradius = 0.02\nheight = 0.1\nat = [0.9, 0.1]\nrpy = [0, 90, 0]',
        0.702,
    ),
    "tray": ('shape = "tray"\nsize = [0.2, 0.15, 0.04]\nat = [0.9, 0.0]', 0.702),
    "carton on its side": ("size = [0.2, 0.1, 0.05]\nat = [0.9, 0.0]\nrpy = [90, 0, 0]", 0.702),
    "nearly upright": ("size = [0.05, 0.05, 0.1]\nat = [0.9, 0.0]\nrpy = [2, -3, 10]", 0.702),
    "on a board": ('size = [0.05, 0.05, 0.1]\nat = [-1.0, 0.2]\non = "rack/1"', 0.302),
    "on the floor": ('size = [0.05, 0.05, 0.1]\nat = [0.0, 1.0]\non = "floor"', 0.002),
    "in a bin": ("size = [0.05, 0.05, 0.1]\nat = [1.0, -0.3]", 0.714),
    "on the cube": ('size = [0.04, 0.04, 0.03]\non = "cube"', 0.702 + 0.05 + 0.002),
    "over the edge": ("size = [0.3, 0.2, 0.05]\nat = [0.76, 0.0]", 0.702),
}


@pytest.mark.parametrize(("keys", "bottom"), RESTING.values(), ids=RESTING)
def test_things_rest_on_what_they_are_on(tmp_path, keys, bottom) -> None:
    scene = read(tmp_path, ROOM, CUBE, thing("it", keys), GOAL)
    assert lowest(scene, "it") == pytest.approx(bottom, abs=1e-3)


def test_what_lies_has_the_heading_of_its_own_z(tmp_path) -> None:
    keys = 'shape = "cylinder"\nradius = 0.03\nheight = 0.1\nat = [0.9, 0.1]\nrpy = [0, 90, 40]'
    scene = read(tmp_path, ROOM, CUBE, thing("can", keys), GOAL)
    can = scene.objects[1]
    assert can.rests.yaw == pytest.approx(math.radians(40))
    pose = scene.world.movables[1].pose
    assert pose[:, 2] == pytest.approx([math.cos(can.rests.yaw), math.sin(can.rests.yaw), 0.0])
    assert (pose @ [0, 0, 0.05, 1])[:2] == pytest.approx([0.9, 0.1])


def test_towers_may_be_told_from_above(tmp_path) -> None:
    top = thing("top", 'size = [0.04, 0.04, 0.04]\non = "middle"')
    middle = thing("middle", 'size = [0.04, 0.04, 0.04]\non = "cube"')
    scene = read(tmp_path, ROOM, top, middle, CUBE, GOAL)
    assert [o.name for o in scene.objects] == ["top", "middle", "cube"]
    assert support_of(scene, "top") == "middle"
    assert lowest(scene, "top") == pytest.approx(0.702 + 0.052 + 0.042)
    for index, support in enumerate(scene.supports):
        if support.owner in ("top", "middle", "cube"):  # where it is, and in which order
            owner = scene.world.movables[scene.world.index(support.owner)]
            assert compose(owner.pose, support.pose)[2, 2] == pytest.approx(1.0)
            assert index >= 5
    assert [s.name for s in scene.supports[5:]] == ["top", "middle", "cube"]


def test_one_thing_may_rest_across_two(tmp_path) -> None:
    other = thing("other", "size = [0.05, 0.05, 0.05]\nat = [0.9, 0.22]")
    cube = CUBE.replace("yaw = 20.0", "")
    bridge = thing("bridge", 'size = [0.05, 0.05, 0.05]\non = ["cube", "other"]')
    scene = read(tmp_path, ROOM, cube, other, bridge, GOAL)
    rests = scene.objects[2].rests
    assert (rests.x, rests.y) == pytest.approx((0.9, 0.26))
    assert [scene.supports[i].name for i in (rests.support, *rests.others)] == ["cube", "other"]
    off = bridge.replace("on =", "at = [0.9, 0.36]\non =")
    assert "not between cube and other" in problems(tmp_path, ROOM, cube, other, off, GOAL)[0]


def test_a_mesh_is_found_beside_its_scene_and_is_part_of_the_digest(tmp_path) -> None:
    mesh = "v 0 0 0\nv 60 0 0\nv 0 60 0\nv 0 0 60\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    (tmp_path / "t.obj").write_text(mesh, encoding="utf-8")
    keys = 'mesh = "t.obj"\nscale = 0.001\nat = [0.9, 0.0]\nmass = 0.1'
    scene = read(tmp_path, ROOM, CUBE, thing("it", keys), GOAL)
    assert scene.objects[1].body.mass == 0.1
    assert lowest(scene, "it") == pytest.approx(0.702)
    (tmp_path / "t.obj").write_text(mesh + "# another\n", encoding="utf-8")
    assert read(tmp_path, ROOM, CUBE, thing("it", keys), GOAL).digest != scene.digest


# -- goals -------------------------------------------------------------------------------------


def goals(folder: Path, keys: str) -> tuple[Scene, object]:
    tray = thing("tray", 'shape = "tray"\nsize = [0.3, 0.2, 0.04]\nat = [0.95, 0.1]\nyaw = 90.0')
    cube = CUBE.replace("[0.9, 0.3]", "[0.9, 0.38]")
    scene = read(folder, ROOM, cube, tray, f'\n[[goal]]\nobject = "cube"\n{keys}\n')
    return scene, scene.goals[0]


def test_goals_of_every_kind(tmp_path) -> None:
    scene, goal = goals(tmp_path, 'on = "tray"')
    assert isinstance(goal, RegionGoal)
    assert scene.supports[goal.support].owner == "tray"
    scene, goal = goals(tmp_path, 'on = "tray"\nat = [0.1, 0.05]\nyaw = 90')
    assert goal == PoseGoal(scene.objects[0].rests.support + 6, 0.1, 0.05, math.pi / 2, 0.005)
    scene, goal = goals(tmp_path, "held = true")
    assert goal == HeldGoal()
    assert scene.world.goals == (wanted.IsHeld("cube"),)
    scene, goal = goals(tmp_path, 'any = [{ on = "bin" }, { at = [-1.0, 0.1], on = "rack/1" }]')
    assert goal == AnyGoal((RegionGoal(3), PoseGoal(1, -1.0, 0.1, None, 0.005)))
    at = wanted.RestsAt("cube", "rack/1", pytest.approx(0.1), pytest.approx(0.0), 0.005, symmetry=4)
    assert scene.world.goals == (wanted.AnyOf((wanted.RestsOn("cube", "bin"), at)),)


def test_headings_of_goals_are_measured_on_what_they_are_on(tmp_path) -> None:
    scene, _ = goals(tmp_path, 'on = "rack/1"\nat = [-1.0, 0.0]\nyaw = 120')
    found = scene.world.goals[0]
    assert isinstance(found, wanted.RestsAt)
    assert found.yaw == pytest.approx(math.radians(30))


# -- mistakes ----------------------------------------------------------------------------------

REFUSED = {
    "unknown shape": ('shape = "cylindre"\nat = [0.9, 0.0]', "cylindre", "cylinder"),
    "a box with a radius": (
        "size = [0.1, 0.1, 0.1]\nradius = 1\nat = [0.9, 0.0]",
        "radius",
        "size",
    ),
    "a can without height": (
        'shape = "cylinder"\nradius = 0.1\nat = [0.9, 0.0]',
        "height",
        "missing",
    ),
    "both headings": (
        "size = [0.1, 0.1, 0.1]\nyaw = 1\nrpy = [0, 0, 1]\nat = [0.9, 0.0]",
        "yaw",
        "rpy",
    ),
    "on its edge": (
        "size = [0.1, 0.1, 0.1]\nrpy = [45, 0, 0]\nat = [0.9, 0.0]",
        "rpy",
        "45 degrees",
    ),
    "a standing pill": (
        'shape = "capsule"\nradius = 0.02\nheight = 0.1\nat = [0.9, 0.0]',
        "rest",
        "rpy",
    ),
    "on nothing known": ('size = [0.1, 0.1, 0.1]\non = "rack/3"', "rack/3", "rack/2"),
    "on a shelf": ('size = [0.1, 0.1, 0.1]\non = "rack"', "shelf", "rack/1, rack/2"),
    "on itself": ('size = [0.1, 0.1, 0.1]\non = "it"', "circle", "it on it"),
    "on boards, unsaid": ("size = [0.1, 0.1, 0.1]\nat = [-1.0, 0.0]", "several boards", "rack/1"),
    "off its board": ('size = [0.1, 0.1, 0.1]\nat = [0.9, 0.0]\non = "rack/1"', "not on", "rack/1"),
    "too high for its board": (
        'size = [0.1, 0.1, 0.6]\nat = [-1.0, 0.0]\non = "rack/1"',
        "0.6 m high",
        "leaves 0.478 m",
    ),
    "falling over the edge": ("size = [0.3, 0.2, 0.05]\nat = [0.69, 0.0]", "not on", "bench"),
    "inside another": ("size = [0.1, 0.1, 0.1]\nat = [0.93, 0.32]", "starts inside", "cube"),
    "in the wall of the bin": ("size = [0.1, 0.1, 0.1]\nat = [0.9, -0.3]", "starts inside", "bin"),
    "a missing mesh": ('mesh = "no.obj"\nat = [0.9, 0.0]', "mesh", "no such file"),
    "no mass": ("size = [0.1, 0.1, 0.1]\nmass = 0\nat = [0.9, 0.0]", "mass", "positive"),
    "on at three": ('size = [0.1, 0.1, 0.1]\non = ["cube", 3]', "on", "names"),
}


@pytest.mark.parametrize("case", [name for name in REFUSED if REFUSED[name][1]])
def test_what_cannot_be_is_said_with_its_place(tmp_path, case) -> None:
    keys, *words = REFUSED[case]
    found = problems(tmp_path, ROOM, CUBE, thing("it", keys), GOAL)
    line = (ROOM + CUBE).count("\n") + 2
    assert len(found) == 1, found
    assert all(word in found[0] for word in words), found
    assert "[[object]] it" in found[0]
    number = int(found[0].split(":")[1])
    assert line <= number <= line + 6


def test_the_floor_has_its_name(tmp_path) -> None:
    found = problems(tmp_path, ROOM.replace('"bin"', '"floor"'), CUBE, GOAL)
    assert "name of the floor" in found[0]


FURNITURE = {
    "boards that fall": ("boards = [0.3, 0.8]", "boards = [0.8, 0.3]", "rise"),
    "boards in each other": ("boards = [0.3, 0.8]", "boards = [0.3, 0.31]", "rise"),
    "no boards": ("boards = [0.3, 0.8]", "boards = []", "one board"),
    "a thick table": ("thickness = 0.05", "thickness = 0.9", "more than the height"),
    "a bin of walls": ("wall = 0.01", "wall = 0.1", "nothing is left"),
    "a bin on a shelf": ("wall = 0.01", 'wall = 0.01\non = "rack"', "named 'rack'"),
    "a misspelt key": ("boards = [0.3, 0.8]", "boards = [0.3, 0.8]\nsdes = true", "sdes"),
    "one name for two": ('name = "bin"', 'name = "bench"', "a table and a bin"),
}


@pytest.mark.parametrize(("old", "new", "word"), FURNITURE.values(), ids=FURNITURE)
def test_furniture_that_cannot_be_is_named(tmp_path, old, new, word) -> None:
    assert old in ROOM
    found = problems(tmp_path, ROOM.replace(old, new, 1), CUBE, GOAL.replace("rack/2", "bench"))
    assert word in found[0], found


BROKEN = """robot_start = [0.0, 0.0]

[[table]]
name = "bench"
at = [1.0, 0.0]
size = [0.6, -1.0]
top = 0.7
tpo = 1

[[table]]
name = "desk"
at = [1.0, 2.0]
size = [0.6, 1.0]
top = "high"

[[object]]
name = "cube"
size = [0.05, 0.05]
on = "desk"

[[object]]
name = "can"
shape = "can"
at = [5.0, 5.0]

[[goal]]
object = "cub"
on = "desk"

[[goal]]
object = "cube"
on = "nowhere"
"""


def test_all_mistakes_of_a_file_are_told_in_one_run_in_the_order_of_their_lines(tmp_path) -> None:
    found = problems(tmp_path, BROKEN)
    places = [text.split(": ", 2)[0] for text in found]
    assert places == [f"/scene.toml:{line}" for line in (1, 6, 8, 14, 18, 21, 23, 27, 32)] or (
        # What stands nowhere because of its shape is not told to stand nowhere.
        places == [f"/scene.toml:{line}" for line in (1, 6, 8, 14, 18, 23, 27, 32)]
    )
    assert "tpo" in found[2]
    assert "did you mean 'cube'" in "".join(found)


def test_the_command_prints_each_of_them(tmp_path) -> None:
    from sketchlang.cli.run import command as run

    path = write_scene(tmp_path, BROKEN)
    done = CliRunner().invoke(run, ["pick_and_place", str(path)])
    assert done.exit_code == 2
    assert done.stderr.count("error: ") >= 8
    assert "Traceback" not in done.stderr


def test_lines_are_found_behind_strings_and_lists_of_several_lines() -> None:
    text = 'a = """\n[[object]]\nx = 1\n"""\nb = [\n  1, # ]\n  2,\n]\n'
    text += '[[object]]\n"c" = "]["\n[[object]]\nc = 2\n'
    lines = lines_of(text)
    assert lines.of("", 0, "b") == 5
    assert lines.of("object", 0) == 9
    assert lines.of("object", 0, "c") == 10
    assert lines.of("object", 1, "c") == 12
    assert lines.of("object", 1, "d") == 11


def test_scenes_of_boxes_load_without_the_libraries_for_meshes() -> None:
    code = (
        "import sys; from domains.tabletop.scene.load import load_scene\n"
        "from sketchlang.library import find_scene\n"
        "load_scene(*find_scene('stack/tower'))\n"
        "heavy = ('trimesh', 'networkx', 'coacd', 'scipy.spatial', 'scipy.optimize')\n"
        "print([name for name in heavy if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_object_of_the_new_scenes_rests_where_it_is_said_to(tmp_path) -> None:
    from sketchlang.library import find_scene

    for name in (
        "kitchen/tidy",
        "warehouse/shelves",
        "kit/parts",
        "stack/pyramid",
        "desk/sort",
        "desk/low",
    ):
        scene = load_scene(*find_scene(name))
        heights = [float(scene.supports[o.rests.support].pose[2, 3]) for o in scene.objects]
        found = [lowest(scene, o.name) for o in scene.objects]
        assert np.array(found) == pytest.approx(np.array(heights), abs=2e-3)


def test_what_others_are_put_on_at_a_point_has_one_heading() -> None:
    """A cube looks the same after a quarter turn; the place beside its middle does not."""
    from sketchlang.library import find_scene

    scene = load_scene(*find_scene("stack/pyramid"))
    assert sorted(scene.objects[i].name for i in scene.bearing) == ["a", "b", "d"]
    turns = {goal.body: goal.symmetry for goal in scene.world.goals if hasattr(goal, "symmetry")}
    assert turns == {"a": 1, "b": 1, "c": 4, "d": 1, "e": 4, "f": 4}
