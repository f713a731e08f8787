"""A second judge of plans, for comparison: PyBullet's kinematics and contacts, JSON as it is.

It shares no code with the judge. It looks less closely, and calls only clear faults: what it
refuses, the judge has to refuse.
"""

from __future__ import annotations

import math
import tomllib
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pybullet as pb
from pybullet_utils.bullet_client import BulletClient

import runtime.robot
from runtime.world.goals import RestsAt, RestsOn, Spelled
from runtime.world.solids import Box, Cylinder, Sphere
from runtime.world.world import World

FOLDER = Path(runtime.robot.__path__[0]) / "tiago"
DEEP = -0.0005  # metres: contacts less deep than this may be those of Bullet's margins
STEP = 0.025  # radians and metres between samples

Json = dict[str, Any]


class Second:
    """Judges plans in one world."""

    def __init__(self, world: World, robot_digest: str) -> None:
        self.world, self.robot_digest = world, robot_digest
        self.file = tomllib.loads((FOLDER / "tiago.toml").read_text(encoding="utf-8"))
        self.limits = _limits(FOLDER / "tiago.urdf")
        self.bullet: Any = BulletClient(pb.DIRECT)
        self._load()

    def close(self) -> None:
        self.bullet.disconnect()

    def _load(self) -> None:
        b = self.bullet
        self.robot = b.loadURDF(
            str(FOLDER / "tiago.urdf"), useFixedBase=True, flags=b.URDF_USE_SELF_COLLISION
        )
        info = [b.getJointInfo(self.robot, i) for i in range(b.getNumJoints(self.robot))]
        self.joint = {row[1].decode(): row[0] for row in info}
        self.link = {row[12].decode(): row[0] for row in info} | {"base_footprint": -1}
        self.tool = self.link["gripper_grasping_frame"]
        self.hand = [self.link[name] for name in self.file["gripper"]["links"]]
        moving = {*self.file["joints"], *self.file["gripper"]["finger_joints"]}
        group = {-1: -1}
        for row in info:  # parents come before their children
            group[row[0]] = row[0] if row[1].decode() in moving else group[row[16]]
        listed = self.file["ignored_collisions"]
        ignored = {frozenset(self.link[name] for name in pair) for pair in listed}
        for i, one in group.items():
            for j, two in group.items():
                if i < j and (one == two or frozenset((i, j)) in ignored):
                    b.setCollisionFilterPair(self.robot, self.robot, i, j, 0)
        self.swinging = [link for link, moving_with in group.items() if moving_with != -1]
        self.fixed = [self._body(t.body, _quaternion(t.pose)) for t in self.world.fixed]
        self.things = {t.name: self._body(t.body, _quaternion(t.pose)) for t in self.world.movables}

    def _body(self, body: Any, pose: tuple[Any, Any]) -> int:
        b, (part,) = self.bullet, body.parts
        match part.solid:
            case Box(size):
                shape = b.createCollisionShape(b.GEOM_BOX, halfExtents=[s / 2 for s in size])
            case Cylinder(radius, height):
                shape = b.createCollisionShape(b.GEOM_CYLINDER, radius=radius, height=height)
            case Sphere(radius):
                shape = b.createCollisionShape(b.GEOM_SPHERE, radius=radius)
        place, turn = _quaternion(part.pose)
        where = b.multiplyTransforms(*pose, place, turn)
        number: int = b.createMultiBody(0, shape, -1, *where)
        self.offset = getattr(self, "offset", {})
        self.offset[number] = (place, turn)
        return number

    # -- the verdict -------------------------------------------------------------------------

    def fault(self, data: Json) -> str | None:
        """The first clear fault of a plan, or None."""
        found = self._head(data) or self._clock(data)
        return found or self._run(data)

    def _head(self, data: Json) -> str | None:
        if data["scene"]["digest"] != self.world.digest:
            return "another scene"
        if data["robot"]["digest"] != self.robot_digest:
            return "another robot"
        if data["objects"] != [thing.name for thing in self.world.movables]:
            return "other objects"
        if data["robot"].get("joints", self.file["joints"]) != self.file["joints"]:
            return "other joints"
        off = np.array(data["base_start"]) - self.world.robot_start
        off[2] = math.remainder(off[2], 2 * math.pi)
        if np.abs(off).max() > 0.001:
            return "starts elsewhere"
        order = [action["subgoal"] for action in data["actions"]]
        if order != sorted(order):
            return "actions out of order"
        for i, subgoal in enumerate(data["subgoals"]):
            if order.count(i) != subgoal["actions"]:
                return "actions are missing"
        for a, b in pairwise(data["subgoals"]):
            if a["after"] != b["before"]:
                return "features change between subgoals"
        return None

    def _clock(self, data: Json) -> str | None:
        """Speeds and accelerations, as far as they are clear without any corner."""
        opening = 0.09
        for action in data["actions"]:
            for piece in action["pieces"]:
                times = np.array(piece["times"])
                if piece["type"] == "base":
                    found = self._base_clock(np.array(piece["poses"]), times)
                elif piece["type"] == "arm":
                    found = self._arm_clock(np.array(piece["path"]), times)
                else:
                    speed = 2 * self.limits["gripper_left_finger_joint"][2]
                    fast = abs(piece["opening"] - opening) > 1.05 * speed * times[-1] + 1e-5
                    found = "fingers too fast" if fast else None
                    opening = piece["opening"]
                if found:
                    return found
        return None

    def _base_clock(self, poses: Any, times: Any) -> str | None:
        base = self.file["base"]
        for a, b, t in zip(poses, poses[1:], np.diff(times), strict=False):
            d, turn = math.dist(a[:2], b[:2]), abs(b[2] - a[2])
            if d > 1e-4 and turn > 1e-4:
                return "drives and turns"
            if d > 1e-3:
                side = abs(np.cross([*(b - a)[:2], 0], [math.cos(a[2]), math.sin(a[2]), 0])[2])
                if side > 2e-4:
                    return "drives sideways"
            for way, v, acc in (
                (d, base["velocity"], base["acceleration"]),
                (turn, base["angular_velocity"], base["angular_acceleration"]),
            ):
                # The furthest that rest to rest gets in the time: half up, half down, or capped.
                top = min(v, acc * t / 2)
                if way > 1.03 * (top * t - top * top / acc) + 2e-5:
                    return "the base is too fast"
        return None

    def _arm_clock(self, path: Any, times: Any) -> str | None:
        limit = np.array([self.limits[name][2] for name in self.file["joints"]])
        hard = np.array(self.file["acceleration"])
        for a, b, t in zip(path, path[1:], np.diff(times), strict=False):
            if (np.abs(b - a) > 1.03 * limit * t + 1e-4).any():
                return "the arm is too fast"
        for rows, marks in ((path, times), (path[::-1], times[-1] - times[::-1])):
            steps = np.diff(rows, axis=0)
            length = np.linalg.norm(steps, axis=1)
            for i in range(len(steps)):
                ahead = steps[i] @ steps[0] > (1 - 1e-6) * length[i] * length[0]
                if i and not ahead:  # from the first corner on, speeds may jump
                    break
                got = np.abs(rows[i + 1] - rows[0])
                if (got > 1.03 * hard * marks[i + 1] ** 2 / 2 + 1e-4).any():
                    return "the arm does not rest at an end"
        return None

    # -- geometry ----------------------------------------------------------------------------

    def _run(self, data: Json) -> str | None:
        self._q, self._base = list(self.file["home"]), list(self.world.robot_start)
        self._opening, self._held, self._in_tool = 0.09, None, None
        for thing in self.world.movables:
            self._put(self.things[thing.name], _quaternion(thing.pose))
            self._allow(thing.name, False)
        for action in data["actions"]:
            for piece in action["pieces"]:
                found = self._piece(piece)
                if found:
                    return found
        if np.abs(np.array(self._q) - self.file["home"]).max() > 0.001:
            return "the arm is not home at the end"
        if self._held is not None:
            return "something is held at the end"
        return self._goals()

    def _piece(self, piece: Json) -> str | None:
        if piece["type"] == "base":
            poses = np.array(piece["poses"])
            off = poses[0] - self._base
            off[2] = math.remainder(off[2], 2 * math.pi)
            if np.abs(off).max() > 0.001:
                return "the base jumps"
            if np.abs(np.array(self._q) - self.file["home"]).max() > 0.001:
                return "drives while the arm is not home"
            for pose in _between(poses):
                self._base = pose
                found = self._touches()
                if found:
                    return found
            self._base = poses[-1]
            return None
        if piece["type"] == "arm":
            path = np.array(piece["path"])
            if np.abs(path[0] - self._q).max() > 0.001:
                return "the arm jumps"
            bounds = np.array([self.limits[name][:2] for name in self.file["joints"]])
            if (path < bounds[:, 0] - 1e-3).any() or (path > bounds[:, 1] + 1e-3).any():
                return "a joint leaves its limits"
            for q in _between(path):
                self._q = q
                found = self._touches()
                if found:
                    return found
            self._q = path[-1]
            return None
        return self._grip(piece)

    def _grip(self, piece: Json) -> str | None:
        change = piece.get("attach") or piece.get("release")
        if not -1e-4 <= piece["opening"] <= 0.0901:
            return "the gripper cannot open so far"
        if change is None and self._held and abs(piece["opening"] - self._opening) > 0.001:
            return "the fingers move around what they hold"
        if change is not None:
            self._allow(change["body"], True)
        for opening in np.linspace(self._opening, piece["opening"], 8):
            self._opening = float(opening)
            found = self._touches()
            if found:
                return found
        if "attach" in piece:
            return self._attach(change["body"])
        if "release" in piece:
            return self._release(piece["release"])
        return None

    def _attach(self, name: str) -> str | None:
        if self._held is not None:
            return "two things are gripped"
        body = self.things[name]
        for link in self.hand[1:]:
            near = self.bullet.getClosestPoints(self.robot, body, 0.02, link, -1)
            if not near or not -0.006 < min(p[8] for p in near) < 0.004:
                return "a finger does not touch what is gripped"
        inverse = self.bullet.invertTransform(*self._tool())
        self._in_tool = self.bullet.multiplyTransforms(*inverse, *self._pose(body))
        self._held = name
        return None

    def _release(self, release: Json) -> str | None:
        name = release["body"]
        if self._held != name:
            return "what is let go is not held"
        body = self.things[name]
        thing = next(t for t in self.world.movables if t.name == name)
        place, turn = self._pose(body)
        is_at = self.bullet.multiplyTransforms(
            place, turn, *self.bullet.invertTransform(*self.offset[body])
        )
        if math.dist(is_at[0], release["pose"][:3]) > 0.003:
            return "it is not put where the plan says"
        same = abs(np.dot(is_at[1], release["pose"][3:]))
        if 2 * math.acos(min(1.0, same)) > 0.03:
            return "it is turned"
        on = [s for s in self.world.supports if s.name == release["on"]]
        if not on:
            return "there is no such support"
        # The corners of its foot and its middle, in the frame of the support.
        half = np.array(thing.body.parts[0].solid.half)
        turned = np.array(self.bullet.getMatrixFromQuaternion(turn)).reshape(3, 3)
        corners = np.array([[x, y, -1] for x in (-1, 1) for y in (-1, 1)]) * half @ turned.T + place
        local = (corners - on[0].pose[:, 3]) @ on[0].pose[:, :3]
        if np.abs(local[:, 2]).max() > 0.004:
            return "it is let go above or in its support"
        if (np.abs(local[:, :2].mean(axis=0)) > np.array(on[0].half) + 0.0005).any():
            return "it tips over the edge"
        self._held = self._in_tool = None
        return None

    def _goals(self) -> str | None:
        for goal in self.world.goals:
            if isinstance(goal, Spelled):
                continue  # words are the judge's alone
            assert isinstance(goal, RestsOn | RestsAt)
            support = next(s for s in self.world.supports if s.name == goal.support)
            place = np.array(self._pose(self.things[goal.body])[0])
            local = (place - support.pose[:, 3]) @ support.pose[:, :3]
            if (np.abs(local[:2]) > np.array(support.half) + 0.002).any():
                return "a goal is not reached"
            if isinstance(goal, RestsOn):
                continue
            if math.dist(local[:2], (goal.x, goal.y)) > goal.tolerance + 0.002:
                return "a goal pose is missed"
        return None

    def _touches(self) -> str | None:
        b = self.bullet
        x, y, yaw = self._base
        turn = b.getQuaternionFromEuler([0, 0, yaw])
        b.resetBasePositionAndOrientation(self.robot, [x, y, 0], turn)
        for name, value in zip(self.file["joints"], self._q, strict=True):
            b.resetJointState(self.robot, self.joint[name], float(value))
        for name in self.file["gripper"]["finger_joints"]:
            b.resetJointState(self.robot, self.joint[name], self._opening / 2)
        if self._held is not None:
            pose = b.multiplyTransforms(*self._tool(), *self._in_tool)
            b.resetBasePositionAndOrientation(self.things[self._held], *pose)
        b.performCollisionDetection()
        if any(c[8] < DEEP for c in b.getContactPoints(self.robot)):
            return "the robot touches something"
        if self._held is not None:
            held = self.things[self._held]
            if any(c[8] < DEEP and c[2] != self.robot for c in b.getContactPoints(held)):
                return "what is held touches something"
        for link in self.swinging:
            if b.getAABB(self.robot, link)[0][2] < -0.005 and b.getCollisionShapeData(
                self.robot, link
            ):
                return "the robot is in the floor"
        return None

    def _tool(self) -> tuple[Any, Any]:
        state = self.bullet.getLinkState(self.robot, self.tool, computeForwardKinematics=1)
        return state[4], state[5]

    def _pose(self, body: int) -> tuple[Any, Any]:
        place, turn = self.bullet.getBasePositionAndOrientation(body)
        return place, turn

    def _put(self, body: int, pose: tuple[Any, Any]) -> None:
        where = self.bullet.multiplyTransforms(*pose, *self.offset[body])
        self.bullet.resetBasePositionAndOrientation(body, *where)

    def _allow(self, name: str, touch: bool) -> None:
        """Whether the gripper may touch a body."""
        for link in self.hand:
            self.bullet.setCollisionFilterPair(
                self.robot, self.things[name], link, -1, int(not touch)
            )


def _between(rows: Any) -> Any:
    yield rows[0]
    for a, b in pairwise(rows):
        count = max(1, math.ceil(float(np.abs(b - a).max()) / STEP))
        for i in range(1, count + 1):
            yield a + (b - a) * (i / count)


def _limits(path: Path) -> dict[str, tuple[float, float, float]]:
    found = {}
    for joint in ElementTree.parse(path).getroot().findall("joint"):
        limit = joint.find("limit")
        if limit is not None:
            low, high, speed = (float(limit.get(k, 0)) for k in ("lower", "upper", "velocity"))
            if joint.get("type") == "continuous":
                low, high = -math.inf, math.inf
            found[joint.get("name", "")] = low, high, speed
    return found


def _quaternion(pose: Any) -> tuple[list[float], list[float]]:
    """A 3x4 pose as Bullet has it, by the formula for traces above -1."""
    r = np.array(pose)[:, :3]
    w = math.sqrt(max(0.0, 1 + np.trace(r))) / 2
    if w < 1e-3:
        values, vectors = np.linalg.eigh((r + r.T) / 2)
        axis = vectors[:, int(values.argmax())]
        return np.array(pose)[:, 3].tolist(), [*axis.tolist(), 0.0]
    x, y, z = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
    return np.array(pose)[:, 3].tolist(), [x / 4 / w, y / 4 / w, z / 4 / w, w]
