"""The figures that the paper reports (its Table 1), to stand beside ours.

Averages over ten runs on an Intel i7-10610U. Those of BFWS are from Ferrer-Mestres et al. (2017),
with preprocessing, and those of Planet from Thomason (2022), as the paper has them. These two, and
PDDLStream, are no dependency of this project and are not run by it.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Published:
    """Solved runs in per cent; minutes, nodes and subplans where they were reported."""

    scene: str
    system: str
    solved: int
    planning_min: float | None = None
    execution_min: float | None = None
    expanded: int | None = None
    subplans: int | None = None


SYSTEMS = {"Lazy-SIIW_R": "lazy-siiw-r", "SIW_R": "siw-r", "BFWS": "bfws"}
"""Those that have a planner of ours beside them."""

STREAMS = tuple(f"PDDLStream {name}" for name in ("adaptive", "binding", "focused", "incremental"))


def _none(scene: str, *systems: str) -> tuple[Published, ...]:
    """Systems that solved no run in 30 minutes."""
    return tuple(Published(scene, system, 0) for system in systems)


def _words(scene: str) -> tuple[Published, ...]:
    """The paper reports both words together."""
    return (
        Published(scene, "Lazy-SIIW_R", 100, 2.26, 3.49, 243, 13),
        Published(scene, "SIW_R", 100, 8.07, 3.58, 216, 13),
    )


PUBLISHED = (
    Published("sorting/3t-02", "Lazy-SIIW_R", 100, 0.26, 1.21, 28, 4),
    Published("sorting/3t-02", "PDDLStream adaptive", 100, 0.03, 1.24, None, 1),
    Published("sorting/3t-02", "PDDLStream binding", 100, 0.21, 1.20, None, 1),
    Published("sorting/3t-02", "PDDLStream incremental", 100, 12.01, 1.22, None, 1),
    *_none("sorting/3t-02", "PDDLStream focused"),
    Published("sorting/4t-07", "Lazy-SIIW_R", 100, 2.35, 4.45, 185, 14),
    Published("sorting/4t-07", "Planet", 100, 3.22, None, None, 1),
    Published("sorting/4t-07", "PDDLStream adaptive", 100, 7.47, 5.72, None, 1),
    *_none("sorting/4t-07", *STREAMS[1:]),
    Published("sorting/1t-20", "Lazy-SIIW_R", 100, 3.16, 3.67, 60, 14),
    Published("sorting/1t-20", "SIW_R", 100, 13.05, 3.73, 54, 14),
    Published("sorting/1t-20", "BFWS", 100, 5.25, 5.91, 63300, 1),
    Published("sorting/3t-25", "Lazy-SIIW_R", 100, 3.36, 3.95, 235, 10),
    Published("sorting/3t-25", "SIW_R", 100, 21.6, 4.02, 198, 10),
    Published("sorting/3t-25", "BFWS", 100, 13.47, 7.61, 3500, 1),
    *_none("sorting/3t-25", *STREAMS),
    Published("sorting/4t-28", "Lazy-SIIW_R", 100, 6.52, 9.24, 630, 34),
    *_none("sorting/4t-28", "Planet", *STREAMS),
    Published("non_monotonic/2t-11", "Lazy-SIIW_R", 100, 3.53, 8.10, 565, 30),
    Published("non_monotonic/2t-11", "SIW_R", 100, 17.69, 7.96, 534, 30),
    *_words("words/tamp"),
    *_words("words/robot"),
)

SCENES = tuple(dict.fromkeys(row.scene for row in PUBLISHED))
"""The eight scenes of the paper."""
