"""Plan files of version 1 are still read, strictly, and mean the same motions."""

from __future__ import annotations

import copy
import math
from typing import Any

import pytest

from runtime.judge.certify import certify
from runtime.motion.motion import GripperMove
from sketchlang.errors import InputError
from tests.runtime.plans import Json, parse, pieces

NAMES = ("move_base", "pick", "place")


def as_version_1(data: Json) -> Json:
    """A plan of picks and places as version 1 wrote it."""
    old = copy.deepcopy(data)
    old["version"] = 1
    del old["robot"]["joints"]
    for action in old["actions"]:
        del action["text"]
        thing = action.pop("arguments").get("object")
        if thing is not None:
            action["object"] = thing
        for piece in action["pieces"]:
            if "attach" in piece:
                piece["attach"] = True
            if "release" in piece:
                x, y, z, _, _, sine, cosine = piece["release"]["pose"]
                action["placement"] = [x, y, z, 2 * math.atan2(sine, cosine)]
                piece["release"] = True
    return old


def test_it_means_the_same_motions(tmp_path, plain_data) -> None:
    new, old = parse(tmp_path, plain_data), parse(tmp_path, as_version_1(plain_data))
    assert old.execution_time == new.execution_time
    for a, b in zip(old.actions, new.actions, strict=True):
        assert a.name == b.name
        for one, two in zip(a.pieces, b.pieces, strict=True):
            assert type(one.piece) is type(two.piece)
            if isinstance(one.piece, GripperMove) and isinstance(two.piece, GripperMove):
                assert (one.piece.attach is None) == (two.piece.attach is None)
                if one.piece.release is not None and two.piece.release is not None:
                    assert one.piece.release.body == two.piece.release.body
                    assert one.piece.release.pose == pytest.approx(two.piece.release.pose, abs=1e-6)


def test_it_is_certified(tmp_path, plain_data, sticks, robot) -> None:
    assert certify(parse(tmp_path, as_version_1(plain_data)), sticks.world, robot).valid


def drop_placement(data: Json) -> None:
    next(a for a in data["actions"] if a["name"] == "place").pop("placement")


def grip_on_the_way(data: Json) -> None:
    grip = {"type": "gripper", "times": [0, 1], "opening": 0, "attach": True}
    data["actions"][0]["pieces"].append(grip)


def both(data: Json) -> None:
    next(p for _, _, p in pieces(data, "gripper") if "attach" in p)["release"] = True


@pytest.mark.parametrize(
    ("damage", "place"),
    [
        (drop_placement, "placement"),
        (grip_on_the_way, "actions[0].pieces[1]"),
        (both, "attach and release"),
        (lambda d: d["actions"][0].update(name="fly"), "actions[0].name"),
        (lambda d: d["actions"][1].update(object="pan"), "actions[1].object"),
        (lambda d: d["robot"].update(joints=[]), "robot"),
    ],
)
def test_damage_is_named_with_its_place(tmp_path, plain_data, damage: Any, place: str) -> None:
    data = as_version_1(plain_data)
    damage(data)
    with pytest.raises(InputError) as caught:
        parse(tmp_path, data)
    assert place in str(caught.value).replace(str(tmp_path), "")
