"""Placements: where the held object belongs, or where it is least in the way."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from domains.tabletop.features import swept
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.features.swept import STEP
from domains.tabletop.sampling.draw import PLACEMENTS, Draw, heading_bit, pick_headings
from domains.tabletop.state import UNIT, Grasp, Placement, State
from domains.tabletop.world import PLACING_INSET, Task

CHOICE = 3
"""Placements to put something aside are the best of so many times their number."""

BIN = 0.1
"""Placements fall into the least filled bins of this size, in metres, as published."""


class PlacementSampler:
    """Samples placements for one task."""

    def __init__(self, task: Task) -> None:
        self.task = task

    def of_held(self, draw: Draw) -> list[Placement]:
        """Goal placements of the held object; elsewhere where these do not serve."""
        task, state = self.task, draw.state
        index, _ = draw.held
        goal = task.goal_sites(index, task.arrangement(state.placements))
        number = PLACEMENTS * draw.scale
        found: list[Placement] = []
        if goal is not None and (draw.doubting or task.obstructions(state, index) == 0):
            found = self._at_goal(draw, goal, number)
            if draw.attempt == 0 and any(task.disturbed_by(state, index, p) == 0 for p in found):
                return found
        aside = []
        for surface in range(len(task.scene.surfaces)):
            candidates = self._free(draw, surface, CHOICE * number)
            aside += self._least_in_the_way(state, candidates)[:number]
        return found + self._least_in_the_way(state, aside)

    def with_grasp(self, draw: Draw, grasp: Grasp) -> list[Placement]:
        """Goal placements for the held object, were it held with another grasp."""
        state, (index, _) = draw.state, draw.held
        regrasped = State(state.base, state.placements, index, grasp, self.task)
        goal = self.task.goal_sites(index, self.task.arrangement(state.placements))
        if goal is None:
            return []
        return self._at_goal(replace(draw, state=regrasped), goal, draw.scale)

    def anywhere(self, draw: Draw) -> list[Placement]:
        """Placements for whatever will be picked up, unoccupied for the largest object."""
        task, state = self.task, draw.state
        standing = [i for i, placement in enumerate(state.placements) if placement is not None]
        index = max(standing, key=lambda i: task.shapes[i].outer_radius)
        grasp = Grasp.of(draw.rng.uniform(0.0, 2 * math.pi), task.shapes[index].grasp_height)
        holding = replace(draw, state=State(state.base, state.placements, index, grasp, task))
        found = []
        for surface in range(len(task.scene.surfaces)):
            found += self._free(holding, surface, PLACEMENTS * draw.scale)
        return found

    def _least_in_the_way(self, state: State, placements: list[Placement]) -> list[Placement]:
        """Placements ordered by how many ways, to misplaced objects and to places that
        goals name, an object there would bar; the farther from the robot the later."""
        task = self.task
        index = state.held
        assert index is not None
        arrangement = task.arrangement(state.placements)
        misplaced = [i for i in task.misplaced(state) if state.placements[i] is not None]
        named = (task.goal_sites(i, arrangement) for i in range(len(state.placements)))
        goals = [goal for goal in named if goal is not None and goal.region is None]
        xy = np.array([arrangement.xy[i] for i in misplaced] + [goal.xy[0] for goal in goals])
        if not len(xy):
            xy = np.zeros((0, 2))
        reachable = np.array(
            [arrangement.reachable[i] for i in misplaced] + [goal.reachable[0] for goal in goals],
            dtype=np.int64,
        )
        grips = np.tile(task.place_grips(index, None, None), (len(xy), 1))
        boxes = np.array([task.object_row(index, p) for p in placements]).reshape(-1, 8)
        barred = swept.barred_matrix(xy, grips, boxes, task.strip) & reachable[:, None]
        ways = np.bitwise_count(barred).sum(axis=0) if len(xy) else np.zeros(len(placements))
        distance = np.hypot(boxes[:, 0] - state.base.x * UNIT, boxes[:, 1] - state.base.y * UNIT)
        return [placements[i] for i in np.lexsort((distance, ways))]

    def _at_goal(self, draw: Draw, goal: GoalSites, number: int) -> list[Placement]:
        if goal.region is not None:
            return self._free(draw, goal.surface, number)
        _, grasp = draw.held
        found = []
        for x, y in goal.xy:
            if goal.yaw is not None:
                step = 2 * math.pi / goal.symmetry
                turns = [goal.yaw + i * step for i in range(goal.symmetry)]
                free = self._free_at(draw, x, y, goal.surface)
                held = grasp.heading
                yaws = [yaw for yaw in turns if (free >> heading_bit(yaw + held)) & 1] or turns
            else:
                free = self._free_at(draw, x, y, goal.surface)
                headings = pick_headings(free, number, draw.rng)
                yaws = [k * STEP + draw.jitter() - grasp.heading for k in headings]
            found += [Placement.of(x, y, yaw, goal.surface) for yaw in yaws]
        return found

    def _free(self, draw: Draw, surface_index: int, number: int) -> list[Placement]:
        """Random unoccupied placements on a surface, in its least filled bins, with a
        heading for which the held object's grasp can come in where nothing bars it."""
        task, state, rng = self.task, draw.state, draw.rng
        index, grasp = draw.held
        surface = task.scene.surfaces[surface_index]
        arrangement = task.arrangement(state.placements)
        inset = task.shapes[index].outer_radius + PLACING_INSET
        spans = [half - inset for half in surface.half]
        if min(spans) <= 0:
            return []
        bins = [max(1, int(2 * span / BIN)) for span in spans]
        load = np.zeros(bins[0] * bins[1])
        for placement in state.placements:
            if placement is not None and placement.surface == surface_index:
                lx, ly = surface.table.local(*placement.pose[:2])
                i = min(bins[0] - 1, max(0, int((lx + spans[0]) / (2 * spans[0]) * bins[0])))
                j = min(bins[1] - 1, max(0, int((ly + spans[1]) / (2 * spans[1]) * bins[1])))
                load[i * bins[1] + j] += 1
        order = np.argsort(load + rng.uniform(0.0, 0.9, len(load)))
        radius = task.shapes[index].outer_radius
        low, high = surface.rest, surface.rest + task.shapes[index].size[2]
        found: list[Placement] = []
        for turn in range(3):
            for cell in order:
                i, j = divmod(int(cell), bins[1])
                lx = -spans[0] + (i + rng.random()) * 2 * spans[0] / bins[0]
                ly = -spans[1] + (j + rng.random()) * 2 * spans[1] / bins[1]
                x, y = surface.table.world(lx, ly)
                if swept.occupied_sites(np.array([[x, y]]), radius, arrangement.boxes, -1)[0]:
                    continue
                if swept.nearest_static(x, y, task.statics, low, high) < radius:
                    continue
                free = self._free_at(draw, x, y, surface_index)
                if not free and turn < 2:
                    continue
                for k in pick_headings(free or swept.ALL, 1, rng):
                    yaw = k * STEP + draw.jitter() - grasp.heading
                    found.append(Placement.of(x, y, yaw, surface_index))
                if len(found) >= number:
                    return found
        return found

    def _free_at(self, draw: Draw, x: float, y: float, surface: int) -> int:
        """Headings along which nothing bars the way to a site that is not occupied."""
        if draw.doubting:
            return swept.ALL
        task, (index, grasp) = self.task, draw.held
        arrangement = task.arrangement(draw.state.placements)
        site = np.array([[x, y]])
        grips = task.place_grips(index, None, grasp)[None]
        barred = swept.barred_matrix(site, grips, arrangement.boxes, task.strip)[0]
        reachable = int(task.reachable_sites(site, task.scene.surfaces[surface].rest)[0])
        return reachable & ~int(np.bitwise_or.reduce(barred)) if len(barred) else reachable
