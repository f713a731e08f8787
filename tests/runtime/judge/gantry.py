"""A gantry that hangs over a table, and plans for it that are written by hand.

Its three joints are the place of the grasp centre; the hand points down, its fingers close
along y. So a plan is a list of places, and every number in it can be checked by eye. One of the
posts that bear it stands in a corner within reach.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from runtime.judge.certify import certify
from runtime.judge.findings import Certificate
from runtime.motion import timing
from runtime.motion.motion import ArmMove, Attach, Carried, GripperMove, Piece, Release
from runtime.plan.model import Plan, PlanAction, PlanSubgoal
from runtime.robot.load import load_robot
from runtime.robot.model import RobotModel
from runtime.world.body import Body, Part
from runtime.world.goals import Goal
from runtime.world.poses import Pose, upright
from runtime.world.quaternions import pose_of
from runtime.world.solids import Box
from runtime.world.world import Fixed, Guide, Movable, Support, World

AIR = 0.002
TOP = 0.4
CUBE = 0.04
HOME = (0.0, 0.0, 1.0)
POST = (-1.2, 1.2)

URDF = """<robot name="gantry">
  <link name="rail"><collision><origin xyz="-1.2 1.2 0.6"/><geometry><box size="0.1 0.1 1.2"/>
    </geometry></collision></link>
  <link name="trolley"/>
  <link name="bridge"><collision><origin xyz="0 0 1.7"/><geometry><box size="0.2 4 0.05"/>
    </geometry></collision></link>
  <link name="mast"><collision><origin xyz="0 0 0.57"/><geometry><box size="0.02 0.02 1.0"/>
    </geometry></collision></link>
  <link name="hand"><collision><origin xyz="-0.01 0 0"/><geometry><box size="0.02 0.1 0.03"/>
    </geometry></collision></link>
  <link name="left"><collision><origin xyz="0.03 0.004 0"/><geometry><box size="0.06 0.008 0.02"/>
    </geometry></collision></link>
  <link name="right"><collision><origin xyz="0.03 -0.004 0"/><geometry><box size="0.06 0.008 0.02"/>
    </geometry></collision></link>
  <link name="grasp"/>
  <joint name="x" type="prismatic"><parent link="rail"/><child link="bridge"/><axis xyz="1 0 0"/>
    <limit lower="-2" upper="2" velocity="0.5" effort="1"/></joint>
  <joint name="y" type="prismatic"><parent link="bridge"/><child link="trolley"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="0.5" effort="1"/></joint>
  <joint name="z" type="prismatic"><parent link="trolley"/><child link="mast"/><axis xyz="0 0 1"/>
    <limit lower="-0.2" upper="1.5" velocity="0.5" effort="1"/></joint>
  <joint name="wrist" type="fixed"><parent link="mast"/><child link="hand"/>
    <origin xyz="0 0 0.05" rpy="0 1.5707963267948966 0"/></joint>
  <joint name="left_finger" type="prismatic"><parent link="hand"/><child link="left"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="0.04" velocity="0.05" effort="1"/></joint>
  <joint name="right_finger" type="prismatic"><parent link="hand"/><child link="right"/>
    <axis xyz="0 -1 0"/><limit lower="0" upper="0.04" velocity="0.05" effort="1"/></joint>
  <joint name="centre" type="fixed"><parent link="hand"/><child link="grasp"/>
    <origin xyz="0.05 0 0"/></joint>
</robot>
"""

TOML = """name = "gantry"
urdf = "gantry.urdf"
tool_link = "grasp"
joints = ["x", "y", "z"]
acceleration = [1.0, 1.0, 1.0]
home = [0.0, 0.0, 1.0]
ignored_collisions = [
  ["bridge", "mast"], ["mast", "hand"], ["hand", "left"], ["hand", "right"], ["left", "right"],
]

[gripper]
finger_joints = ["left_finger", "right_finger"]
links = ["hand", "left", "right"]
payload = 2.0

[base]
type = "fixed"
"""


@lru_cache(maxsize=1)
def gantry() -> RobotModel:
    """The robot."""
    with TemporaryDirectory() as folder:
        (Path(folder) / "gantry.urdf").write_text(URDF, encoding="utf-8")
        path = Path(folder) / "gantry.toml"
        path.write_text(TOML, encoding="utf-8")
        return load_robot(str(path))


@lru_cache(maxsize=1)
def tilting_gantry() -> RobotModel:
    """The same with a fourth joint: the hand turns about the line along which its fingers close."""
    fixed = '<joint name="wrist" type="fixed"><parent link="mast"/><child link="hand"/>'
    turning = fixed.replace("fixed", "revolute") + (
        '<axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="1" effort="1"/>'
    )
    text = TOML.replace('"z"]', '"z", "wrist"]').replace("1.0, 1.0]", "1.0, 1.0, 1.0]")
    text = text.replace("home = [0.0, 0.0, 1.0]", "home = [0.0, 0.0, 1.0, 0.0]")
    with TemporaryDirectory() as folder:
        (Path(folder) / "gantry.urdf").write_text(URDF.replace(fixed, turning), encoding="utf-8")
        path = Path(folder) / "gantry.toml"
        path.write_text(text, encoding="utf-8")
        return load_robot(str(path))


def block(size: tuple[float, float, float], mass: float = 0.1) -> Body:
    """A box whose frame is in the middle of its bottom."""
    half = size[2] / 2
    return Body((Part(Box(size), upright(0, 0, half, 0)),), mass, (0.0, 0.0, half))


def thing(name: str, size: tuple[float, float, float], x: float, y: float, z: float) -> Movable:
    """A box that stands with its bottom at a height."""
    return Movable(name, block(size), upright(x, y, z, 0.0))


def cube(name: str, x: float, y: float, z: float = TOP + AIR) -> Movable:
    """A cube of 4 cm."""
    return thing(name, (CUBE, CUBE, CUBE), x, y, z)


def _is_box(movable: Movable) -> bool:
    return isinstance(movable.body.parts[0].solid, Box)


def top_of(movable: Movable) -> Support:
    """The top of a box as a support."""
    solid = movable.body.parts[0].solid
    assert isinstance(solid, Box)
    a, b, c = solid.size
    place = upright(0, 0, c + AIR, 0)
    return Support(f"top of {movable.name}", movable.name, place, (a / 2, b / 2))


def table_world(
    *movables: Movable, fixed: Sequence[Fixed] = (), goals: Sequence[Goal] = ()
) -> World:
    """A table of 1 x 1 m, 40 cm high, with boxes that bear others."""
    table = Fixed("table", block((1.0, 1.0, TOP)), upright(0, 0, 0, 0))
    region = Support("table", "table", upright(0, 0, TOP + AIR, 0), (0.5, 0.5))
    return World(
        name="table",
        digest="w",
        robot_start=(0.0, 0.0, 0.0),
        fixed=(table, *fixed),
        movables=movables,
        supports=(region, *(top_of(m) for m in movables if len(m.body.parts) == 1 and _is_box(m))),
        goals=tuple(goals),
    )


def drawer(x: float, y: float, reach: float) -> Fixed:
    """A box that slides along x by a reach, its bottom above the table."""
    guide = Guide("prismatic", (1.0, 0.0, 0.0), (x, y, 0.0), 0.0, reach)
    return Fixed("drawer", block((0.1, 0.2, 0.1)), upright(x, y, TOP + AIR, 0.0), guide)


class Script:
    """A plan that grows place by place."""

    def __init__(self, world: World) -> None:
        self.world, self.robot = world, gantry()
        self.pieces: list[Piece] = []
        self.at = HOME

    def to(
        self, x: float, y: float, z: float, carried: str | None = None, start: Pose | None = None
    ) -> Script:
        """Move the grasp centre on a straight line; a body that starts at a pose goes along."""
        path = np.array([self.at, (x, y, z)])
        along: tuple[Carried, ...] = ()
        if carried is not None and start is not None:
            end = start.copy()
            end[:, 3] += path[1] - path[0]
            along = (Carried(carried, np.array([pose_of(start), pose_of(end)])),)
        self.pieces.append(ArmMove(path, "free", along))
        self.at = (x, y, z)
        return self

    def over(self, x: float, y: float, z: float) -> Script:
        """Up, across and down to a place."""
        high = 0.8
        return self.to(*self.at[:2], high).to(x, y, high).to(x, y, z)

    def fingers(self, opening: float) -> Script:
        """Move the fingers."""
        self.pieces.append(GripperMove(opening))
        return self

    def take(self, name: str, opening: float) -> Script:
        """Close on a body."""
        self.pieces.append(GripperMove(opening, Attach(name, "grasp")))
        return self

    def put(self, name: str, on: str | None, pose: Pose, opening: float = 0.08) -> Script:
        """Let a body go."""
        self.pieces.append(GripperMove(opening, release=Release(name, on, pose_of(pose))))
        return self

    def home(self) -> Script:
        """Go home."""
        return self.to(*self.at[:2], 0.9).to(*HOME)

    def plan(self) -> Plan:
        """The plan: one action of one subgoal."""
        timed, _ = timing.timed_motion(self.robot, tuple(self.pieces), 0.08)
        return Plan(
            sketch="none",
            scene=self.world.name,
            scene_digest=self.world.digest,
            robot=self.robot.name,
            robot_digest=self.robot.digest,
            planner="hand",
            seed=0,
            objects=tuple(movable.name for movable in self.world.movables),
            base_start=(0.0, 0.0, 0.0),
            subgoals=(PlanSubgoal("rule", {}, {}, 1, 0, 0, 0, 1, {}),),
            actions=(PlanAction("work", "work", 0, timed),),
            joints=self.robot.joints,
        )

    def verdict(self) -> Certificate:
        """What the judge says."""
        return certify(self.plan(), self.world, self.robot)

    def fault(self) -> str:
        """The first finding, empty where there is none."""
        found = self.verdict().findings
        return found[0].message if found else ""
