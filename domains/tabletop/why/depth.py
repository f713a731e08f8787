"""How deep a support lies between things that stand around it, such as the walls of a bin."""

from __future__ import annotations

from typing import TYPE_CHECKING

from runtime.kernels.plane import point_distance

if TYPE_CHECKING:
    from domains.tabletop.ground import Ground
    from domains.tabletop.world import TabletopWorld

BESIDE = 0.05
"""Metres beyond a support at which walls still count as around it, and from which they count as
deep."""


def depth_of(world: TabletopWorld, ground: Ground) -> float:
    """Metres that what never moves rises above a support of furniture on all four sides of it."""
    if ground.owner is not None:
        return 0.0
    hx, hy = ground.half
    statics = world.statics_at(float(ground.pose[0, 3]), float(ground.pose[1, 3]))
    rising = [row for row in statics if row[2] - row[5] < ground.height + BESIDE]
    sides = [ground.outside(*side) for side in ((hx, 0.0), (-hx, 0.0), (0.0, hy), (0.0, -hy))]
    lowest = min(
        max(
            (
                float(row[2] + row[5]) - ground.height
                for row in rising
                if point_distance(row, x, y) < BESIDE
            ),
            default=0.0,
        )
        for x, y in sides
    )
    return max(0.0, lowest)


def in_words(world: TabletopWorld, ground: Ground) -> str:
    """The same in words, for after the support's name; nothing where it is not deep."""
    depth = depth_of(world, ground)
    return f" ({100 * depth:.0f} cm deep)" if depth > BESIDE else ""


def is_beyond_the_estimate(world: TabletopWorld, index: int, ground: Ground) -> bool:
    """Whether walls around a support rise higher than the volumes that an approach to an object
    there is known to sweep: whether the arm above comes past them only X can tell."""
    depth = depth_of(world, ground)
    if depth <= BESIDE:
        return False
    known = max(
        world.hold(index, family, 0.0).height + float(world.hand.sweeps[family][:, 5].max())
        for family in world.families
    )
    return depth > known
