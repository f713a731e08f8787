"""Ground actions (paper, Action Schemas Act): what they do, how they are told and written.

An action is whatever offers the methods of `Action`; the search, plan files and the executor
know no more of it, so that a domain can be extended with actions of its own.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from domains.tabletop.faces import turned
from domains.tabletop.state import BasePose, Grasp, Placement, State
from runtime.search.problem import Rejection

if TYPE_CHECKING:
    from domains.tabletop.actions.executability import Executor
    from domains.tabletop.world import TabletopWorld
    from runtime.motion.motion import Motion


class Action(Protocol):
    """A ground action. Actions are compared and hashed by their parameters."""

    @property
    def name(self) -> str:
        """The name of its schema, as plan files have it."""
        ...

    def after(self, state: State) -> State:
        """The state that it leads to (N of the paper, for an executable action)."""
        ...

    def motion(self, executor: Executor, state: State, seeds: int) -> Motion | Rejection:
        """X: the motion that carries it out, or why there is none. `seeds` is how hard inverse
        kinematics may try."""
        ...

    def text(self, world: TabletopWorld) -> str:
        """The action in a few words."""
        ...

    def arguments(self, world: TabletopWorld) -> dict[str, Any]:
        """Its parameters as plain data."""
        ...


class ActionSchema(Protocol):
    """Actions that a domain adds: `Domain.action` declares a class that offers this."""

    def sample(self, state: State, attempt: int, rng: np.random.Generator) -> Iterable[Action]:
        """Ground actions for the subproblem that starts in a state; more of them with each
        attempt. They are offered in all states of the subproblem in which they are applicable."""
        ...

    def applicable(self, state: State, action: Any) -> bool:
        """Whether one of its ground actions can be tried in a state."""
        ...


class MoveBase(NamedTuple):
    """Move-Base(b, b')."""

    target: BasePose

    @property
    def name(self) -> str:
        return "move_base"

    def after(self, state: State) -> State:
        return state.driven(self.target)

    def motion(self, executor: Executor, state: State, seeds: int) -> Motion | Rejection:
        return executor.drive(state, self.target)

    def text(self, world: TabletopWorld) -> str:
        x, y, _ = self.target.pose
        return f"drive to ({x:.2f}, {y:.2f})"

    def arguments(self, world: TabletopWorld) -> dict[str, Any]:
        return {"base": list(self.target)}


class Pick(NamedTuple):
    """Pick(b, o, g) from where the robot stands."""

    object: int
    grasp: Grasp

    @property
    def name(self) -> str:
        return "pick"

    def after(self, state: State) -> State:
        return state.picked(self.object, self.grasp)

    def motion(self, executor: Executor, state: State, seeds: int) -> Motion | Rejection:
        placement = state.placements[self.object]
        assert placement is not None, "only standing objects are picked"
        return executor.manipulate(state, self.object, placement, self.grasp, True, seeds)

    def text(self, world: TabletopWorld) -> str:
        return f"pick {world.items[self.object].name}"

    def arguments(self, world: TabletopWorld) -> dict[str, Any]:
        return {"object": world.items[self.object].name, "grasp": list(self.grasp)}


class Place(NamedTuple):
    """Place(b, o, p, sigma) from where the robot stands; the placement's heading is sigma."""

    object: int
    placement: Placement

    @property
    def name(self) -> str:
        return "place"

    def after(self, state: State) -> State:
        return state.placed(self.object, self.placement)

    def motion(self, executor: Executor, state: State, seeds: int) -> Motion | Rejection:
        assert state.grasp is not None, "only held objects are placed"
        grasp = turned(executor.world, self.object, state.grasp, self.placement.face)
        if grasp is None:
            return Rejection("in_arm_workspace", executor.world.items[self.object].name)
        return executor.manipulate(state, self.object, self.placement, grasp, False, seeds)

    def text(self, world: TabletopWorld) -> str:
        x, y, _ = self.placement.pose
        ground = world.grounds[self.placement.support]
        where = "" if ground.owner is not None else f" at ({x:.2f}, {y:.2f})"
        where += ", on another side" if self.placement.face else ""
        return f"place {world.items[self.object].name} on {ground.name}{where}"

    def arguments(self, world: TabletopWorld) -> dict[str, Any]:
        placement = self.placement
        return {
            "object": world.items[self.object].name,
            "support": world.grounds[placement.support].name,
            "placement": [placement.x, placement.y, placement.yaw],
            "face": placement.face,
        }
