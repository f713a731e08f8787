"""Pictures of a trace without a browser: PyBullet's software renderer, which shows the scene and
no words."""

from __future__ import annotations

import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runtime.physics.simulation import connect
from runtime.robot.model import Floats
from runtime.show.colours import FLOOR
from runtime.show.drawn import Drawn, Scenery
from runtime.show.meshes import triangles
from runtime.show.moments import moments
from runtime.trace.model import Trace
from runtime.world.quaternions import pose_of
from runtime.world.solids import Box

Image = NDArray[np.uint8]
"""Rows of pixels, red, green, blue: (height, width, 3)."""

SIZE = (960, 544)
"""Width and height, multiples of 16 as encoders of films like them."""

LIGHT = (-0.5, -0.8, 1.6)

LENS = 42.0
"""Degrees that the camera sees from bottom to top."""

FORWARD = np.array([0.95, 1.55, -1.55]) / np.linalg.norm([0.95, 1.55, -1.55])
RIGHT = np.cross(FORWARD, [0, 0, 1.0]) / np.linalg.norm(np.cross(FORWARD, [0, 0, 1.0]))
UP = np.cross(RIGHT, FORWARD)
"""Where the camera looks, in the world frame."""

NEAREST = 0.1
"""Metres from the camera at which the picture begins."""

MARGIN = 0.94
"""Share of the picture that the scene takes."""

TILES = 40
"""Tiles of 1 m, or larger ones where more than this many would lie side by side."""


class Studio:
    """A trace before a camera that sees the whole scene."""

    lacks: str | None = "there is no Chromium: drawn by the software renderer, without words"

    def __init__(self, trace: Trace, size: tuple[int, int] = SIZE) -> None:
        self.trace, self.size, self.scenery = trace, size, Scenery(trace)
        self.bullet: Any = connect(False)
        self._bodies: dict[str, int] = {}
        self.eye, self.target = framed(_corners(self.scenery), size[0] / size[1])
        self._add_floor()

    def _add_floor(self) -> None:
        # In tiles, and none behind the camera: the renderer draws large triangles wrongly that
        # reach there.
        seen = _floor_seen(self.eye, self.target, self.size[0] / self.size[1])
        tile = max(1.0, float(np.ptp(seen, axis=0).max()) / TILES)
        low, high = np.floor(seen.min(axis=0) / tile), np.ceil(seen.max(axis=0) / tile)
        corners = tile * np.array([[i, j, 0] for i in (0, 1) for j in (0, 1)])
        for i, j in np.ndindex(*(high - low).astype(int)):
            corner = tile * np.array([low[0] + i, low[1] + j, 0.0])
            if ((corner + corners - self.eye) @ (self.target - self.eye)).min() < NEAREST:
                continue
            shade = 1.0 if (i + j) % 2 else 0.97
            colour = (FLOOR[0] * shade, FLOOR[1] * shade, FLOOR[2] * shade)
            pose = np.eye(4)
            pose[:3, 3] = corner[0] + tile / 2, corner[1] + tile / 2, -0.01
            slab = triangles(Box((tile, tile, 0.02)))
            self._add(Drawn(f"floor {i} {j}", *slab, pose, colour))

    def close(self) -> None:
        """Put everything away."""
        if self.bullet.isConnected():
            self.bullet.disconnect()

    def _add(self, thing: Drawn) -> None:
        b, pose = self.bullet, pose_of(thing.pose)
        # Corners of each face of its own: the renderer shades by normals at the corners.
        corners = thing.vertices[thing.faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-12)[:, None]
        shape = b.createVisualShape(
            b.GEOM_MESH,
            vertices=corners.reshape(-1, 3).tolist(),
            indices=list(range(3 * len(corners))),
            normals=np.repeat(normals, 3, axis=0).tolist(),
            rgbaColor=[*thing.colour, 1.0],
        )
        self._bodies[thing.name] = b.createMultiBody(
            0, -1, shape, pose[:3].tolist(), pose[3:].tolist()
        )

    def picture(self, time: float) -> Image:
        """The scene at a time."""
        for thing in self.scenery.at(time):
            if thing.name in self._bodies:
                pose = pose_of(thing.pose)
                self.bullet.resetBasePositionAndOrientation(
                    self._bodies[thing.name], pose[:3].tolist(), pose[3:].tolist()
                )
            else:
                self._add(thing)
        b, (width, height) = self.bullet, self.size
        view = b.computeViewMatrix(self.eye.tolist(), self.target.tolist(), [0, 0, 1])
        lens = b.computeProjectionMatrixFOV(
            LENS, width / height, NEAREST, max(100, 10 * self.eye[2])
        )
        pixels = b.getCameraImage(
            width,
            height,
            view,
            lens,
            lightDirection=LIGHT,
            shadow=0,  # its shadow map does not cover the floor: half of it would be dark
            renderer=b.ER_TINY_RENDERER,
        )[2]
        return np.reshape(np.asarray(pixels, dtype=np.uint8), (height, width, 4))[:, :, :3]

    def shot(self, time: float) -> bytes:
        """The same as PNG."""
        return png(self.picture(time))


def framed(points: Floats, aspect: float) -> tuple[Floats, Floats]:
    """Where a camera stands and a point at which it looks (3,), world frame: it sees all
    points (k, 3), and from as near as it can. `aspect` is width by height."""
    depth, centre, distance = points @ FORWARD, np.zeros(3), 0.0
    tangent = MARGIN * np.tan(np.radians(LENS / 2))
    for axis, slope in ((UP, tangent), (RIGHT, aspect * tangent)):
        # A point is in the picture where |its way along the axis| <= slope * its depth.
        high = (points @ axis - slope * depth).max()
        low = (-points @ axis - slope * depth).max()
        centre += axis * (high - low) / 2
        distance = max(distance, float(high + low) / (2 * slope))
    eye: Floats = centre - distance * FORWARD
    return eye, eye + FORWARD


def _corners(scenery: Scenery) -> Floats:
    """Points (k, 3) around everything at the moments of which there are pictures."""
    trace = scenery.trace
    times = {time for _, time in moments(trace)} | set(np.linspace(0, trace.duration, 20).tolist())
    return np.concatenate(
        [
            thing.vertices @ thing.pose[:3, :3].T + thing.pose[:3, 3]
            for time in sorted(times)
            for thing in scenery.at(time)
        ]
    )


def _floor_seen(eye: Floats, target: Floats, aspect: float) -> Floats:
    """Where the corners of the picture see the floor (4, 2)."""
    slope = np.tan(np.radians(LENS / 2))
    rays = np.array(
        [target - eye + slope * (x * aspect * RIGHT + y * UP) for x in (-1, 1) for y in (-1, 1)]
    )
    seen: Floats = (eye - rays * eye[2] / rays[:, 2:])[:, :2]
    return seen


def png(image: Image) -> bytes:
    """An image as PNG."""
    height, width, _ = image.shape
    rows = np.zeros((height, 1 + 3 * width), dtype=np.uint8)  # filter 0 before each row
    rows[:, 1:] = image.reshape(height, -1)

    def chunk(kind: bytes, data: bytes) -> bytes:
        check = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", check)

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    packed = zlib.compress(rows.tobytes(), 6)
    parts = (chunk(b"IHDR", header), chunk(b"IDAT", packed), chunk(b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)
