"""What each suite runs."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

from runtime.bench.paper import SCENES
from runtime.bench.store import Job
from runtime.search.planners import PLANNERS
from sketchlang.errors import InputError
from sketchlang.files import write_text
from sketchlang.reading import read_text

SIZES = (10, 28, 56, 112, 200)


def jobs_of(
    suite: str,
    seeds: int | None,
    planners: Sequence[str],
    scenes: Sequence[str],
    timeout: float,
    out: Path,
    sorting: Callable[[int, int], str],
) -> list[Job]:
    """The jobs of a suite, narrowed to some planners or scenes where these are given;
    `sorting` gives the text of a scene with so many objects, by a seed.

    Raises:
        InputError: there is no such planner or scene in the suite.
    """
    for planner in planners:
        if planner not in PLANNERS:
            known = ", ".join(PLANNERS)
            raise InputError(f"there is no planner {planner!r}", hint=f"planners: {known}")
    if suite == "scaling":
        chosen = list(planners or ["lazy-siiw-r"])
        known_scenes = _scaling_scenes(out.parent, sorting)
        count = seeds or 3
    else:
        chosen = list(planners or PLANNERS)
        known_scenes = list(SCENES)
        count = seeds or 10
    for scene in scenes:
        if scene not in known_scenes:
            raise InputError(f"the suite {suite} has no scene {scene!r}")
    return [
        Job("pick_and_place", scene, planner, seed, timeout)
        for scene in dict.fromkeys(scenes or known_scenes)
        for planner in dict.fromkeys(chosen)
        for seed in range(count)
    ]


def _scaling_scenes(folder: Path, sorting: Callable[[int, int], str]) -> list[str]:
    """Write the generated scenes beside the results, so that they can be looked at."""
    paths = []
    for size in SIZES:
        path = folder / f"sorting-{size}.toml"
        text = sorting(size, size)
        if not os.path.lexists(path):
            write_text(path, text)
        elif read_text(path) != text:
            raise InputError("is here already and not the scene of this suite", place=str(path))
        paths.append(str(path))
    return paths
