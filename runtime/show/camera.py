"""Who takes pictures: the replay page in a headless Chromium, or else the software renderer.

Both are asked for the picture of a time, and give it as the bytes of a PNG.
"""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol

from runtime.show.browser import Browser, find_browser
from runtime.show.page import page
from runtime.trace.model import Trace
from sketchlang.errors import InputError

WIDE = (1920, 1080)
"""Width and height of pictures and films of the page."""


class Camera(Protocol):
    """Takes pictures of one trace. `lacks` says what they are without, if anything."""

    lacks: str | None

    def shot(self, time: float) -> bytes:
        """The picture of a time, as PNG."""
        ...


class PageCamera:
    """The replay page, only the scene and what is written over it."""

    lacks: str | None = None

    def __init__(self, browser: Browser, speed: float, view: str = "auto") -> None:
        self.browser = browser
        browser.evaluate(f"replay.film(); replay.theme(false); replay.speed({speed})")
        browser.evaluate(f"replay.camera({view!r})")

    def shot(self, time: float) -> bytes:
        """The picture of a time, as PNG."""
        self.browser.evaluate(f"replay.seek({time:.6f})")
        self.browser.wait("replay.fresh")
        options = {"format": "png", "optimizeForSpeed": True}
        return base64.b64decode(self.browser.call("Page.captureScreenshot", options)["data"])


@contextmanager
def camera_of(
    trace: Trace, size: tuple[int, int] = WIDE, speed: float = 1.0, view: str = "auto"
) -> Iterator[Camera]:
    """The best camera that there is. `speed` is that of the film, after which the view moves;
    `view` a preset of the page.

    Raises:
        InputError: there is neither a Chromium nor PyBullet.
    """
    if find_browser() is None:
        yield from _software(trace)
        return
    with tempfile.TemporaryDirectory() as folder, Browser(*size) as browser:
        path = Path(folder) / "replay.html"
        path.write_text(page(trace), encoding="utf-8")
        browser.open(path)
        yield PageCamera(browser, speed, view)


def _software(trace: Trace) -> Iterator[Camera]:
    try:
        from runtime.show.software import Studio

        studio = Studio(trace)
    except InputError as error:
        raise InputError(
            "pictures need a Chromium, or PyBullet", hint="install the package `chromium`"
        ) from error
    try:
        yield studio
    finally:
        studio.close()
