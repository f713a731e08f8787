"""Observations as KinDER's process answers them, drawn at random."""

from __future__ import annotations

from typing import Any

import numpy as np

from domains.tabletop.kinder.observed import CYLINDER, RIGHT, Observation

HOME = (0.0, -0.35, -3.1415927, -2.5, 0.0, -0.87, 1.5707964)
LYING = {"pose_qx": 0.0, "pose_qy": 0.0, "pose_qz": 0.0, "pose_qw": 1.0}


def robot(x: float = 0.0) -> dict[str, Any]:
    joints = {f"joint_{i}": value for i, value in enumerate(HOME, 1)}
    base = {"pos_base_x": x, "pos_base_y": 0.0, "pos_base_rot": 0.0}
    return {"type": "robot", **base, **joints, "finger_state": 0.0, "grasp_active": 0.0}


def at(x: float, y: float, z: float) -> dict[str, float]:
    return {"pose_x": x, "pose_y": y, "pose_z": z, **LYING, "grasp_active": 0.0}


def cuboid(
    x: float, y: float, bottom: float, half: tuple[float, float, float], kind: float = -1.0
) -> dict[str, Any]:
    sides = {f"half_extent_{axis}": value for axis, value in zip("xyz", half, strict=True)}
    place = at(x, y, bottom + half[2])
    return {"type": "Kinematic3DCuboid", **place, **sides, "object_type": kind}


def triangle(x: float, y: float, bottom: float, right: bool) -> dict[str, Any]:
    shape = {"triangle_type": RIGHT if right else 0.0, "side_a": 0.1, "side_b": 0.1, "depth": 0.02}
    return {"type": "Kinematic3DTriangle", **at(x, y, bottom + 0.01), **shape}


def observation(things: dict[str, Any], x: float = 0.0) -> Observation:
    state = {"robot": robot(x), **things}
    return Observation.of({"state": state, "terminated": False, "limit": 0.2})


def spread(rng: np.random.Generator, count: int, low: Any, high: Any, apart: float) -> Any:
    """Points (count, 2) between two corners, apart from each other."""
    found: list[np.ndarray] = []
    while len(found) < count:
        point = rng.uniform(low, high)
        if all(np.abs(point - other).max() > apart for other in found):
            found.append(point)
    return found


def table3d(rng: np.random.Generator, count: int) -> Observation:
    half = (0.025, 0.025, 0.025)
    points = spread(rng, count, (0.43, -0.37), (0.77, 0.37), 0.051)
    cubes = {f"cube{i}": cuboid(*p, 0.4, half) for i, p in enumerate(points)}
    return observation({"table": cuboid(0.6, 0.0, 0.0, (0.2, 0.4, 0.2)), **cubes})


def on_floor(rng: np.random.Generator, count: int) -> list[np.ndarray]:
    """Places on the floor that the robot does not stand on."""
    return [
        p if abs(p[0]) > 0.5 else p + np.array([1.0, 0.0])
        for p in spread(rng, count, (-0.9, -0.9), (0.9, 0.9), 0.3)
    ]


def shelf(rng: np.random.Generator, count: int, name: str) -> Observation:
    round_ = name == "cylinder"
    half = (0.03, 0.03, 0.1) if round_ else (0.05, 0.025, 0.025)
    things = {
        f"{name}{i}": cuboid(*p, 0.0, half, CYLINDER if round_ else -1.0)
        for i, p in enumerate(on_floor(rng, count))
    }
    return observation({"shelf": {"type": "fixture", **at(2.0, 2.4, 0.02)}, **things})


def obstruction(rng: np.random.Generator, count: int) -> Observation:
    """Obstructions on the region, their middles up to a quarter of their size beside it."""
    region = rng.uniform(0.03, 0.05, 2)
    x, y = rng.uniform((0.2, -0.1), (0.4, 0.1))
    things = {
        "target_region": cuboid(x, y, 0.075, (*region, 0.005)),
        "target_block": cuboid(0.3, -0.3, 0.075, (*(0.8 * region), 0.025)),
    }
    for i in range(count):
        side = -1.0 if i % 2 else 1.0
        half = (0.01, 0.01, float(rng.uniform(0.01, 0.03)))
        reach = region + 0.25 * np.array(half[:2]) * rng.uniform(-1, 1)
        place = (x + side * reach[0], y + (1 if i < 2 else -1) * reach[1])
        things[f"obstruction{i}"] = cuboid(*place, 0.085, half)
    return observation(things, -0.12)


def transport(rng: np.random.Generator, count: int) -> Observation:
    points = [p + np.array([-0.9, -0.9]) for p in on_floor(rng, count + 1)]
    half = (0.025, 0.025, 0.025)
    things = {f"cube{i}": cuboid(*p, 0.0, half) for i, p in enumerate(points[1:])}
    table = cuboid(0.6, 0.0, 0.0, (0.2, 0.4, 0.2))
    return observation(
        {"table": table, "box0": cuboid(*points[0], 0.0, (0.1, 0.15, 0.1)), **things}
    )


def packing(rng: np.random.Generator, count: int) -> Observation:
    """Parts a centimetre above the table, as KinDER has them."""
    parts: dict[str, Any] = {}
    for i in range(count):
        x, y = 0.25, (-0.32, 0.22, 0.34)[i] if i < 3 else 0.0
        kind = int(rng.integers(3)) if i else 1
        parts[f"part{i}"] = (
            cuboid(x, y, 0.085, (0.05, 0.05, 0.01))
            if kind == 0
            else triangle(x, y, 0.085, kind == 1)
        )
    return observation({"rack": cuboid(0.3, 0.0, 0.075, (0.1, 0.15, 0.02)), **parts}, -0.12)


OBSERVED = {
    "Table3D-o2": lambda rng: table3d(rng, 2),
    "KinematicShelf3D-o3": lambda rng: shelf(rng, 3, "cube"),
    "KinematicCylinderShelf3D-o2": lambda rng: shelf(rng, 2, "cylinder"),
    "Obstruction3D-o4": lambda rng: obstruction(rng, 4),
    "Transport3D-o2": lambda rng: transport(rng, 2),
    "Packing3D-p2": lambda rng: packing(rng, 2),
}
