"""Pictures and films of a trace, drawn by PyBullet's software renderer: no display needed."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runtime.errors import InputError
from runtime.execution.physics import connect
from runtime.export.model import boxes
from runtime.files import write_bytes
from runtime.trace.kinematics import pose_of
from runtime.trace.model import Trace
from runtime.view.colours import FLOOR

Image = NDArray[np.uint8]
"""Rows of pixels, red, green, blue: (height, width, 3)."""

SIZE = (960, 540)
FRAMES = 12.0
"""Frames of a film a second."""

LIGHT = (-0.5, -0.8, 1.6)


class Studio:
    """A trace before a camera that sees the whole scene."""

    def __init__(self, trace: Trace, size: tuple[int, int] = SIZE) -> None:
        self.trace, self.size = trace, size
        self.bullet: Any = connect(False)
        self._bodies: dict[str, int] = {}
        centres = [surface.table.centre[:2] for surface in trace.scene.surfaces]
        points = np.array([*centres, trace.scene.robot_start[:2]])
        self.middle = (points.min(axis=0) + points.max(axis=0)) / 2
        reach = [
            np.hypot(*(np.array(s.table.centre[:2]) - self.middle)) + max(s.table.size[:2]) / 2
            for s in trace.scene.surfaces
        ]
        self.span = max(1.6, *reach) if reach else 1.6
        self._add(
            "floor", np.array([40.0, 40.0, 0.02]), np.array([0, 0, -0.01, 0, 0, 0, 1.0]), FLOOR
        )

    def _add_floor(self) -> None:
        # In tiles: the renderer draws large triangles wrongly that reach behind the camera.
        for i in range(-4, 4):
            for j in range(-4, 4):
                x, y = self.middle + np.array([i + 0.5, j + 0.5])
                shade = 1.0 if (i + j) % 2 else 0.95
                colour = (FLOOR[0] * shade, FLOOR[1] * shade, FLOOR[2] * shade)
                pose = np.array([x, y, -0.01, 0.0, 0.0, 0.0, 1.0])
                self._add(f"floor {i} {j}", np.array([1.0, 1.0, 0.02]), pose, colour)

    def close(self) -> None:
        """Put everything away."""
        if self.bullet.isConnected():
            self.bullet.disconnect()

    def _add(self, name: str, size: Any, pose: Any, colour: tuple[float, float, float]) -> None:
        b = self.bullet
        shape = b.createVisualShape(
            b.GEOM_BOX, halfExtents=(size / 2).tolist(), rgbaColor=[*colour, 1.0]
        )
        self._bodies[name] = b.createMultiBody(0, -1, shape, pose[:3].tolist(), pose[3:].tolist())

    def picture(self, time: float) -> Image:
        """The scene at a time."""
        for name, size, transform, colour in boxes(self.trace, time):
            pose = pose_of(transform)
            if name in self._bodies:
                self.bullet.resetBasePositionAndOrientation(
                    self._bodies[name], pose[:3].tolist(), pose[3:].tolist()
                )
            else:
                self._add(name, size, pose, colour)
        b, (width, height) = self.bullet, self.size
        x, y = self.middle
        view = b.computeViewMatrix(
            [x - 0.95 * self.span, y - 1.55 * self.span, 0.5 + 1.55 * self.span],
            [x, y, 0.45],
            [0, 0, 1],
        )
        lens = b.computeProjectionMatrixFOV(42, width / height, 0.1, 60)
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


def moments(trace: Trace) -> Iterator[tuple[str, float]]:
    """Names and times of the pictures: the start, the end of each subgoal, the end."""
    yield "start", 0.0
    for number, subgoal in enumerate(trace.subgoals, 1):
        yield f"subgoal-{number:02d}-{subgoal.rule}", subgoal.end
    yield "end", trace.duration


def write_pictures(trace: Trace, folder: Path) -> list[Path]:
    """Write the pictures of `moments` as PNG files into a folder; their paths.

    Raises:
        InputError: they cannot be written, or PyBullet is missing.
    """
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot be made: {error.strerror}", place=str(folder)) from None
    studio, paths = Studio(trace), []
    try:
        for name, time in moments(trace):
            paths.append(folder / f"{name}.png")
            write_bytes(paths[-1], png(studio.picture(time)))
    finally:
        studio.close()
    return paths


def write_film(trace: Trace, path: Path, speed: float) -> None:
    """Write an MP4 (H.264) that is `speed` times as fast as the trace.

    Raises:
        InputError: the package imageio-ffmpeg or PyBullet is missing, or nothing is written.
    """
    try:
        import imageio_ffmpeg
    except ImportError:
        raise InputError(
            "films need the package imageio-ffmpeg", hint="install sketchlang[film]"
        ) from None
    if not path.parent.is_dir():
        raise InputError(f"there is no folder {str(path.parent)!r}", place=str(path))
    # The encoder wants sides that are multiples of 16.
    studio = Studio(trace, (960, 544))
    writer = imageio_ffmpeg.write_frames(str(path), studio.size, fps=FRAMES, quality=7)
    try:
        writer.send(None)
        for time in np.arange(0.0, trace.duration + speed / FRAMES, speed / FRAMES):
            image = studio.picture(min(float(time), trace.duration))
            writer.send(np.ascontiguousarray(image))
    except OSError as error:
        raise InputError(f"cannot be written: {error}", place=str(path)) from None
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
