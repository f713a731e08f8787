"""What stands on a carried body: when it slides, and when it tips, against what a formula says."""

from __future__ import annotations

import math

import numpy as np
import pytest

from runtime.judge.grip import FRICTION, GRAVITY
from runtime.judge.load import STRETCH, Load, accelerations, even_times

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
