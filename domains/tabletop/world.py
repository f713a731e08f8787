"""A scene and a robot: everything about a run that does not change.

Questions about states are answered by `features`; what they cost is remembered in `memory`,
which holds nothing that could not be computed anew.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from domains.tabletop import aslant, ends, holds, solids
from domains.tabletop.faces import faces_of
from domains.tabletop.features import swept
from domains.tabletop.features.goals import LATTICE, GoalSites
from domains.tabletop.features.swept import HEADINGS
from domains.tabletop.features.towers import storeys, with_room
from domains.tabletop.features.words import WordGoals
from domains.tabletop.foot import sunk_into
from domains.tabletop.ground import Ground
from domains.tabletop.hand import Hand, hand_of
from domains.tabletop.holds import SiteHold
from domains.tabletop.items import Item
from domains.tabletop.memory import Memory
from domains.tabletop.room import INSET, goes_over
from domains.tabletop.scene.model import (
    AnyGoal,
    HeldGoal,
    PoseGoal,
    RegionGoal,
    Scene,
    SceneObject,
)
from domains.tabletop.state import END, SLANT, TOP, BasePose, Grasp, Placement, State
from runtime.kernels import plane
from runtime.kernels.convex import Obstacles, boxes_only, join
from runtime.motion.roads import Roads
from runtime.motion.room import Room, room_around
from runtime.robot.model import RobotModel
from runtime.world.body import Part
from runtime.world.packed import PackedBodies, upright_row
from runtime.world.poses import Floats, Pose, compose, upright
from runtime.world.stable import ANY_TURN
from runtime.world.world import Peg, World
from sketchlang.analysis.words import listed
from sketchlang.errors import InputError

if TYPE_CHECKING:
    from domains.tabletop.features.arrangement import Arrangement

Ints = NDArray[np.int64]

Placements = tuple[Placement | None, ...]

OVER = 1e-4
"""Metres by which the solids of a knob may be wider than it was found to be."""

OF_THE_HAND = (
    "holds", "holds within a step", "place holds", "grasps", "grips", "turned", "turns",
    "carrying", "level",
)  # fmt: skip
"""Tables of the memory that depend on the objects and the robot alone, not on what stands about."""

AWAY = (1e3, 1e3, 0.0, 0.0)
"""Where the sites on an object are that is in the hand: nobody reaches them."""


@dataclass(frozen=True, eq=False)
class TabletopWorld:
    """One pick-and-place task. `families` are the approaches that may be used; `starts` are x, y,
    bottom and heading of the objects at the start. `faces` are the objects on each of their
    faces, `items` on that of the start."""

    scene: Scene
    robot: RobotModel
    items: tuple[Item, ...]
    faces: tuple[tuple[Item, ...], ...]
    starts: tuple[tuple[float, float, float, float], ...]
    grounds: tuple[Ground, ...]
    hand: Hand
    families: tuple[int, ...]
    statics: Floats
    roads: Roads
    room: Room
    memory: Memory = field(default_factory=Memory)

    @classmethod
    def of(
        cls, scene: Scene, robot: RobotModel, before: TabletopWorld | None = None
    ) -> TabletopWorld:
        """The world of a scene for a robot. Of a world `before`, with the same objects and the
        same robot, what is known of both stays known.

        Raises:
            InputError: the robot cannot stand where the scene puts it.
        """
        statics = fixed_rows(scene.world)
        roads = Roads.of(robot, robot.body(robot.gripper.max_opening), statics)
        x, y, _ = scene.robot_start
        # Where it has no room to turn, the room is that which it gets to straight backwards.
        room = (x, y) if is_fixed(robot) else roads.lane(scene.robot_start)
        if room is None:
            raise InputError(
                f"the robot cannot stand at ({x:g}, {y:g}): {_too_near(scene, roads)}",
                place=f"{scene.name}: robot_start",
            )
        sunk = sunk_into(scene, robot) if is_fixed(robot) else []
        if sunk:
            raise InputError(
                f"the foot of {robot.name} at ({x:g}, {y:g}) would be in {listed(sunk)}",
                place=f"{scene.name}: robot_start",
                hint="`height` under [base] in the robot's file says what it stands on",
            )
        turned = _seen_from(scene)
        made = [
            Item.of(thing, told.rests.yaw, 1 if thing.name in turned else _symmetry(told))
            for thing, told in zip(scene.world.movables, scene.objects, strict=True)
        ]
        items = tuple(item for item, _ in made)
        things = zip(scene.objects, scene.world.movables, items, strict=True)
        one = len(scene.families) == 1  # a hand that comes in one way only turns nothing
        alike = before is not None and (
            before.robot is robot
            and before.scene.objects is scene.objects
            and before.scene.world.movables is scene.world.movables
            and before.scene.families == scene.families
            and before.scene.aslant == scene.aslant
        )
        known = before if alike else None
        world = cls(
            scene=scene,
            robot=robot,
            items=items if known is None else known.items,
            faces=known.faces
            if known is not None
            else tuple(
                (item,) if one else faces_of(told, thing, item) for told, thing, item in things
            ),
            starts=tuple(start for _, start in made),
            grounds=grounds_of(scene, items),
            hand=hand_of(robot) if known is None else known.hand,
            families=scene.families if known is None else known.families,
            statics=statics,
            roads=roads,
            room=room_around(statics, roads.clearance, *room),
            memory=Memory() if known is None else known.memory.of_tables(OF_THE_HAND),
        )
        if known is None and scene.aslant:
            more = world.with_family(SLANT)
            world = more if aslant.is_wanted(world, more) else world
        if known is None and TOP in scene.families:
            more = world.with_family(END)
            world = more if ends.are_wanted(world, more) else world
        return world

    def with_family(self, family: int) -> TabletopWorld:
        """The same with one more family of approaches."""
        return replace(self, families=(*self.families, family), memory=Memory())

    @cached_property
    def initial(self) -> State:
        """The state that the scene describes."""
        placements: list[Placement | None] = [None] * len(self.items)
        # Supports that never move first, then what stands on things that have been placed.
        for i in sorted(range(len(self.items)), key=lambda i: self.starts[i][2]):
            support = self.scene.objects[i].rests.support
            pose = upright(*self.starts[i])
            placements[i] = self.relative(tuple(placements), support, pose)
        return State(BasePose.of(*self.scene.robot_start), tuple(placements), world=self)

    @cached_property
    def kinds(self) -> tuple[int, ...]:
        """For each object the first one that is like it."""
        first: dict[object, int] = {}
        kinds = [tuple(item.kind for item in faces) for faces in self.faces]
        return tuple(first.setdefault(kind, i) for i, kind in enumerate(kinds))

    def item(self, index: int, face: int) -> Item:
        """An object on one of its faces."""
        return self.faces[index][face]

    @cached_property
    def bases(self) -> frozenset[int]:
        """Objects on which some goal wants things: they stay on their face, for only that has a
        level top."""
        singles = [
            single
            for goal in self.scene.goals.values()
            for single in (goal.alternatives if isinstance(goal, AnyGoal) else (goal,))
        ]
        used = [s for g in singles if not isinstance(g, HeldGoal) for s in _supports_of(g)]
        used += [self.scene.word.support] if self.scene.word is not None else []
        owners = (self.grounds[support].owner for support in used)
        return frozenset(owner for owner in owners if owner is not None)

    @cached_property
    def owned(self) -> dict[int, tuple[int, ...]]:
        """The supports that belong to each object that has some."""
        found: dict[int, list[int]] = {}
        for i, ground in enumerate(self.grounds):
            if ground.owner is not None:
                found.setdefault(ground.owner, []).append(i)
        return {owner: tuple(indices) for owner, indices in found.items()}

    # -- where things are -------------------------------------------------------------------

    def rests(self, placements: Placements, index: int) -> tuple[float, float, float, float] | None:
        """x, y, height of the bottom and heading of an object in the world; None where it, or
        what it stands on, is in the hand."""
        placement = placements[index]
        return None if placement is None else self.rests_at(placements, index, placement)

    def rests_at(
        self, placements: Placements, index: int, placement: Placement
    ) -> tuple[float, float, float, float] | None:
        """The same were the object at a placement; None where the support is in the hand, or
        stands on another face than the one on which it bears something."""
        ground = self.grounds[placement.support]
        x, y, yaw = placement.pose
        if ground.owner is None:
            return x, y, ground.height, yaw
        below = self.bearer(placements, ground.owner)
        if below is None:
            return None
        bx, by, bz, byaw = below
        c, s = math.cos(byaw), math.sin(byaw)
        return bx + c * x - s * y, by + s * x + c * y, bz + ground.height, byaw + yaw

    def bearer(
        self, placements: Placements, owner: int
    ) -> tuple[float, float, float, float] | None:
        """The same of something that bears others: on the face on which it can only."""
        placement = placements[owner]
        if placement is None or placement.face:
            return None
        return self.rests_at(placements, owner, placement)

    def pose(self, placements: Placements, index: int) -> Pose | None:
        """The standing frame of an object in the world (3, 4), None where it is held."""
        found = self.rests(placements, index)
        return None if found is None else upright(*found)

    def relative(
        self, placements: Placements, support: int, pose: Pose, face: int = 0
    ) -> Placement | None:
        """The placement of something with a standing frame in the world (3, 4) on a support, on
        one of its faces; None where the support is in the hand."""
        ground = self.grounds[support]
        x, y, yaw = pose[0, 3], pose[1, 3], math.atan2(pose[1, 0], pose[0, 0])
        if ground.owner is not None:
            below = self.bearer(placements, ground.owner)
            if below is None:
                return None
            c, s = math.cos(below[3]), math.sin(below[3])
            dx, dy = x - below[0], y - below[1]
            x, y, yaw = c * dx + s * dy, c * dy - s * dx, yaw - below[3]
        return Placement.of(x, y, yaw, support, face)

    def standing_in(self, placements: Placements, index: int) -> list[int]:
        """Objects that rest on an object itself."""
        grounds = self.owned.get(index, ())
        return [i for i, p in enumerate(placements) if p is not None and p.support in grounds]

    def riders(self, placements: Placements, index: int) -> tuple[int, ...]:
        """Objects that rest on an object, or on what rests on it."""
        if index not in self.owned:
            return ()
        direct = self.standing_in(placements, index)
        return tuple(direct) + tuple(r for i in direct for r in self.riders(placements, i))

    def box_row(self, index: int, at: tuple[float, float, float, float], face: int = 0) -> Floats:
        """The upright box around an object that rests at x, y, height and heading on a face
        (8,)."""
        x, y, z, yaw = at
        a, b, c = self.faces[index][face].size
        return np.array([x, y, z + c / 2, a / 2, b / 2, c / 2, math.cos(yaw), math.sin(yaw)])

    def site_boxes(self, index: int, goal: GoalSites) -> Floats:
        """The boxes (S, 8) around an object at the sites of a goal on furniture."""
        nothing: Placements = (None,) * len(self.items)

        def compute() -> Floats:
            found = [self.rests_at(nothing, index, p) for p in goal.placements]
            return np.array([self.box_row(index, at) for at in found if at is not None])

        return self.memory.answer("site boxes", (goal.key, self.kinds[index]), compute)

    @cached_property
    def packed(self) -> PackedBodies | None:
        """The solids of all objects, as they stand, and of what is fixed, in one table; None
        where all of them are upright boxes."""
        return solids.packed(self)

    @cached_property
    def forms(self) -> list[Item]:
        """All objects on all of their faces, in the order of `packed`."""
        return [item for faces in self.faces for item in faces]

    @cached_property
    def first_form(self) -> list[int]:
        """Where in that order the faces of each object begin."""
        counts = [len(faces) for faces in self.faces]
        return [sum(counts[:i]) for i in range(len(counts))]

    @cached_property
    def fixed(self) -> Obstacles:
        """What never moves."""
        things = self.scene.world.fixed
        if self.packed is None:
            return boxes_only(self.statics)
        n = len(self.forms)
        return join(*(self.packed.at(n + i, thing.pose) for i, thing in enumerate(things)))

    def object_at(
        self, index: int, at: tuple[float, float, float, float], face: int = 0
    ) -> Obstacles:
        """The solids of an object that rests at x, y, height and heading on a face."""
        return solids.object_at(self, index, at, face)

    def obstacles(self, placements: Placements, without: Collection[int]) -> Obstacles:
        """What is fixed and all objects that rest, but for some."""
        return solids.obstacles(self, placements, without)

    def rider_parts(self, placements: Placements, index: int) -> tuple[Part, ...]:
        """The solids of what rests on an object, in the object's standing frame."""
        return solids.rider_parts(self, placements, index)

    def rests_on(self, placements: Placements, rider: int, below: int) -> Pose:
        """The standing frame of a rider (3, 4) in that of the object it is carried by."""
        return solids.rests_on(self, placements, rider, below)

    def own(self, index: int, face: int = 0) -> Floats:
        """What an object takes up where it stands, whatever its heading: radius and height."""
        if face:
            item = self.faces[index][face]
            return np.array([item.inner_radius, item.size[2]])
        taken: Floats = self.owns[index]
        return taken

    def owns_of(self, placements: Placements) -> Floats:
        """The same for all objects (n, 2), on the faces on which they rest."""
        turned = [i for i, p in enumerate(placements) if p is not None and p.face]
        if not turned:
            return self.owns
        found = self.owns.copy()
        for i in turned:
            placement = placements[i]
            assert placement is not None
            found[i] = self.own(i, placement.face)
        return found

    @cached_property
    def owns(self) -> Floats:
        """The same for all objects (n, 2), on their faces at the start."""
        return np.array([[i.inner_radius, i.size[2]] for i in self.items]).reshape(-1, 2)

    def radius(self, index: int) -> float:
        """Radius of the smallest upright cylinder around an object on any of its faces, metres."""
        return max(item.outer_radius for item in self.faces[index])

    @cached_property
    def widest(self) -> float:
        """Metres in the plane that the swept volumes reach from the grasp centre, at most."""
        return max(float(swept.extent(self.hand.sweeps[family])) for family in self.families)

    # -- how things are taken -----------------------------------------------------------------

    def hold(self, index: int, family: int, yaw: float, face: int = 0) -> SiteHold:
        """How an object that stands with a heading on a face is taken along each heading of the
        hand."""
        return holds.hold(self, index, family, yaw, face)

    def learn_holds(self, family: int, standing: Iterable[tuple[int, int, float]]) -> None:
        """Look at once at how objects, by index, face and heading, are taken, where that is not
        known yet."""
        return holds.learn_holds(self, family, standing)

    def grasp(self, index: int, face: int, family: int, angle: float) -> Grasp | None:
        """The grasp of an object by a family at a heading in the standing frame of a face; None
        where no hand takes it so."""
        return holds.grasp(self, index, face, family, angle)

    def place_hold(
        self, index: int, family: int, yaw: float | None, grasp: Grasp | None
    ) -> SiteHold:
        """How an object is held while it is put down, for each heading of the hand there: given
        by its heading there where that is prescribed, else by the grasp that holds it, else
        that of its narrowest grasp."""
        return holds.place_hold(self, index, family, yaw, grasp)

    # -- what the robot can get to ---------------------------------------------------------------

    def reachable(
        self, sites: Floats, own: Floats, hold: SiteHold, family: int, wanted: int = swept.ALL
    ) -> Ints:
        """Bits of the `wanted` headings (S,) from which the robot could take, at sites (S, 3),
        something that is held in a way, as far as what never moves is concerned."""
        sweeps = self.hand.sweeps[family]
        open_ways = swept.open_headings(sites, hold.rows, hold.height, own, self.statics, sweeps)
        for support in self.pegs:  # what stands there goes over the peg
            ground = self.grounds[support]
            assert ground.peg is not None
            away = np.abs(sites[:, :2] - ground.pose[:2, 3]).max(axis=1)
            over = away < ground.peg.radius
            if over.any():
                beside = self._statics_beside(support)
                open_ways[over] = swept.open_headings(
                    sites[over], hold.rows, hold.height, own, beside, sweeps
                )
        open_ways &= hold.fits & wanted
        out: Ints = np.zeros(len(sites), dtype=np.int64)
        for height in np.unique(sites[:, 2]).tolist():
            level = sites[:, 2] == height
            workspace = self.hand.workspace(family, height + hold.height)
            if workspace is None:
                continue
            wrist, inner, outer = workspace
            if self.is_fixed:
                base = np.array(self.scene.robot_start)
                out[level] = swept.fixed_headings(
                    sites[level],
                    hold.rows,
                    open_ways[level],
                    base,
                    self.shoulder,
                    wrist,
                    inner,
                    outer,
                )
            else:
                out[level] = swept.stand_headings(
                    sites[level], hold.rows, open_ways[level], self.shoulder, wrist, inner, outer,
                    *self.room.floor,
                )  # fmt: skip
        return out

    @cached_property
    def pegs(self) -> tuple[int, ...]:
        """The supports around pegs that never move."""
        return tuple(i for i, g in enumerate(self.grounds) if g.peg is not None and g.owner is None)

    def statics_at(self, x: float, y: float) -> Floats:
        """The boxes of what never moves (w, 8), but for a peg that rises at a point: what stands
        there goes over it."""
        support = self._peg_at(x, y)
        return self.statics if support is None else self._statics_beside(support)

    def peg_over(self, support: int, at: tuple[float, float, float, float]) -> Peg | None:
        """The peg that rises into what rests on a support at x, y, height and heading: that of the
        support, or one that comes through a hole in what the support belongs to."""
        own = self.grounds[support].peg
        if own is not None and own.height:
            return own
        through = self._peg_at(at[0], at[1]) if self.pegs else None
        if through is None:
            return None
        ground = self.grounds[through]
        assert ground.peg is not None
        height = ground.height + ground.peg.height - at[2]
        return Peg(ground.peg.radius, height) if height > 0 else None

    def named_statics_at(self, x: float, y: float) -> tuple[list[str], list[Floats]]:
        """The names of what never moves but for a peg that rises at a point, one for each box, and
        the boxes (8,)."""
        support = self._peg_at(x, y)
        owner = None if support is None else self.scene.supports[support].owner
        names = [thing.name for thing in self.scene.world.fixed for _ in thing.body.parts]
        pairs = zip(names, self.statics, strict=True)
        kept = [(name, row) for name, row in pairs if name != owner]
        return [name for name, _ in kept], [row for _, row in kept]

    def _peg_at(self, x: float, y: float) -> int | None:
        """The support around a peg that never moves, over which a point is."""
        for support in self.pegs:
            (px, py), peg = self.grounds[support].pose[:2, 3], self.grounds[support].peg
            if peg is not None and abs(px - x) < peg.radius and abs(py - y) < peg.radius:
                return support
        return None

    def _statics_beside(self, support: int) -> Floats:
        """The boxes of what never moves but for the peg of a support (w, 8)."""

        def compute() -> Floats:
            x, y = self.grounds[support].pose[:2, 3].tolist()
            return np.array(self.named_statics_at(x, y)[1]).reshape(-1, 8)

        return self.memory.answer("beside pegs", support, compute)

    def part_rows(self, index: int, at: tuple[float, float, float, float], face: int = 0) -> Floats:
        """The upright boxes (k, 8) around the solids of an object that rests at x, y, height and
        heading on a face, but for those of its pegs: what goes over them is not barred by them."""
        kind = self.kinds[index]
        rows = self.memory.answer(
            "part rows", (kind, face), lambda: self._part_rows(kind, face)
        ).copy()
        c, s = math.cos(at[3]), math.sin(at[3])
        turn = np.array([[c, s], [-s, c]])
        rows[:, :2] = rows[:, :2] @ turn + at[:2]
        rows[:, 2] += at[2]
        rows[:, 6:] = rows[:, 6:] @ turn
        return rows

    def _part_rows(self, index: int, face: int) -> Floats:
        parts = self.item(index, face).parts
        rows = np.array([upright_row(part.solid, part.pose) for part in parts])
        for support in () if face else self.owned.get(index, ()):
            ground = self.grounds[support]
            if ground.peg is not None:
                away = np.abs(rows[:, :2] - ground.pose[:2, 3]).max(axis=1)
                within = away + rows[:, 3:5].max(axis=1) <= ground.peg.radius + OVER
                rows = rows[~within | (rows[:, 2] + rows[:, 5] <= ground.height)]
        return rows

    def may_rest(self, index: int, support: int, face: int = 0) -> bool:
        """Whether an object may be put on a support at all: it is not kept to others, and where it
        would have to go over a peg, it can."""
        only_on, ground = self.scene.objects[index].only_on, self.grounds[support]
        if only_on is not None and support not in only_on:
            return False
        return ground.peg is None or goes_over(self.item(index, face), ground.peg)

    @cached_property
    def may_bear(self) -> tuple[int, ...]:
        """For each object, how many others may be put on it."""
        n = len(self.items)
        return tuple(
            sum(
                any(self.may_rest(other, support) for support in self.owned.get(index, ()))
                for other in range(n)
                if other != index
            )
            for index in range(n)
        )

    def reachable_at(
        self, index: int, family: int, at: tuple[float, float, float, float], face: int = 0
    ) -> int:
        """The same for an object that rests at x, y, height and heading on a face."""
        key = (self.kinds[index], family, at[3], *at[:3], face)
        hold, own = self.hold(index, family, at[3], face), self.own(index, face)
        return self.memory.answer(
            "reachable",
            key,
            lambda: int(self.reachable(np.array([at[:3]]), own, hold, family)[0]),
        )

    @property
    def is_fixed(self) -> bool:
        """Whether the robot cannot drive."""
        return is_fixed(self.robot)

    @cached_property
    def shoulder(self) -> Floats:
        """Where the shoulder axis stands in the base frame (2,)."""
        return np.array(self.robot.centre)

    def reachable_goal(
        self, goal: GoalSites, index: int, family: int, hold: SiteHold, face: int = 0
    ) -> Ints:
        """The same for the sites of a goal of an object on a face."""
        question = (goal.key, self.kinds[index], family, face, hold.key)
        own = self.own(index, face)
        if goal.frame is None:
            return self.memory.answer(
                "reachable goals", question, lambda: self.reachable(goal.xyz, own, hold, family)
            )
        return self.reachable(goal.xyz, own, hold, family)

    def is_narrow(self, x: float, y: float, yaw: float) -> bool:
        """Whether the robot can stand somewhere with a heading, though it cannot turn there: it
        comes in and leaves along a lane."""
        lane = self.roads.lane((x, y, yaw))
        return lane is not None and self.room.contains(*lane)

    # -- goals ----------------------------------------------------------------------------------

    @cached_property
    def words(self) -> WordGoals | None:
        """Where the letters of the scene's word belong."""
        return WordGoals(self, self.scene.word) if self.scene.word is not None else None

    @cached_property
    def goals(self) -> dict[int, GoalSites]:
        """Goal sites of the objects whose goal does not depend on where other objects are; the
        same ones for objects that belong in the same place."""
        found: dict[int, GoalSites] = {}
        known: dict[object, GoalSites] = {}
        for index, goal in self.placed_goals.items():
            if self.grounds[goal.support].owner is None:
                sites = self.sites_of(index, goal, None)
                found[index] = known.setdefault((sites.key, sites.symmetry), sites)
        return found

    @cached_property
    def wanted_held(self) -> frozenset[int]:
        """The objects that are to be, or may be, in the gripper at the end."""
        return frozenset(
            index
            for index, goal in self.scene.goals.items()
            for each in (goal.alternatives if isinstance(goal, AnyGoal) else (goal,))
            if isinstance(each, HeldGoal)
        )

    @cached_property
    def placed_goals(self) -> dict[int, RegionGoal | PoseGoal]:
        """The goals of objects that have to be somewhere."""
        goals = self.scene.goals.items()
        return {i: goal for i, goal in goals if isinstance(goal, RegionGoal | PoseGoal)}

    def wanted(self, here: Arrangement) -> Iterable[int]:
        """Objects of which something is wanted."""
        return self.letters(here) if self.words is not None else self.scene.goals

    def letters(self, here: Arrangement) -> dict[int, GoalSites]:
        """Where the letters of the scene's word belong in an arrangement."""
        assert self.words is not None
        if "word" not in here.letters:
            here.letters["word"] = self.words.assign(here)
        return here.letters["word"]

    def goal_sites(self, index: int, here: Arrangement) -> GoalSites | None:
        """Where an object should be, or None where it may be anywhere."""
        if self.words is not None:
            return self.letters(here).get(index)
        fixed = self.goals.get(index)
        if fixed is not None:
            return fixed
        goal = self.scene.goals.get(index)
        if goal is None or isinstance(goal, HeldGoal):
            return None
        if not isinstance(goal, AnyGoal):
            return self.sites_of(index, goal, here)
        return self._best_of(index, goal, here)

    def _best_of(self, index: int, goal: AnyGoal, here: Arrangement) -> GoalSites | None:
        """Of several goals one that holds, else the one with the fewest obstructions; not one that
        leaves no room for what is to stand on the object."""
        choices = [
            self.sites_of(index, each, here)
            for each in goal.alternatives
            if not isinstance(each, HeldGoal)
        ]
        placement = here.placements[index]
        if storeys(self, index):
            choices = list(with_room(here, index, choices))
        for sites in choices:
            if placement is not None and sites.holds(placement):
                return sites
        found = [here.obstructions_with(index, sites, None, None) for sites in choices]
        return choices[found.index(min(found))] if choices else None

    def sites_of(
        self, index: int, goal: RegionGoal | PoseGoal, here: Arrangement | None
    ) -> GoalSites:
        """The sites of one goal; on a support that can be moved they are where it is now."""
        ground = self.grounds[goal.support]
        below = (0.0, 0.0, 0.0, 0.0)
        if ground.owner is not None:
            assert here is not None
            below = self.bearer(here.placements, ground.owner) or AWAY
        key: tuple[object, ...]
        region: Ground | None = None
        if isinstance(goal, RegionGoal):
            inset = INSET + max(item.outer_radius for item in self.items)
            if ground.owner is not None or inset > min(ground.half):
                inset = INSET + self.items[index].inner_radius
            xy = ground.lattice(LATTICE, inset)
            if ground.peg is not None:
                xy = np.array([ground.outside(0.0, 0.0)])
            key, region = ("region", goal.support, round(inset, 6)), ground
            tolerance, yaw = 0.0, None
        else:
            point, turn = (goal.x, goal.y), 0.0
            if ground.owner is not None:  # such goals are in the frame of the region
                point, turn = ground.outside(goal.x, goal.y), ground.yaw
            xy = np.array([point])
            yaw = None if goal.yaw is None else goal.yaw + turn
            key, tolerance = ("pose", index, goal), goal.tolerance
        c, s = math.cos(below[3]), math.sin(below[3])
        turned = xy @ np.array([[c, s], [-s, c]])
        xyz = np.column_stack([turned + below[:2], np.full(len(xy), below[2] + ground.height)])
        return GoalSites(
            key if ground.owner is None else (*key, below),
            goal.support,
            xy,
            xyz,
            tolerance,
            yaw,
            1 if index in self.scene.bearing else self.items[index].symmetry,
            region,
            None if ground.owner is None else below[3],
            self._bearers(goal),
        )

    def _bearers(self, goal: RegionGoal | PoseGoal) -> tuple[int, ...]:
        """The objects that bear what is at a goal."""
        owners = (self.grounds[support].owner for support in _supports_of(goal))
        return tuple(owner for owner in owners if owner is not None)


def _seen_from(scene: Scene) -> set[str]:
    """Objects in whose frame other objects have a goal that is off the middle: which way they are
    turned matters, whatever their own symmetry."""
    goals = [goal for goal in scene.goals.values() if isinstance(goal, PoseGoal)]
    return {
        scene.supports[goal.support].owner
        for goal in goals
        if math.hypot(goal.x, goal.y) > goal.tolerance or goal.yaw is not None
    }


def _supports_of(goal: RegionGoal | PoseGoal) -> tuple[int, ...]:
    """The supports that bear what a goal wants."""
    return (goal.support, *(goal.others if isinstance(goal, PoseGoal) else ()))


def _symmetry(thing: SceneObject) -> int:
    """How many turns about z map an object to itself as it stands."""
    turns = thing.stable[thing.rests.stable].symmetry
    return HEADINGS if turns == ANY_TURN else max(1, turns)


def is_fixed(robot: RobotModel) -> bool:
    """Whether a robot cannot drive."""
    return getattr(robot.base, "type", "differential") == "fixed"


def fixed_rows(world: World) -> Floats:
    """The upright boxes around the solids of what is fixed, packed for the kernels (w, 8)."""
    rows = [
        upright_row(part.solid, compose(thing.pose, part.pose))
        for thing in world.fixed
        for part in thing.body.parts
    ]
    return np.array(rows).reshape(-1, 8)


def grounds_of(scene: Scene, items: tuple[Item, ...]) -> tuple[Ground, ...]:
    """The supports of a scene, by the objects that own them."""
    world = scene.world
    index = {thing.name: i for i, thing in enumerate(world.movables)}
    found = []
    for support in world.supports:
        owner = index.get(support.owner)
        pose = support.pose if owner is None else compose(items[owner].standing, support.pose)
        found.append(
            Ground(support.name, owner, pose, support.half, support.clearance, support.peg)
        )
    return tuple(found)


def _too_near(scene: Scene, roads: Roads) -> str:
    """What keeps the robot from turning where it starts."""
    x, y, _ = scene.robot_start
    names = [thing.name for thing in scene.world.fixed for _ in thing.body.parts]
    rows = zip(names, roads.boxes, roads.clearance, strict=True)
    near = {name for name, row, room in rows if plane.point_distance(row, x, y) < room}
    return (
        f"there is no room to turn between {listed(sorted(near))}"
        if len(near) > 1
        else (f"it would touch {listed(sorted(near))}, or could not turn beside it")
    )
