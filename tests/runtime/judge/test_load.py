"""What stands on a carried body: when it slides, and when it tips, against what a formula says."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from runtime.judge.grip import FRICTION, GRAVITY
from runtime.judge.load import DENT, STRETCH, Load, accelerations, even_times, loads_of
from runtime.world.poses import upright
from tests.runtime.judge.gantry import AIR, CUBE, TOP, table_world, thing

SQUARE = np.array([[-0.025, -0.025], [0.025, -0.025], [0.025, 0.025], [-0.025, 0.025]])


def block(centre_height: float) -> Load:
    """On a foot of 5 by 5 cm, its centre of mass at a height above that."""
    return Load("block", np.array([0.0, 0.0, centre_height]), SQUARE, 0.0, np.eye(4))


def pushed(load: Load, x: float, y: float = 0.0, carried: np.ndarray | None = None) -> str | None:
    poses = np.eye(4)[None] if carried is None else carried[None]
    return load.fault(poses, np.array([[x, y, 0.0]]))


@pytest.mark.parametrize("share", [0.5, 0.97, 1.03])
def test_a_low_block_slides_at_the_limit_of_friction(share) -> None:
    fault = pushed(block(0.01), share * FRICTION * GRAVITY)
    assert ("slides" in str(fault)) == (share > 1)


@pytest.mark.parametrize("share", [0.8, 0.95, 1.1])
def test_a_tall_block_tips_before_it_slides(share) -> None:
    height = 0.1
    limit = GRAVITY * 0.025 / height  # where the force goes through the edge of its foot
    assert limit < FRICTION * GRAVITY
    fault = pushed(block(height), share * limit)
    assert ("tips" in str(fault)) == (share > 1.05)
    # Over a corner it takes more.
    corner = share * limit / math.sqrt(2)
    assert pushed(block(height), corner, corner) is None or share > 1.05


@pytest.mark.parametrize("count", [1, 2, 4])
@pytest.mark.parametrize("share", [0.95, 1.05])
def test_a_tower_tips_as_one_body_would(count, share, rng) -> None:
    """About the foot of the lowest block, with the mass of all: the others keep on it."""
    for _ in range(10):
        sizes, z = rng.uniform(0.12, 0.3, count), TOP + AIR + 0.02
        slab = thing("slab", (0.2, 0.2, 0.02), 0.0, 0.0, TOP + AIR)
        blocks, foot = [], z + AIR
        for number, size in enumerate(sizes):
            made = thing(f"b{number}", (CUBE, CUBE, size), 0.0, 0.0, z + AIR)
            blocks.append(replace(made, body=replace(made.body, mass=rng.uniform(0.1, 1.0))))
            z += AIR + size
        world = table_world(slab, *blocks)
        poses = {
            i: np.vstack([upright(0.0, 0.0, m.pose[2, 3], 0.0), [0.0, 0.0, 0.0, 1.0]])
            for i, m in enumerate(world.movables)
        }
        loads = loads_of(world, poses, 0, list(poses))
        assert [load.name for load in loads] == [block.name for block in blocks]
        masses = np.array([block.body.mass for block in blocks])
        heights = np.array([b.pose[2, 3] + b.body.centre[2] for b in blocks]) - foot
        limit = GRAVITY * (CUBE / 2 + DENT) / (masses @ heights / masses.sum())
        assert limit < FRICTION * GRAVITY
        push = np.array([[0.0, share * limit, 0.0]])
        faults = [load.fault(poses[0][None], push) for load in loads]
        assert faults[0] == ("b0 tips over on what it is carried on" if share > 1 else None)
        assert count == 1 or share > 1 or faults[1:] == [None] * (count - 1)


def test_a_tray_that_leans_is_as_good_as_one_that_is_pushed() -> None:
    def leaning(angle: float) -> np.ndarray:
        c, s = math.cos(angle), math.sin(angle)
        return np.array([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1.0]])

    assert pushed(block(0.02), 0.0, carried=leaning(0.9 * math.atan(FRICTION))) is None
    assert "slides" in str(pushed(block(0.02), 0.0, carried=leaning(1.1 * math.atan(FRICTION))))
    # Leaning into the push, as a waiter does, makes up for it.
    push = GRAVITY * math.tan(0.4)
    assert pushed(block(0.1), push, carried=leaning(0.4)) is None
    assert pushed(block(0.1), push) is not None


def test_accelerations_are_those_of_the_motion() -> None:
    times = even_times(np.array([0.0, 2.0]))
    x = np.where(times < 0, 0.0, np.where(times > 2, 2.0, times**2 / 2))
    found = accelerations(np.column_stack([x, np.zeros_like(x), np.zeros_like(x)]))
    inside = (times > 2 * STRETCH) & (times < 2 - 2 * STRETCH)
    assert np.allclose(found[inside, 0], 1.0)
    # The halt at the end is no gentle one.
    assert np.abs(found[:, 0]).max() > 5.0
