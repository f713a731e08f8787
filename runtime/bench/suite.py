"""A suite: which sketches, scenes, planners, robots and seeds are run with each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

from runtime.bench.job import Job, Versions
from runtime.bench.versions import versions_of
from sketchlang.errors import InputError

TIMEOUT = 120.0
"""Seconds a run, unless a suite says otherwise."""

SEEDS = 10
"""Runs of each, unless a suite says otherwise."""

MOST_RUNS = 1_000_000


@dataclass(frozen=True)
class Block:
    """All combinations of some sketches, scenes, planners, robots and seeds."""

    sketches: tuple[str, ...]
    scenes: tuple[str, ...]
    planners: tuple[str, ...]
    seeds: tuple[int, ...]
    robots: tuple[str, ...] = ("",)
    timeout: float = TIMEOUT
    k_max: int = 2
    domain: str = ""

    @property
    def runs(self) -> int:
        """How many runs it is."""
        sizes = (self.sketches, self.scenes, self.planners, self.robots, self.seeds)
        count = 1
        for each in sizes:
            count *= len(each)
        return count


@dataclass(frozen=True)
class Suite:
    """What is run, and which tables it is shown in; paths start from `folder`."""

    name: str
    blocks: tuple[Block, ...]
    folder: str = ""
    tables: str = "plain"

    def narrowed(
        self,
        planners: Sequence[str] = (),
        scenes: Sequence[str] = (),
        seeds: int | None = None,
        timeout: float | None = None,
    ) -> Suite:
        """The suite with these planners, with only these scenes, and so many runs of each, where
        they are given.

        Raises:
            InputError: the suite has no such scene.
        """
        known = [scene for block in self.blocks for scene in block.scenes]
        for scene in scenes:
            if scene not in known:
                raise InputError(f"the suite {self.name} has no scene {scene!r}")
        blocks = []
        for block in self.blocks:
            chosen = tuple(scene for scene in block.scenes if not scenes or scene in scenes)
            block = replace(block, scenes=chosen)
            if planners:
                block = replace(block, planners=tuple(dict.fromkeys(planners)))
            if seeds is not None:
                block = replace(block, seeds=tuple(range(seeds)))
            if timeout is not None:
                block = replace(block, timeout=timeout)
            blocks.append(block)
        return replace(self, blocks=tuple(block for block in blocks if block.scenes))

    def jobs(self) -> list[Job]:
        """The runs, each once, with the versions of what they read.

        Raises:
            InputError: something cannot be read, or they are too many.
        """
        if sum(block.runs for block in self.blocks) > MOST_RUNS:
            raise InputError(f"the suite {self.name} has more than {MOST_RUNS} runs")
        known: dict[tuple[str, ...], Versions] = {}
        found = []
        for block in self.blocks:
            for sketch, scene, planner, robot in product(
                block.sketches, block.scenes, block.planners, block.robots
            ):
                job = Job(
                    sketch, scene, planner, 0, block.timeout, robot, block.k_max, block.domain,
                    folder=self.folder,
                )  # fmt: skip
                names = (sketch, scene, robot, block.domain)
                if names not in known:
                    known[names] = versions_of(job)
                job = replace(job, versions=known[names])
                found += [replace(job, seed=seed) for seed in block.seeds]
        return list(dict.fromkeys(found))
