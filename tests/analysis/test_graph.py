"""Pictures: what they show, that the formats are well formed, that nothing lies on top."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable
from itertools import combinations

import pytest

from sketchlang.analysis.graph import dot, mermaid, svg
from sketchlang.analysis.graph.drawing import (
    COLOURS,
    UNREMOVED,
    Arrow,
    Drawing,
    Look,
    TooLargeError,
)
from sketchlang.analysis.graph.drawing import ENDLESS as ENDLESS_COLOUR
from sketchlang.analysis.graph.layout import lay_out
from sketchlang.analysis.graph.removal import Removal
from sketchlang.analysis.graph.views import VIEWS
from sketchlang.analysis.termination import Terminating, decide_termination
from sketchlang.model import Effect, Feature, Kind, Rule, SketchModel
from tests.analysis.known import KNOWN
from tests.analysis.random_sketches import random_sketch
from tests.analysis.reference import policy_graph

PICK_AND_PLACE = next(k for k in KNOWN if k.name == "pick_and_place").variant(True, False)
ENDLESS = next(k for k in KNOWN if k.name == "pick_and_place_with_v_free").variant(True, False)


def draw(sketch: SketchModel, view: str) -> Drawing:
    return VIEWS[view](sketch, decide_termination(sketch))


def test_groups_of_pick_and_place() -> None:
    drawing = draw(PICK_AND_PLACE, "groups")
    looks = {box.lines[0]: box.look for box in drawing.boxes}
    assert looks == {
        "{!H, m = 0}": Look.GOAL,
        "{!H, m > 0, u = 0}": Look.PLAIN,
        "{!H, m > 0, u > 0, v > 0}": Look.PLAIN,
        "{!H, m > 0, u > 0, v = 0}": Look.GAP,
        "{H, I}": Look.PLAIN,
        "{H, !I}": Look.PLAIN,
    }
    assert [step for step, _ in drawing.legend] == [1, 2, 3, 4]
    # Every arrow is removed by the proof.
    assert all(arrow.step is not None for arrow in drawing.arrows)


def test_the_cycle_is_drawn() -> None:
    for view in VIEWS:
        drawing = draw(ENDLESS, view)
        red = through_bundles(drawing, lambda arrow: arrow.endless)
        assert len(red) == 4
        assert {source for source, _, _ in red} == {target for _, target, _ in red}


def test_the_policy_view_has_the_edges_of_the_policy_graph() -> None:
    for seed in range(100):
        sketch = random_sketch(seed)
        key = {}
        for before, _, after in policy_graph(sketch):
            for valuation in (before, after):
                bits = sum(bit << f for f, bit in enumerate(valuation))
                key[valuation] = f"v{bits}"
        names = [rule.name for rule in sketch.rules]
        expected = {(key[a], key[b], names[rule]) for a, rule, b in policy_graph(sketch)}
        assert through_bundles(draw(sketch, "policy")) == expected


def through_bundles(
    drawing: Drawing, drawn: Callable[[Arrow], bool] = lambda arrow: True
) -> set[tuple[str, str, str]]:
    """From where, to where and by which rule arrows lead, past the boxes at which they part."""
    parts = {box.key for box in drawing.boxes if box.look is Look.RULE}
    into = {arrow.target: arrow.source for arrow in drawing.arrows if arrow.target in parts}
    # A box at which arrows part has one that comes in, and leads on to several.
    assert len(into) == sum(arrow.target in parts for arrow in drawing.arrows) == len(parts)
    assert all(sum(a.source == box for a in drawing.arrows) > 1 for box in parts)
    return {
        (into.get(arrow.source, arrow.source), arrow.target, rule)
        for arrow in drawing.arrows
        if arrow.target not in parts and drawn(arrow)
        for rule in arrow.rules or ("",)
    }


def test_a_proof_removes_every_edge() -> None:
    for seed in range(200):
        sketch = random_sketch(seed)
        verdict = decide_termination(sketch)
        if isinstance(verdict, Terminating):
            removal = Removal(sketch, verdict.steps)
            for before, rule, after in policy_graph(sketch):
                bits = [sum(bit << f for f, bit in enumerate(v)) for v in (before, after)]
                assert removal.of_edge(bits[0], rule, bits[1]) is not None


@pytest.mark.parametrize("view", VIEWS)
def test_formats_are_well_formed(view: str) -> None:
    for sketch in [PICK_AND_PLACE, ENDLESS, *(random_sketch(seed, 4) for seed in range(60))]:
        drawing = draw(sketch, view)
        root = ET.fromstring(svg.write(drawing))
        texts = [text.text for text in root.iter("{http://www.w3.org/2000/svg}text")]
        assert all(line in texts for box in drawing.boxes for line in box.lines)
        text = dot.write(drawing)
        assert text.count("{\n") == 1
        assert text.endswith("}\n")
        assert text.count(" -> ") >= len(drawing.arrows)
        assert sum(" -->" in line for line in mermaid.write(drawing).splitlines()) == len(
            drawing.arrows
        )


def test_names_are_escaped() -> None:
    # The language has no such names, but a model can be made by hand.
    features = (Feature('a"<&>', Kind.NAT),)
    sketch = SketchModel('"<x>"', features, (Rule("r<1>", {0: True}, {}),))
    for view in VIEWS:
        drawing = draw(sketch, view)
        ET.fromstring(svg.write(drawing))
        assert "<1>" not in mermaid.write(drawing)
        assert '"<x>"' not in dot.write(drawing)


def test_too_large_sketches_are_refused() -> None:
    features = tuple(Feature(f"n{i}", Kind.NAT) for i in range(9))
    sketch = SketchModel("large", features, (Rule("r", {0: True}, {}),))
    for view in ("policy", "groups"):
        with pytest.raises(TooLargeError):
            draw(sketch, view)
    assert draw(sketch, "rules").boxes
    features = tuple(Feature(f"n{i}", Kind.NAT) for i in range(7))
    anything = Rule("r", {}, dict.fromkeys(range(7), Effect.ANY))
    with pytest.raises(TooLargeError):
        svg.write(draw(SketchModel("dense", features, (anything,)), "policy"))


def test_boxes_and_labels_do_not_overlap() -> None:
    for seed in range(40):
        drawing = draw(random_sketch(seed, 4), "groups")
        number = {box.key: i for i, box in enumerate(drawing.boxes)}
        arrows = [(number[arrow.source], number[arrow.target]) for arrow in drawing.arrows]
        found = lay_out([(80.0, 30.0)] * len(number), arrows, [(50.0, 15.0)] * len(arrows))
        labels = [chain.label for chain in found.chains if chain and chain.label]
        for a, b in combinations([*found.boxes, *labels], 2):
            apart_x = abs(a.x - b.x) >= (a.width + b.width) / 2 - 1e-6
            apart_y = abs(a.y - b.y) >= (a.height + b.height) / 2 - 1e-6
            assert apart_x or apart_y
        for item in [*found.boxes, *labels]:
            assert item.x - item.width / 2 >= -1e-6
            assert item.x + item.width / 2 <= found.width + 1e-6
            assert item.y + item.height / 2 <= found.height + 1e-6


def luminance(colour: str) -> float:
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def test_all_colours_can_be_read() -> None:
    """Text and arrows on white, and text on the fills: a contrast of 4.5 to 1 (WCAG 2.1, AA)."""
    for ink in (*COLOURS, ENDLESS_COLOUR, UNREMOVED):
        for paper in ("#ffffff", "#d9f2d9", "#fde0d9"):
            low, high = sorted((luminance(ink), luminance(paper)))
            needed = 4.5 if paper == "#ffffff" else 3.0  # on fills they are only borders
            assert (high + 0.05) / (low + 0.05) >= needed, (ink, paper)


@pytest.mark.parametrize("view", ["groups", "policy"])
def test_each_valuation_is_in_one_box_and_the_start_is_marked(view: str) -> None:
    verdict = decide_termination(PICK_AND_PLACE)
    for start in (0b00100, 0b10100, 0b00011):
        drawing = VIEWS[view](PICK_AND_PLACE, verdict, start)
        covered = [pattern for box in drawing.boxes for pattern in box.covers]
        assert len(covered) == len(set(covered))
        (here,) = [box for box in drawing.boxes if box.start]
        assert format(start, "05b")[::-1] in here.covers
        assert "start" in here.lines
        text = svg.write(drawing)
        assert all(f'data-box="{box.key}"' in text for box in drawing.boxes)
        assert {rule for arrow in drawing.arrows for rule in arrow.rules} <= {
            rule.name for rule in PICK_AND_PLACE.rules
        }


def test_rules_show_their_conditions() -> None:
    lines = [box.lines for box in draw(PICK_AND_PLACE, "rules").boxes]
    assert any("if !H, m > 0, u = 0" in each for each in lines)
    assert len([each for each in lines if each[1].startswith("if ")]) == len(PICK_AND_PLACE.rules)
