"""Changes of a run that may make it shorter: where the robot stands, what it takes first, where it
puts things, how it grips them, and with which posture of the arm.

Each is chosen by what driving would take by a simple estimate, with some chance; whether it can
be done at all, and what it really takes, is for `runs.py` to find out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from domains.tabletop.actions.actions import Pick, Place
from domains.tabletop.improve.runs import Job, Run
from domains.tabletop.sampling.draw import Draw
from domains.tabletop.sampling.samples import Sampler
from domains.tabletop.state import BasePose, Grasp, Placement, State
from runtime.angles import wrap
from runtime.robot.model import MobileBase

STANDS = 24
"""Base poses that are drawn to choose one."""

POSTURES = 4
"""Postures of the arm at a grasp that are tried."""

NEAREST = 12
"""Jobs away to which a pair of jobs is moved at most, where that is not drawn from all."""

Jobs = tuple[Job, ...]


@dataclass(frozen=True, eq=False)
class Changer:
    """Draws changes of runs from one start."""

    sampler: Sampler
    start: State
    rng: np.random.Generator

    def draw(self, run: Run) -> Jobs | None:
        """Other jobs than those of a run; None where what was drawn cannot be changed."""
        kinds = (self._stand, self._order, self._place, self._posture, self._grasp)
        kind = kinds[int(self.rng.choice(len(kinds), p=SHARES))]
        return kind(run)

    # -- one job ---------------------------------------------------------------------------

    def _one(self, run: Run) -> int | None:
        """A job that can be changed."""
        able = [i for i, job in enumerate(run.jobs) if job.stand is not None]
        return able[int(self.rng.integers(len(able)))] if able else None

    def _stand(self, run: Run) -> Jobs | None:
        """Another base pose for a job: of some, one between those before and after it."""
        number = self._one(run)
        if number is None or self.sampler.executor.world.is_fixed:
            return None
        job, state = run.jobs[number], run.before(self.start, number)
        last, following = self._neighbours(run, number)
        stands = [stand for stand in (last, following) if stand is not None]
        stands += self._drawn(state, job)
        reachable = [stand for stand in stands if self._reaches(state, job, stand)]
        reachable = [stand for stand in dict.fromkeys(reachable) if stand != job.stand]
        if not reachable:
            return None
        base = self.sampler.executor.world.robot.base
        costs = np.array([detour(base, last, stand, following) for stand in reachable])
        chosen = int(np.argmin(costs + self.rng.exponential(0.4, len(costs))))
        return _with(run.jobs, number, replace(job, stand=reachable[chosen], posture=0))

    def _drawn(self, state: State, job: Job) -> list[BasePose]:
        """Random base poses for a manipulation."""
        action = job.actions[0]
        if isinstance(action, Pick):
            index, placement, grasp = action.object, state.placements[action.object], action.grasp
        else:
            assert isinstance(action, Place)
            assert state.grasp is not None
            index, placement, grasp = action.object, action.placement, state.grasp
        if placement is None:
            return []
        bases = self.sampler.bases
        found = (bases.pose_for(state, index, placement, grasp, self.rng) for _ in range(STANDS))
        return [stand for stand in found if stand is not None]

    def _reaches(self, state: State, job: Job, stand: BasePose) -> bool:
        """Whether a manipulation is within the arm's workspace from a stand."""
        action = job.actions[0]
        assert isinstance(action, Pick | Place)
        placement: Placement | None
        grasp: Grasp | None
        if isinstance(action, Pick):
            placement, grasp = state.placements[action.object], action.grasp
        else:
            placement, grasp = action.placement, state.grasp
        if placement is None or grasp is None:
            return False
        target = (action.object, placement, grasp)
        return bool(self.sampler.executor.in_arm_workspace(state, stand, [target]))

    def _posture(self, run: Run) -> Jobs | None:
        """Another posture of the arm at a grasp."""
        number = self._one(run)
        if number is None:
            return None
        job = run.jobs[number]
        others = [p for p in range(POSTURES) if p != job.posture]
        return _with(run.jobs, number, replace(job, posture=int(self.rng.choice(others))))

    def _grasp(self, run: Run) -> Jobs | None:
        """Another grasp of an object that is picked up."""
        number = self._one(run)
        if number is None:
            return None
        job, state = run.jobs[number], run.before(self.start, number)
        action = job.actions[0]
        if not isinstance(action, Pick):
            return None
        grasps = self.sampler.grasps.of(Draw(state, 1, self.rng), action.object)
        if not grasps:
            return None
        grasp = grasps[int(self.rng.integers(len(grasps)))]
        return _with(run.jobs, number, replace(job, actions=(Pick(action.object, grasp),)))

    def _place(self, run: Run) -> Jobs | None:
        """Another place for an object that is put down, and a base pose for it."""
        number = self._one(run)
        if number is None:
            return None
        job, state = run.jobs[number], run.before(self.start, number)
        action = job.actions[0]
        if not isinstance(action, Place) or state.held != action.object:
            return None
        draw = Draw(state, 0, self.rng)
        places = self.sampler.placements.of_held(draw)
        if not places:
            return None
        place = places[int(self.rng.integers(len(places)))]
        changed = replace(job, actions=(Place(action.object, place),), posture=0)
        if self.sampler.executor.world.is_fixed:
            return _with(run.jobs, number, changed)
        last, following = self._neighbours(run, number)
        stands = [s for s in (last, job.stand, following) if s is not None]
        stands = [s for s in [*stands, *self._drawn(state, changed)] if
                  self._reaches(state, changed, s)]  # fmt: skip
        if not stands:
            return None
        base = self.sampler.executor.world.robot.base
        best = min(stands, key=lambda stand: detour(base, last, stand, following))
        return _with(run.jobs, number, replace(changed, stand=best))

    def _neighbours(self, run: Run, number: int) -> tuple[BasePose, BasePose | None]:
        """Where the robot stands before a job, and at the next one."""
        last = run.before(self.start, number).base
        following = run.jobs[number + 1].stand if number + 1 < len(run.jobs) else None
        return last, following

    # -- the order -------------------------------------------------------------------------

    def _order(self, run: Run) -> Jobs | None:
        """An object handled earlier or later: its pick and its place go together."""
        pairs = [i for i in range(len(run.jobs) - 1) if self._is_pair(run.jobs, i)]
        if len(pairs) < 2:
            return None
        number = pairs[int(self.rng.integers(len(pairs)))]
        pair = run.jobs[number : number + 2]
        rest = run.jobs[:number] + run.jobs[number + 2 :]
        spots = [i for i in range(len(rest) + 1) if i != number and not _splits(rest, i)]
        if not spots:
            return None
        costs = np.array([self._cost(rest[:i] + pair + rest[i:]) for i in spots])
        chosen = spots[int(np.argmin(costs + self.rng.exponential(1.5, len(costs))))]
        return rest[:chosen] + pair + rest[chosen:]

    def _is_pair(self, jobs: Jobs, number: int) -> bool:
        one, other = jobs[number], jobs[number + 1]
        return (
            one.handled is not None
            and one.handled == other.handled
            and isinstance(one.actions[0], Pick)
            and isinstance(other.actions[0], Place)
        )

    def _cost(self, jobs: Jobs) -> float:
        """About the seconds that driving from stand to stand takes."""
        base = self.sampler.executor.world.robot.base
        total, last = 0.0, self.start.base
        for job in jobs:
            if job.stand is not None:
                total += about(base, last, job.stand)
                last = job.stand
        return total


SHARES = (0.45, 0.25, 0.1, 0.1, 0.1)
"""How often stands, order, places, postures and grasps are changed."""


def _splits(jobs: Jobs, number: int) -> bool:
    """Whether something is held between the jobs before and from a number on."""
    return number > 0 and isinstance(jobs[number - 1].actions[-1], Pick)


def _with(jobs: Jobs, number: int, job: Job) -> Jobs:
    return (*jobs[:number], job, *jobs[number + 1 :])


def about(base: MobileBase, a: BasePose, b: BasePose) -> float:
    """About the seconds of a drive: at full speed, with half of the turns on the way."""
    if a == b or not base.velocity:
        return 0.0
    (ax, ay, ayaw), (bx, by, byaw) = a.pose, b.pose
    away = math.hypot(bx - ax, by - ay)
    bearing = math.atan2(by - ay, bx - ax)
    turn = min(
        abs(wrap(bearing + way - ayaw)) + abs(wrap(byaw - bearing - way)) for way in (0.0, math.pi)
    )
    ramp = base.velocity / base.acceleration
    return away / base.velocity + 0.5 * turn / base.angular_velocity + ramp


def detour(base: MobileBase, last: BasePose, stand: BasePose, following: BasePose | None) -> float:
    """About the seconds of driving to a stand and on."""
    onwards = 0.0 if following is None else about(base, stand, following)
    return about(base, last, stand) + onwards
