"""What replay pages cost: `python -m benchmarks.pages`.

Plans scenes, writes their pages and opens each in a headless Chromium: size, seconds to load until
the first frame is drawn, draw calls and triangles of a frame, the robot's share of the height.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from benchmarks.execution import planned
from runtime.show.browser import Browser
from runtime.show.page import page
from sketchlang.files import write_text

SCENES = ("sorting/4t-07", "sorting/4t-28", "words/tamp", "kitchen/tidy", "warehouse/shelves")
SHARES = (0.05, 0.35, 0.65, 0.95)


def measure(scene: str, path: Path) -> str:
    """A row of the table."""
    trace = planned(scene, seed=0)
    write_text(path, page(trace))
    with Browser(1280, 720) as browser:
        start = time.monotonic()
        browser.open(path)
        loaded = time.monotonic() - start
        calls, triangles, height = [], [], []
        for share in SHARES:
            browser.evaluate(f"replay.seek({share} * replay.duration); replay.draw()")
            drawn = browser.evaluate("replay.calls[0]")
            calls.append(drawn["calls"])
            triangles.append(drawn["triangles"])
            height.append(browser.evaluate("replay.robotHeight"))
    size = path.stat().st_size / 1e6
    return (
        f"| {scene} | {len(trace.world.movables)} | {size:.1f} MB | {loaded:.1f} s | {max(calls)} "
        f"| {max(triangles):,} | {min(height):.0%} |"
    )


if __name__ == "__main__":
    print("| scene | objects | file | loads in | draw calls | triangles | robot's height, least |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name in sys.argv[1:] or SCENES:
            print(measure(name, Path(folder) / "replay.html"), flush=True)
