"""Random logistics tasks with their domain, as PDDL files.

`python -m benchmarks.logistics_tasks FOLDER` writes them.
Task i has 2 + i/4 cities of 3 places, 2 airplanes and 2 + i packages. Same numbers, same tasks.
"""

from __future__ import annotations

import random
import sys
from pathlib import Path

TASKS = 20


def task(number: int) -> str:
    """The text of a task."""
    rng = random.Random(number)
    cities = [f"city{i}" for i in range(2 + number // 4)]
    places = {city: [f"{city}-{i}" for i in range(3)] for city in cities}
    anywhere = [place for found in places.values() for place in found]
    airports = [found[0] for found in places.values()]
    packages = [f"package{i}" for i in range(2 + number)]
    facts = [f"(city {city})" for city in cities]
    for city, found in places.items():
        facts += [f"(location {p}) (in-city {p} {city})" for p in found]
        facts += [
            f"(airport {found[0]}) (truck truck-{city}) (at truck-{city} {rng.choice(found)})"
        ]
    for airplane in ("plane0", "plane1"):
        facts += [f"(airplane {airplane}) (at {airplane} {rng.choice(airports)})"]
    facts += [f"(obj {p}) (at {p} {rng.choice(anywhere)})" for p in packages]
    goals = [f"(at {p} {rng.choice(anywhere)})" for p in packages]
    names = [
        *cities,
        *anywhere,
        *(f"truck-{city}" for city in cities),
        "plane0",
        "plane1",
        *packages,
    ]
    return (
        f"(define (problem logistics-{number}) (:domain logistics)\n (:objects {' '.join(names)})\n"
        f"  (:init {' '.join(facts)})\n  (:goal (and {' '.join(goals)})))\n"
    )


def main(folder: Path) -> None:
    """Write the domain and all tasks."""
    folder.mkdir(parents=True, exist_ok=True)
    domain = Path(__file__).resolve().parent.parent / "domains" / "logistics" / "domain.pddl"
    (folder / "domain.pddl").write_text(domain.read_text())
    for number in range(TASKS):
        (folder / f"task{number:02}.pddl").write_text(task(number))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
