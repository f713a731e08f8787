"""A: the ground actions of a subproblem, sampled at its start (paper, Ground Actions).

Relevant objects and surfaces come first, grasps from the side that nothing bars first, and
base poses where the sampled grasps can be taken. Each failure of a subproblem doubles the
density and drops a restriction; from the third attempt on every grasp, placement and base
pose can be sampled, which keeps the planner probabilistically complete.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from runtime.kernels import plane, swept
from runtime.kernels.swept import HEADINGS, STEP
from runtime.pick_place.executability import Executor, Target
from runtime.pick_place.goals import GoalSites
from runtime.pick_place.state import (
    UNIT,
    Action,
    BasePose,
    Grasp,
    MoveBase,
    Pick,
    Place,
    Placement,
    State,
)
from runtime.pick_place.task import PLACING_INSET, Task

GRASPS = 4
PLACEMENTS = 7
BASES = 7
"""Published numbers of samples: grasps an object, placements and base poses a surface."""

DOUBT = 2
"""From this attempt on the features' estimate of what bars the way is no longer believed, and
every grasp, placement and base pose can be sampled; after it, with an object in the gripper,
other objects as well."""

ROUNDS = 3
"""So many base poses for the same grasp, where there are few grasps."""

CHOICE = 3
"""Placements to put something aside are the best of so many times their number."""

REGRASP_PLACES = 4
"""Places at which the held object may be put down to grip it anew."""

NARROW = 1e-3
"""Metres by which a grasp may be wider than the narrowest one and still count as narrow."""

BIN = 0.1
"""Placements fall into the least filled bins of this size, in metres, as published."""


@dataclass(frozen=True, eq=False)
class Samples:
    """The sampled parameters of one subproblem: A(s) for all its states s."""

    executor: Executor
    bases: tuple[BasePose, ...]
    picks: tuple[tuple[int, tuple[Grasp, ...]], ...]
    places: tuple[Placement, ...]
    placed: int | None  # the object that `places` are for; None: any

    def actions(self, state: State) -> Iterator[tuple[Action, State]]:
        """Sampled ground actions in a state, and where each leads if it is executable.

        Manipulations have passed InArmWorkspace. They come before base moves, and near
        bases before far ones: within a layer of the breadth-first search, cheap first.
        """
        executor = self.executor
        targets: list[Target] = []
        if state.held is None:
            for index, grasps in self.picks:
                placement = state.placements[index]
                if placement is not None:
                    targets.extend((index, placement, grasp) for grasp in grasps)
        elif state.grasp is not None and self.placed in (None, state.held):
            targets = [(state.held, placement, state.grasp) for placement in self.places]
        for index, placement, grasp in executor.in_arm_workspace(state.base, targets):
            action = Pick(index, grasp) if state.held is None else Place(index, placement)
            yield action, state.after(action)
        here = state.base
        for base in sorted(self.bases, key=lambda b: (b.x - here.x) ** 2 + (b.y - here.y) ** 2):
            if base != here:
                move = MoveBase(base)
                yield move, state.after(move)


class Sampler:
    """Samples the subproblems of one task."""

    def __init__(self, task: Task, executor: Executor) -> None:
        self.task = task
        self.executor = executor
        self._doubting = False

    def sample(self, state: State, attempt: int, rng: np.random.Generator) -> Samples:
        """Samples for the subproblem that starts in a state; `attempt` counts its failures."""
        scale = 2**attempt
        self._doubting = attempt >= DOUBT
        if state.held is None:
            picks = self._picks(state, attempt, rng)
            wanted = [
                [(state.placements[index], grasp) for grasp in grasps] for index, grasps in picks
            ]
            places = self._anywhere(state, scale, rng) if self._doubting else []
            wanted += [[(placement, Grasp.of(0.0, 0.0))] for placement in places]
        else:
            assert state.grasp is not None
            places = self._placements(state, attempt, rng)
            wanted = [[(placement, state.grasp)] for placement in places]
            picks = self._regrasps(state, attempt, rng) if attempt > 0 else []
            for index, grasps in picks:
                aside = list(places[:REGRASP_PLACES])
                for grasp in grasps:
                    goals = self._goal_placements_with(state, index, grasp, scale, rng)
                    places += goals
                    wanted += [[(placement, grasp)] for placement in goals + aside]
            if attempt > DOUBT:
                picks += self._picks(state, attempt, rng)
        bases = self._bases(state, wanted, scale, rng)
        placed = state.held if attempt <= DOUBT else None
        return Samples(self.executor, tuple(bases), tuple(picks), tuple(places), placed)

    # -- grasps --------------------------------------------------------------------------

    def _picks(
        self, state: State, attempt: int, rng: np.random.Generator
    ) -> list[tuple[int, tuple[Grasp, ...]]]:
        task = self.task
        arrangement = task.arrangement(state.placements)
        picks = []
        for index in self._relevant(state, attempt):
            placement = state.placements[index]
            assert placement is not None
            free = arrangement.free_headings(index)
            if not free:
                if attempt == 0:
                    continue
                # The estimate may be wrong: try what geometry allows at all.
                free = int(arrangement.reachable[index])
            free = self._placeable(state, index, free) or free
            if self._doubting:
                free = swept.ALL
            number = GRASPS * 2**attempt
            narrow = free & self._narrow(index, placement)
            headings = pick_headings(narrow, number, rng)
            if len(headings) < number:
                headings += pick_headings(free & ~narrow, number - len(headings), rng)
            jitter = 0.0 if attempt == 0 else STEP / 2
            height = task.shapes[index].grasp_height
            grasps = tuple(
                Grasp.of(
                    k * STEP + rng.uniform(-jitter, jitter) - placement.yaw * UNIT,
                    height,
                    flipped=attempt > 0 and rng.random() < 0.3,
                )
                for k in headings
            )
            if grasps:
                picks.append((index, grasps))
        return picks

    def _placeable(self, state: State, index: int, free: int) -> int:
        """Those of some headings with which an object can also be put at its goal, where
        its heading there is prescribed and the grasp ties the two together."""
        task = self.task
        arrangement = task.arrangement(state.placements)
        goal = task.goal_sites(index, arrangement)
        placement = state.placements[index]
        if goal is None or goal.yaw is None or placement is None:
            return free
        barred, counts = arrangement.place_counts(goal, task.place_grips(index, goal, None))
        own = (barred[:, index, None] >> np.arange(HEADINGS)) & 1
        place = (counts - own).min(axis=0)
        turn = round((goal.yaw - placement.pose[2]) / STEP)
        fitting = 0
        for k in range(HEADINGS):
            ends = [(k + turn + i * goal.modulus) % HEADINGS for i in range(goal.symmetry)]
            if any(place[end] == place.min() for end in ends):
                fitting |= 1 << k
        # Where the heading is prescribed, room is tight: narrow grasps before wide ones.
        return (free & fitting & self._narrow(index, placement)) or (free & fitting)

    def _narrow(self, index: int, placement: Placement) -> int:
        """Headings along which the gripper need not open much wider than it must at best:
        those along the sides of a box, where its fingers lie flat."""
        grips = self.task.grips(index, placement.pose[2])
        return sum(1 << k for k in range(HEADINGS) if grips[k] < grips.min() + NARROW)

    def _regrasps(
        self, state: State, attempt: int, rng: np.random.Generator
    ) -> list[tuple[int, tuple[Grasp, ...]]]:
        """Other grasps of the held object: where it cannot go to its goal with the grasp
        that holds it, it is put down, gripped anew and placed, all in one subproblem."""
        index = state.held
        assert index is not None
        height = self.task.shapes[index].grasp_height
        number = GRASPS * 2**attempt
        # The first angles are along the sides of the object, the narrowest ones.
        angles = np.arange(number) * 2 * math.pi / number
        if attempt > 1:
            angles += rng.uniform(0.0, 2 * math.pi / number)
        return [(index, tuple(Grasp.of(a, height, flipped=rng.random() < 0.3) for a in angles))]

    def _goal_placements_with(
        self, state: State, index: int, grasp: Grasp, number: int, rng: np.random.Generator
    ) -> list[Placement]:
        """Goal placements for the held object, were it held with another grasp."""
        regrasped = State(state.base, state.placements, index, grasp, self.task)
        goal = self.task.goal_sites(index, self.task.arrangement(state.placements))
        if goal is None:
            return []
        return self._goal_placements(regrasped, goal, number, rng)

    def _relevant(self, state: State, attempt: int) -> list[int]:
        """Misplaced objects and those in their way, nearest first; all after a failure."""
        task = self.task
        arrangement = task.arrangement(state.placements)
        standing = [i for i, placement in enumerate(state.placements) if placement is not None]
        if attempt == 0:
            misplaced = task.misplaced(state)
            relevant = set(misplaced)
            for index in misplaced:
                goal = task.goal_sites(index, arrangement)
                if goal is not None and task.obstructions(state, index) > 0:
                    relevant |= set(arrangement.in_the_way(index, goal))
            standing = [i for i in standing if i in relevant]
        x, y = state.base.x, state.base.y
        return sorted(
            standing,
            key=lambda i: (state.placements[i].x - x) ** 2 + (state.placements[i].y - y) ** 2,  # type: ignore[union-attr]
        )

    # -- placements ----------------------------------------------------------------------

    def _placements(self, state: State, attempt: int, rng: np.random.Generator) -> list[Placement]:
        """Goal placements of the held object; elsewhere where these do not serve."""
        task = self.task
        index, grasp = state.held, state.grasp
        assert index is not None
        assert grasp is not None
        arrangement = task.arrangement(state.placements)
        goal = task.goal_sites(index, arrangement)
        number = PLACEMENTS * 2**attempt
        found: list[Placement] = []
        if goal is not None and (self._doubting or task.obstructions(state, index) == 0):
            found = self._goal_placements(state, goal, number, rng)
            if attempt == 0 and any(task.disturbed_by(state, index, p) == 0 for p in found):
                return found
        aside = []
        for surface in range(len(task.scene.surfaces)):
            candidates = self._free_placements(state, surface, CHOICE * number, rng)
            aside += self._least_in_the_way(state, candidates)[:number]
        return found + self._least_in_the_way(state, aside)

    def _anywhere(self, state: State, scale: int, rng: np.random.Generator) -> list[Placement]:
        """Placements for whatever will be picked up, unoccupied for the largest object."""
        task = self.task
        standing = [i for i, placement in enumerate(state.placements) if placement is not None]
        index = max(standing, key=lambda i: task.shapes[i].outer_radius)
        grasp = Grasp.of(rng.uniform(0.0, 2 * math.pi), task.shapes[index].grasp_height)
        holding = State(state.base, state.placements, index, grasp, task)
        found = []
        for surface in range(len(task.scene.surfaces)):
            found += self._free_placements(holding, surface, PLACEMENTS * scale, rng)
        return found

    def _jitter(self, rng: np.random.Generator) -> float:
        """A random turn within a step of headings, once the estimate is doubted."""
        return rng.uniform(-STEP / 2, STEP / 2) if self._doubting else 0.0

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

    def _goal_placements(
        self, state: State, goal: GoalSites, number: int, rng: np.random.Generator
    ) -> list[Placement]:
        if goal.region is not None:
            return self._free_placements(state, goal.surface, number, rng)
        assert state.held is not None
        assert state.grasp is not None
        found = []
        for x, y in goal.xy:
            if goal.yaw is not None:
                step = 2 * math.pi / goal.symmetry
                turns = [goal.yaw + i * step for i in range(goal.symmetry)]
                free = self._free_at(state, x, y, goal.surface)
                held = state.grasp.heading
                yaws = [yaw for yaw in turns if (free >> heading_bit(yaw + held)) & 1] or turns
            else:
                headings = pick_headings(self._free_at(state, x, y, goal.surface), number, rng)
                yaws = [k * STEP + self._jitter(rng) - state.grasp.heading for k in headings]
            found += [Placement.of(x, y, yaw, goal.surface) for yaw in yaws]
        return found

    def _free_placements(
        self, state: State, surface_index: int, number: int, rng: np.random.Generator
    ) -> list[Placement]:
        """Random unoccupied placements on a surface, in its least filled bins, with a
        heading for which the held object's grasp can come in where nothing bars it."""
        task = self.task
        assert state.held is not None
        assert state.grasp is not None
        surface = task.scene.surfaces[surface_index]
        arrangement = task.arrangement(state.placements)
        inset = task.shapes[state.held].outer_radius + PLACING_INSET
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
        radius = task.shapes[state.held].outer_radius
        low, high = surface.rest, surface.rest + task.shapes[state.held].size[2]
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
                free = self._free_at(state, x, y, surface_index)
                if not free and turn < 2:
                    continue
                for k in pick_headings(free or swept.ALL, 1, rng):
                    yaw = k * STEP + self._jitter(rng) - state.grasp.heading
                    found.append(Placement.of(x, y, yaw, surface_index))
                if len(found) >= number:
                    return found
        return found

    def _free_at(self, state: State, x: float, y: float, surface: int) -> int:
        """Headings along which nothing bars the way to a site that is not occupied."""
        if self._doubting:
            return swept.ALL
        task = self.task
        assert state.held is not None
        arrangement = task.arrangement(state.placements)
        site = np.array([[x, y]])
        grips = task.place_grips(state.held, None, state.grasp)[None]
        barred = swept.barred_matrix(site, grips, arrangement.boxes, task.strip)[0]
        reachable = int(task.reachable_sites(site, task.scene.surfaces[surface].rest)[0])
        return reachable & ~int(np.bitwise_or.reduce(barred)) if len(barred) else reachable

    # -- base poses ----------------------------------------------------------------------

    def _bases(
        self,
        state: State,
        wanted: Sequence[Sequence[tuple[Placement | None, Grasp]]],
        scale: int,
        rng: np.random.Generator,
    ) -> list[BasePose]:
        """Base poses from which the wanted grasps can be taken: one grasp of every object
        first, then the next of every object, and again, up to a number for each surface."""
        limit = BASES * scale
        count: dict[int, int] = {}
        bases: list[BasePose] = []
        for turn in range(ROUNDS * max((len(targets) for targets in wanted), default=0)):
            for targets in wanted:
                if turn >= ROUNDS * len(targets):
                    continue
                placement, grasp = targets[turn % len(targets)]
                if placement is None or count.get(placement.surface, 0) >= limit:
                    continue
                base = self.base_for(placement, grasp, rng)
                if base is not None:
                    bases.append(base)
                    count[placement.surface] = count.get(placement.surface, 0) + 1
        return bases

    def base_for(
        self, placement: Placement, grasp: Grasp, rng: np.random.Generator
    ) -> BasePose | None:
        """A random base pose from which the wrist of a grasp is in the arm's workspace."""
        workspace = self.task.robot.workspace
        x, y, yaw = placement.pose
        heading = yaw + grasp.heading
        wx = x - workspace.wrist_offset * math.cos(heading)
        wy = y - workspace.wrist_offset * math.sin(heading)
        tries = 48
        # Straight behind the gripper is easiest for the arm; stray further try by try.
        bearing = heading + rng.normal(size=tries) * np.linspace(0.2, 1.2, tries)
        reach = rng.uniform(workspace.inner, workspace.outer, tries)
        turn = rng.uniform(-0.4, 0.4, tries)
        cx, cy = workspace.centre
        room = self.task.room
        for b, r, t in zip(bearing, reach, turn, strict=True):
            hx, hy = wx - r * math.cos(b), wy - r * math.sin(b)
            facing = math.atan2(y - hy, x - hx) + t
            c, s = math.cos(facing), math.sin(facing)
            bx, by = hx - c * cx + s * cy, hy - s * cx - c * cy
            if plane.in_room(*room, bx, by):
                return BasePose.of(bx, by, facing)
        return None


def heading_bit(heading: float) -> int:
    """The bit of the heading (radians) that is nearest."""
    return round(heading / STEP) % HEADINGS


def pick_headings(bits: int, number: int, rng: np.random.Generator) -> list[int]:
    """Up to `number` of the headings whose bits are set, spread around the circle."""
    headings = [k for k in range(HEADINGS) if (bits >> k) & 1]
    if len(headings) <= number:
        return headings
    start = rng.integers(len(headings))
    places = (start + np.arange(number) * len(headings) / number) % len(headings)
    return [headings[int(i)] for i in places]
