"""The pictures of the docs: `python -m benchmarks.screenshots docs/images`.

Plans a scene of each task family, writes the replay page, and takes pictures of it in a headless
Chromium. `--moments` takes ten pictures of each scene instead, to be looked at, and a sheet of
them (`moments-NAME.jpg`).
"""

from __future__ import annotations

import argparse
import base64
import tempfile
from pathlib import Path

from benchmarks.execution import planned
from runtime.show.browser import Browser
from runtime.show.page import page
from sketchlang.files import write_bytes, write_text

SHOTS = (
    ("sorting", "sorting/4t-07", 0.30, "page"),
    ("non-monotonic", "non_monotonic/2t-11", 0.55, "page"),
    ("words", "words/tamp", 0.93, "page"),
    ("kitchen", "kitchen/tidy", 0.62, "film"),
    ("desk", "desk/sort", 0.42, "film"),
    ("stack", "stack/tower", 0.85, "film"),
    ("warehouse", "warehouse/shelves", 0.30, "film"),
)
"""Name of the picture, scene, when (as a share of the time), and whether with the panel."""

MOMENTS = 10

WIDE = 800
"""Pixels of a sheet from left to right."""


class Photographer:
    """A browser that shows one scene's replay at a time."""

    def __init__(self, browser: Browser, folder: Path) -> None:
        self.browser, self.folder = browser, folder

    def open(self, scene: str, film: bool) -> None:
        """Plan a scene and open its page."""
        path = self.folder / "replay.html"
        write_text(path, page(planned(scene, seed=0)))
        self.browser.open(path)
        script = "replay.theme(false); replay.speed(8); replay.camera('auto')"
        self.browser.evaluate(f"{script}; replay.film({str(film).lower()})")

    def at(self, share: float) -> bytes:
        """The page at a share of the time, as JPEG."""
        self.browser.evaluate(f"replay.seek({share} * replay.duration)")
        self.browser.wait("replay.fresh")
        options = {"format": "jpeg", "quality": 82}
        return base64.b64decode(self.browser.call("Page.captureScreenshot", options)["data"])

    def sheet(self, pictures: list[Path]) -> bytes:
        """Pictures side by side, two in a row, as JPEG; the page shows nothing else then."""
        images = "".join(f'<img src="{picture.resolve().as_uri()}">' for picture in pictures)
        style = "body{margin:0;display:grid;grid-template-columns:1fr 1fr;gap:4px}img{width:100%}"
        path = self.folder / "sheet.html"
        write_text(path, f"<!doctype html><style>{style}</style>{images}")
        self.browser.call("Page.navigate", {"url": path.as_uri()})
        self.browser.wait("document.images.length && [...document.images].every((i) => i.complete)")
        clip = {
            "x": 0,
            "y": 0,
            "width": WIDE,
            "height": WIDE / 3.52 * len(pictures) / 2,
            "scale": 1,
        }
        options = {"format": "jpeg", "quality": 80, "captureBeyondViewport": True, "clip": clip}
        return base64.b64decode(self.browser.call("Page.captureScreenshot", options)["data"])


def take(folder: Path) -> list[Path]:
    """Write the pictures of the docs into a folder; their paths."""
    paths = []
    with tempfile.TemporaryDirectory() as scratch, Browser(1200, 675) as browser:
        photographer = Photographer(browser, Path(scratch))
        for name, scene, share, kind in SHOTS:
            photographer.open(scene, kind == "film")
            paths.append(folder / f"replay-{name}.jpg")
            write_bytes(paths[-1], photographer.at(share))
    return paths


def take_moments(folder: Path) -> list[Path]:
    """Write ten pictures of each scene into a folder; their paths."""
    paths = []
    with tempfile.TemporaryDirectory() as scratch, Browser(800, 450) as browser:
        photographer = Photographer(browser, Path(scratch))
        for name, scene, _, _ in SHOTS:
            photographer.open(scene, True)
            taken = []
            for number in range(MOMENTS):
                taken.append(folder / f"{name}-{number}.jpg")
                write_bytes(taken[-1], photographer.at((number + 0.5) / MOMENTS))
            paths += [*taken, folder / f"moments-{name}.jpg"]
            write_bytes(paths[-1], photographer.sheet(taken))
    return paths


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--moments", action="store_true")
    chosen = parser.parse_args()
    chosen.folder.mkdir(parents=True, exist_ok=True)
    for path in (take_moments if chosen.moments else take)(chosen.folder):
        print(path)
