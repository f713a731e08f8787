"""A robot and a scene in PyBullet. Metres, radians, seconds, newtons, world frame.

The base is moved in the plane by motors of its own (no wheels, no slip of wheels); lift, arm
and fingers by the motors of their joints. Objects are boxes with mass and friction. A grasp
is a constraint between gripper and object that is made only where both fingers touch the
object, and breaks where it would have to hold more than the fingers' friction can.
"""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import sleep
from typing import Any

import numpy as np

from runtime.physics.materials import Materials
from runtime.physics.urdf import BASE_JOINTS, body_urdf, own_name, robot_urdf
from runtime.robot.model import Floats
from runtime.trace.model import TraceRobot
from runtime.world.body import Body, Part
from runtime.world.poses import Pose, upright
from runtime.world.quaternions import matrix, pose_of
from runtime.world.solids import Box
from runtime.world.world import World
from sketchlang.errors import InputError

STEP = 1 / 240
"""Seconds of one step of the simulation."""

SQUEEZE = 0.006
"""Metres by which closing fingers are sent beyond the object's sides."""

STRONG = 1e5
"""Newtons (metres) of the motors of base, lift and arm: torques are not what is judged."""

GAIN = 0.25
"""Share of a motor's position error that is corrected in one step."""


@dataclass(frozen=True)
class Contact:
    """Two things that touch, by name; `link` is the robot's link where one of them is."""

    link: str
    thing: str


class Physics:
    """One simulation."""

    def __init__(
        self,
        world: World,
        robot: TraceRobot,
        gui: bool = False,
        materials: Materials | None = None,
    ) -> None:
        self.world, self.robot = world, robot
        self.materials = materials or Materials.of(robot.max_force)
        self.bullet = connect(gui)
        self.watched = gui
        self.time = 0.0
        self.held: int | None = None
        self.squeezing = False
        self._constraint: int | None = None
        self._held_opening = 0.0
        self._axes: dict[int, tuple[Any, Any]] = {}
        b = self.bullet
        b.setGravity(0, 0, -9.81)
        b.setTimeStep(STEP)
        b.setPhysicsEngineParameter(numSolverIterations=60, enableFileCaching=0)
        self.floor = b.createMultiBody(0, b.createCollisionShape(b.GEOM_PLANE))
        self.statics = {
            self._body(thing.body, thing.pose, True): thing.name for thing in world.fixed
        }
        self.body = self._load_robot()
        self.objects = [self._object(index) for index in range(len(world.movables))]
        self.names = {self.floor: "floor", **self.statics}
        self.names |= {
            body: thing.name for body, thing in zip(self.objects, world.movables, strict=True)
        }
        # What the base touches before anything moves is what it stands on, or is bolted to.
        self._stands_on: set[Contact] = set()
        self.bullet.performCollisionDetection()
        foot, movable = self._links_of_the_base(), {thing.name for thing in world.movables}
        self._stands_on = {
            contact
            for contact in self.contacts(None)
            if self._links[contact.link] in foot and contact.thing not in movable
        }
        # Meshes end a little below the plane that they are mounted on: pushed out of it, the robot
        # would shake.
        bodies = {name: body for body, name in self.names.items()}
        for contact in self._stands_on:
            link, thing = self._links[contact.link], bodies[contact.thing]
            b.setCollisionFilterPair(self.body, thing, link, -1, 0)

    def close(self) -> None:
        """End the simulation."""
        if self.bullet.isConnected():
            self.bullet.disconnect()

    def _links_of_the_base(self) -> set[int]:
        """The links that no planning joint moves against the base."""
        moved = set(self.robot.joints)
        joints = self.robot.urdf.joints  # by their child

        def is_still(link: str) -> bool:
            while link in joints:
                if joints[link].name in moved:
                    return False
                link = joints[link].parent
            return True

        return {index for name, index in self._links.items() if is_still(name)}

    # -- what there is -------------------------------------------------------------------------

    def _body(self, body: Body, pose: Pose, fixed: bool) -> int:
        b, place = self.bullet, pose_of(pose)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "body.urdf"
            path.write_text(body_urdf(body, fixed, Path(folder)), encoding="utf-8")
            with quiet():
                number: int = b.loadURDF(
                    str(path), useFixedBase=fixed, flags=b.URDF_USE_INERTIA_FROM_FILE
                )
        # Bullet speaks of the frame of the principal axes of inertia, not of the body's.
        info = b.getDynamicsInfo(number, -1)
        self._axes[number] = info[3], info[4]
        where = b.multiplyTransforms(place[:3].tolist(), place[3:].tolist(), info[3], info[4])
        b.resetBasePositionAndOrientation(number, *where)
        b.changeDynamics(number, -1, lateralFriction=self.materials.friction, restitution=0.0)
        return number

    def add_obstacle(self, name: str, size: tuple[float, float, float], x: float, y: float) -> None:
        """Something that stands on the floor and never moves."""
        half = size[2] / 2
        box = Body((Part(Box(size), upright(0.0, 0.0, half, 0.0)),), 0.0, (0.0, 0.0, half))
        body = self._body(box, upright(x, y, 0.0, 0.0), True)
        self.statics[body] = self.names[body] = name

    def _object(self, index: int) -> int:
        thing = self.world.movables[index]
        body = self._body(thing.body, thing.pose, False)
        b, materials = self.bullet, self.materials
        b.changeDynamics(
            body,
            -1,
            spinningFriction=materials.spinning,
            activationState=b.ACTIVATION_STATE_ENABLE_SLEEPING,
        )
        return body

    def _load_robot(self) -> int:
        b, robot = self.bullet, self.robot
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "robot.urdf"
            path.write_text(robot_urdf(robot, Path(folder)), encoding="utf-8")
            with quiet():
                body: int = b.loadURDF(
                    str(path), useFixedBase=True, flags=b.URDF_USE_INERTIA_FROM_FILE
                )
        self.link_names, joint_index = {-1: "world"}, {}
        for i in range(b.getNumJoints(body)):
            info = b.getJointInfo(body, i)
            self.link_names[i] = info[12].decode()
            joint_index[info[1].decode()] = i
            b.changeDynamics(
                body,
                i,
                linearDamping=0,
                angularDamping=0,
                jointDamping=0,
                lateralFriction=self.materials.friction,
                restitution=0.0,
            )
        base = [own_name(robot, name) for name in BASE_JOINTS]
        self._motors = [joint_index[name] for name in (*base, *robot.joints)]
        self._fingers = [joint_index[name] for name in robot.fingers]
        self._links = {name: index for index, name in self.link_names.items()}
        self.tool = self._links[robot.tool]
        self._gripper = {self._links[name] for name in robot.gripper_links}
        start = np.concatenate([self.world.robot_start, robot.home])
        for index, value in zip(self._motors, start, strict=True):
            b.resetJointState(body, index, float(value))
        open_ = robot.finger_values(np.array(robot.max_opening)).tolist()
        for index, value in zip(self._fingers, open_, strict=True):
            b.resetJointState(body, index, value)
        return body

    # -- what moves ----------------------------------------------------------------------------

    def drive(self, target: Floats, velocity: Floats, opening: float) -> None:
        """Targets of the motors: base and planning joints (3 + n,), opening of the gripper."""
        b, count = self.bullet, len(self._motors)
        b.setJointMotorControlArray(
            self.body,
            self._motors,
            b.POSITION_CONTROL,
            targetPositions=target.tolist(),
            targetVelocities=velocity.tolist(),
            positionGains=[GAIN] * count,
            velocityGains=[1.0] * count,
            forces=[STRONG] * count,
        )
        fingers = len(self._fingers)
        wanted = opening - (2 * SQUEEZE if self.squeezing else 0.0)
        if self.held is not None:
            wanted = self._held_opening
        b.setJointMotorControlArray(
            self.body,
            self._fingers,
            b.POSITION_CONTROL,
            targetPositions=self.robot.finger_values(np.array(wanted)).tolist(),
            positionGains=[0.1] * fingers,
            velocityGains=[1.0] * fingers,
            forces=[self.materials.finger_force] * fingers,
        )

    def step(self) -> bool:
        """One step; False where the grasp broke in it."""
        self.bullet.stepSimulation()
        self.time += STEP
        if self.watched:
            sleep(STEP)  # at the speed of the world, or slower
        if self._constraint is None:
            return True
        force = self.bullet.getConstraintState(self._constraint)
        if np.linalg.norm(force[:3]) <= self.materials.holding_force:
            return True
        self.release()
        return False

    # -- grasps --------------------------------------------------------------------------------

    def touching_sides(self, index: int) -> int:
        """On how many sides the gripper touches an object: both, where it is between fingers."""
        contacts = self.bullet.getContactPoints(self.body, self.objects[index])
        to_tool = np.linalg.inv(self.tool_matrix())
        sides = {
            float((to_tool @ [*c[5], 1.0])[1]) > 0
            for c in contacts
            if c[3] in self._gripper and c[8] < 1e-3
        }
        return len(sides)

    def grasp(self, index: int) -> bool:
        """Fix an object to the gripper as it is; False where the fingers do not hold it."""
        if self.touching_sides(index) < 2:
            return False
        b = self.bullet
        position, turn = b.getBasePositionAndOrientation(self.objects[index])
        state = b.getLinkState(self.body, self.tool, computeForwardKinematics=1)
        # Constraints refer to the link's centre of mass.
        inverse = b.invertTransform(state[0], state[1])
        local = b.multiplyTransforms(*inverse, position, turn)
        self._constraint = b.createConstraint(
            self.body,
            self.tool,
            self.objects[index],
            -1,
            b.JOINT_FIXED,
            [0, 0, 0],
            local[0],
            [0, 0, 0],
            local[1],
        )
        # Stronger than the limit at which `step` breaks it: it shall break, not stretch.
        b.changeConstraint(self._constraint, maxForce=4 * self.materials.holding_force)
        self._let_fingers_touch(index, False)
        # An object that fell asleep in the gripper would be torn out of it at the next move.
        b.changeDynamics(
            self.objects[index], -1, activationState=b.ACTIVATION_STATE_DISABLE_SLEEPING
        )
        self.held, self.squeezing = index, False
        self._held_opening = self.opening()
        return True

    def _let_fingers_touch(self, index: int, touch: bool) -> None:
        # The constraint stands for the fingers' friction: with both, they would work against
        # each other, and the constraint's force would say nothing about the load.
        for link in self._gripper:
            self.bullet.setCollisionFilterPair(self.body, self.objects[index], link, -1, int(touch))

    def release(self) -> None:
        """Let go of what is held."""
        if self._constraint is not None:
            self.bullet.removeConstraint(self._constraint)
        if self.held is not None:
            b = self.bullet
            self._let_fingers_touch(self.held, True)
            b.changeDynamics(
                self.objects[self.held], -1, activationState=b.ACTIVATION_STATE_WAKE_UP
            )
        self._constraint = self.held = None
        self.squeezing = False

    def shift(self, index: int, step: Floats) -> None:
        """Move an object by a step (3,), as somebody who pushes it does."""
        b, body = self.bullet, self.objects[index]
        position, turn = b.getBasePositionAndOrientation(body)
        b.resetBasePositionAndOrientation(body, (np.array(position) + step).tolist(), turn)

    # -- what is measured ----------------------------------------------------------------------

    def robot_state(self) -> tuple[Floats, Floats]:
        """Positions and velocities (3 + n,) of base and planning joints."""
        states = self.bullet.getJointStates(self.body, self._motors)
        return np.array([s[0] for s in states]), np.array([s[1] for s in states])

    def opening(self) -> float:
        """How far the fingers are apart."""
        states = self.bullet.getJointStates(self.body, self._fingers)
        return self.robot.opening_of([state[0] for state in states])

    def object_pose(self, index: int) -> Floats:
        """World pose (7,) of an object's frame."""
        b, body = self.bullet, self.objects[index]
        to_body = b.invertTransform(*self._axes[body])
        position, turn = b.multiplyTransforms(*b.getBasePositionAndOrientation(body), *to_body)
        return np.array([*position, *turn])

    def tool_matrix(self) -> Floats:
        """World pose (4, 4) of the tool frame."""
        state = self.bullet.getLinkState(self.body, self.tool)
        return matrix(np.array([*state[4], *state[5]]))

    def contacts(self, gripped: int | None) -> set[Contact]:
        """What the robot touches, apart from the gripper and the object it is gripping, and from
        what its base stands on."""
        found = set()
        for point in self.bullet.getContactPoints(self.body):
            link, other = point[3], point[2]
            if point[8] > 0 or other == self.body:
                continue
            mine = gripped is not None and other == self.objects[gripped]
            if not (mine and link in self._gripper):
                found.add(Contact(self.link_names[link], self.names[other]))
        return found - self._stands_on


def connect(gui: bool) -> Any:
    """A PyBullet client.

    Raises:
        InputError: PyBullet is not installed, or there is no display for its window.
    """
    if gui and sys.platform == "linux" and not _display_opens():
        raise InputError("there is no display for the window", hint="leave --gui out")
    try:
        with quiet():
            import pybullet
            from pybullet_utils.bullet_client import BulletClient
    except ImportError:
        raise InputError(
            "PyBullet is not installed", hint="it has packages for Python 3.11: install pybullet"
        ) from None
    try:
        with quiet():
            return BulletClient(pybullet.GUI if gui else pybullet.DIRECT)
    except pybullet.error as error:
        hint = "leave --gui out" if gui else None
        raise InputError(f"PyBullet does not start: {error}", hint=hint) from None


def _display_opens() -> bool:
    """Whether X11 has a display for us: without one, PyBullet ends the whole process. It does
    not know Wayland, which gives programs of X11 a DISPLAY as well."""
    if not os.environ.get("DISPLAY"):
        return False
    try:
        x11 = ctypes.CDLL("libX11.so.6")
    except OSError:
        return False  # PyBullet looks for the same library
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = x11.XOpenDisplay(None)
    if display:
        x11.XCloseDisplay(ctypes.c_void_p(display))
    return bool(display)


@contextmanager
def quiet() -> Iterator[None]:
    """Keep what native code prints off our output: results only belong there."""
    sys.stdout.flush()
    sys.stderr.flush()
    keep = [os.dup(1), os.dup(2)]
    sink = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(sink, 1)
        os.dup2(sink, 2)
        yield
    finally:
        if os.name == "posix":
            ctypes.CDLL(None).fflush(None)  # what C has buffered would come out at the end
        for number, kept in enumerate(keep, 1):
            os.dup2(kept, number)
            os.close(kept)
        os.close(sink)
