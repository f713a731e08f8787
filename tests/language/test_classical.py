"""Delivery and blocks: scenes, sketches, and the widths of the published table.

The search here is written for these tests alone, as literally as the definitions allow.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from domains.blocks.problem import HAND, TABLE
from domains.blocks.scene import of_towers
from domains.delivery.scene import of_map
from sketchlang.compile import CompiledSketch, compile_sketch
from sketchlang.domain import LoadOptions, SceneError
from sketchlang.loader import load_domain, load_sketch

DOMAINS = Path(__file__).parents[2] / "domains"


def sketch_of(name: str) -> CompiledSketch:
    loaded = load_sketch(name)
    assert loaded.ok
    return compile_sketch(loaded.checked)


def scene(name: str) -> Any:
    folder, _, stem = name.partition("/")
    domain = load_domain(folder)
    assert domain is not None
    assert domain.load is not None
    return domain.load(str(DOMAINS / folder / "scenes" / f"{stem}.toml"), LoadOptions())


def subgoal(sketch: CompiledSketch, before: tuple[int, ...], state: Any) -> bool:
    """A goal state, or one that satisfies a rule together with the state before."""
    after = sketch.evaluate(state)
    model = sketch.model
    return model.is_goal(after) or any(rule.satisfied_by(before, after) for rule in model.rules)


def iw(problem: Any, sketch: CompiledSketch, start: Any, k: int) -> Any | None:
    """Breadth-first search that drops every state without a new tuple of at most k atoms;
    for k = 0 only the neighbours of the start are looked at."""
    before = sketch.evaluate(start)
    seen: set[frozenset[Hashable]] = set()

    def novel(state: Any) -> bool:
        atoms = {atom for family in sketch.atoms for atom in family(state)}
        tuples = {frozenset(c) for size in range(1, k + 1) for c in combinations(atoms, size)}
        new = bool(tuples - seen)
        seen.update(tuples)
        return new

    novel(start)
    layer = [start]
    while layer:
        reached = []
        for state in layer:
            for _, after in problem.successors(state):
                if k > 0 and not novel(after):
                    continue
                if subgoal(sketch, before, after):
                    return after
                reached.append(after)
        layer = reached if k > 0 else []
    return None


def width(problem: Any, sketch: CompiledSketch, limit: int) -> int | None:
    """The largest k that IW needs on the way to the goal; None if `limit` is not enough."""
    state, largest = problem.initial, 0
    for _ in range(1000):
        if sketch.model.is_goal(sketch.evaluate(state)):
            return largest
        for k in range(limit + 1):
            found = iw(problem, sketch, state, k)
            if found is not None:
                state, largest = found, max(largest, k)
                break
        else:
            return None
    raise AssertionError("the run does not end")


@pytest.mark.parametrize(
    ("name", "one", "several"),
    [
        # Bonet and Geffner, AAAI 2021, Table 1; None: no bound.
        ("delivery_s0", 2, None),
        ("delivery_s1", 2, None),
        ("delivery_s2", 1, None),
        ("delivery_s4", 2, 2),
        ("delivery_s5", 1, 1),
        ("delivery_s6", 2, None),
        ("delivery_s7", 2, None),
        ("delivery_s8", 0, 0),
        ("delivery_policy", 0, 0),
    ],
)
def test_published_widths(name: str, one: int, several: int | None) -> None:
    sketch = sketch_of(name)
    assert width(scene("delivery/one"), sketch, 2) == one
    assert width(scene("delivery/four"), sketch, 2) == several
    if several is not None:
        assert width(scene("delivery/walls"), sketch, 2) == several


@pytest.mark.parametrize("name", ["three", "eight", "twenty"])
def test_towers_have_width_one(name: str) -> None:
    assert width(scene(f"blocks/{name}"), sketch_of("blocks_towers"), 1) == 1


def test_clearing_has_width_zero() -> None:
    assert width(scene("blocks/clear"), sketch_of("blocks_clear"), 0) == 0


def test_all_scenes_load() -> None:
    paths = [*DOMAINS.glob("delivery/scenes/*"), *DOMAINS.glob("blocks/scenes/*")]
    assert len(paths) >= 7
    for path in paths:
        problem = scene(f"{path.parent.parent.name}/{path.stem}")
        assert list(problem.successors(problem.initial))


maps = st.permutations(list("......##abc.")).map(lambda signs: [signs[:6], signs[6:]])


@given(maps, st.integers(0, 30))
def test_delivery_features(signs: list[list[str]], steps: int) -> None:
    """Feature values against the rules of the game, along a walk."""
    rows = ["A " + " ".join(signs[0]), "T " + " ".join(signs[1])]
    problem = of_map("\n".join(rows))
    sketch = sketch_of("delivery_policy")
    state = problem.initial
    for step in range(steps):
        h, p, t, n = sketch.evaluate(state)
        grid = state.grid
        assert h == (state.held is not None)
        assert n == sum(cell != grid.target for cell in state.cells)
        assert (t == 0) == (state.agent == grid.target)
        waiting = [cell for cell in state.cells if cell not in (None, grid.target)]
        assert (p == 0) == bool(h or not waiting or state.agent in waiting)
        followers = list(problem.successors(state))
        if not followers:
            return
        state = followers[(step * 7919) % len(followers)][1]


def walk(towers: list[str], choices: list[int]) -> Iterator[Any]:
    problem = of_towers(towers, [])
    state = problem.initial
    for choice in choices:
        yield state
        followers = [after for _, after in problem.successors(state)]
        state = followers[choice % len(followers)]


@given(
    st.sampled_from([["a b c", "d"], ["a", "b", "c"], ["d c b a"]]),
    st.lists(st.integers(0, 50), max_size=30),
)
def test_blocks_stay_towers(towers: list[str], choices: list[int]) -> None:
    for state in walk(towers, choices):
        below = state.below
        assert below.count(HAND) <= 1
        on_blocks = [b for b in below if b >= 0]
        assert len(set(on_blocks)) == len(on_blocks)
        for number in range(len(below)):
            path = [number]
            while below[path[-1]] >= 0:
                path.append(below[path[-1]])
                assert len(path) <= len(below)
            assert below[path[-1]] in (TABLE, HAND)


@pytest.mark.parametrize(
    ("folder", "text", "message"),
    [
        ("delivery", "map = 3", "`map` is missing or no text"),
        ("delivery", "map = '''\nA A T\n'''", "'A' is twice"),
        ("delivery", "map = '''\nA .\n'''", "no target"),
        ("delivery", "map = '''\nA T ?\n'''", "'?' in the map"),
        ("delivery", "map = '''\nA.T\n'''", "signs are set apart by blanks"),
        ("delivery", "map = ", "Invalid value"),
        ("delivery", "size = 3", "unknown key 'size'"),
        ("blocks", "towers = []", "there are no blocks"),
        ("blocks", 'towers = ["a a"]', "block 'a' is twice in `towers`"),
        ("blocks", 'towers = ["a"]\ngoal = ["b"]', "`goal` names block 'b'"),
        ("blocks", 'towers = ["a"]\nclear = "b"', "`clear` is no list of texts"),
        ("blocks", "tower = []", "unknown key 'tower'"),
    ],
)
def test_files_that_are_no_scenes(tmp_path: Path, folder: str, text: str, message: str) -> None:
    path = tmp_path / "x.toml"
    path.write_text(text)
    domain = load_domain(folder)
    assert domain is not None
    assert domain.load is not None
    with pytest.raises(SceneError) as caught:
        domain.load(str(path), LoadOptions())
    assert message in str(caught.value)
    assert str(path) in str(caught.value)
