"""What objects and placements are called where people read of them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from domains.tabletop.state import Placement
    from domains.tabletop.world import TabletopWorld


def object_name(world: TabletopWorld, index: int) -> str:
    """The name that the scene gives an object."""
    return world.scene.objects[index].name


def placement_name(world: TabletopWorld, placement: Placement) -> str:
    """`(x, y) on SUPPORT`, in metres, and the heading in degrees where that is not 0."""
    x, y, yaw = placement.pose
    degrees = round(math.degrees(yaw)) % 360
    turned = f" at {degrees} degrees" if degrees else ""
    return f"({x:.2f}, {y:.2f}) on {world.grounds[placement.support].name}{turned}"
