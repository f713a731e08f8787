"""A plan carried out in exact geometry, step by step, until something is wrong."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from itertools import pairwise

import numpy as np

from runtime.angles import wrap
from runtime.judge.carried import dense_poses, guide_fault, slide_fault, touch_fault, tracks_of
from runtime.judge.collisions import Crowd, first_collision
from runtime.judge.contacts import Exact, Track
from runtime.judge.extents import homogeneous
from runtime.judge.findings import Finding
from runtime.judge.footing import above, footings, movable
from runtime.judge.grip import grip_fault, load_fault
from runtime.judge.limits import arm_fault, base_fault, finger_fault
from runtime.judge.load import Load, accelerations, drive_pushes, even_times, loads_of
from runtime.judge.skeleton import Skeleton
from runtime.judge.stability import falls, fault_of_rest
from runtime.judge.together import Underway
from runtime.motion.motion import (
    ArmMove,
    Attach,
    BaseMove,
    Carried,
    GripperMove,
    Release,
    Together,
)
from runtime.plan.model import PlanAction, TimedPiece
from runtime.robot.model import RobotModel
from runtime.world.poses import Floats
from runtime.world.quaternions import matrix
from runtime.world.world import World

JOINT_STEP = 0.01
"""Radians (metres) between samples of an arm motion."""

BASE_STEP = 0.01
"""Metres and radians between samples of a base motion."""

FINGER_STEP = 0.005
"""Metres between samples of the gripper's opening."""

JOIN = 1e-4
"""Radians or metres by which consecutive pieces may differ: rounding in the file."""

PLACE = 0.001
"""Metres by which a released body may miss the pose that the plan states."""

TURNED = 0.01
"""Radians by which it may."""

SPILL = 0.1
"""Radians by which something that other things stand on may lean while it is carried."""


class Replay:
    """What a plan has done to robot and world so far.

    `poses` are those (4, 4) of the movables that are not held, by index; `group` the poses in
    the link `link` of the body that is held and of those that stand on it.
    """

    def __init__(self, world: World, robot: RobotModel, base: Floats) -> None:
        self.world, self.robot = world, robot
        self.skeleton, self.exact = Skeleton(robot), Exact()
        self.base, self.q, self.opening = base, robot.home.copy(), robot.gripper.max_opening
        self.poses = {i: homogeneous(thing.pose) for i, thing in enumerate(world.movables)}
        self.fixed = [homogeneous(thing.pose) for thing in world.fixed]
        self.held: int | None = None
        self.link = robot.urdf_tool
        self.group: dict[int, Floats] = {}
        self.loads: list[Load] = []
        self.samples = 0
        self.findings: list[Finding] = []
        self._number = 0
        self._motion = Underway()
        self._up = np.array([0.0, 0.0, 1.0])  # the vertical in the frame of what is held
        self._known: dict[str, tuple[Floats, list[Track]]] = {}

    def action(self, number: int, action: PlanAction) -> None:
        """Carry out an action, up to the first thing that is wrong with it."""
        self._number = number
        for timed in action.pieces:
            if not isinstance(timed.piece, Together) and not self.rest():
                return
            match timed.piece:
                case BaseMove(poses, along):
                    done = self._drive(poses, along, timed)
                case ArmMove(path, _, along):
                    done = self._reach(path, along, timed)
                case Together() as piece:
                    done = self._together(piece, timed.times)
                case GripperMove() as piece:
                    done = self._gripper(piece, float(timed.times[-1]))
            if not done:
                return  # what follows a mistake would only repeat it

    def _find(self, message: str | None) -> bool:
        """Note what is wrong, None for nothing; whether it is nothing."""
        if message is not None:
            self.findings.append(Finding(self._number, message))
        return message is None

    # -- motions -----------------------------------------------------------------------------

    def _drive(self, poses: Floats, along: Sequence[Carried], timed: TimedPiece) -> bool:
        jump = np.abs(poses[0] - self.base)
        jump[2] = abs(wrap(poses[0, 2] - self.base[2]))
        if jump.max() > JOIN:
            return self._find(f"the base jumps by {jump.max():.4f} (m or rad)")
        if self.held is None and np.abs(self.q - self.robot.home).max() > JOIN:
            return self._find("the robot drives while its arm is not in the home posture")
        if not self._find(base_fault(self.robot.base, poses, timed.times)):
            return False
        base, counts = _dense(poses, np.full(3, BASE_STEP))
        done = self._travel(base, np.tile(self.q, (len(base), 1)), along, counts)
        self.base = poses[-1].copy()
        return done and self._find(self._shaken_off_driving())

    def _reach(self, path: Floats, along: Sequence[Carried], timed: TimedPiece) -> bool:
        if path.shape[1] != len(self.robot.joints):
            return self._find(f"{path.shape[1]} joint values for {len(self.robot.joints)} joints")
        jump = np.abs(path[0] - self.q)
        if jump.max() > JOIN:
            joint = self.robot.joints[int(jump.argmax())]
            return self._find(f"{joint} jumps by {jump.max():.4f} between two motions")
        if not self._find(arm_fault(self.robot, path, timed.times)):
            return False
        q, counts = _dense(path, np.full(len(self.q), JOINT_STEP))
        done = self._travel(np.tile(self.base, (len(q), 1)), q, along, counts)
        self.q = path[-1].copy()
        base = np.tile(self.base, (len(path), 1))
        return done and self._find(self._shaken_off(base, path, timed.times, True))

    # -- what stands on what is held ---------------------------------------------------------

    def _shaken_off(self, poses: Floats, path: Floats, times: Floats, rests: bool) -> str | None:
        """What slides or tips while base and arm go through way points, None for nothing;
        `rests`: they are at rest before and after."""
        if not self.loads or self.held is None:
            return None
        marks = even_times(times, rests)
        rows = np.hstack([poses, path])
        rows = np.column_stack([np.interp(marks, times, column) for column in rows.T])
        links = self.skeleton.transforms(rows[:, :3], rows[:, 3:], self.opening)
        carried = links[self.link] @ self.group[self.held]
        faults = (load.fault(carried, accelerations(load.places(carried))) for load in self.loads)
        return next((fault for fault in faults if fault is not None), None)

    def _shaken_off_driving(self) -> str | None:
        """The same while the base drives as hard as it can."""
        if not self.loads or self.held is None:
            return None
        links = self.skeleton.transforms(self.base[None], self.q[None], self.opening)
        carried = links[self.link] @ self.group[self.held]
        for load in self.loads:
            reach = float(np.hypot(*(load.places(carried)[0, :2] - self.base[:2])))
            pushes = drive_pushes(self.robot.base, reach)
            fault = load.fault(np.repeat(carried, len(pushes), axis=0), pushes)
            if fault is not None:
                return fault
        return None

    def _together(self, piece: Together, times: Floats) -> bool:
        """Base, arm and fingers at once. Limits are tested when the robot comes to rest: only
        then is it known what is one motion."""
        rows = np.hstack([piece.poses, piece.path, piece.openings[:, None]])
        if piece.path.shape[1] != len(self.robot.joints):
            found = piece.path.shape[1]
            return self._find(f"{found} joint values for {len(self.robot.joints)} joints")
        jump = np.abs(rows[0] - [*self.base, *self.q, self.opening])
        turns = round(float(self.base[2] - rows[0, 2]) / (2 * math.pi))
        rows[:, 2] += 2 * math.pi * turns
        jump[2] = abs(wrap(rows[0, 2] - self.base[2]))
        if jump.max() > JOIN:
            return self._find(f"the robot jumps by {jump.max():.4f} (m or rad) between two motions")
        if self.held is not None and np.ptp(rows[:, -1]) > JOIN:
            return self._find("the gripper moves while it holds an object")
        self._motion.add(self._number, rows, times)
        step = np.full(rows.shape[1], JOINT_STEP)
        step[:3], step[-1] = BASE_STEP, FINGER_STEP
        dense, counts = _dense(rows, step)
        done = self._travel(dense[:, :3], dense[:, 3:-1], (), counts, dense[:, -1])
        done = done and self._find(self._shaken_off(rows[:, :3], rows[:, 3:-1], times, False))
        self.base, self.q, self.opening = rows[-1, :3], rows[-1, 3:-1], float(rows[-1, -1])
        return done

    def rest(self) -> bool:
        """Test the limits of a motion that has come to its end; whether nothing is wrong."""
        fault = self._motion.fault(self.robot)
        self._motion = Underway()
        if fault is not None:
            self.findings.append(Finding(*fault))
        return fault is None

    def _travel(
        self,
        base: Floats,
        q: Floats,
        along: Sequence[Carried],
        counts: list[int],
        opening: Floats | None = None,
    ) -> bool:
        links = self.skeleton.transforms(base, q, self.opening if opening is None else opening)
        guided: dict[str, list[Track]] = {}
        for carried in along:
            tracks = self._guided(carried.body, dense_poses(carried.poses, counts), links)
            if tracks is None:
                return False
            guided[carried.body] = tracks
        if not self._free(links, guided, None):
            return False
        if len(self.group) > 1 and self.held is not None:
            turns = (links[self.link] @ self.group[self.held])[:, 2, :3]
            if np.min(turns @ self._up) < math.cos(SPILL):
                return self._find(f"{self._name(self.held)} leans: what stands on it slides off")
        for carried in along:
            self._settle(carried)
        return not self.findings

    # -- collisions --------------------------------------------------------------------------

    def _free(
        self, links: dict[str, Floats], guided: Mapping[str, list[Track]], gripped: int | None
    ) -> bool:
        """Whether nothing touches what it must not, in all samples. `guided` are the solids of
        bodies that are moved along, by name; `gripped` is what the fingers close on or let go."""
        count = len(links[self.link])
        self.samples += count
        carried = {
            index: tracks_of(self._name(index), self.world.movables[index].body, poses)
            for index, local in self.group.items()
            if len(poses := links[self.link] @ local)
        }
        if gripped is None or gripped != self.held:
            held = carried.pop(self.held, []) if self.held is not None else []
        else:
            held = []
            carried.pop(gripped)
        absent = {*guided, *([self._name(gripped)] if gripped is not None else [])}
        crowd = Crowd(
            robot=self.skeleton.tracks(links),
            held=held,
            resting=[track for tracks in carried.values() for track in tracks],
            guided=[track for tracks in guided.values() for track in tracks],
            standing=self._standing(absent),
        )
        hit = first_collision(self.exact, self.skeleton, self.robot.gripper.links, crowd)
        if hit is None:
            return True
        share = 100 * hit.sample / max(1, count - 1)
        return self._find(f"{hit.first} hits {hit.second} ({share:.0f} % into the motion)")

    def _standing(self, absent: Collection[str]) -> list[Track]:
        """The solids of all that stands, but for some, by name."""
        there = [
            (thing.name, thing.body, pose)
            for thing, pose in zip(self.world.fixed, self.fixed, strict=True)
        ]
        there += [(self._name(i), self.world.movables[i].body, p) for i, p in self.poses.items()]
        found: list[Track] = []
        for name, body, pose in there:
            if name in absent:
                continue
            known = self._known.get(name)
            if known is None or known[0] is not pose:
                known = self._known[name] = pose, tracks_of(name, body, pose[None])
            found += known[1]
        return found

    def _name(self, index: int) -> str:
        return self.world.movables[index].name

    # -- gripping ----------------------------------------------------------------------------

    def _gripper(self, piece: GripperMove, seconds: float) -> bool:
        if not self._find(finger_fault(self.robot, self.opening, piece.opening, seconds)):
            return False
        change = piece.attach or piece.release
        index = None if change is None else movable(self.world, change.body)
        if change is not None and index is None:
            return self._find(f"there is nothing called {change.body} that can be moved")
        if change is None and self.held is not None and abs(piece.opening - self.opening) > JOIN:
            return self._find("the gripper moves while it holds an object")
        count = 2 + math.ceil(abs(piece.opening - self.opening) / FINGER_STEP)
        opening = np.linspace(self.opening, piece.opening, count)
        base, q = np.tile(self.base, (count, 1)), np.tile(self.q, (count, 1))
        links = self.skeleton.transforms(base, q, opening)
        # Moving fingers may touch the body that they grip or let go, nothing else.
        if not self._free(links, {}, index):
            return False
        here = {link: pose[-1] for link, pose in links.items()}
        self.opening = piece.opening
        if piece.attach is not None and index is not None:
            return self._attach(piece.attach, index, here)
        if piece.release is not None and index is not None:
            return self._release(piece.release, index, here)
        return True

    def _attach(self, attach: Attach, index: int, links: dict[str, Floats]) -> bool:
        name, link = self._name(index), attach.to or self.robot.urdf_tool
        if self.held is not None:
            return self._find(f"{name} is gripped while another object is held")
        if link not in {*self.robot.gripper.links, self.robot.urdf_tool}:
            return self._find(f"{name} is fixed to {link}, which is no part of the gripper")
        body, tool = self.world.movables[index].body, np.linalg.inv(links[self.robot.urdf_tool])
        in_tool = tool @ self.poses[index]
        if not self._find(grip_fault(self.skeleton, self.opening, body, name, in_tool)):
            return False
        group = [index, *sorted(above(self.world, self.poses, [index]))]
        for each in group[1:]:
            for footing in footings(self.world, self.poses, each):
                owner = movable(self.world, footing.support.owner)
                if owner not in group:
                    both = f"{name}, and on {footing.support.name} as well"
                    return self._find(f"{self._name(each)} stands on {both}")
        masses: Floats = np.array([self.world.movables[i].body.mass for i in group])
        centres = np.array(
            [self.poses[i] @ [*self.world.movables[i].body.centre, 1.0] for i in group]
        )
        centre = np.asarray(tool @ (masses @ centres / masses.sum()), dtype=np.float64)[:3]
        load = load_fault(self.robot, float(masses.sum()), centre, -np.asarray(tool[:3, 2]))
        if load is not None:
            return self._find(f"{name}: {load}")
        to_link = np.linalg.inv(links[link])
        self._up = self.poses[index][2, :3]
        self.loads = loads_of(self.world, self.poses, index, group)
        self.group = {i: to_link @ self.poses.pop(i) for i in group}
        self.held, self.link = index, link
        return True

    def _release(self, release: Release, index: int, links: dict[str, Floats]) -> bool:
        name = self._name(index)
        if self.held != index:
            return self._find(f"{name} is released but not held")
        poses = {i: links[self.link] @ local for i, local in self.group.items()}
        wanted = matrix(release.pose)
        off = float(np.linalg.norm(wanted[:3, 3] - poses[index][:3, 3]))
        turned = float(np.abs(wanted[:3, :3] - poses[index][:3, :3]).max())
        if off > PLACE or turned > TURNED:
            return self._find(f"{name} ends {1000 * off:.1f} mm from where the plan says it is put")
        self.poses |= poses
        self.held, self.group, self.link = None, {}, self.robot.urdf_tool
        self.loads = []
        return self._find(fault_of_rest(self.world, self.poses, index, release.on))

    # -- bodies that are moved along -----------------------------------------------------------

    def _guided(self, name: str, way: Floats, links: dict[str, Floats]) -> list[Track] | None:
        """The solids of a body that is moved along, None where it cannot be."""
        fixed = [i for i, thing in enumerate(self.world.fixed) if thing.name == name]
        index = movable(self.world, name)
        if fixed:
            thing, start = self.world.fixed[fixed[0]], self.fixed[fixed[0]]
            body, first = thing.body, homogeneous(thing.pose)
            if thing.guide is None:
                self._find(f"{name} is moved, which is fixed")
                return None
            fault = guide_fault(thing.guide, first, way, name)
        elif index is not None and index in self.poses:
            body, start = self.world.movables[index].body, self.poses[index]
            fault = slide_fault(self.world, self.poses, index, way)
            if above(self.world, self.poses, [index]):
                fault = f"{name} is pushed while something stands on it"
        else:
            self._find(f"there is nothing called {name} that could be moved along")
            return None
        if np.abs(way[0] - start).max() > PLACE:
            fault = f"{name} does not start where it is"
        tracks = tracks_of(name, body, way)
        hand = [t for t in self.skeleton.tracks(links) if t.owner in self.robot.gripper.links]
        fault = fault or touch_fault(self.exact, tracks, hand, name)
        return tracks if self._find(fault) else None

    def _settle(self, carried: Carried) -> None:
        """Take a body for where it was moved to."""
        pose, index = matrix(carried.poses[-1]), movable(self.world, carried.body)
        if index is None:
            names = [thing.name for thing in self.world.fixed]
            self.fixed[names.index(carried.body)] = pose
            return
        self.poses[index] = pose
        self._find(falls(self.world, self.poses, [index]))


def _dense(path: Floats, step: Floats) -> tuple[Floats, list[int]]:
    """Way points with samples in between, no further apart than `step` in any coordinate; and
    how many samples there are from each way point to the next."""
    rows, counts = [path[:1]], []
    for a, b in pairwise(path):
        count = max(1, math.ceil(float((np.abs(b - a) / step).max())))
        rows.append(a + (b - a) * (np.arange(1, count + 1) / count)[:, None])
        counts.append(count)
    return np.vstack(rows), counts
