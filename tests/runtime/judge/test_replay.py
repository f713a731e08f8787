"""Stacks, trays, drawers, pushes and the floor, with a robot whose plans are written by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from runtime.judge.certify import certify
from runtime.motion.motion import ArmMove, BaseMove, Together
from runtime.plan.model import TimedPiece
from runtime.world.body import Body, Part
from runtime.world.goals import IsHeld, RestsOn
from runtime.world.poses import upright
from runtime.world.solids import Box
from runtime.world.world import Fixed, Movable
from tests.runtime.judge.gantry import (
    AIR,
    CUBE,
    HOME,
    POST,
    TOP,
    Script,
    block,
    cube,
    drawer,
    gantry,
    table_world,
    thing,
    tilting_gantry,
    top_of,
)

ROBOT_LINKS = ("mast", "hand", "left", "right")

GRIP = 0.02
"""Metres above the bottom of a cube at which it is gripped."""


def level(number: int) -> float:
    """The height of the bottom of a cube that stands on so many others."""
    return TOP + AIR + number * (CUBE + AIR)


def stack(script: Script, names: str, x: float, shift: float = 0.0) -> Script:
    """Put cubes on the one at x, one on the other, each further by a shift."""
    for number, name in enumerate(names, 1):
        start = script.world.movables[script.world.index(name)].pose
        script.over(start[0, 3], start[1, 3], start[2, 3] + GRIP).take(name, CUBE)
        there = x + number * shift
        script.over(there, 0.0, level(number) + GRIP)
        under = f"top of {'abcd'[number - 1]}"
        script.put(name, under, upright(there, 0.0, level(number), 0.0), 0.06)
    return script.home()


def test_a_tower_is_built() -> None:
    world = table_world(cube("a", 0, 0), cube("b", 0.2, 0), cube("c", 0.3, 0),
                        goals=[RestsOn("c", "top of b")])  # fmt: skip
    assert stack(Script(world), "bc", 0.0).verdict().findings == ()


def test_a_tower_that_leans_falls_with_the_cube_that_is_too_much() -> None:
    world = table_world(cube("a", 0, 0), cube("b", 0.2, 0), cube("c", 0.3, 0), cube("d", -0.3, 0))
    assert stack(Script(world), "bc", 0.0, shift=0.011).fault() == ""
    assert "the stack of a, b, c, d falls over" in stack(Script(world), "bcd", 0.0, 0.011).fault()


def test_what_is_held_must_not_touch_what_stands() -> None:
    world = table_world(cube("a", 0, 0), cube("b", 0.2, 0))
    script = Script(world).over(0.2, 0.0, level(0) + GRIP).take("b", CUBE)
    assert "b hits a" in script.to(0.2, 0, level(0) + GRIP + 0.01).to(-0.2, 0, 0.44).fault()


def test_the_hand_must_not_touch_what_stands() -> None:
    world = table_world(cube("a", 0, 0))
    assert "hits a" in Script(world).over(0.0, 0.03, level(0) + GRIP).fault()
    assert "hits table" in Script(world).over(0.0, 0.2, TOP - 0.01).fault()


def test_the_hand_must_not_go_into_the_floor() -> None:
    script = Script(table_world(cube("a", 0, 0))).to(0.8, 0, 1.0)
    assert script.to(0.8, 0, 0.011).fault() == "the arm is not in its home posture at the end"
    assert "hits the floor" in script.to(0.8, 0, 0.005).fault()


def test_the_arm_must_not_go_through_the_robots_own_base() -> None:
    """The hand passes the gantry's post at a distance, then goes through it; nothing else is
    near."""
    x, y = POST
    beside = Script(table_world(cube("a", 0, 0))).to(0.0, y - 0.2, 1.0).to(x, y - 0.2, 1.0)
    assert beside.fault() == "the arm is not in its home posture at the end"
    through = Script(table_world(cube("a", 0, 0))).to(0.0, y, 1.0).to(x - 0.2, y, 1.0).to(*HOME)
    assert through.fault().split(" (")[0] in {f"{link} hits rail" for link in ROBOT_LINKS}


def test_what_is_held_must_not_go_through_the_robots_own_base() -> None:
    """A long rod is led past the post: its end goes through, the hand keeps half a metre."""
    x, y = POST
    rod = thing("rod", (1.0, CUBE, CUBE), 0, 0, level(0))
    held = Script(table_world(rod)).over(0, 0, level(0) + GRIP).take("rod", CUBE).to(0, 0, 0.8)
    assert "rod hits rail" in held.to(x + 0.3, 0, 0.8).to(x + 0.3, y, 0.8).fault()


def test_what_is_held_must_not_touch_what_is_fixed() -> None:
    """A long rod is led past a post of the room: the robot itself keeps clear of it."""
    pole = Fixed("pole", block((0.05, 0.05, 0.3)), upright(0.3, 0.3, TOP + AIR, 0))
    rod = thing("rod", (0.8, CUBE, CUBE), 0, 0, level(0))
    world = table_world(rod, fixed=[pole])
    assert Script(world).to(0, 0, 0.5).to(0, 0.4, 0.5).home().fault() == ""
    held = Script(world).over(0, 0, level(0) + GRIP).take("rod", CUBE).to(0, 0, 0.5)
    assert "rod hits pole" in held.to(0, 0.4, 0.5).fault()


# -- what stands on what -----------------------------------------------------------------------


def tray_world(*others: Movable, tall: float = CUBE):
    """A slab of 24 x 6 x 2 cm with two boxes at its ends."""
    slab = thing("tray", (0.24, 0.06, 0.02), 0, 0, TOP + AIR)
    on_it = TOP + AIR + 0.02 + AIR
    riders = (
        thing("left", (CUBE, CUBE, tall), -0.08, 0, on_it),
        thing("right", (CUBE, CUBE, CUBE), 0.08, 0, on_it),
    )
    return table_world(slab, *riders, *others)


def carry(script: Script, x: float) -> Script:
    """Carry the tray along x."""
    script.over(0.0, 0.0, TOP + AIR + 0.012).take("tray", 0.06)
    script.over(x, 0.0, TOP + AIR + 0.012).put("tray", "table", upright(x, 0, TOP + AIR, 0), 0.07)
    return script.home()


def test_a_tray_takes_along_what_stands_on_it() -> None:
    script = carry(Script(tray_world()), 0.3)
    script.over(0.22, 0.0, TOP + AIR + 0.02 + AIR + GRIP).take("left", CUBE)
    script.over(-0.2, 0.0, level(0) + GRIP).put("left", "table", upright(-0.2, 0, level(0), 0))
    assert script.home().verdict().findings == ()


def test_what_a_tray_takes_along_must_not_touch_anything() -> None:
    """A bar hangs where the box on the tray comes by, and the tray does not."""
    bar = Fixed("bar", block((0.02, 0.02, 0.05)), upright(-0.25, 0, TOP + 0.1, 0))
    script = Script(replace(tray_world(), fixed=(*tray_world().fixed, bar)))
    script.over(0.0, 0.0, TOP + AIR + 0.012).take("tray", 0.06).to(0.0, 0.0, TOP + 0.08)
    assert "left hits bar" in script.to(-0.2, 0.0, TOP + 0.08).fault()


def test_what_is_held_and_what_stands_on_it_must_not_touch_the_robot() -> None:
    """The bridge of the gantry is above: long things must not be lifted into it."""
    posts = [Part(Box((0.01, 0.01, 0.6)), upright(x, 0, 0.3, 0)) for x in (-0.06, 0.06)]
    slab = Part(Box((0.14, 0.04, 0.02)), upright(0, 0, 0.01, 0))
    fork = Movable("fork", Body((slab, *posts), 0.2, (0.0, 0.0, 0.2)), upright(0, 0, TOP + AIR, 0))
    script = Script(table_world(fork)).over(0, 0, TOP + AIR + 0.012).take("fork", 0.04)
    low, high = script.to(0, 0, 1.0), 1.2
    assert low.fault() == "fork is still held at the end"
    assert "fork hits bridge" in script.to(0, 0, high).fault()
    script = Script(tray_world(tall=0.6)).over(0, 0, TOP + AIR + 0.012).take("tray", 0.06)
    assert "left hits bridge" in script.to(0, 0, high).fault()


@pytest.mark.parametrize("tall", [0.2, 0.6])
def test_a_tall_box_on_a_tray_tips_where_the_gantry_is_as_quick_as_it_can(tall) -> None:
    """At 1 m/s2 a box of 4 x 4 cm tips that is taller than 40 cm."""
    found = carry(Script(tray_world(tall=tall)), 0.3).fault()
    assert found == ("left tips over on what it is carried on" if tall > 0.4 else "")


@pytest.mark.parametrize("share", [0.8, 1.25])
def test_a_tall_box_tips_as_well_where_base_and_arm_may_move_at_once(share) -> None:
    """By a polynomial whose largest acceleration is 5.77 distance / time^2, within all limits."""
    tall, way = 0.6, 0.4
    push = share * 9.81 * CUBE / tall
    seconds = math.ceil(math.sqrt(5.774 * way / push) / 0.05) * 0.05
    script = Script(tray_world(tall=tall)).over(0, 0, TOP + AIR + 0.012).take("tray", 0.06)
    script.to(0, 0, script.at[2] + 0.05)
    times = np.arange(round(seconds / 0.05) + 1) * 0.05
    s = times / seconds
    path = np.tile(np.array(script.at), (len(s), 1))
    path[:, 0] += way * (10 * s**3 - 15 * s**4 + 6 * s**5)
    lifted = script.plan()
    swing = TimedPiece(Together(np.zeros((len(s), 3)), path, np.full(len(s), 0.06)), times)
    (action,) = lifted.actions
    plan = replace(lifted, actions=(replace(action, pieces=(*action.pieces, swing)),))
    found = certify(plan, script.world, gantry()).findings[0].message
    assert found == (
        "left tips over on what it is carried on" if share > 1 else "tray is still held at the end"
    )


@pytest.mark.parametrize(("lean", "loaded"), [(0.09, True), (0.11, True), (0.11, False)])
def test_what_bears_something_is_carried_level(lean, loaded) -> None:
    """What leans less than friction holds is spilt all the same: the limit is a tenth."""
    world = tray_world()
    if not loaded:
        world = replace(world, movables=world.movables[:1], supports=world.supports[:1])
    script = Script(world).over(0, 0, TOP + AIR + 0.012).take("tray", 0.06).to(0, 0, 0.8)
    moves = [
        replace(piece, path=np.column_stack([piece.path, np.zeros(len(piece.path))]))
        if isinstance(piece, ArmMove)
        else piece
        for piece in script.pieces
    ]
    turn = ArmMove(np.array([(*script.at, 0.0), (*script.at, lean)]), "free")
    script.robot, script.pieces = tilting_gantry(), [*moves, turn]
    spilt = "tray leans: what stands on it slides off"
    assert script.fault() == (spilt if loaded and lean > 0.1 else "tray is still held at the end")


def test_what_stands_on_two_things_bars_both() -> None:
    step = thing("step", (0.06, 0.04, 0.02), -0.15, 0, TOP + AIR)
    world = tray_world(step)
    bridge = thing("bridge", (0.1, 0.03, 0.02), -0.13, 0, TOP + AIR + 0.02 + AIR)
    supports = (world.supports[0], top_of(world.movables[0]), top_of(step))
    world = replace(world, movables=(world.movables[0], step, bridge), supports=supports)
    assert "bridge stands on tray, and on top of step as well" in carry(Script(world), 0.3).fault()


def test_a_load_beyond_the_payload_is_refused() -> None:
    world = tray_world()
    heavy = tuple(replace(m, body=replace(m.body, mass=1.0)) for m in world.movables)
    assert "3.00 kg are too heavy" in carry(Script(replace(world, movables=heavy)), 0.3).fault()


# -- doors, drawers and pushes -----------------------------------------------------------------


def pull(reach: float, way: float, gap: float = 0.001) -> Script:
    """Push a drawer along x with closed fingers, from a gap behind it."""
    box = drawer(0.0, 0.0, reach)
    script = Script(table_world(cube("a", -0.4, 0.3), fixed=[box])).fingers(0.0)
    behind = -0.05 - 0.01 - gap  # half of the drawer, half of the fingers
    low = TOP + 0.06
    script.over(behind, 0.0, low)
    return script.to(behind + way, 0.0, low, "drawer", box.pose).home()


def test_a_drawer_follows_the_hand_along_its_rails() -> None:
    assert pull(0.2, 0.15).verdict().findings == ()
    assert "beyond the end of its guide" in pull(0.1, 0.15).fault()
    assert "the gripper is" in pull(0.2, 0.15, gap=0.01).fault()


def test_what_has_no_guide_is_not_moved() -> None:
    script = pull(0.2, 0.15)
    fixed = tuple(replace(thing, guide=None) for thing in script.world.fixed)
    script.world = replace(script.world, fixed=fixed)
    assert "drawer is moved, which is fixed" in script.fault()


def test_a_drawer_that_leaves_its_rails_is_told() -> None:
    script = pull(0.2, 0.15)
    move = next(piece for piece in script.pieces if getattr(piece, "along", ()))
    move.along[0].poses[1, 1] += 0.01
    assert "leaves its guide" in script.fault()


@pytest.mark.parametrize(
    ("way", "word"), [(0.1, ""), (0.7, "not on what it could rest on"), (0.52, "tips")]
)
def test_a_cube_is_pushed_as_far_as_the_table_goes(way, word) -> None:
    world = table_world(cube("a", 0, 0))
    script = Script(world).fingers(0.0).over(-CUBE / 2 - 0.011, 0.0, level(0) + 0.012)
    script.to(-CUBE / 2 - 0.011 + way, 0.0, level(0) + 0.012, "a", world.movables[0].pose)
    found = script.home().fault()
    assert word in found if word else not found


def test_what_bears_something_is_not_pushed() -> None:
    world = table_world(cube("a", 0, 0), cube("b", 0, 0, level(1)))
    script = Script(world).fingers(0.0).over(-CUBE / 2 - 0.011, 0.0, TOP + 0.04)
    script.to(0.1, 0.0, TOP + 0.04, "a", world.movables[0].pose)
    assert "pushed while something stands on it" in script.fault()


# -- ends --------------------------------------------------------------------------------------


def test_a_goal_may_be_to_hold_something() -> None:
    world = table_world(cube("a", 0, 0), goals=[IsHeld("a")])
    script = Script(world).over(0, 0, level(0) + GRIP).take("a", CUBE).home()
    assert script.verdict().findings == ()
    other = Script(replace(world, goals=()))
    other.pieces = script.pieces
    assert "still held" in other.fault()
    assert "a is not held" in Script(world).home().fault()


def test_a_fixed_base_does_not_drive() -> None:
    plan = Script(table_world(cube("a", 0, 0))).home().plan()
    drive = TimedPiece(BaseMove(np.array([[0.0, 0, 0], [0.5, 0, 0]])), np.array([0.0, 60.0]))
    (action,) = plan.actions
    moved = replace(plan, actions=(replace(action, pieces=(*action.pieces, drive)),))
    found = certify(moved, table_world(cube("a", 0, 0)), gantry()).findings
    assert "the base moves, which is fixed" in found[0].message


def test_an_object_lies_on_its_side_where_it_is_put_so() -> None:
    """A stick is gripped lying; where it is put, its frame is turned as it was."""
    lying = np.array([[0.0, 0, 1, -0.1], [0, 1, 0, 0], [-1, 0, 0, TOP + AIR + 0.02]])
    stick = Movable("stick", block((0.04, 0.04, 0.2)), lying)
    world = table_world(cube("a", 0.4, 0.4))
    world = replace(world, movables=(stick,), supports=world.supports[:1])
    there = lying.copy()
    there[1, 3] = 0.3
    script = Script(world).over(0, 0, TOP + AIR + 0.02).take("stick", 0.04)
    script.over(0, 0.3, TOP + AIR + 0.02).put("stick", "table", there, 0.05).home()
    assert script.verdict().findings == ()
