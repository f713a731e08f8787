"""Observations of KinDER as scenes: what is seen is where the scene has it, and is well formed."""

from __future__ import annotations

import numpy as np
import pytest

from domains.tabletop.kinder.scenes import ENVS, is_known, problem_of
from domains.tabletop.kinder.slim import NEAR, gap_between, slimmed
from domains.tabletop.scene.furniture import AIR
from domains.tabletop.scene.load import load_scene
from runtime.world.poses import apply
from sketchlang.errors import InputError
from sketchlang.loader import load_sketch
from tests.tabletop.kinder.observations import OBSERVED, cuboid, observation


@pytest.mark.parametrize("env", OBSERVED)
@pytest.mark.parametrize("seed", range(3))
def test_scenes_hold_what_is_seen(tmp_path, env, seed) -> None:
    seen = OBSERVED[env](np.random.default_rng(seed))
    problem = problem_of(env, seen)
    scene = load_scene(problem.write(tmp_path, (-0.6, 0.0, 0.0)))
    movable = {thing.name: thing for thing in scene.world.movables}
    assert load_sketch(problem.sketch).ok
    assert scene.goals
    for name, thing in movable.items():
        told = seen.things[name]
        points = np.vstack(
            [apply(thing.pose @ _homogeneous(p.pose), _corners(p.solid)) for p in thing.body.parts]
        )
        bottom = told.bottom + problem.lift
        assert -1e-6 <= points[:, 2].min() - bottom <= AIR + 1e-6
        if "half_extent_x" in told.features:
            middle = (points.min(axis=0) + points.max(axis=0))[:2] / 2
            assert middle == pytest.approx(told.position[:2], abs=1e-5)
            size = (points.max(axis=0) - points.min(axis=0))[:2]
            assert (size <= 2 * np.array(told.half[:2]) + 1e-5).all()
            assert (size >= 2 * np.array(told.half[:2]) - NEAR - 1e-5).all()
    wanted = {
        n for n in seen.things if n.startswith(("cube", "cylinder", "box", "part", "target_b"))
    }
    asked = {scene.objects[i].name for i in scene.goals}
    assert asked == wanted if env != "Table3D-o2" else len(asked) == 1


def _homogeneous(pose):
    return np.vstack([pose, [0.0, 0.0, 0.0, 1.0]])


def _corners(solid):
    return getattr(
        solid,
        "points",
        np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * solid.half,
    )


def test_all_environments_are_read_and_no_others() -> None:
    assert len(ENVS) == 21
    assert all(map(is_known, ENVS))
    assert not is_known("Motion3D-p1")
    with pytest.raises(InputError, match="no reader"):
        problem_of("Motion3D-p1", observation({}))


@pytest.mark.parametrize("seed", range(5))
def test_what_nearly_touches_is_told_smaller(seed) -> None:
    """Cubes in a row, some of them next to each other or a hair in one another: then there are
    2.5 mm between all."""
    rng = np.random.default_rng(seed)
    gaps = rng.choice([-1e-4, 1e-5, 1e-3, 0.004], 5)
    x, things = 0.0, {}
    for i, gap in enumerate(gaps.tolist()):
        half = float(rng.uniform(0.01, 0.03))
        x += gap + half
        things[f"cube{i}"] = cuboid(x, 0.0, 0.0, (half, 0.02, 0.03))
        x += half
    wall = observation({"wall": cuboid(x + 0.051, 0.0, 0.0, (0.05, 0.1, 0.1))}).things["wall"]
    given = observation(things).named("cube")
    told = slimmed(given, [wall])
    for a, b in zip(told, [*told[1:], wall], strict=True):
        assert gap_between(a, b) >= NEAR - 1e-9
    for before, after in zip(given, told, strict=True):
        assert before.position == after.position
        assert before.half[0] - after.half[0] <= NEAR + 1e-4 + 1e-9
        assert before.half[2] == after.half[2]
