"""States in which everything has a free way to its goal, but would bar another one there."""

from __future__ import annotations

from pathlib import Path

import pytest

from runtime.search.limits import Limits
from runtime.solve import Task, open_task
from sketchlang.analysis.certificate import certificate_of
from sketchlang.analysis.coverage import find_coverage
from sketchlang.analysis.termination import Terminating, decide_termination
from sketchlang.analysis.verify import verify
from sketchlang.loader import load_sketch

BAY = """
[[table]]
name = "{name}"
at = [{x}, 0.0]
size = [0.6, 1.4]
top = 0.7
[[wall]]
name = "{name} left"
at = [{x}, 0.13]
size = [0.6, 0.02, 1.0]
[[wall]]
name = "{name} right"
at = [{x}, -0.13]
size = [0.6, 0.02, 1.0]
[[wall]]
name = "{name} end"
at = [{end}, 0.0]
size = [0.02, 0.3, 1.0]
"""
STICK = """
[[object]]
name = "{name}"
size = [0.04, 0.04, 0.2]
at = [{x}, 0.0]
[[goal]]
object = "{name}"
at = [{goal}, 0.0]
"""


def swap(folder: Path, seed: int, sketch: str = "pick_and_place") -> Task:
    """Two bays; what stands in each belongs in front of what stands in the other one."""
    scene = folder / "swap.toml"
    scene.write_text(
        'robot_start = [-0.5, 0.0, 0.0]\napproaches = ["side"]\n'
        + BAY.format(name="a", x=0.8, end=1.11)
        + BAY.format(name="b", x=-1.8, end=-2.11)
        + STICK.format(name="p", x=0.8, goal=-1.7)
        + STICK.format(name="q", x=-1.8, goal=0.7)
    )
    return open_task(load_sketch(sketch).checked, str(scene), seed)


@pytest.mark.parametrize("seed", range(2))
def test_two_things_that_bar_each_other_change_places(tmp_path, seed) -> None:
    found = swap(tmp_path, seed).solve(Limits(timeout=60))
    assert found.solved
    assert found.outcome.subgoals[0].rule == "break_tie"
    assert len(found.outcome.subgoals) == 5
    assert found.plan.validate().valid


def test_the_published_rules_alone_have_nothing_to_say_there(tmp_path) -> None:
    text = load_sketch("pick_and_place").source.text
    published = tmp_path / "published.sketch"
    published.write_text("\n".join(x for x in text.split("\n") if "rule break_tie" not in x))
    task = swap(tmp_path, 0, str(published))
    names = [feature.name for feature in task.sketch.model.features]
    values = dict(zip(names, task.sketch.evaluate(task.problem.initial), strict=True))
    assert values == {"H": 0, "I": 0, "m": 2, "u": 1, "v": 0}
    assert not task.solve(Limits(timeout=60, rejections=40)).solved


def test_the_built_in_sketch_provides_for_every_valuation_and_terminates() -> None:
    model = load_sketch("pick_and_place").checked.model
    found = find_coverage(model)
    assert (found.gaps, found.dead) == ((), ())
    verdict = decide_termination(model)
    assert isinstance(verdict, Terminating)
    verify(certificate_of(model, verdict), model)
