"""What scene files mean, and how their mistakes are reported."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from domains.tabletop.scene.load import load_scene
from domains.tabletop.scene.model import (
    AnyGoal,
    HeldGoal,
    PoseGoal,
    RegionGoal,
    Scene,
    WordGoal,
)
from runtime.kernels.boxes import pose_vs_upright
from sketchlang.errors import InputError
from sketchlang.library import built_in_scenes, find_scene
from tests.tabletop.scene.texts import SCENE, WORD, example_of_the_documentation, write_scene

TABLETOP = [
    name
    for name in built_in_scenes()
    if not name.startswith(("blocks", "delivery")) and find_scene(name)[0].suffix == ".toml"
]
NAMED_IN_THE_CONTRACT = {
    "sorting/1t-20",
    "sorting/3t-02",
    "sorting/3t-25",
    "sorting/4t-07",
    "sorting/4t-28",
    "non_monotonic/2t-11",
    "words/tamp",
    "words/robot",
}


def read(folder: Path, text: str) -> Scene:
    return load_scene(write_scene(folder, text))


def mistake(folder: Path, text: str) -> InputError:
    with pytest.raises(InputError) as caught:
        read(folder, text)
    return caught.value


# -- what is read ------------------------------------------------------------------------------


def test_things_are_where_the_file_says(tmp_path) -> None:
    scene = read(tmp_path, SCENE)
    assert scene.robot_start == (-0.5, 0.0, 0.0)
    assert [surface.name for surface in scene.surfaces] == ["left", "right"]
    assert scene.surfaces[0].half == (0.45, 0.3)
    assert scene.surfaces[0].rest == 0.767
    red = scene.objects[1]
    assert (red.name, red.size, red.rests.support) == ("red1", (0.04, 0.05, 0.2), 0)
    assert red.start == pytest.approx((0.9, 0.7, math.radians(30)))
    wall = next(obstacle.box for obstacle in scene.obstacles if obstacle.name == "divider")
    assert wall.centre == (0.8, -0.2, 0.6)


def test_tables_are_solid_down_to_the_floor(tmp_path) -> None:
    scene = read(tmp_path, SCENE)
    table = next(obstacle.box for obstacle in scene.obstacles if obstacle.name == "left")
    assert table.centre[2] - table.size[2] / 2 == 0.0
    assert table.centre[2] + table.size[2] / 2 == 0.765


def test_the_fence_encloses_a_square(tmp_path) -> None:
    scene = read(tmp_path, SCENE)
    panels = [obstacle.box for obstacle in scene.obstacles if "fence" in obstacle.name]
    assert len(panels) == 4
    for x, y, inside in [
        (2.49, 2.49, False),
        (2.52, 0, True),
        (-2.52, 2.52, True),
        (0, 2.6, False),
    ]:
        assert any(
            abs(lx) <= panel.size[0] / 2 and abs(ly) <= panel.size[1] / 2
            for panel in panels
            for lx, ly in [panel.local(x, y)]
        ) == inside  # fmt: skip


def test_goals_by_colour_name_and_point(tmp_path) -> None:
    scene = read(tmp_path, SCENE)
    assert scene.goals == {0: RegionGoal(1), 1: PoseGoal(1, 0.9, -1.0, None, 0.005)}


def test_goal_at_the_start_is_where_the_object_began(tmp_path) -> None:
    scene = read(tmp_path, SCENE.replace("at = [0.9, -1.0]", 'at = "start"'))
    assert scene.goals[1] == PoseGoal(0, 0.9, 0.7, None, 0.005)


def test_word_goal(tmp_path) -> None:
    scene = read(tmp_path, WORD)
    assert scene.word == WordGoal("AB", 1, 0.07, 0.005)


def test_objects_rest_two_millimetres_above_a_table_that_does_not_say(tmp_path) -> None:
    scene = read(tmp_path, SCENE.replace("rest = 0.767\n", ""))
    assert scene.surfaces[0].rest == pytest.approx(0.767)


def test_surface_contains_what_is_on_its_turned_region(tmp_path) -> None:
    left = read(tmp_path, SCENE).surfaces[0]
    assert left.contains(0.8, 1.04)  # 0.9 m along y, for the table is turned by 90 degrees
    assert not left.contains(0.8 + 0.44, 0.6)
    assert left.contains(0.8, 1.04, inset=0.005)
    assert not left.contains(0.8, 1.04, inset=0.02)


def test_packed_boxes_touch_what_the_boxes_touch(tmp_path) -> None:
    scene = read(tmp_path, SCENE)
    pose = np.eye(3, 4)
    for x, y, hit in [(0.8, 0.6, True), (0.8, 1.06, False), (1.11, 0.6, False), (0.8, -0.2, True)]:
        pose[:, 3] = x, y, 0.3
        half = np.full(3, 0.001)
        found = any(pose_vs_upright(pose, half, 0.002, row, 0.0) for row in scene.obstacle_rows)
        assert found == hit


def test_the_digest_is_that_of_the_text(tmp_path) -> None:
    assert read(tmp_path, SCENE).digest == read(tmp_path, SCENE).digest
    assert read(tmp_path, SCENE).digest != read(tmp_path, SCENE + "# a remark\n").digest


@pytest.mark.parametrize("name", TABLETOP)
def test_built_in_scenes_load(name) -> None:
    path, shown = find_scene(name)
    scene = load_scene(path, shown)
    assert scene.name == name
    assert scene.goals or scene.word


def test_the_contract_s_scenes_are_built_in() -> None:
    assert set(built_in_scenes()) >= NAMED_IN_THE_CONTRACT


def test_the_number_in_a_name_counts_the_tables_and_the_objects() -> None:
    for name in TABLETOP:
        found = re.fullmatch(r".*/(\d)t-(\d\d)", name)
        if found:
            scene = load_scene(*find_scene(name))
            assert len(scene.surfaces) == int(found[1])
            assert len(scene.objects) == int(found[2])


def test_the_example_of_the_documentation_loads(tmp_path) -> None:
    scene = read(tmp_path, example_of_the_documentation())
    assert [thing.name for thing in scene.objects] == ["blue_stick", "can", "cup", "lid"]
    names = [support.name for support in scene.supports]
    assert names[:7] == ["left", "right", "shelf/1", "shelf/2", "bin", "peg", "floor"]
    assert scene.goals[0] == RegionGoal(1)
    assert scene.goals[2] == PoseGoal(1, 0.9, -1.1, pytest.approx(math.pi / 2), 0.005)
    assert scene.goals[1] == AnyGoal((RegionGoal(4), RegionGoal(2), HeldGoal()))
    can, lid = scene.objects[1], scene.objects[3]
    assert can.stable[can.rests.stable].rolls
    assert names[lid.rests.support] == "cup"


# -- mistakes ----------------------------------------------------------------------------------

MISTAKES = {
    "unknown key": (("height = 0.4", "height = 0.4\nhieght = 1"), "[arena]", "height"),
    "unknown key of the scene": (("robot_start", "color = 3\nrobot_start"), "scene.toml", None),
    "misspelt key": (("size = [0.9, 0.6]", "sise = [0.9, 0.6]"), "[[table]] left", "sise"),
    "missing key": (("top = 0.765\n", ""), "[[table]] left", None),
    "missing robot": (("robot_start = [-0.5, 0.0, 0.0]", ""), "robot_start", None),
    "wrong type": (("at = [0.8, 0.6]", 'at = "here"'), "[[table]] left", None),
    "wrong length": (("at = [0.8, 0.6]", "at = [0.8]"), "[[table]] left", None),
    "truth value for a number": (("top = 0.765", "top = true"), "top", None),
    "not a number": (("top = 0.765", "top = nan"), "top", None),
    "infinite": (("at = [0.8, 0.6]", "at = [inf, 0.6]"), "at", None),
    "text for a table": (("[arena]\ninner", 'arena = "big"\n#'), "arena", None),
    "table for tables": (("[[wall]]", "[wall]"), "wall", None),
    "no tables": (
        (SCENE[SCENE.index("[[table]]") : SCENE.index("[[wall]]")], ""),
        "not on a table",
        "floor",
    ),
    "no goals": ((SCENE[SCENE.index("[[goal]]") :], ""), "[[goal]]", "[[goal]]"),
    "negative size": (("size = [0.04, 0.04, 0.2]", "size = [0.04, -0.04, 0.2]"), "blue1", None),
    "zero size": (("size = [0.04, 0.04, 0.2]", "size = [0.0, 0.04, 0.2]"), "blue1", None),
    "negative table": (("size = [0.9, 0.6]", "size = [-0.9, 0.6]"), "left", None),
    "negative region": (("rest = 0.767", "rest = 0.767\nregion = [-1, 0.5]"), "region", None),
    "region too large": (("rest = 0.767", "rest = 0.767\nregion = [1, 0.5]"), "region", None),
    "table below the floor": (("top = 0.765", "top = -0.765"), "top", None),
    "enormous table": (("size = [0.9, 0.6]", "size = [900, 600]"), "size", None),
    "far away": (("at = [0.8, 0.6]", "at = [800000, 0.6]"), "at", None),
    "fence inside out": (("outer = 2.55", "outer = 2.45"), "outer", None),
    "rest inside the table": (("rest = 0.767", "rest = 0.7"), "rest", "0.767"),
    "rest on the table": (("rest = 0.767", "rest = 0.765"), "rest", "0.767"),
    "bottom inside the table": (
        ("at = [0.7, 0.5]", "at = [0.7, 0.5]\nbottom = 0.6"),
        "bottom",
        "bottom",
    ),
    "bottom in the air": (("at = [0.7, 0.5]", "at = [0.7, 0.5]\nbottom = 0.9"), "bottom", "bottom"),
    "two tables of a name": (('name = "right"', 'name = "left"'), "left", None),
    "two objects of a name": (('name = "red1"', 'name = "blue1"'), "blue1", None),
    "objects overlap": (("at = [0.9, 0.7]", "at = [0.71, 0.52]"), "red1", "apart"),
    "object in a wall": (("at = [0.8, -0.2]", "at = [0.8, 0.5]"), "blue1", "apart"),
    "object off any table": (("at = [0.7, 0.5]", "at = [0.0, 0.5]"), "blue1", "left"),
    "goal for an unknown object": (('object = "red1"', 'object = "red2"'), "red2", "red1"),
    "goal for an unknown colour": (
        ('\ncolour = "blue"\non', '\ncolour = "bleu"\non'),
        "bleu",
        "blue",
    ),
    "goal on an unknown table": (('on = "right"', 'on = "rihgt"'), "rihgt", "right"),
    "goal off any table": (("at = [0.9, -1.0]", "at = [0.0, -1.0]"), "(0, -1)", "right"),
    "goal without object": (('object = "red1"\n', ""), "colour", None),
    "goal twice": (('object = "red1"', 'object = "blue1"'), "blue1", None),
    "goal at and on": (("at = [0.9, -1.0]", 'at = [0.9, -1.0]\non = "left"'), "on", None),
    "goal for object and colour": (
        ('object = "red1"', 'object = "red1"\ncolour = "red"'),
        "colour",
        None,
    ),
    "goal of negative tolerance": (
        ("at = [0.9, -1.0]", "at = [0.9, -1.0]\ntolerance = -1"),
        "tolerance",
        None,
    ),
    "tolerance of a region": (('on = "right"', 'on = "right"\ntolerance = 1'), "tolerance", None),
    "not toml": (("[arena]", "[arena"), "scene.toml", None),
    "a number of thousands of digits": (
        ("height = 0.4", "height = 1" + "0" * 5000),
        "scene.toml",
        None,
    ),
    "nested too deeply": (("height = 0.4", "height = " + "[" * 100_000), "scene.toml", None),
}

WORD_MISTAKES = {
    "letters that are missing": (("AB", "ABBA"), "A, B", "AB"),
    "empty word": (('word = "AB"', 'word = ""'), "word", None),
    "word on an unknown table": (('on = "right"', 'on = "up"'), "up", "left, right"),
    "pitch too small": (("0.07", "0.03"), "pitch", None),
    "negative pitch": (("0.07", "-0.07"), "pitch", None),
    "word too long": (("0.07", "0.7"), "AB", None),
    "word and other goals": (
        ("pitch = 0.07", 'pitch = 0.07\n[[goal]]\ncolour = "red"\non = "left"'),
        "word",
        None,
    ),
    "two words": (
        ("pitch = 0.07", 'pitch = 0.07\n[[goal]]\nword = "A"\non = "left"\npitch = 0.07'),
        "word",
        None,
    ),
}


def check_mistake(folder: Path, text: str, change: tuple[str, str], word: str, hint: str | None):
    assert change[0] in text
    error = mistake(folder, text.replace(*change, 1))
    assert error.place is not None
    assert str(folder / "scene.toml") in error.place
    assert word in str(error).replace(str(folder), "")
    if hint is not None:
        assert hint in (error.hint or "")


@pytest.mark.parametrize(("change", "word", "hint"), MISTAKES.values(), ids=MISTAKES)
def test_mistakes_name_file_place_and_cure(tmp_path, change, word, hint) -> None:
    check_mistake(tmp_path, SCENE, change, word, hint)


@pytest.mark.parametrize(("change", "word", "hint"), WORD_MISTAKES.values(), ids=WORD_MISTAKES)
def test_mistakes_of_words_name_file_place_and_cure(tmp_path, change, word, hint) -> None:
    check_mistake(tmp_path, WORD, change, word, hint)


def test_a_missing_file_is_named(tmp_path) -> None:
    with pytest.raises(InputError, match="no such file"):
        load_scene(tmp_path / "missing.toml")


def test_a_folder_is_not_a_scene(tmp_path) -> None:
    with pytest.raises(InputError, match="is a directory"):
        load_scene(tmp_path)


def test_a_file_that_is_not_text_is_named(tmp_path) -> None:
    path = tmp_path / "scene.toml"
    path.write_bytes(SCENE.encode() + b"# \xff\xfe\n")
    with pytest.raises(InputError, match="UTF-8") as caught:
        load_scene(path)
    assert caught.value.place == str(path)


NUMBERS = re.compile(r"-?\d+(?:\.\d+)?")
LINES = SCENE.splitlines()
VALUES = ["0", "-1", "1e-9", "1e9", "nan", '"x"', "[]", "[[]]", "{}", "true", "[1, 2, 3, 4]"]


@settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_any_change_gives_a_scene_or_an_input_error(tmp_path: Path, data: st.DataObject) -> None:
    lines = list(LINES)
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(lines) - 1))
        match data.draw(st.sampled_from(["drop", "double", "swap", "number", "value", "text"])):
            case "drop":
                lines[at] = ""
            case "double":
                lines.insert(at, lines[at])
            case "swap":
                other = data.draw(st.integers(0, len(lines) - 1))
                lines[at], lines[other] = lines[other], lines[at]
            case "number":
                lines[at] = NUMBERS.sub(data.draw(st.sampled_from(VALUES)), lines[at], 1)
            case "value":
                key, _, _ = lines[at].partition("=")
                lines[at] = f"{key}= {data.draw(st.sampled_from(VALUES))}"
            case "text":
                lines[at] = data.draw(st.text(max_size=20)).replace("\r", "")
    place = None
    try:
        assert isinstance(read(tmp_path, "\n".join(lines)), Scene)
    except InputError as error:
        place = error.place or ""
    assert place is None or str(tmp_path) in place


# -- the library -------------------------------------------------------------------------------


def test_a_path_wins_over_a_name(tmp_path) -> None:
    path = write_scene(tmp_path)
    assert find_scene(str(path)) == (path, str(path))


@pytest.mark.parametrize("name", ["sorting/4t_07", "sortng/4t-07"])
def test_a_misspelt_scene_comes_with_the_one_that_was_meant(name) -> None:
    with pytest.raises(InputError, match="there is no scene") as caught:
        find_scene(name)
    assert "sorting/4t-07" in (caught.value.hint or "")


@pytest.mark.parametrize("name", ["", ".", "*", "a" * 300, "sorting", "sorting/", "nul\0", "/"])
def test_strange_names_are_unknown_scenes(name) -> None:
    with pytest.raises(InputError, match="there is no scene"):
        find_scene(name)
