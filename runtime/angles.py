"""Arithmetic on angles in radians."""

from __future__ import annotations

import math


def wrap(angle: float) -> float:
    """An angle in (-pi, pi]."""
    return angle - 2 * math.pi * math.ceil((angle - math.pi) / (2 * math.pi))
