"""Runs of a sketch that differ in a few choices, worked out from a short description.

A run is described by its jobs: from where the robot stands, a manipulation. Whatever is changed
about a job, all that follows is validated anew in the states that it leads to: each subgoal by
the rules of the sketch, each action by X, the time by the motions put together. What has been
worked out for the same state and action is remembered, so that a small change costs little.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from domains.tabletop.actions.actions import Action, MoveBase, Pick, Place
from domains.tabletop.actions.executability import Executor, seeds_at
from domains.tabletop.actions.schedule import Schedule, Step
from domains.tabletop.faces import turned
from domains.tabletop.state import BasePose, Grasp, State
from runtime.motion.motion import Motion
from runtime.motion.transit import Transit
from runtime.search.guide import Guide, Subgoal
from runtime.search.problem import Rejection


@dataclass(frozen=True)
class Job:
    """A subgoal: the actions that lead to it, base moves left out where `stand` says it. With a
    `stand` there is one action, a manipulation from there; without, the actions are kept as they
    were found. `posture` counts the postures of the arm that are left out. `like` is the subgoal
    of the search that it comes from."""

    actions: tuple[Action, ...]
    stand: BasePose | None
    like: int
    posture: int = 0

    @property
    def handled(self) -> int | None:
        """The object of its one manipulation."""
        action = self.actions[0]
        return action.object if self.stand and isinstance(action, Pick | Place) else None


def jobs_of(start: State, subgoals: Sequence[Subgoal]) -> tuple[Job, ...]:
    """The jobs of a run that was found."""
    jobs, base = [], start.base
    for number, subgoal in enumerate(subgoals):
        *moves, last = subgoal.actions
        simple = isinstance(last, Pick | Place) and all(isinstance(m, MoveBase) for m in moves)
        base = subgoal.states[-1].base
        if simple:
            jobs.append(Job((last,), base, number))
        else:
            jobs.append(Job(subgoal.actions, None, number))
    return tuple(jobs)


@dataclass(frozen=True, eq=False)
class Run:
    """A run that was validated, and the seconds that it takes."""

    jobs: tuple[Job, ...]
    subgoals: tuple[Subgoal, ...]
    seconds: float

    def before(self, start: State, number: int) -> State:
        """The state in which a job begins."""
        return self.subgoals[number - 1].states[-1] if number else start


@dataclass(eq=False)
class Workshop:
    """Works out runs from one start; `found` are the subgoals of the search."""

    executor: Executor
    guide: Guide
    start: State
    found: Sequence[Subgoal]
    _motions: dict[object, Motion | None] = field(default_factory=dict)
    _transits: dict[object, tuple[object, Transit]] = field(default_factory=dict)

    def run_of(self, jobs: tuple[Job, ...], less_than: float) -> Run | None:
        """The run of some jobs; None where it is none of the sketch, an action cannot be
        executed, or it takes no less than so many seconds."""
        if len(self._motions) > REMEMBERED:
            self._motions.clear()
            self._transits.clear()
        state, subgoals = self.start, []
        for job in jobs:
            subgoal = self._subgoal(state, job)
            if subgoal is None:
                return None
            subgoals.append(subgoal)
            state = subgoal.states[-1]
        if not self.guide.is_goal(self.guide.values(state), state):
            return None
        seconds = self._seconds(subgoals, less_than)
        return None if seconds >= less_than else Run(jobs, tuple(subgoals), seconds)

    def _subgoal(self, state: State, job: Job) -> Subgoal | None:
        """One job from a state; None where it cannot be done, or satisfies no rule."""
        actions = job.actions
        if job.stand is not None and job.stand != state.base:
            actions = (MoveBase(job.stand), *actions)
        if not _is_possible(state, actions):
            return None
        states, here = [], state
        for action in actions:
            here = action.after(here)
            states.append(here)
        before, after = self.guide.values(state), self.guide.values(here)
        rule = self.guide.fired(before, after, here)
        if rule is None:
            return None
        motions: list[Motion] = []
        for action, at in zip(actions, [state, *states], strict=False):
            motion = self._motion(at, action, job)
            if motion is None:
                return None
            motions.append(motion)
        return replace(
            self.found[job.like],
            rule=rule,
            before=before,
            after=after,
            actions=actions,
            motions=tuple(motions),
            states=tuple(states),
            values=tuple(self.guide.values(s) for s in states),
        )

    def _motion(self, state: State, action: Action, job: Job) -> Motion | None:
        """The motion of an action of a job, asked for as carefully as when it was found."""
        posture, seeds = job.posture, seeds_at(self.found[job.like].attempt)
        key = state, action, posture, seeds
        if key not in self._motions:
            if posture and isinstance(action, Pick | Place):
                motion = self._another(state, action, posture)
            else:
                motion = action.motion(self.executor, state, seeds)
            self._motions[key] = None if isinstance(motion, Rejection) else motion
        return self._motions[key]

    def _another(self, state: State, action: Pick | Place, number: int) -> Motion | Rejection:
        """The motion of a manipulation with another posture of the arm."""
        executor, index = self.executor, action.object
        placement = state.placements[index] if isinstance(action, Pick) else action.placement
        taken = action.grasp if isinstance(action, Pick) else state.grasp
        grasp: Grasp | None = taken
        if isinstance(action, Place) and taken is not None:
            grasp = turned(executor.world, index, taken, action.placement.face)
        name = executor.world.items[index].name
        if placement is None or grasp is None or taken is None:
            return Rejection("in_arm_workspace", name)
        if not executor.can_leave(action.after(state)):
            return Rejection("motion_plan", name)
        target = (index, placement, grasp)
        return executor.another(state, target, taken, isinstance(action, Pick), number)

    def _seconds(self, subgoals: Sequence[Subgoal], enough: float) -> float:
        """How long subgoals take; where it is no less than enough, perhaps less than that."""
        opening = self.executor.world.robot.gripper.max_opening
        schedule = Schedule(self.executor, opening, known=self._transits)
        state = self.start
        for subgoal in subgoals:
            rows = zip(subgoal.actions, subgoal.motions, subgoal.states, strict=True)
            for action, motion, after in rows:
                schedule.add(Step(action, motion, state, after))
                state = after
            if schedule.seconds >= enough:
                return schedule.seconds
        schedule.end(state)
        return schedule.seconds


REMEMBERED = 20_000
"""Motions that are kept."""


def _is_possible(state: State, actions: Sequence[Action]) -> bool:
    """Whether what some actions take or put down is there, by the state alone."""
    held, placements = state.held, state.placements
    for action in actions:
        if isinstance(action, Pick):
            if held is not None or placements[action.object] is None:
                return False
            held = action.object
        elif isinstance(action, Place):
            if held != action.object:
                return False
            held = None
    return True
