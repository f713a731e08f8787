"""Scenes seen from above: what is drawn is where it is."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from domains.tabletop.picture import view_of_file
from runtime.show.top_picture import TopPicture
from runtime.show.top_text import Grid, draw, symbols_of
from runtime.show.top_view import Patch, Sort, Thing, TopView, contains, outline
from sketchlang.library import find_scene
from tests.trust.hostile import names

coordinates = st.integers(-50, 50).map(lambda value: value / 10)
clouds = st.lists(st.tuples(coordinates, coordinates), min_size=3, max_size=12)


@settings(max_examples=100, deadline=None)
@given(clouds)
def test_outlines_are_convex_and_hold_all_points(points: list[tuple[float, float]]) -> None:
    corners = outline(np.array(points))
    assert set(corners) <= set(points)
    if len(corners) > 2:
        assert all(contains(corners, x, y) for x, y in points)
        for i in range(len(corners)):  # no corner could be left out
            rest = corners[:i] + corners[i + 1 :]
            assert len(rest) < 3 or not contains(rest, *corners[i])


def scene(name: str) -> TopView:
    path, shown = find_scene(name)
    return view_of_file(str(path), shown)


@pytest.mark.parametrize("name", ["sorting/4t-07", "desk/sort", "words/tamp", "stack/tower"])
@pytest.mark.parametrize("width", [60, 100])
def test_objects_are_drawn_where_they_are(name: str, width: int) -> None:
    view, grid = scene(name), Grid(scene(name), width)
    lines = draw(view, width)
    symbols = symbols_of(view)
    if name == "stack/tower":  # from above one sees the top only
        assert sum("(hidden)" in line for line in lines) == len(view.things) - 1
        return
    assert all(len(line) <= width for line in lines[: grid.rows])
    for thing in view.things:
        assert thing.middle is not None
        row, column = grid.cell(*thing.middle)
        # The cell of its middle, or one beside it where the object is smaller than a cell.
        near = "".join(line[column - 1 : column + 2] for line in lines[row - 1 : row + 2])
        assert symbols[thing.name] in near, thing
    # Supports that lie on no other cover as many cells as their area has.
    area = sum(_area(p.corners) for p in view.patches if p.sort is Sort.SUPPORT)
    drawn = sum(line.count(".") for line in lines[: grid.rows])
    if name != "desk/sort":
        assert drawn == pytest.approx(area / (2 * grid.step**2), rel=0.15)
    x, y, _ = view.robot
    row, column = grid.cell(x, y)
    assert lines[row][column] == ">"


def _area(corners: tuple[tuple[float, float], ...]) -> float:
    """The area of a polygon."""
    pairs = zip(corners, [*corners[1:], corners[0]], strict=True)
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in pairs) / 2


def test_the_drawing_has_everything() -> None:
    view = scene("kitchen/tidy")
    tree = ElementTree.fromstring(TopPicture(view).svg())
    titles = [element.text for element in tree.iter() if element.tag.endswith("title")]
    assert {thing.name for thing in view.things} <= set(titles)
    data = TopPicture(view).data()
    assert [one["name"] for one in data["objects"]] == [thing.name for thing in view.things]
    assert all(one["goal"] for one in data["objects"])


def test_colours_only_where_they_are_wanted() -> None:
    view = scene("sorting/3t-02")
    assert "\x1b" not in "\n".join(draw(view, 80))
    painted = "\n".join(draw(view, 80, colour=True))
    assert "\x1b[34ma\x1b[0m" in painted  # blue
    assert re.sub(r"\x1b\[\d+m", "", painted) == "\n".join(draw(view, 80))


def test_names_of_others_do_no_harm() -> None:
    square = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
    for name in names(200):
        view = TopView(
            name,
            (
                Patch(Sort.SUPPORT, name, square, 0.7),
                Patch(Sort.OBJECT, name, square, 0.8, name),
            ),
            (Thing(name, name, name[:1], f"on {name}", f"on {name}", (0.5, 0.5)),),
            ((name, 0.7),),
            (),
            (0.0, 0.0, 0.0),
            (f"{name} on {name}",),
        )
        assert all(line.isprintable() for line in draw(view, 60))
        ElementTree.fromstring(TopPicture(view).svg())
