"""Pictures and films of a trace."""

from __future__ import annotations

import math
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

from runtime.show.camera import camera_of
from runtime.show.encoder import FILM, MOVING, Encoder
from runtime.show.moments import moments
from runtime.trace.model import Trace
from sketchlang.errors import InputError
from sketchlang.files import check_output, replacing, write_bytes

Progress = Callable[[int, int], None]
"""How many pictures are done, and how many there will be."""

Say = Callable[[str], None]


def write_pictures(
    trace: Trace,
    folder: Path,
    progress: Progress = lambda done, total: None,
    say: Say = lambda text: None,
) -> list[Path]:
    """Write the pictures of `moments` as PNG files into a folder; their paths. What they lack
    is said.

    Raises:
        InputError: they cannot be written, or there is nothing that draws them.
    """
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot be made: {error.strerror}", place=str(folder)) from None
    times = {folder / f"{name}.png": time for name, time in moments(trace)}
    for path in times:
        check_output(path)
    with camera_of(trace) as camera:
        if camera.lacks is not None:
            say(camera.lacks)
        for number, (path, time) in enumerate(times.items(), 1):
            write_bytes(path, camera.shot(time))
            progress(number, len(times))
    return list(times)


def check_film(path: Path, suffix: str = ".mp4") -> None:
    """Find out before the work whether a film can be written under a name.

    Raises:
        InputError: the package imageio-ffmpeg is missing, or the name is not that of a film.
    """
    if find_spec("imageio_ffmpeg") is None:
        raise InputError("films need the package imageio-ffmpeg", hint="install sketchlang[film]")
    if path.suffix.lower() != suffix:
        raise InputError(f"a film of this kind has a name that ends in {suffix}", place=str(path))


def write_film(
    trace: Trace,
    path: Path,
    speed: float,
    start: float = 0.0,
    end: float = math.inf,
    progress: Progress = lambda done, total: None,
    say: Say = lambda text: None,
) -> None:
    """Write an MP4 (H.264) or, by the name's suffix, a GIF, from `start` to `end` of the trace,
    `speed` times as fast as it; as a whole or not at all.

    Raises:
        InputError: the package imageio-ffmpeg or what draws is missing, or nothing is written.
    """
    kind = MOVING if path.suffix.lower() == ".gif" else FILM
    check_film(path, kind.suffix)
    start, end = min(start, trace.duration), min(end, trace.duration)
    total = math.ceil((end - start) * kind.frames / speed) + 1
    with replacing(path) as temporary, camera_of(trace, kind.size, speed) as camera:
        if camera.lacks is not None:
            say(camera.lacks)
        with Encoder(temporary, kind) as encoder:
            for frame in range(total):
                encoder.add(camera.shot(min(end, start + frame * speed / kind.frames)))
                progress(frame + 1, total)
