"""An arm of six joints with a gripper, made of primitives: small enough to write down."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import trimesh

from runtime.robot import reachable

LINKS = (
    # name, joint's place in the link before, its axis, the shape's middle and geometry
    ("turret", "0 0 0.1", "0 0 1", "0 0 0.05", '<cylinder radius="0.07" length="0.1"/>'),
    ("upper", "0 0 0.12", "0 1 0", "0 0 0.15", '<mesh filename="meshes/tube.stl"/>'),
    ("fore", "0 0 0.35", "0 1 0", "0 0 0.13", '<mesh filename="meshes/tube.stl"/>'),
    ("roll", "0 0 0.32", "0 0 1", "0 0 0.02", '<sphere radius="0.04"/>'),
    ("pitch", "0 0 0.08", "0 1 0", "0 0 0.02", '<sphere radius="0.04"/>'),
    ("flange", "0 0 0.08", "0 0 1", "0 0 0", '<cylinder radius="0.035" length="0.04"/>'),
)
HAND = """
  <link name="palm"><collision><origin xyz="0 0 0.03"/><geometry><box size="0.05 0.12 0.05"/>
    </geometry></collision></link>
  <joint name="mount" type="fixed"><parent link="flange"/><child link="palm"/>
    <origin xyz="0 0 0.02" rpy="0 0 0.7853981634"/></joint>
  <link name="left"><collision><origin xyz="0 0.005 0.03"/>
    <geometry><box size="0.02 0.01 0.06"/></geometry></collision></link>
  <link name="right"><collision><origin xyz="0 -0.005 0.03"/>
    <geometry><box size="0.02 0.01 0.06"/></geometry></collision></link>
  <joint name="slide_left" type="prismatic"><parent link="palm"/><child link="left"/>
    <origin xyz="0 0 0.055"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.045" velocity="0.1"/></joint>
  <joint name="slide_right" type="prismatic"><parent link="palm"/><child link="right"/>
    <origin xyz="0 0 0.055"/><axis xyz="0 -1 0"/><limit lower="0" upper="0.045" velocity="0.1"/>
    <mimic joint="slide_left"/></joint>
"""


def arm_urdf(hand: str = HAND, limit: str = 'lower="-2.6" upper="2.6" velocity="2"') -> str:
    """The arm on a foot, as URDF."""
    parts = [
        '<robot name="arm"><link name="foot"><collision><origin xyz="0 0 0.04"/><geometry>'
        '<box size="0.2 0.2 0.08"/></geometry></collision></link>'
    ]
    before = "foot"
    for name, place, axis, middle, geometry in LINKS:
        parts.append(
            f'<link name="{name}"><collision><origin xyz="{middle}"/><geometry>{geometry}'
            f'</geometry></collision></link><joint name="{name}_joint" type="revolute">'
            f'<parent link="{before}"/><child link="{name}"/><origin xyz="{place}"/>'
            f'<axis xyz="{axis}"/><limit {limit} effort="1"/></joint>'
        )
        before = name
    return "".join(parts) + hand + "</robot>"


def write_arm(folder: Path, urdf: str | None = None) -> Path:
    """Write the URDF and its mesh; returns the path of the URDF."""
    (folder / "meshes").mkdir(exist_ok=True)
    trimesh.creation.cylinder(radius=0.045, height=0.26).export(folder / "meshes" / "tube.stl")
    path = folder / "arm.urdf"
    path.write_text(urdf or arm_urdf(), encoding="utf-8")
    return path


@contextmanager
def coarse_grid(cache: Path) -> Iterator[None]:
    """Where arms reach, on a coarse grid of heights and distances, with a cache of its own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(cache))
        patch.setattr(reachable, "HEIGHT_STEP", 0.2)
        patch.setattr(reachable, "DISTANCE_STEP", 0.12)
        patch.setattr(reachable, "SEEDS", 2)
        yield
