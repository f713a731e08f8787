"""A robot of three links, small enough to see through, as text to be changed by tests."""

from __future__ import annotations

from pathlib import Path

URDF = """<robot name="crane">
  <link name="foot"><collision><origin xyz="0 0 0.2"/><geometry><box size="0.4 0.4 0.4"/>
    </geometry></collision></link>
  <link name="mast"><collision><origin xyz="0 0 0.2"/><geometry><box size="0.1 0.1 0.4"/>
    </geometry></collision></link>
  <link name="boom"><collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.05 0.05"/>
    </geometry></collision></link>
  <link name="palm"><collision><geometry><box size="0.02 0.1 0.02"/></geometry></collision></link>
  <link name="left"><collision><origin xyz="0.03 0.003 0"/>
    <geometry><box size="0.04 0.006 0.02"/></geometry></collision></link>
  <link name="right"><collision><origin xyz="0.03 -0.003 0"/>
    <geometry><box size="0.04 0.006 0.02"/></geometry></collision></link>
  <link name="grasp"/>
  <joint name="lift" type="prismatic"><parent link="foot"/><child link="mast"/>
    <origin xyz="0 0 0.4"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.5" velocity="0.1" effort="1"/></joint>
  <joint name="swing" type="revolute"><parent link="mast"/><child link="boom"/>
    <origin xyz="0 0 0.4"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
  <joint name="wrist" type="fixed"><parent link="boom"/><child link="palm"/>
    <origin xyz="0.42 0 0"/></joint>
  <joint name="left_finger" type="prismatic"><parent link="palm"/><child link="left"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="0.04" velocity="0.05" effort="1"/></joint>
  <joint name="right_finger" type="prismatic"><parent link="palm"/><child link="right"/>
    <axis xyz="0 -1 0"/><limit lower="0" upper="0.04" velocity="0.05" effort="1"/></joint>
  <joint name="tip" type="fixed"><parent link="palm"/><child link="grasp"/>
    <origin xyz="0.04 0 0"/></joint>
</robot>
"""

TOML = """name = "crane"
urdf = "crane.urdf"
base_link = "foot"
tool_link = "grasp"
joints = ["lift", "swing"]
acceleration = [0.1, 2.0]
home = [0.1, 0.0]
ignored_collisions = [["foot", "mast"], ["mast", "boom"]]

[gripper]
finger_joints = ["left_finger", "right_finger"]
links = ["palm", "left", "right"]
clearance = 0.004
time = 0.5

[base]
velocity = 0.8
acceleration = 0.6
angular_velocity = 1.2
angular_acceleration = 1.5
"""


def write_robot(folder: Path, toml: str = TOML, urdf: str = URDF) -> Path:
    """Write the two files; returns the path of the robot file."""
    (folder / "crane.urdf").write_text(urdf, encoding="utf-8")
    path = folder / "crane.toml"
    path.write_text(toml, encoding="utf-8")
    return path
