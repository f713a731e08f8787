"""`python -m tests.fuzz`: damaged files of every format, for as long as is wished.

Every case has a seed; what is found is said with it and kept in a folder. Moved to
`tests/fuzz/corpus/TARGET-NAME` it becomes a test.
"""

from __future__ import annotations

import argparse
import itertools
import sys
import time
from pathlib import Path

from tests.fuzz.run import tried
from tests.fuzz.targets import TARGETS, case


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=", ".join(TARGETS))
    parser.add_argument("--seconds", type=float, default=600.0, help="how long, in all")
    parser.add_argument("--seed", default="0", help="same seed, same cases")
    parser.add_argument("--keep", type=Path, default=Path("out/fuzz"), help="for what is found")
    options = parser.parse_args()
    unknown = set(options.targets) - TARGETS.keys()
    if unknown:
        parser.error(f"no such target: {', '.join(sorted(unknown))}")
    names, end, found, done = (
        options.targets or list(TARGETS),
        time.monotonic() + options.seconds,
        0,
        0,
    )
    for number in itertools.count():
        for name in names:
            if time.monotonic() > end:
                print(f"{done} cases, {found} findings")
                return 1 if found else 0
            done += 1
            seed = f"{options.seed}/{number}"
            finding = tried(name, case(name, seed))
            if finding is not None:
                found += 1
                options.keep.mkdir(parents=True, exist_ok=True)
                path = options.keep / f"{name}-{seed.replace('/', '-')}"
                path.write_bytes(case(name, seed))
                print(f"{name}, seed {seed}: {finding}; kept in {path}", file=sys.stderr)
    raise AssertionError("never")


sys.exit(main())
