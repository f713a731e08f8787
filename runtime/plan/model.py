"""A plan in memory. Lengths in metres, angles in radians, times in seconds, world frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from runtime.motion.motion import Piece, Together
from runtime.world.poses import Floats


@dataclass(frozen=True, eq=False)
class TimedPiece:
    """A piece of a motion and the seconds at its way points (k,), from its own start."""

    piece: Piece | Together
    times: Floats


@dataclass(frozen=True, eq=False)
class PlanAction:
    """One action: its name in the domain, one line for people, the number of its subgoal, and
    its motion. `arguments` are plain data that only the domain reads, `values` those of the
    features after it by name, where they are known."""

    name: str
    text: str
    subgoal: int
    pieces: tuple[TimedPiece, ...]
    arguments: Mapping[str, Any] = field(default_factory=dict)
    values: Mapping[str, int] | None = None


@dataclass(frozen=True)
class PlanSubgoal:
    """One subplan: the rule, feature values by name, and the effort it took; `rejected`
    counts the candidates that died at each step of X."""

    rule: str
    before: Mapping[str, int]
    after: Mapping[str, int]
    actions: int
    expanded: int
    generated: int
    attempt: int
    width: int
    rejected: Mapping[str, int]


@dataclass(frozen=True)
class Failure:
    """Why a plan does not go on to the goal: the reason in one sentence, the feature values by
    name where it ends, and findings as plain data, each with a `text`."""

    reason: str
    stuck: Mapping[str, int] = field(default_factory=dict)
    why: tuple[Mapping[str, Any], ...] = ()


@dataclass(frozen=True, eq=False)
class Plan:
    """A plan as it is on disk: bodies, supports and joints by name, so that it reads by itself.

    A partial plan, of a run that did not reach the goal, has a `failure`. `objects` are the
    names of all movables of the world, `joints` those of the planning joints (empty in files of
    version 1, which do not say them).
    """

    sketch: str
    scene: str
    scene_digest: str
    robot: str
    robot_digest: str
    planner: str
    seed: int
    objects: tuple[str, ...]
    base_start: tuple[float, float, float]
    subgoals: tuple[PlanSubgoal, ...]
    actions: tuple[PlanAction, ...]
    joints: tuple[str, ...] = ()
    tool_version: str = ""
    failure: Failure | None = None
    path: str = field(default="", compare=False)

    @property
    def execution_time(self) -> float:
        """Seconds that the trajectories take."""
        return float(sum(t.times[-1] for action in self.actions for t in action.pieces))
