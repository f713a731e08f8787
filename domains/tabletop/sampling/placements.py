"""Placements: where the held object belongs, or where it is least in the way."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from domains.tabletop.faces import can_turn, faces_at, turned
from domains.tabletop.features import swept
from domains.tabletop.features.functions import (
    arrangement,
    disturbed_by,
    misplaced,
    obstructions,
)
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.features.swept import STEP, heading_bit
from domains.tabletop.footprints import footprints_meet
from domains.tabletop.loads import tall
from domains.tabletop.room import INSET, room_on
from domains.tabletop.sampling.draw import PLACEMENTS, Draw, pick_headings
from domains.tabletop.state import PINCH, Grasp, Placement, State
from domains.tabletop.world import AWAY, TabletopWorld
from runtime.world.poses import Floats
from runtime.world.world import FLOOR

CHOICE = 3
"""Placements to put something aside are the best of so many times their number."""

MOST = 100
"""Bins of a support that are looked at, and four for each placement that is wanted, however
large it is."""

ROUNDS = 3
"""So many places are looked at in every bin of a support, at least; more where it is small."""

BIN = 0.1
"""Placements fall into the least filled bins of this size, in metres, as published."""


ON_EDGE = 0.03
"""Metres from the edge of a support, at least, that the middle of what juts over it is."""


class PlacementSampler:
    """Samples placements for one task."""

    def __init__(self, world: TabletopWorld) -> None:
        self.world = world

    def of_held(self, draw: Draw) -> list[Placement]:
        """Goal placements of the held object; elsewhere where these do not serve."""
        world, state = self.world, draw.state
        index, _ = draw.held
        goal = world.goal_sites(index, arrangement(world, state.placements))
        number = PLACEMENTS * draw.scale
        found: list[Placement] = []
        if goal is not None and (draw.doubting or obstructions(state, index) == 0):
            for on_face in self._on_faces(draw, goal):
                found += self.at_goal(on_face, goal, number)
            if draw.attempt == 0 and any(disturbed_by(state, index, p) == 0 for p in found):
                return found
        return found + self.aside(draw)

    def aside(self, draw: Draw) -> list[Placement]:
        """Placements where the held object is least in the way."""
        number, found = PLACEMENTS * draw.scale, []
        index, _ = draw.held
        goal = self.world.goal_sites(index, arrangement(self.world, draw.state.placements))
        faces = self._on_faces(draw, goal)
        for support in self._supports_of(draw, index):
            candidates: list[Placement] = []
            for on_face in faces:
                candidates += self._free(on_face, support, CHOICE * number)
            found += self._least_in_the_way(draw.state, candidates)[:number]
        return self._least_in_the_way(draw.state, found)

    def on(self, draw: Draw, support: int) -> list[Placement]:
        """Placements of the held object on one support."""
        return self._free(draw, support, PLACEMENTS * draw.scale)

    def _on_faces(self, draw: Draw, goal: GoalSites | None) -> list[Draw]:
        """The same drawing, were the held object taken on each of the faces on which it may be
        put, on all of them once the estimate is doubted; what bears others stays on the one that
        it is on."""
        world, state, (index, grasp) = self.world, draw.state, draw.held
        faces = faces_at(world, index, goal)
        if draw.doubting and can_turn(world, index, goal):
            faces += tuple(i.face for i in world.faces[index] if i.face not in faces)
        if faces == (grasp.face,) or world.riders(state.placements, index):
            return [draw]
        seen = [turned(world, index, grasp, face) for face in faces]
        return [replace(draw, state=replace(state, grasp=g)) for g in seen if g is not None] or [
            draw
        ]

    def _supports(self, draw: Draw) -> list[int]:
        """Supports on which something may be put aside: furniture; once that failed, the floor
        and tops of objects as well."""
        world = self.world
        fixed = [i for i, ground in enumerate(world.grounds) if ground.owner is None]
        raised = [i for i in fixed if world.grounds[i].name != FLOOR]
        if raised and not draw.doubting:
            return raised
        here = arrangement(world, draw.state.placements)
        return fixed + [
            i
            for i, ground in enumerate(world.grounds)
            if ground.owner is not None and here.present[ground.owner]
        ]

    def _supports_of(self, draw: Draw, index: int) -> list[int]:
        """The same for an object: all on which it may rest, where these are few."""
        world = self.world
        only_on = world.scene.objects[index].only_on
        if only_on is None:
            return self._supports(draw)
        here = arrangement(world, draw.state.placements)
        owners = {i: world.grounds[i].owner for i in sorted(only_on)}
        return [i for i, owner in owners.items() if owner is None or here.present[owner]]

    def with_grasp(self, draw: Draw, grasp: Grasp) -> list[Placement]:
        """Goal placements for the held object, were it held with another grasp."""
        state, (index, _) = draw.state, draw.held
        goal = self.world.goal_sites(index, arrangement(self.world, state.placements))
        if goal is None:
            return []
        held = replace(draw, state=replace(state, grasp=grasp))
        return [
            placement
            for on_face in self._on_faces(held, goal)
            for placement in self.at_goal(on_face, goal, draw.scale)
        ]

    def anywhere(self, draw: Draw) -> tuple[list[Placement], int]:
        """Placements for whatever will be picked up, unoccupied for the largest object, and
        that object."""
        world, state = self.world, draw.state
        standing = [i for i, placement in enumerate(state.placements) if placement is not None]
        index = max(standing, key=lambda i: world.items[i].outer_radius)
        grasp = Grasp.of(draw.rng.uniform(0.0, 2 * math.pi), 0.1)
        holding = replace(draw, state=replace(state, held=index, grasp=grasp))
        found = []
        for support in self._supports(draw):
            if world.grounds[support].owner is None:
                found += self._free(holding, support, PLACEMENTS * draw.scale)
        return found, index

    def _least_in_the_way(self, state: State, placements: list[Placement]) -> list[Placement]:
        """Placements ordered by how many ways, to misplaced objects and to places that
        goals name, an object there would bar; the farther from the robot the later."""
        index = state.held
        assert index is not None
        boxes = np.array([self._box(state, index, p) for p in placements]).reshape(-1, 8)
        ways = self._ways_barred(state, index, boxes)
        x, y, _ = state.base.pose
        distance = np.hypot(boxes[:, 0] - x, boxes[:, 1] - y)
        return [placements[i] for i in np.lexsort((distance, ways))]

    def _ways_barred(self, state: State, index: int, boxes: Floats) -> Floats:
        """How many ways, to misplaced objects and to named goals, boxes (p, 8) would bar."""
        world = self.world
        here = arrangement(world, state.placements)
        wrong = [i for i in sorted(misplaced(state)) if here.present[i]]
        named = [
            (i, goal)
            for i in range(len(state.placements))
            if (goal := world.goal_sites(i, here)) is not None and goal.region is None
        ]
        count = np.zeros(len(boxes))
        for family in world.families:
            picks = here.picks[family]
            hand = world.hand.sweeps[family]
            if wrong:
                owns = world.owns_of(state.placements)[wrong]
                barred = swept.barred_matrix(
                    here.sites[wrong], picks.holds[wrong], picks.heights[wrong], owns, boxes,
                    hand, 0.0,
                )  # fmt: skip
                reachable = picks.reachable[wrong]
                count += np.bitwise_count(barred & reachable[:, None]).sum(axis=0)
            for i, goal in named:
                ways = here.places_of(i, goal, family)
                barred = swept.barred_matrix(
                    goal.xyz[:1], ways.hold.rows[None], np.array([ways.hold.height]),
                    ways.own[None], boxes, hand, 0.0,
                )  # fmt: skip
                count += np.bitwise_count(barred & ways.reachable[:1, None]).sum(axis=0)
        return count

    def _box(self, state: State, index: int, placement: Placement) -> Floats:
        at = self.world.rests_at(state.placements, index, placement)
        assert at is not None, "placements are sampled on supports that rest"
        return self.world.box_row(index, at, placement.face)

    def at_goal(self, draw: Draw, goal: GoalSites, number: int) -> list[Placement]:
        """Placements of the held object at the sites of a goal."""
        if goal.region is not None:
            return self._free(draw, goal.support, number)
        _, grasp = draw.held
        frame = goal.frame or 0.0
        found = []
        for (x, y), site in zip(goal.xy, goal.xyz, strict=True):
            free = self._free_at(draw, site, goal.support)
            if goal.yaw is not None:
                step = 2 * math.pi / goal.symmetry
                turns = [goal.yaw + i * step for i in range(goal.symmetry)]
                yaws = [
                    yaw for yaw in turns if (free >> heading_bit(yaw + frame + grasp.heading)) & 1
                ] or turns
            else:
                headings = pick_headings(free, number, draw.rng)
                yaws = [k * STEP + draw.jitter() - grasp.heading - frame for k in headings]
            found += [Placement.of(x, y, yaw, goal.support, grasp.face) for yaw in yaws]
        return found

    def _free(self, draw: Draw, support: int, number: int) -> list[Placement]:
        """Random unoccupied placements on a support, in its least filled bins, with a
        heading for which the held object's grasp can come in where nothing bars it."""
        world = self.world
        index, grasp = draw.held
        ground, item = world.grounds[support], world.item(index, grasp.face)
        spans, turns = room_on(ground, item)
        if grasp.family == PINCH:  # a finger is below: it juts over the edge
            spans, turns = [max(half - ON_EDGE, 0.0) for half in ground.half], None
        frame = (0.0, 0.0, 0.0, 0.0)
        if not world.may_rest(index, support, grasp.face):
            return []
        if ground.peg is not None and grasp.family == PINCH:
            return []  # the finger below would be between the two
        if ground.owner is not None:
            frame = world.bearer(draw.state.placements, ground.owner) or AWAY
        height = tall(world, draw.state.placements, index, grasp.face)
        if spans is None or height > ground.clearance - INSET or frame is AWAY:
            return []
        radius = item.outer_radius if turns is None else item.inner_radius
        found: list[Placement] = []
        bins = math.prod(_bins(spans))
        for _ in range(max(ROUNDS, MOST // bins)):
            for lx, ly in islice(self._by_load(draw, support, spans), MOST + 4 * number):
                x, y = ground.outside(lx, ly)
                site = _moved(frame, x, y, ground.height)
                if self._is_taken(draw, site, radius, support):
                    continue
                free = self._free_at(draw, site, support)
                if not free:
                    continue
                yaw = self._heading(draw, free, turns, frame[3])
                if yaw is None or (turns and not self._fits(draw, support, x, y, yaw)):
                    continue
                found.append(Placement.of(x, y, yaw, support, grasp.face))
                if len(found) >= number:
                    return found
        return found

    def _by_load(
        self, draw: Draw, support: int, spans: list[float]
    ) -> Iterator[tuple[float, float]]:
        """A random point of every bin of a support, in its frame, least filled bins first."""
        ground, rng = self.world.grounds[support], draw.rng
        bins = _bins(spans)
        load = np.zeros(bins[0] * bins[1])
        for placement in draw.state.placements:
            if placement is not None and placement.support == support:
                point = ground.local(*placement.pose[:2])
                i, j = (
                    min(count - 1, max(0, int((value + span) / max(2 * span, 1e-9) * count)))
                    for value, span, count in zip(point, spans, bins, strict=True)
                )
                load[i * bins[1] + j] += 1
        for cell in np.argsort(load + rng.uniform(0.0, 0.9, len(load))):
            i, j = divmod(int(cell), bins[1])
            lx = -spans[0] + (i + rng.random()) * 2 * spans[0] / bins[0]
            ly = -spans[1] + (j + rng.random()) * 2 * spans[1] / bins[1]
            yield lx, ly

    def _is_taken(self, draw: Draw, site: Floats, radius: float, support: int) -> bool:
        """Whether something stands at a site (3,) of a support where the held object would, or is
        too near."""
        below = self.world.grounds[support].owner
        world, (index, grasp) = self.world, draw.held
        here = arrangement(world, draw.state.placements)
        height = tall(world, draw.state.placements, index, grasp.face)
        own = np.array([radius, height])
        skip = -1 if below is None else below
        if swept.occupied_sites(site[None], own, here.boxes, skip)[0]:
            return True
        low, high = site[2], site[2] + height
        statics = world.statics_at(site[0], site[1])
        return bool(swept.nearest_static(site[0], site[1], statics, low, high) < radius)

    def _heading(
        self, draw: Draw, free: int, turns: list[float] | None, frame: float
    ) -> float | None:
        """A heading, in the frame of the support, with which the held object's grasp comes in
        along one of the free headings."""
        _, grasp = draw.held
        if turns is None:
            k = pick_headings(free, 1, draw.rng)[0]
            return k * STEP + draw.jitter() - grasp.heading - frame
        fitting = [t for t in turns if (free >> heading_bit(t + frame + grasp.heading)) & 1]
        return fitting[int(draw.rng.integers(len(fitting)))] if fitting else None

    def _fits(self, draw: Draw, support: int, x: float, y: float, yaw: float) -> bool:
        """Whether the held object, lying there so, is clear of other objects and of what is
        fixed, by the boxes around them."""
        world, state = self.world, draw.state
        index, grasp = draw.held
        placement = Placement.of(x, y, yaw, support, grasp.face)
        box = self._box(state, index, placement)
        here = arrangement(world, state.placements)
        owner = world.grounds[support].owner
        others = [b for i, b in enumerate(here.boxes) if here.present[i] and i != owner]
        return not any(
            _overlap(box, other) for other in [*others, *world.statics_at(box[0], box[1])]
        )

    def _free_at(self, draw: Draw, site: Floats, support: int) -> int:
        """Headings along which nothing bars the way to a site of a support that is not occupied."""
        if draw.doubting:
            return swept.ALL
        world, (index, grasp) = self.world, draw.held
        here = arrangement(world, draw.state.placements)
        hold = world.place_hold(index, grasp.family, None, grasp)
        own = world.own(index, grasp.face)
        ground, boxes = world.grounds[support], here.boxes
        if ground.peg is not None and ground.owner is not None:
            boxes = np.delete(boxes, ground.owner, axis=0)
        barred = swept.barred_matrix(
            site[None], hold.rows[None], np.array([hold.height]), own[None], boxes,
            world.hand.sweeps[grasp.family], 0.0,
        )[0]  # fmt: skip
        wanted = swept.ALL & ~int(np.bitwise_or.reduce(barred)) if len(barred) else swept.ALL
        return int(world.reachable(site[None], own, hold, grasp.family, wanted)[0])


def _bins(spans: list[float]) -> list[int]:
    """How many bins a region has along both of its sides, of which these are the halves."""
    return [max(1, int(2 * span / BIN)) for span in spans]


def _moved(frame: tuple[float, float, float, float], x: float, y: float, z: float) -> Floats:
    """A point in a frame that is at x, y, height and heading, in the world (3,)."""
    c, s = math.cos(frame[3]), math.sin(frame[3])
    return np.array([frame[0] + c * x - s * y, frame[1] + s * x + c * y, frame[2] + z])


def _overlap(a: Floats, b: Floats) -> bool:
    """Whether two upright boxes (8,) come within the play of each other."""
    if abs(a[2] - b[2]) >= a[5] + b[5] - swept.LEVEL:
        return False
    return footprints_meet(a, b, swept.PLAY)
