"""The pictures of the docs: `python -m benchmarks.screenshots docs/images`.

Plans a scene of each task family, writes the replay page, and takes a picture of it in a
headless Chromium.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from benchmarks.execution import planned
from runtime.show.browser import Browser
from runtime.show.page import page
from sketchlang.files import write_bytes, write_text

SHOTS = (
    ("sorting", "sorting/4t-07", 0.30),
    ("non-monotonic", "non_monotonic/2t-11", 0.55),
    ("words", "words/tamp", 0.93),
)
"""Name of the picture, scene, and when: as a share of the time."""


def take(folder: Path) -> list[Path]:
    """Write the pictures into a folder; their paths."""
    paths = []
    with tempfile.TemporaryDirectory() as scratch, Browser(1200, 675) as browser:
        for name, scene, share in SHOTS:
            trace = planned(scene, seed=0)
            file = Path(scratch) / f"{name}.html"
            write_text(file, page(trace))
            browser.open(file)
            browser.evaluate(f"replay.seek({share * trace.duration})")
            browser.wait("replay.fresh")
            paths.append(folder / f"replay-{name}.png")
            write_bytes(paths[-1], browser.screenshot())
    return paths


if __name__ == "__main__":
    for path in take(Path(sys.argv[1])):
        print(path)
