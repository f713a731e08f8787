"""Pictures to a film, by the ffmpeg that the package imageio-ffmpeg brings."""

from __future__ import annotations

import subprocess
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType


@dataclass(frozen=True)
class Kind:
    """A kind of film: frames a second, size of the pictures, and what ffmpeg is told."""

    suffix: str
    frames: float
    size: tuple[int, int]
    options: tuple[str, ...]


FILM = Kind(
    ".mp4",
    30.0,
    (1920, 1080),
    (
        *("-c:v", "libx264", "-preset", "medium", "-crf", "21", "-pix_fmt", "yuv420p"),
        *("-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-movflags", "+faststart", "-f", "mp4"),
    ),
)

PALETTE = (
    "scale=560:-2:flags=lanczos,split[a][b];[a]palettegen=max_colors=80:stats_mode=diff[p];"
    "[b][p]paletteuse=dither=none:diff_mode=rectangle"
)
MOVING = Kind(".gif", 8.0, (960, 540), ("-filter_complex", PALETTE, "-loop", "0", "-f", "gif"))
"""For READMEs: small, eight frames a second."""


class Encoder:
    """An ffmpeg that is given one picture after the other.

    Raises:
        OSError: it fails; what it says is for those who know its command line, and not shown.
    """

    def __init__(self, path: Path, kind: Kind) -> None:
        import imageio_ffmpeg

        self.path = path
        command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-v", "quiet", "-f", "image2pipe"]
        command += ["-framerate", str(kind.frames), "-i", "-", *kind.options, str(path)]
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )

    def add(self, picture: bytes) -> None:
        """The next picture, as PNG."""
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(picture)
        except OSError:
            raise OSError("the encoder failed") from None

    def __enter__(self) -> Encoder:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        assert self._process.stdin is not None
        if kind is not None:
            self._process.kill()
        with suppress(OSError):
            self._process.stdin.close()
        failed = self._process.wait() != 0
        if kind is None and (failed or not self.path.stat().st_size):
            raise OSError("the encoder failed")
