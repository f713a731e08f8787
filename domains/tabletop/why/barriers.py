"""What stands in the ways to an object or to its goal: which approaches, which things.

An approach is one of the K headings of a family at a site, as the features see it (`swept.py`);
fixed things count as well as objects.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from domains.tabletop.features import swept
from domains.tabletop.features.functions import arrangement
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.holds import SiteHold
from domains.tabletop.state import State
from domains.tabletop.world import TabletopWorld
from runtime.motion.room import Room, bare, whole
from runtime.world.poses import Floats
from sketchlang.analysis.words import listed

FROM = ("from the side", "from above", "across its edge", "aslant", "from above at its end")
"""The families of approaches in words."""

NAMED = 3
"""Things that are named in one clause."""


@dataclass(frozen=True)
class Barrier:
    """The ways of one family: how many there are, how many each thing bars, by name, the fewest
    things in one way, and how many ways nothing bars, but the robot cannot use: `short` says what
    it lacks."""

    family: int
    ways: int
    barred: dict[str, int]
    nearest: tuple[str, ...]
    free: int
    short: str = ""

    @property
    def text(self) -> str:
        """The same in a clause."""
        return f"{FROM[self.family]} {self.clause}"

    @property
    def clause(self) -> str:
        """The same without where the hand comes from."""
        if self.free:
            return self.short
        many = Counter(self.barred).most_common()
        all_of_them = [name for name, count in many if count == self.ways]
        if all_of_them:
            verb = "blocks" if len(all_of_them) == 1 else "block"
            said = f"{listed(all_of_them[:NAMED])} {verb} all {self.ways} ways in"
        else:
            parts = [f"{name} blocks {count}" for name, count in many[:NAMED]]
            said = f"{listed(parts)} of {self.ways} ways in"
        if set(self.nearest) != set(all_of_them):
            said += f", the nearest way in is barred by {listed(self.nearest[:NAMED])}"
        return said

    def as_json(self) -> dict[str, object]:
        """The same as plain data."""
        return {
            "from": FROM[self.family],
            "ways": self.ways,
            "barred": self.barred,
            "nearest": list(self.nearest),
            "unreachable": self.free,
        }


def to_object(world: TabletopWorld, state: State, index: int) -> list[Barrier]:
    """What bars the ways to an object where it rests."""
    at = world.rests(state.placements, index)
    assert at is not None
    site = np.array([at[:3]])
    placement = state.placements[index]
    face = 0 if placement is None else placement.face
    return _barriers(
        world, state, index, site, lambda family: world.hold(index, family, at[3], face)
    )


def to_goal(world: TabletopWorld, state: State, index: int, goal: GoalSites) -> list[Barrier]:
    """What bars the ways to the goal of an object, all its sites together."""
    grasp = state.grasp if state.held == index else None

    def hold_of(family: int) -> SiteHold:
        return world.place_hold(index, family, goal.world_yaw, grasp)

    return _barriers(world, state, index, goal.xyz, hold_of, goal)


def in_words(barriers: list[Barrier]) -> str:
    """The ways of all families."""
    alike: dict[str, list[str]] = {}
    for barrier in barriers:
        alike.setdefault(barrier.clause, []).append(FROM[barrier.family])
    said = [f"{listed(where)} {clause}" for clause, where in alike.items()]
    return "; ".join(said) or "no hand fits there"


def _barriers(
    world: TabletopWorld,
    state: State,
    index: int,
    sites: Floats,
    hold_of: Callable[[int], SiteHold],
    goal: GoalSites | None = None,
) -> list[Barrier]:
    here = arrangement(world, state.placements)
    # One peg at most rises where it stands, or is to stand: that is inside of it.
    names, rows = world.named_statics_at(*sites[0, :2].tolist())
    below = set() if goal is None else set(goal.bearers)
    for other in np.flatnonzero(here.present).tolist():
        if other != index and other not in below:
            names.append(world.items[other].name)
            rows.append(here.boxes[other])
    found = []
    for family in world.families:
        hold = hold_of(family)
        if hold.fits:
            found.append(_barrier(world, index, family, sites, hold, names, rows))
    return found


def _barrier(
    world: TabletopWorld,
    index: int,
    family: int,
    sites: Floats,
    hold: SiteHold,
    names: list[str],
    rows: list[Floats],
) -> Barrier:
    sweep, own = world.hand.sweeps[family], world.own(index)
    bars = np.array(
        [
            swept.ALL & ~swept.open_headings(sites, hold.rows, hold.height, own, row[None], sweep)
            for row in rows
        ],
        dtype=np.int64,
    ).reshape(len(rows), len(sites))
    barred: Counter[str] = Counter()
    nearest: tuple[str, ...] | None = None
    ways = free = 0
    for site in range(len(sites)):
        for k in range(swept.HEADINGS):
            if not (hold.fits >> k) & 1:
                continue
            ways += 1
            things = tuple(
                dict.fromkeys(names[i] for i in np.flatnonzero((bars[:, site] >> k) & 1))
            )
            barred.update(things)
            free += not things
            if nearest is None or len(things) < len(nearest):
                nearest = things
    known = dict(barred.most_common())
    short = _short_of(world, sites, own, hold, family) if free else ""
    return Barrier(family, ways, known, nearest or (), free, short)


def _short_of(world: TabletopWorld, sites: Floats, own: Floats, hold: SiteHold, family: int) -> str:
    """Why the robot cannot use ways that nothing bars."""

    def reaches(room: Room) -> bool:
        elsewhere = replace(world, room=room)
        return bool(elsewhere.reachable(sites, own, hold, family).any())

    if not world.is_fixed:
        if reaches(whole(world.room)):
            return "the robot cannot drive to where it would have to stand"
        if reaches(bare(world.room)):
            return "there is nowhere to stand"
    return "the arm is too short"
