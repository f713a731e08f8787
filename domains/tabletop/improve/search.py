"""Anytime improvement: a change is kept where the run is a run of the sketch, and shorter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from domains.tabletop.actions.executability import Executor
from domains.tabletop.improve.changes import Changer
from domains.tabletop.improve.runs import Run, Workshop, jobs_of
from domains.tabletop.sampling.samples import Sampler
from domains.tabletop.state import State
from runtime.improve import Improvement, Told
from runtime.search.guide import Guide
from runtime.search.siw_r import Outcome
from sketchlang.compile import CompiledSketch


def improve(
    executor: Executor,
    sampler: Sampler,
    start: State,
    sketch: CompiledSketch,
    outcome: Outcome,
    improvement: Improvement,
    told: Told,
) -> Outcome:
    """The outcome of a search with a run that takes less time, as far as one was found."""
    workshop = Workshop(executor, Guide(sketch), start, outcome.subgoals)
    improvement.restart()
    best: Run | None = None
    try:
        best = workshop.run_of(jobs_of(start, outcome.subgoals), np.inf)
        if best is None:  # as it was found it satisfies other rules than one by one
            return outcome
        changer = Changer(sampler, start, np.random.default_rng([executor.seed, 1]))
        while improvement.goes_on():
            improvement.tried += 1
            jobs = changer.draw(best)
            run = None if jobs is None else workshop.run_of(jobs, best.seconds - LEAST)
            if run is not None:
                best = run
                told(improvement.tried, best.seconds)
    except KeyboardInterrupt:
        pass  # what was found until then is as good as it is
    if best is None:
        return outcome
    return replace(outcome, subgoals=list(best.subgoals), state=best.subgoals[-1].states[-1])


LEAST = 0.02
"""Seconds by which a run has to be shorter."""
