"""Whether what stands on a carried body stays there while that is moved: it neither slides nor
tips over.

Seen from the body that carries it, a load is pulled by gravity and pushed back by the
acceleration with which it is moved (d'Alembert). What is left has to go through the polygon of
its contact, within the cone of friction. Accelerations are taken over stretches of time, for
controllers round off the corners of a path.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from runtime.judge.footing import Poses, above, footings
from runtime.judge.grip import GRAVITY
from runtime.judge.polygon import convex_hull, outside_by
from runtime.judge.squeeze import FRICTION
from runtime.robot.model import MobileBase
from runtime.world.poses import Floats
from runtime.world.world import World

STRETCH = 0.1
"""Seconds over which an acceleration is taken."""

DENT = 0.001
"""Metres by which the line of the force may miss the contact."""


@dataclass(frozen=True, eq=False)
class Load:
    """Something that stands on a carried body, with all that stands on it: its centre of mass
    (3,), the polygon (k, 2) of its contact, and the height of that, in the world in which the
    carried body was gripped at the pose `start` (4, 4)."""

    name: str
    centre: Floats
    polygon: Floats
    height: float
    start: Floats

    def places(self, carried: Floats) -> Floats:
        """Where its centre of mass (N, 3) is with the carried body at poses (N, 4, 4)."""
        local = np.linalg.inv(self.start) @ [*self.centre, 1.0]
        found: Floats = (carried @ local)[:, :3]
        return found

    def fault(self, carried: Floats, push: Floats) -> str | None:
        """Why it does not stay with the carried body at poses (N, 4, 4) and its own centre of
        mass accelerated by (N, 3)."""
        turn = carried[:, :3, :3] @ self.start[:3, :3].T
        force = np.einsum("nji,nj->ni", turn, push + np.array([0.0, 0.0, GRAVITY]))
        flat = np.hypot(force[:, 0], force[:, 1])
        if np.any(force[:, 2] <= 0) or np.any(flat > FRICTION * force[:, 2]):
            return f"{self.name} slides off what it is carried on"
        worst = -np.inf
        for x, y, z in force:
            above_contact = self.centre[2] - self.height
            through = self.centre[:2] - np.array([x, y]) / z * above_contact
            worst = max(worst, outside_by(self.polygon, through))
        if worst > DENT:
            return f"{self.name} tips over on what it is carried on"
        return None


def loads_of(world: World, poses: Poses, held: int, group: Sequence[int]) -> list[Load]:
    """What stands on a body that is gripped, all bodies at poses (4, 4)."""
    found = []
    for index in group:
        under = footings(world, poses, index)
        if index == held or not under:
            continue
        on_it = [index, *(i for i in above(world, poses, [index]) if i in group)]
        masses = np.array([world.movables[i].body.mass for i in on_it])
        centres = np.array([poses[i] @ [*world.movables[i].body.centre, 1.0] for i in on_it])
        centre: Floats = (masses @ centres)[:3] / masses.sum()
        polygon = convex_hull(np.vstack([f.patch for f in under]))
        height = float(poses[index][2, 3])
        found.append(Load(world.movables[index].name, centre, polygon, height, poses[held]))
    return found


def even_times(times: Floats, rests: bool = True) -> Floats:
    """Times (N,), `STRETCH` apart, over a motion; a little longer where it is from rest to rest."""
    if rests:
        return np.arange(times[0] - STRETCH, times[-1] + 2 * STRETCH, STRETCH)
    return np.arange(times[0], times[-1] + 1e-9, STRETCH)


def accelerations(places: Floats) -> Floats:
    """Accelerations (N, 3) at places (N, 3) of even times; 0 at both ends."""
    found = np.zeros_like(places)
    found[1:-1] = np.diff(places, 2, axis=0) / STRETCH**2
    return found


def drive_pushes(base: MobileBase, reach: float) -> Floats:
    """Accelerations (k, 3) in all directions, as hard as a base can: along a line, or turning with
    something `reach` metres from its axis."""
    turning = np.hypot(base.angular_acceleration * reach, base.angular_velocity**2 * reach)
    hardest = max(base.acceleration, float(turning))
    angles = np.arange(16) * np.pi / 8
    return hardest * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(16)])
