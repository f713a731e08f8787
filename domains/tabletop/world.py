"""A scene and a robot: everything about a run that does not change, and the domain's
functions over states (misplaced, obstructions, disturbances, ...)."""

from __future__ import annotations

from collections import OrderedDict
from itertools import islice

import numpy as np

from domains.tabletop.features import swept
from domains.tabletop.features.arrangement import Arrangement, Placements
from domains.tabletop.features.goals import GoalSites, lattice
from domains.tabletop.features.swept import HEADINGS, STEP
from domains.tabletop.features.words import WordGoals
from domains.tabletop.scene.model import PoseGoal, RegionGoal, Scene
from domains.tabletop.shapes import Shape, box_shape
from domains.tabletop.state import BasePose, Grasp, Placement, State
from runtime.motion.base import BaseRoads, Footprint, footprint
from runtime.motion.room import room_around
from runtime.robot.model import Floats, Ints, RobotModel
from sketchlang.errors import InputError

CACHED_OBJECTS = 12_000
"""As many arrangements are remembered as hold so many objects together, and not less than ..."""

MIN_CACHED = 48
LOOK_BACK = 12
"""Arrangements that are looked through for one that differs in one object only."""

PLACING_INSET = 0.005
"""Metres between the edge of a surface and the outline of an object placed on it."""


class Task:
    """One pick-and-place task: the features and the sampler ask it about states."""

    def __init__(self, scene: Scene, robot: RobotModel) -> None:
        self.scene = scene
        self.robot = robot
        self.shapes: tuple[Shape, ...] = tuple(box_shape(o.size) for o in scene.objects)
        strip = robot.strip
        self.strip: Floats = np.array(
            [
                strip.finger_back,
                strip.finger_tip,
                strip.arm_length,
                strip.arm_half_width,
                strip.finger_width,
            ]
        )
        self.statics: Floats = scene.obstacle_rows
        self.footprint: Footprint = footprint(robot, robot.body(robot.gripper.max_opening))
        self.clearance: Floats = self.footprint.clearances(self.statics)
        self.roads = BaseRoads(self.statics, self.clearance)
        self.room = room_around(self.statics, self.clearance, *scene.robot_start[:2])
        self._arrangements: OrderedDict[Placements, Arrangement] = OrderedDict()
        self._latest: tuple[Placements, Arrangement] = ((), Arrangement(self, ()))
        self._reachable: dict[tuple[float, float, int], int] = {}
        self._holds: dict[object, bool] = {}
        self._rows: dict[tuple[int, Placement], Floats] = {}
        self._grips: dict[object, Floats] = {}
        self._place_grips: dict[object, Floats] = {}
        self.goals = self._static_goals()
        self.words = WordGoals(self, scene.word) if scene.word is not None else None
        self.initial = self._initial()

    # -- set-up ---------------------------------------------------------------------------

    def _initial(self) -> State:
        x, y, yaw = self.scene.robot_start
        if not self.roads.is_clear(x, y):
            raise InputError(
                f"the robot cannot stand at ({x:g}, {y:g}): it would touch a table or the fence",
                place=f"{self.scene.name}: robot_start",
            )
        placements = tuple(
            Placement.of(*thing.start, thing.surface) for thing in self.scene.objects
        )
        return State(BasePose.of(x, y, yaw), placements, task=self)

    def _static_goals(self) -> dict[int, GoalSites]:
        """Goal sites of the objects whose goal does not depend on the state."""
        regions: dict[int, GoalSites] = {}
        goals: dict[int, GoalSites] = {}
        for index, goal in self.scene.goals.items():
            surface = self.scene.surfaces[goal.surface]
            if isinstance(goal, RegionGoal):
                if goal.surface not in regions:
                    inset = max(s.outer_radius for s in self.shapes) + PLACING_INSET
                    xy = lattice(surface, inset)
                    regions[goal.surface] = GoalSites(
                        ("region", goal.surface),
                        goal.surface,
                        xy,
                        self.reachable_sites(xy, surface.rest),
                        0.0,
                        region=surface,
                    )
                goals[index] = regions[goal.surface]
            else:
                goals[index] = self._pose_goal(index, goal)
        return goals

    def _pose_goal(self, index: int, goal: PoseGoal) -> GoalSites:
        xy = np.array([[goal.x, goal.y]])
        rest = self.scene.surfaces[goal.surface].rest
        reachable = self.reachable_sites(xy, rest)
        return GoalSites(("pose", index), goal.surface, xy, reachable, goal.tolerance)

    def reachable_sites(self, xy: Floats, rest: float) -> Ints:
        """Bits of the headings (S,) from which the robot could grasp at sites (S, 2)."""
        workspace = self.robot.annulus
        height = rest + min(shape.grasp_height for shape in self.shapes)
        bits: Ints = swept.reachable_headings(
            xy,
            self.strip,
            np.array(workspace.centre),
            workspace.wrist_offset,
            workspace.inner,
            workspace.outer,
            height - 0.03,
            height + 0.03,
            *self.room,
        )
        return bits

    def reachable_at(self, placement: Placement) -> int:
        """Bits of the headings from which the robot could grasp an object placed there."""
        return self.reachable_xy(*placement.pose[:2], placement.surface)

    def reachable_xy(self, x: float, y: float, surface: int) -> int:
        """The same for a point of a surface."""
        key = (x, y, surface)
        if key not in self._reachable:
            sites = np.array([[x, y]])
            rest = self.scene.surfaces[surface].rest
            self._reachable[key] = int(self.reachable_sites(sites, rest)[0])
        return self._reachable[key]

    # -- the domain's functions -------------------------------------------------------------

    def arrangement(self, placements: Placements) -> Arrangement:
        """The geometry of an arrangement, from the cache where it is known."""
        if placements is self._latest[0]:  # hashing the places of many objects takes its time
            return self._latest[1]
        found = self._arrangements.get(placements)
        if found is None:
            found = Arrangement(self, placements, self._origin_of(placements))
            self._arrangements[placements] = found
            if len(self._arrangements) > max(MIN_CACHED, CACHED_OBJECTS // len(placements)):
                self._arrangements.popitem(last=False)
        else:
            self._arrangements.move_to_end(placements)
        self._latest = placements, found
        return found

    def _origin_of(self, placements: Placements) -> tuple[Arrangement, int] | None:
        """A recent arrangement that differs in one object only, and that object."""
        for known in islice(reversed(self._arrangements), LOOK_BACK):
            changed = -1
            for i, (a, b) in enumerate(zip(known, placements, strict=True)):
                if a is not b and a != b:
                    if changed >= 0:
                        break
                    changed = i
            else:
                origin = self._arrangements[known]
                origin.settle()
                return origin, changed
        return None

    def goal_sites(self, index: int, arrangement: Arrangement) -> GoalSites | None:
        """Where an object should stand, or None where it may stand anywhere."""
        if self.words is not None:
            return arrangement.letters.get(index)
        return self.goals.get(index)

    def misplaced(self, state: State) -> frozenset[int]:
        """Objects that stand outside their goal, or are held and their goal is blocked."""
        arrangement = self.arrangement(state.placements)
        known = arrangement.misplaced.get(state.grasp)
        if known is None:
            known = arrangement.misplaced[state.grasp] = frozenset(
                index
                for index in range(len(state.placements))
                if self._is_misplaced(state, index, arrangement)
            )
        return known

    def _is_misplaced(self, state: State, index: int, arrangement: Arrangement) -> bool:
        goal = self.goal_sites(index, arrangement)
        if goal is None:
            return False
        placement = state.placements[index]
        if placement is None:
            return arrangement.obstructions(index, goal, state.grasp) > 0
        key = (goal.key, placement)
        holds = self._holds.get(key)
        if holds is None:
            holds = self._holds[key] = goal.holds(placement)
        return not holds

    def obstructions(self, state: State, index: int) -> int:
        """alpha of an object: fewest objects in the way of picking it up and of putting it
        at its goal with the same grasp (0 for an object without a goal)."""
        arrangement = self.arrangement(state.placements)
        goal = self.goal_sites(index, arrangement)
        if goal is None:
            return 0
        grasp = state.grasp if state.held == index else None
        return arrangement.obstructions(index, goal, grasp)

    def goal_placements(self, state: State, index: int) -> tuple[Placement, ...]:
        """Goal placements of an object that no other object occupies."""
        arrangement = self.arrangement(state.placements)
        goal = self.goal_sites(index, arrangement)
        if goal is None:
            return ()
        radius = self.shapes[index].inner_radius
        taken = swept.occupied_sites(goal.xy, radius, arrangement.boxes, index)
        return tuple(
            placement
            for placement, occupied in zip(goal.placements, taken, strict=True)
            if not occupied
        )

    def disturbed_by(self, state: State, index: int, placement: Placement) -> int:
        """How many other misplaced objects are obstructed more with the object there."""
        return self._without(state, index).disturbed_by(index, placement, self.misplaced(state))

    def disturbances(self, state: State, index: int) -> int:
        """beta of an object: fewest misplaced objects that a goal place of it blocks."""
        arrangement = self.arrangement(state.placements)
        goal = self.goal_sites(index, arrangement)
        if goal is None:
            return 0
        misplaced = self.misplaced(state)
        without = self._without(state, index)
        fewest = len(misplaced)
        for placement in self.goal_placements(state, index) or goal.placements:
            fewest = min(fewest, without.disturbed_by(index, placement, misplaced))
            if fewest == 0:
                break
        return fewest

    def _without(self, state: State, index: int) -> Arrangement:
        placements = state.placements
        if placements[index] is not None:
            placements = (*placements[:index], None, *placements[index + 1 :])
        return self.arrangement(placements)

    # -- what actions need -------------------------------------------------------------------

    def object_row(self, index: int, placement: Placement) -> Floats:
        """An object at a placement, packed for the kernels (8,)."""
        key = (index, placement)
        row = self._rows.get(key)
        if row is None:
            box = self.scene.object_box(index, *placement.pose, placement.surface)
            row = self._rows[key] = box.row()
        return row

    def grips(self, index: int, yaw: float) -> Floats:
        """Half the width (K,) of an object with a heading, across each approach heading."""
        key = (self.shapes[index].size, yaw)
        grips = self._grips.get(key)
        if grips is None:
            angles = np.linspace(0.0, HEADINGS * STEP, HEADINGS, endpoint=False) - yaw
            grips = self._grips[key] = self.shapes[index].widths(angles) / 2
        return grips

    def place_grips(self, index: int, goal: GoalSites | None, grasp: Grasp | None) -> Floats:
        """Half the width (K,) of an object between the fingers, for each heading with which
        it can be put at a goal: given by its heading there where that is prescribed, else by
        the grasp that holds it, else that of its narrowest grasp."""
        yaw = None if goal is None else goal.yaw
        key = (self.shapes[index].size, yaw, None if grasp is None else grasp.angle)
        grips = self._place_grips.get(key)
        if grips is None:
            if yaw is not None:
                grips = self.grips(index, yaw)
            elif grasp is not None:
                width = round(self.shapes[index].width(grasp.heading) / 2, 4)
                grips = np.full(HEADINGS, width)
            else:
                grips = np.full(HEADINGS, self.grips(index, 0.0).min())
            self._place_grips[key] = grips
        return grips

    def world_rows(self, state: State, without: int | None = None) -> Floats:
        """Obstacles and standing objects packed for the kernels (w, 8)."""
        rows = [
            self.object_row(i, placement)
            for i, placement in enumerate(state.placements)
            if placement is not None and i != without
        ]
        return np.vstack([self.statics, *rows]) if rows else self.statics
