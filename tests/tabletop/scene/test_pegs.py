"""Pegs, what goes over them, and objects that are kept to some supports."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh

from domains.tabletop.scene.load import load_scene
from domains.tabletop.scene.model import Scene
from runtime.world.world import Peg
from sketchlang.errors import CollectedInputError, InputError
from tests.tabletop.scene.texts import write_scene

ROOM = """robot_start = [-0.3, 0.0, 0.0]

[[table]]
name = "bench"
at = [0.7, 0.0]
size = [0.8, 0.8]
top = 0.7
region = [0.2, 0.2]

[[peg]]
name = "peg"
at = [0.5, 0.1]
radius = 0.008
height = 0.06

[[peg]]
name = "low"
at = [3.0, 0.0]
radius = 0.02
height = 0.5
"""
GOAL = '\n[[goal]]\nobject = "ring"\non = "peg"\n'


def ring(name: str, keys: str) -> str:
    return f'\n[[object]]\nname = "{name}"\nmesh = "ring.stl"\n{keys}\n'


def read(folder: Path, *parts: str) -> Scene:
    trimesh.creation.annulus(0.013, 0.035, 0.025).export(folder / "ring.stl")
    return load_scene(write_scene(folder, "".join(parts)))


def said(folder: Path, *parts: str) -> str:
    with pytest.raises((InputError, CollectedInputError)) as raised:
        read(folder, *parts)
    return str(raised.value)


def test_a_peg_stands_on_what_is_there_if_beside_its_region(tmp_path) -> None:
    scene = read(tmp_path, ROOM, ring("ring", 'on = "peg"'), GOAL)
    supports = {support.name: support for support in scene.supports}
    assert supports["peg"].pose[:, 3] == pytest.approx([0.5, 0.1, 0.702])
    assert supports["peg"].peg == Peg(0.008, pytest.approx(0.058))
    assert supports["low"].pose[2, 3] == pytest.approx(0.002)
    fixed = {thing.name: thing for thing in scene.world.fixed}
    assert fixed["peg"].pose[2, 3] == pytest.approx(0.7)
    assert fixed["low"].pose[2, 3] == 0.0
    (thing,) = scene.world.movables
    assert thing.pose[:, 3] == pytest.approx([0.5, 0.1, 0.702], abs=1e-6)


def test_rings_stand_on_each_other_whatever_their_order(tmp_path) -> None:
    scene = read(tmp_path, ROOM, ring("top", 'on = "ring"'), ring("ring", 'on = "peg"'), GOAL)
    top, below = scene.world.movables
    assert top.pose[:2, 3] == pytest.approx(below.pose[:2, 3], abs=1e-6)
    assert top.pose[2, 3] - below.pose[2, 3] == pytest.approx(0.027, abs=1e-6)
    names = [support.name for support in scene.supports]
    assert names[-2:] == ["top/ring", "ring/ring"]
    assert scene.supports[scene.objects[0].rests.support].name == "ring/ring"


def test_only_what_is_hollow_goes_over_a_peg(tmp_path) -> None:
    cube = '\n[[object]]\nname = "ring"\nsize = [0.05, 0.05, 0.05]\non = "peg"\n'
    assert "does not go over 'peg': it has no hollow" in said(tmp_path, ROOM, cube, GOAL)
    wide = ring("ring", 'on = "low"')
    text = said(tmp_path, ROOM, wide, GOAL)
    assert "its hollow is" in text
    assert "0.046 m" in text


def test_an_object_is_kept_to_some_supports(tmp_path) -> None:
    keys = 'on = "peg"\nonly_on = ["peg", "low"]'
    scene = read(tmp_path, ROOM, ring("ring", keys), GOAL)
    assert scene.world.movables[0].only_on == {"peg", "low"}
    names = [scene.supports[i].name for i in sorted(scene.objects[0].only_on or ())]
    assert names == ["peg", "low"]


@pytest.mark.parametrize(
    ("keys", "goal", "message"),
    [
        ('only_on = ["low"]', 'on = "peg"', "does not name 'peg', on which it starts"),
        ('only_on = ["peg", "pg"]', 'on = "peg"', "there is no table, board, bin or object"),
        ('only_on = ["peg"]', 'on = "low"', "'ring' may not rest on 'low'"),
        ("only_on = []", 'on = "peg"', "is empty"),
    ],
)
def test_what_an_object_is_kept_to_has_to_fit_the_rest(tmp_path, keys, goal, message) -> None:
    found = said(
        tmp_path,
        ROOM,
        ring("ring", f'on = "peg"\n{keys}'),
        f'\n[[goal]]\nobject = "ring"\n{goal}\n',
    )
    assert message in found


def test_what_is_wrong_with_a_peg_is_told(tmp_path) -> None:
    beside = ROOM.replace("at = [0.5, 0.1]", 'at = [5.0, 0.1]\non = "bench"')
    assert "(5, 0.1) is not on 'bench'" in said(tmp_path, beside, ring("ring", 'on = "peg"'), GOAL)
    flat = ROOM.replace("height = 0.06", "height = 0.0")
    assert "height" in said(tmp_path, flat, ring("ring", 'on = "peg"'), GOAL)
