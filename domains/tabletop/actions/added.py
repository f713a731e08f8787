"""Actions that a domain has been extended by, watched.

What goes wrong in the code of others, or comes out of it that cannot be used, ends the run with
the file and line of what is to be mended.
"""

from __future__ import annotations

import inspect
import json
import traceback
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from domains.tabletop.actions.actions import Action, MoveBase, Pick, Place
from domains.tabletop.state import State
from runtime.motion.motion import ArmMove, BaseMove, GripperMove, Motion
from runtime.search.problem import Rejection
from sketchlang.compile import EvaluationError
from sketchlang.domain import position_of
from sketchlang.errors import InputError

if TYPE_CHECKING:
    from domains.tabletop.actions.executability import Executor
    from domains.tabletop.world import TabletopWorld

OURS = (MoveBase, Pick, Place)

SCHEMA = ("sample", "applicable")
ACTION = ("name", "after", "motion", "text", "arguments")


@dataclass(frozen=True, eq=False)
class Added:
    """A schema that a domain adds."""

    schema: Any

    @classmethod
    def of(cls, kind: Any) -> Added:
        """A schema of a class that `Domain.action` was given.

        Raises:
            InputError: it cannot be made, or lacks a method.
        """
        name = getattr(kind, "__name__", str(kind))
        schema = _called(kind, f"making the action schema {name}", kind)
        for method in SCHEMA:
            if not callable(getattr(schema, method, None)):
                _refuse(kind, f"the action schema {name} has no method {method}")
        return cls(schema)

    def sample(self, state: State, attempt: int, rng: np.random.Generator) -> Iterator[Action]:
        """The schema's ground actions, each of them watched."""
        method = self.schema.sample
        found = _called(method, f"{self._name}.sample", lambda: list(method(state, attempt, rng)))
        for action in found:
            if isinstance(action, OURS):
                yield action
                continue
            for member in ACTION:
                if not hasattr(action, member):
                    _refuse(method, f"{self._name}.sample yields {action!r}, without {member}")
            try:
                hash(action)
            except TypeError:
                _refuse(method, f"{self._name}.sample yields {action!r}, which has no hash")
            if not isinstance(action.name, str):
                _refuse(type(action), f"the name of {action!r} is no text")
            yield AddedAction(action)

    def applicable(self, state: State, action: Any) -> bool:
        """Whether an action can be tried in a state."""
        method = self.schema.applicable
        own = action.action if isinstance(action, AddedAction) else action
        found = _called(method, f"{self._name}.applicable", lambda: method(state, own))
        if not isinstance(found, bool | np.bool_):
            _refuse(method, f"{self._name}.applicable returns {found!r}, expected True or False")
        return bool(found)

    @property
    def _name(self) -> str:
        return type(self.schema).__name__


@dataclass(frozen=True)
class AddedAction:
    """A ground action of such a schema."""

    action: Any

    @property
    def name(self) -> str:
        """The name of its schema, as plan files have it."""
        name: str = self.action.name
        return name

    def after(self, state: State) -> State:
        """The state that it leads to."""
        method = self.action.after
        found = self._ask("after", lambda: method(state))
        if not isinstance(found, State) or found.world is not state.world:
            self._refuse("after", found, "a state made from the given one")
        held = [i for i, p in enumerate(found.placements) if p is None]
        wanted = [] if found.held is None else [found.held]
        if len(found.placements) != len(state.placements) or held != wanted:
            self._refuse("after", found, "a placement for every object but the held one")
        return found

    def motion(self, executor: Executor, state: State, seeds: int) -> Motion | Rejection:
        """The motion that carries it out, or why there is none."""
        method = self.action.motion
        found = self._ask("motion", lambda: method(executor, state, seeds))
        if isinstance(found, Rejection):
            return found
        joints = len(executor.world.robot.joints)
        if not isinstance(found, tuple) or not found:
            self._refuse("motion", found, "a tuple of pieces, or a Rejection")
        for piece in found:
            if not _is_piece(piece, joints):
                self._refuse(
                    "motion", piece, f"finite poses (k, 3) or configurations (k, {joints}), k > 1"
                )
        return found

    def text(self, world: TabletopWorld) -> str:
        """The action in a few words."""
        method = self.action.text
        found = self._ask("text", lambda: method(world))
        if not isinstance(found, str):
            self._refuse("text", found, "a text")
        return found

    def arguments(self, world: TabletopWorld) -> dict[str, Any]:
        """Its parameters as plain data."""
        method = self.action.arguments
        found = self._ask("arguments", lambda: method(world))
        try:
            json.dumps(found, allow_nan=False)
        except (TypeError, ValueError):
            self._refuse("arguments", found, "plain data that JSON can hold")
        if not isinstance(found, dict):
            self._refuse("arguments", found, "a dictionary")
        return found

    def _ask(self, method: str, ask: Callable[[], Any]) -> Any:
        return _called(getattr(self.action, method), f"{self.name}.{method}", ask)

    def _refuse(self, method: str, found: object, wanted: str) -> NoReturn:
        shown = f"{type(found).__name__} {found!r}"[:200]
        _refuse(
            getattr(self.action, method), f"{self.name}.{method} returns {shown}, expected {wanted}"
        )


def _is_piece(piece: object, joints: int) -> bool:
    """Whether a piece of a motion can be timed."""
    match piece:
        case BaseMove(poses, along):
            rows, width = poses, 3
        case ArmMove(path, _, along):
            rows, width = path, joints
        case GripperMove(opening):
            return isinstance(opening, float | int) and bool(np.isfinite(opening))
        case _:
            return False
    tables = [(rows, width), *((carried.poses, 7) for carried in along)]
    return all(
        isinstance(table, np.ndarray)
        and table.ndim == 2
        and table.shape[1] == columns
        and len(table) == len(rows) > 1
        and bool(np.isfinite(table).all())
        for table, columns in tables
    )


def _called(code: Any, what: str, call: Callable[[], Any]) -> Any:
    """What a call of somebody else's code returns."""
    try:
        return call()
    except (InputError, EvaluationError):
        raise
    except Exception as error:
        words = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        raise InputError(f"{what} raises {words}", place=_line_of(error, code)) from error


def _line_of(error: Exception, code: Any) -> str:
    """`file:line` in the file of some code where an exception comes from."""
    place = position_of(code)
    file = _file_of(code)
    frames: Iterable[traceback.FrameSummary] = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == file]
    return f"{place.rpartition(':')[0]}:{lines[-1]}" if lines and ":" in place else place


def _file_of(code: Any) -> str | None:
    try:
        return inspect.getsourcefile(code)
    except TypeError:
        return None


def _refuse(code: Any, message: str) -> NoReturn:
    raise InputError(message, place=position_of(code))
