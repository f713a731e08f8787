"""Whether objects stand as a scene wants it, judged on exact final poses."""

from __future__ import annotations

import math
from collections.abc import Mapping

from domains.tabletop.scene.model import PoseGoal, RegionGoal, Scene

Pose = tuple[float, float, float]
"""x, y, heading of an object that stands on a table."""

NUMERIC = 1e-4
"""Metres by which a plan's own rounding may miss a tolerance."""


def unmet(scene: Scene, poses: Mapping[int, tuple[int, Pose]]) -> list[str]:
    """What the goals of a scene still lack; `poses` gives surface and pose of each object."""
    found = []
    for index, goal in scene.goals.items():
        name = scene.objects[index].name
        surface, (x, y, _) = poses[index]
        wanted = scene.surfaces[goal.surface].name
        if surface != goal.surface:
            found.append(f"{name} is not on {wanted}")
        elif isinstance(goal, PoseGoal):
            error = math.hypot(x - goal.x, y - goal.y)
            if error > goal.tolerance + NUMERIC:
                found.append(f"{name} is {1000 * error:.1f} mm from its goal pose")
        elif isinstance(goal, RegionGoal) and not scene.surfaces[surface].contains(x, y):
            found.append(f"{name} is outside the region of {wanted}")
    if scene.word is not None and not spells(scene, poses):
        found.append(f"the word {scene.word.word} is not on the table")
    return found


def spells(scene: Scene, poses: Mapping[int, tuple[int, Pose]]) -> bool:
    """Whether blocks spell the scene's word in a row, in one of the table's directions."""
    word = scene.word
    assert word is not None
    surface = scene.surfaces[word.surface]
    blocks = [
        (scene.objects[i].letter, *surface.table.local(pose[0], pose[1]))
        for i, (where, pose) in poses.items()
        if where == word.surface and scene.objects[i].letter is not None
    ]
    for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1)):
        for letter, x, y in blocks:
            if letter != word.word[0]:
                continue
            if all(
                any(
                    other == wanted
                    and math.hypot(ox - x - i * word.pitch * dx, oy - y - i * word.pitch * dy)
                    <= 2 * word.tolerance + NUMERIC
                    for other, ox, oy in blocks
                )
                for i, wanted in enumerate(word.word)
            ):
                return True
    return False
