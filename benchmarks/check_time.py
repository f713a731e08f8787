"""How long `sketchlang check` takes, start-up included: `python -m benchmarks.check_time`.

Process time (user and system) of whole runs on a generated sketch of 100 rules over 30 features
with definitions; the best and the median of 15 runs.
"""

from __future__ import annotations

import os
import random
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RUN = "from sketchlang.cli import main; main()"


def sketch(rules: int, features: int, seed: int = 0) -> str:
    """A sketch without findings: every rule has its own first condition and lowers a number."""
    rng = random.Random(seed)
    lines = ["sketch generated", "use delivery", ""]
    names = []
    for i in range(features):
        if i % 3 == 0:
            names.append((f"p{i}", True))
            lines.append(f"feature p{i} : bool = some x in packages: distance(x) = {i} and held(x)")
        else:
            names.append((f"n{i}", False))
            lines.append(
                f"feature n{i} : nat = count x in packages where not delivered(x): "
                f"distance(x) + target_distance > {i}"
            )
    lines += ["", f"goal {{ {names[1][0]} = 0 }}", ""]
    for i in range(rules):
        chosen = rng.sample(names, 8)
        conditions = [f"{n} > 0" if not b else rng.choice([n, f"!{n}"]) for n, b in chosen[:5]]
        effects = [f"{n}?" for n, _ in chosen[2:]]
        down = next(n for n, b in names[1:] if not b and n not in {c[0] for c in chosen})
        conditions.append(f"{down} > 0")
        lines.append(
            f"rule r{i} {{ {', '.join(conditions)} }} -> {{ {', '.join([*effects, down + '--'])} }}"
        )
    return "\n".join(lines) + "\n"


def seconds(path: Path, cache: Path) -> float:
    """Process time of one run. Byte code is kept in `cache`, as an installation keeps it."""
    env = {name: v for name, v in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [sys.executable, "-c", RUN, "check", str(path)],
        cwd=ROOT,
        env={**env, "PYTHONPYCACHEPREFIX": str(cache)},
        check=True,
        capture_output=True,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "generated.sketch"
        path.write_text(sketch(100, 30), encoding="utf-8")
        times = [seconds(path, Path(directory) / "cache") for _ in range(16)][1:]
    print(
        f"check, 100 rules, 30 features: best {min(times):.3f} s, "
        f"median {statistics.median(times):.3f} s of process time"
    )


if __name__ == "__main__":
    main()
