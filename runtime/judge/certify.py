"""Replay a plan in exact geometry and report everything that is wrong with it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from domains.tabletop.scene.model import Scene
from runtime.angles import wrap
from runtime.judge.geometry import ExactBoxes, Track, close_pairs
from runtime.judge.goals import unmet
from runtime.judge.skeleton import Skeleton
from runtime.motion.motion import ArmMove, BaseMove, GripperMove
from runtime.plan.model import Plan, PlanAction, TimedPiece
from runtime.robot.model import RobotModel
from runtime.world.quaternions import matrix

Floats = NDArray[np.float64]

JOINT_STEP = 0.01  # rad (m) between samples of an arm motion
BASE_STEP = 0.01  # m and rad between samples of a base motion
FINGER_STEP = 0.005  # m between samples of the gripper's opening
JOIN = 1e-4  # rad or m by which consecutive pieces may differ: rounding in the file
LIMIT_SLACK = 1e-5
SPEED_SLACK = 1.01
TILT = 0.02  # rad by which a released object may lean
REST = 0.002  # m by which the bottom of a released object may miss its rest height
PLACE = 0.001  # m by which a released object may miss the placement that the plan states


@dataclass(frozen=True)
class Finding:
    """Something wrong with a plan: in which action (from 0), what."""

    action: int | None
    message: str


@dataclass(frozen=True)
class Certificate:
    """The verdict on a plan, and what was looked at to reach it."""

    findings: tuple[Finding, ...]
    samples: int
    actions: int

    @property
    def valid(self) -> bool:
        """Whether nothing was found."""
        return not self.findings


def certify(plan: Plan, scene: Scene, robot: RobotModel) -> Certificate:
    """Replay a plan from the start of the scene to its goal."""
    return _Replay(plan, scene, robot).run()


class _Replay:
    def __init__(self, plan: Plan, scene: Scene, robot: RobotModel) -> None:
        self.plan = plan
        self.scene = scene
        self.robot = robot
        self.skeleton = Skeleton(robot)
        self.exact = ExactBoxes()
        self.findings: list[Finding] = []
        self.samples = 0
        self.base = np.array(plan.base_start)
        self.q = robot.home.copy()
        self.opening = robot.gripper.max_opening
        self.objects: list[Floats] = [self._start_pose(i) for i in range(len(scene.objects))]
        self._standing: dict[int, tuple[Floats, Track]] = {}
        self.held: int | None = None
        self.in_tool = np.eye(4)
        self.statics = [
            Track(o.name, o.name, np.array(o.box.size) / 2, upright(*o.box.centre, o.box.yaw)[None])
            for o in scene.obstacles
        ]

    def _start_pose(self, index: int) -> Floats:
        thing = self.scene.objects[index]
        x, y, yaw = thing.start
        return upright(x, y, self.scene.surfaces[thing.surface].rest, yaw)

    def find(self, action: int | None, message: str) -> None:
        self.findings.append(Finding(action, message))

    # -- the replay --------------------------------------------------------------------------

    def run(self) -> Certificate:
        self._check_header()
        if not self.findings:
            for number, action in enumerate(self.plan.actions):
                self._action(number, action)
                if self.findings:
                    break  # the replay would go on from a state that the plan does not mean
            else:
                self._check_end()
        return Certificate(tuple(self.findings), self.samples, len(self.plan.actions))

    def _check_header(self) -> None:
        plan, scene, robot = self.plan, self.scene, self.robot
        if plan.scene_digest != scene.digest:
            self.find(None, f"the plan was made for another version of the scene {scene.name}")
        if plan.robot_digest != robot.digest:
            self.find(None, f"the plan was made for another version of the robot {robot.name}")
        if plan.objects != tuple(thing.name for thing in scene.objects):
            self.find(None, "the plan's objects are not those of the scene")
        if plan.joints and plan.joints != robot.joints:
            self.find(None, "the plan's planning joints are not those of the robot")
        off = np.abs(self.base - np.array(scene.robot_start))
        off[2] = abs(wrap(self.base[2] - scene.robot_start[2]))
        if off.max() > JOIN:
            self.find(None, "the plan does not start where the robot stands in the scene")
        expected = [subgoal.actions for subgoal in plan.subgoals]
        counted = [0] * len(expected)
        for action in plan.actions:
            counted[action.subgoal] += 1
        if counted != expected:
            less = "missing" if sum(counted) < sum(expected) else "not where they belong"
            self.find(
                None,
                f"actions are {less}: by its subgoals the plan has {sum(expected)}, "
                f"{sum(counted)} are there",
            )

    def _action(self, number: int, action: PlanAction) -> None:
        for timed in action.pieces:
            piece = timed.piece
            before = len(self.findings)
            if isinstance(piece, GripperMove):
                self._gripper(number, piece)
            else:
                self._travel(number, timed)
            if len(self.findings) > before:
                return  # what follows a mistake in an action would only repeat it

    def _travel(self, number: int, timed: TimedPiece) -> None:
        piece = timed.piece
        if isinstance(piece, BaseMove):
            if not self._base_is_sound(number, piece, timed.times):
                return
            base = _dense(piece.poses, np.full(3, BASE_STEP))
            q = np.tile(self.q, (len(base), 1))
            self._check_collisions(number, base, q)
            self.base = piece.poses[-1].copy()
        elif isinstance(piece, ArmMove):
            if not self._arm_is_sound(number, piece, timed.times):
                return
            q = _dense(piece.path, np.full(len(self.q), JOINT_STEP))
            base = np.tile(self.base, (len(q), 1))
            self._check_collisions(number, base, q)
            self.q = piece.path[-1].copy()
        if self.held is not None:
            self.objects[self.held] = self._tool() @ self.in_tool

    def _base_is_sound(self, number: int, piece: BaseMove, times: Floats) -> bool:
        poses = piece.poses
        jump = np.abs(poses[0] - self.base)
        jump[2] = abs(wrap(poses[0, 2] - self.base[2]))
        if jump.max() > JOIN:
            self.find(number, f"the base jumps by {jump.max():.4f} (m or rad)")
            return False
        if np.abs(self.q - self.robot.home).max() > JOIN:
            self.find(number, "the robot drives while its arm is not in the home posture")
            return False
        base = self.robot.base
        for a, b, seconds in zip(poses[:-1], poses[1:], np.diff(times), strict=True):
            distance, turn = math.hypot(b[0] - a[0], b[1] - a[1]), abs(b[2] - a[2])
            if distance > JOIN and turn > JOIN:
                self.find(number, "the base drives and turns at once")
                return False
            if distance > JOIN:
                off = wrap(math.atan2(b[1] - a[1], b[0] - a[0]) - a[2])
                if min(abs(off), math.pi - abs(off)) * distance > 10 * JOIN:
                    self.find(number, "the base moves sideways, which a differential drive cannot")
                    return False
            fastest = max(distance / base.velocity, turn / base.angular_velocity)
            if fastest > seconds * SPEED_SLACK + JOIN:
                self.find(number, "the base is faster than its limit")
                return False
        return True

    def _arm_is_sound(self, number: int, piece: ArmMove, times: Floats) -> bool:
        path, robot = piece.path, self.robot
        if path.shape[1] != len(robot.joints):
            self.find(number, f"{path.shape[1]} joint values for {len(robot.joints)} joints")
            return False
        jump = np.abs(path[0] - self.q)
        if jump.max() > JOIN:
            joint = robot.joints[int(jump.argmax())]
            self.find(number, f"{joint} jumps by {jump.max():.4f} between two motions")
            return False
        beyond = np.maximum(robot.lower - path, path - robot.upper)
        if beyond.max() > LIMIT_SLACK:
            joint = robot.joints[int(beyond.max(axis=0).argmax())]
            self.find(number, f"{joint} leaves its limits by {beyond.max():.4f}")
            return False
        steps = np.abs(np.diff(path, axis=0)) / robot.velocity
        slow = np.diff(times)[:, None] * SPEED_SLACK + JOIN
        if len(steps) and (steps > slow).any():
            joint = robot.joints[int((steps - slow).max(axis=0).argmax())]
            self.find(number, f"{joint} is faster than its limit")
            return False
        return True

    # -- collisions --------------------------------------------------------------------------

    def _check_fingers(self, number: int, piece: GripperMove) -> None:
        """Moving fingers may touch the object that they grip or let go, nothing else."""
        count = 2 + math.ceil(abs(piece.opening - self.opening) / FINGER_STEP)
        opening = np.linspace(self.opening, piece.opening, count)
        base, q = np.tile(self.base, (count, 1)), np.tile(self.q, (count, 1))
        change = piece.attach or piece.release
        gripped = None if change is None else self.plan.objects.index(change.body)
        self._check_collisions(number, base, q, opening, gripped)

    def _check_collisions(
        self,
        number: int,
        base: Floats,
        q: Floats,
        opening: Floats | None = None,
        gripped: int | None = None,
    ) -> None:
        self.samples += len(base)
        skeleton = self.skeleton
        links = skeleton.transforms(base, q, self.opening if opening is None else opening)
        robot = [
            Track(box.name, box.link, box.half, links[box.link] @ box.pose)
            for box in skeleton.boxes
        ]
        standing = [
            self._object_track(i) for i in range(len(self.objects)) if i not in {self.held, gripped}
        ]
        world = self.statics + standing
        pairs = close_pairs(robot, world)
        pairs += [
            (a, b)
            for i, a in enumerate(robot)
            for b in robot[:i]
            if not skeleton.may_touch(a.owner, b.owner)
        ]
        if self.held is not None and self.held != gripped:
            tool = links[skeleton.robot.urdf_tool]
            held = self._object_track(self.held, tool @ self.in_tool)
            pairs += close_pairs([held], world)
            pairs += [(held, b) for b in robot if b.owner not in self.robot.gripper.links]
        hit = self.exact.first_hit(pairs)
        if hit is not None:
            share = 100 * hit.sample / max(1, len(base) - 1)
            self.find(number, f"{hit.first} hits {hit.second} ({share:.0f} % into the motion)")

    def _object_track(self, index: int, poses: Floats | None = None) -> Track:
        thing = self.scene.objects[index]
        if poses is None:
            known = self._standing.get(index)
            if known is not None and known[0] is self.objects[index]:
                return known[1]
        centre = np.eye(4)
        centre[2, 3] = thing.size[2] / 2
        placed = (self.objects[index][None] if poses is None else poses) @ centre
        track = Track(thing.name, thing.name, np.array(thing.size) / 2, placed)
        if poses is None:
            self._standing[index] = self.objects[index], track
        return track

    # -- gripping ----------------------------------------------------------------------------

    def _tool(self) -> Floats:
        links = self.skeleton.transforms(self.base[None], self.q[None], self.opening)
        pose: Floats = links[self.robot.urdf_tool][0]
        return pose

    def _gripper(self, number: int, piece: GripperMove) -> None:
        if not -LIMIT_SLACK <= piece.opening <= self.robot.gripper.max_opening + LIMIT_SLACK:
            self.find(number, f"the gripper cannot open {piece.opening:.4f} m")
            return
        self._check_fingers(number, piece)
        if piece.attach is not None:
            self._attach(number, piece)
        elif piece.release is not None:
            self._release(number, piece)
        elif self.held is not None and abs(piece.opening - self.opening) > JOIN:
            self.find(number, "the gripper moves while it holds an object")
        self.opening = piece.opening

    def _attach(self, number: int, piece: GripperMove) -> None:
        assert piece.attach is not None
        index = self.plan.objects.index(piece.attach.body)
        thing = self.scene.objects[index]
        if self.held is not None:
            self.find(number, f"{thing.name} is gripped while another object is held")
            return
        in_tool = np.linalg.inv(self._tool()) @ self.objects[index]
        corners = np.array(
            [
                in_tool @ [sx * thing.size[0] / 2, sy * thing.size[1] / 2, z, 1.0]
                for sx in (-1, 1)
                for sy in (-1, 1)
                for z in (0.0, thing.size[2])
            ]
        )
        low, high = corners[:, :3].min(axis=0), corners[:, :3].max(axis=0)
        if np.any(low > 0) or np.any(high < 0):
            self.find(number, f"{thing.name} is not between the fingers when they close")
            return
        # The fingers close along y: they must end on both sides of the object.
        if max(-low[1], high[1]) > self.opening / 2 + PLACE:
            self.find(number, f"the open fingers are narrower than {thing.name}")
            return
        if abs((high[1] - low[1]) - piece.opening) > 2 * PLACE:
            self.find(number, f"the closed fingers do not fit {thing.name}")
            return
        if abs(low[1] + high[1]) / 2 > 2 * PLACE:
            self.find(number, f"{thing.name} is {500 * abs(low[1] + high[1]):.1f} mm off centre")
            return
        self.held, self.in_tool = index, in_tool

    def _release(self, number: int, piece: GripperMove) -> None:
        assert piece.release is not None
        name = piece.release.body
        index = self.plan.objects.index(name)
        if self.held != index:
            self.find(number, f"{name} is released but not held")
            return
        pose = self._tool() @ self.in_tool
        x, y, z = pose[:3, 3]
        yaw = math.atan2(pose[1, 0], pose[0, 0])
        surfaces = [s for s in self.scene.surfaces if s.contains(x, y, -PLACE)]
        if math.acos(min(1.0, abs(pose[2, 2]))) > TILT:
            self.find(number, f"{name} leans when it is released")
        elif not surfaces:
            self.find(number, f"{name} is released over no table")
        elif abs(z - surfaces[0].rest) > REST:
            self.find(number, f"{name} is released {1000 * (z - surfaces[0].rest):.1f} mm high")
        else:
            px, py = piece.release.pose[:2]
            turn = matrix(piece.release.pose)
            pyaw = math.atan2(turn[1, 0], turn[0, 0])
            off = math.hypot(px - x, py - y)
            if off > PLACE or abs(wrap(pyaw - yaw)) > 0.01:
                self.find(
                    number, f"{name} ends {1000 * off:.1f} mm from where the plan says it is put"
                )
        self.objects[index] = pose
        self.held = None

    def _check_end(self) -> None:
        if self.held is not None:
            self.find(None, f"{self.scene.objects[self.held].name} is still held at the end")
            return
        poses = {}
        for index, pose in enumerate(self.objects):
            x, y = float(pose[0, 3]), float(pose[1, 3])
            on = [i for i, s in enumerate(self.scene.surfaces) if s.contains(x, y, -PLACE)]
            yaw = math.atan2(pose[1, 0], pose[0, 0])
            poses[index] = (on[0] if on else -1, (x, y, yaw))
        for message in unmet(self.scene, poses):
            self.find(None, f"goal not reached: {message}")


def upright(x: float, y: float, z: float, yaw: float) -> Floats:
    """The pose (4, 4) of something that stands upright."""
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, z], [0, 0, 0, 1.0]])


def _dense(path: Floats, step: Floats) -> Floats:
    """Way points with samples in between, no further apart than `step` in any coordinate."""
    rows = [path[:1]]
    for a, b in pairwise(path):
        count = max(1, math.ceil(float((np.abs(b - a) / step).max())))
        rows.append(a + (b - a) * (np.arange(1, count + 1) / count)[:, None])
    return np.vstack(rows)
