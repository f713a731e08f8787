"""`cd benchmarks/axe && npm ci`, then `python -m benchmarks.axe PLAN`: what axe-core finds on the
page of a plan, in light and dark, on a wide screen and on one of 390 pixels. Exit 1 if it finds
something."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

from domains.tabletop.scene.worlds import find_world
from runtime.show.browser import Browser
from runtime.show.page import page
from runtime.trace.load import load_trace

AXE = Path(__file__).parent / "node_modules" / "axe-core" / "axe.min.js"
VIEWS = ((1280, 720, False), (1280, 720, True), (390, 800, False))
ASK = (
    "axe.run().then((found) => found.violations.map(({ impact, id, nodes }) => "
    "({ impact, id, places: nodes.map(({ html }) => html.slice(0, 120)) })))"
)


def findings(plan: Path) -> list[dict[str, Any]]:
    """What is found, each with its `impact`, rule (`id`) and `places`."""
    script = AXE.read_text(encoding="utf-8")
    found: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "replay.html"
        path.write_text(page(load_trace(plan, find_world)), encoding="utf-8")
        for width, height, dark in VIEWS:
            with Browser(width, height) as browser:
                browser.open(path)
                browser.evaluate(f"replay.theme({str(dark).lower()}); 0")
                browser.evaluate(f"{script}; 0")
                found += browser.evaluate(ASK)
    return found


if __name__ == "__main__":
    if not AXE.exists():
        sys.exit("axe-core is not here: cd benchmarks/axe && npm ci")
    listed = findings(Path(sys.argv[1]))
    for finding in listed:
        print(f"{finding['impact']}: {finding['id']}: {'; '.join(finding['places'])}")
    print(f"{len(listed)} findings")
    sys.exit(1 if listed else 0)
