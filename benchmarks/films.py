"""A film of a scene of each task family: `python -m benchmarks.films FOLDER`.

Plans the scenes and writes an MP4 of each. Without a graphics card that takes minutes a film;
`--speed 32` makes short ones, names of scenes only those.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from benchmarks.execution import planned
from runtime.show.pictures import write_film
from sketchlang.escape import file_part

SCENES = (
    *("sorting/4t-07", "non_monotonic/2t-11", "words/tamp", "kitchen/tidy", "desk/sort"),
    *("stack/tower", "kit/parts", "warehouse/shelves"),
)

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--speed", type=float, default=16.0)
    chosen = parser.parse_args()
    chosen.folder.mkdir(parents=True, exist_ok=True)
    for scene in chosen.scenes:
        path = chosen.folder / f"{file_part(scene.replace('/', '-'))}.mp4"
        write_film(planned(scene, seed=0), path, chosen.speed, say=print)
        print(path, flush=True)
