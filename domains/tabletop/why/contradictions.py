"""Goals that cannot hold together, whatever is done: two objects at one place, more than fits."""

from __future__ import annotations

import math
from itertools import combinations

from domains.tabletop.ground import Ground
from domains.tabletop.scene.model import PoseGoal, RegionGoal
from domains.tabletop.why.finding import Finding, finding
from domains.tabletop.world import TabletopWorld
from runtime.world.solids import Box


def contradictions(world: TabletopWorld) -> list[Finding]:
    """Pairs of goals that overlap, and supports that are wanted by more than they hold."""
    return _overlapping(world) + _overfull(world)


def _overlapping(world: TabletopWorld) -> list[Finding]:
    found = []
    points = [(i, g) for i, g in sorted(world.placed_goals.items()) if isinstance(g, PoseGoal)]
    for (i, a), (j, b) in combinations(points, 2):
        if a.support != b.support:
            continue
        one, other = world.items[i], world.items[j]
        apart = math.hypot(a.x - b.x, a.y - b.y)
        # However they are turned, they reach as far as this from their middles.
        room = one.inner_radius + other.inner_radius - a.tolerance - b.tolerance
        if apart < room:
            ground = world.grounds[a.support].name
            text = (
                f"the goals of {one.name} and {other.name} on {ground} contradict each other: "
                f"they are {100 * apart:.1f} cm apart, and the objects take {100 * room:.1f}"
            )
            found.append(finding(one.name, "contradictory goals", text, others=[other.name]))
    return found


def _overfull(world: TabletopWorld) -> list[Finding]:
    """Supports whose area is less than that of the objects which have to stand on them."""
    wanted: dict[int, list[int]] = {}
    for index, goal in sorted(world.placed_goals.items()):
        if isinstance(goal, RegionGoal):
            wanted.setdefault(goal.support, []).append(index)
    found = []
    for support, indices in wanted.items():
        ground = world.grounds[support]
        area = 4 * ground.half[0] * ground.half[1]
        placements = world.initial.placements
        # What is there already may jut over an edge; what is put down there does not.
        coming = [i for i in indices if getattr(placements[i], "support", None) != support]
        taken = sum(_foot(world, i) for i in coming)
        if len(coming) > 1 and taken > area:
            names = [world.items[i].name for i in coming]
            text = (
                f"{ground.name} is too small for {len(names)} objects that shall be on it: they "
                f"take {1e4 * taken:.0f} cm2, and it has {1e4 * area:.0f}"
            )
            found.append(finding(names[0], "too small", text, others=names[1:]))
            continue
        for i, j in combinations(coming, 2):
            if not _side_by_side(world, ground, i, j):
                one, other = world.items[i].name, world.items[j].name
                text = f"{ground.name} has room for {one} or {other}, not for both of them"
                found.append(finding(one, "too small", text, others=[other]))
                break
    return found


def _side_by_side(world: TabletopWorld, ground: Ground, i: int, j: int) -> bool:
    """Whether two objects could stand on a support together: not if, however they are turned,
    their middles are less apart than both take, as far apart as the edges let them be."""
    one, other = world.items[i].inner_radius, world.items[j].inner_radius
    spans = [2 * half - one - other for half in ground.half]
    return min(spans) >= 0 and math.hypot(*spans) >= one + other


def _foot(world: TabletopWorld, index: int) -> float:
    """Square metres that nothing else can take where an object stands, at the least."""
    item = world.items[index]
    if len(item.parts) == 1 and isinstance(item.parts[0].solid, Box):
        return float(item.size[0] * item.size[1])
    return math.pi * float(item.inner_radius) ** 2
