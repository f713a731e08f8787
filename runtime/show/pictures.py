"""Pictures and films of a trace, drawn by PyBullet's software renderer: no display needed."""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runtime.physics.simulation import connect
from runtime.robot.model import Floats
from runtime.show.colours import FLOOR
from runtime.show.drawn import Drawn, drawn
from runtime.show.meshes import triangles
from runtime.trace.model import Trace
from runtime.world.quaternions import pose_of
from runtime.world.solids import Box
from sketchlang.errors import InputError
from sketchlang.escape import file_part
from sketchlang.files import check_output, replacing, write_bytes

Image = NDArray[np.uint8]
"""Rows of pixels, red, green, blue: (height, width, 3)."""

SIZE = (960, 540)
FRAMES = 12.0
"""Frames of a film a second."""

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

    def __init__(self, trace: Trace, size: tuple[int, int] = SIZE) -> None:
        self.trace, self.size = trace, size
        self.bullet: Any = connect(False)
        self._bodies: dict[str, int] = {}
        self.eye, self.target = framed(_corners(trace), size[0] / size[1])
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
        for thing in drawn(self.trace, time):
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


def _corners(trace: Trace) -> Floats:
    """Points (k, 3) around everything at the moments of which there are pictures."""
    times = {time for _, time in moments(trace)} | set(np.linspace(0, trace.duration, 20).tolist())
    return np.concatenate(
        [
            thing.vertices @ thing.pose[:3, :3].T + thing.pose[:3, 3]
            for time in sorted(times)
            for thing in drawn(trace, time)
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


def moments(trace: Trace) -> Iterator[tuple[str, float]]:
    """Names and times of the pictures: the start, the end of each subgoal, the end, which is
    called `failure` where a partial plan ends."""
    yield "start", 0.0
    for number, subgoal in enumerate(trace.subgoals, 1):
        yield f"subgoal-{number:02d}-{file_part(subgoal.rule)}", subgoal.end
    partial = trace.source == "plan" and any(event.kind == "verdict" for event in trace.events)
    yield "failure" if partial else "end", trace.duration


def write_pictures(trace: Trace, folder: Path) -> list[Path]:
    """Write the pictures of `moments` as PNG files into a folder; their paths.

    Raises:
        InputError: they cannot be written, or PyBullet is missing.
    """
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot be made: {error.strerror}", place=str(folder)) from None
    times = {folder / f"{name}.png": time for name, time in moments(trace)}
    for path in times:
        check_output(path)
    studio = Studio(trace)
    try:
        for path, time in times.items():
            write_bytes(path, png(studio.picture(time)))
    finally:
        studio.close()
    return list(times)


def check_film(path: Path) -> None:
    """Find out before the work whether a film can be written under a name.

    Raises:
        InputError: the package imageio-ffmpeg is missing, or the name is not that of an MP4.
    """
    if find_spec("imageio_ffmpeg") is None:
        raise InputError("films need the package imageio-ffmpeg", hint="install sketchlang[film]")
    if path.suffix.lower() != ".mp4":
        raise InputError("a film has a name that ends in .mp4", place=str(path))


def write_film(trace: Trace, path: Path, speed: float) -> None:
    """Write an MP4 (H.264) that is `speed` times as fast as the trace, as a whole or not at
    all.

    Raises:
        InputError: the package imageio-ffmpeg or PyBullet is missing, or nothing is written.
    """
    check_film(path)
    with replacing(path) as temporary:
        _write_film(trace, temporary, speed)
        if b"moov" not in temporary.read_bytes():  # the index, which is written last
            raise OSError("the encoder failed")


def _write_film(trace: Trace, path: Path, speed: float) -> None:
    import imageio_ffmpeg

    # The encoder wants sides that are multiples of 16.
    studio = Studio(trace, (960, 544))
    # The encoder's own words are for those who know its command line.
    writer = imageio_ffmpeg.write_frames(
        str(path), studio.size, fps=FRAMES, quality=7, ffmpeg_log_level="quiet"
    )
    try:
        writer.send(None)
        for frame in range(math.ceil(trace.duration * FRAMES / speed) + 1):
            image = studio.picture(min(frame * speed / FRAMES, trace.duration))
            writer.send(np.ascontiguousarray(image))
    except OSError:
        raise OSError("the encoder failed") from None
    finally:
        writer.close()
        studio.close()


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
