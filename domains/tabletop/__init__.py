"""Objects on tables, and a robot that moves them: the functions that sketches can call.

They ask `features.functions`, which knows the geometry of the scene through the state's world.
Nothing heavy is imported here: `sketchlang check` reads these signatures.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from functools import cache
from types import ModuleType
from typing import TYPE_CHECKING

from domains.tabletop.state import Placement
from sketchlang.domain import Domain, LoadOptions, Nat, Picture

if TYPE_CHECKING:
    from domains.tabletop.problem import TabletopProblem
    from domains.tabletop.state import State

domain = Domain(
    "tabletop",
    summary="Pick and place of objects on tables with a mobile robot",
    has_robots=True,
    large=(1_000_000, "an object to which no way leads, whatever is moved"),
    schemas={
        "move_base(pose)": "The robot drives to another place, its arm at home.",
        "pick(object, grasp)": "The arm takes an object that it reaches, and goes home with it.",
        "place(object, placement)": "The arm puts down the object in the hand, and goes home.",
    },
)


@cache
def _features() -> ModuleType:
    from domains.tabletop.features import functions

    return functions


@domain.sort
class Object(int):
    """An object that the robot can move: its index in the scene."""


domain.sort(Placement)


@domain.naming
def name_of(state: State, element: object) -> str | None:
    """The name of an object; x, y, support and heading of a placement."""
    from domains.tabletop.features import names

    if isinstance(element, Object):
        return names.object_name(state.world, element)
    if isinstance(element, Placement):
        return names.placement_name(state.world, element)
    return None


@domain.function(ignores="base")
def objects(state: State) -> tuple[Object, ...]:
    """All movable objects."""
    return _first(len(state.placements))


@cache
def _first(number: int) -> tuple[Object, ...]:
    """So many objects: always the same tuple, so that it need not be looked at again."""
    return tuple(Object(i) for i in range(number))


@domain.function(ignores="base")
def held(state: State, o: Object) -> bool:
    """Whether an object is in the gripper."""
    return state.held == o


@domain.function(ignores="base")
def wanted_held(state: State, o: Object) -> bool:
    """Whether the scene wants an object in the gripper at the end."""
    return o in state.world.wanted_held


@domain.function(ignores="base")
def bars(state: State, o: Object) -> Nat:
    """What is to be taken away before o can be picked up: the number of objects in the way, and
    of those in the way of these; 0 for the object in the gripper."""
    from domains.tabletop.features import functions

    return functions.bars(state, o)


@domain.function(ignores="base")
def misplaced(state: State, o: Object) -> bool:
    """Whether an object stands outside its goal, or is held and its goal is blocked."""
    found: bool = o in _features().misplaced(state)
    return found


@domain.function(ignores="base")
def settled(state: State, o: Object) -> bool:
    """Whether an object rests where the scene wants it, and so does all that it stands on."""
    found: bool = o in _features().settled(state)
    return found


@domain.function(ignores="base")
def next_to_settle(state: State, o: Object) -> bool:
    """Whether an object is not settled, and all that it is to stand on is."""
    found: bool = o in _features().next_to_settle(state)
    return found


@domain.function(ignores="base")
def bars_settling(state: State, p: Object, o: Object) -> bool:
    """Whether p is to be taken away before o, next to settle, can be put where it is wanted."""
    found: bool = _features().bars_settling(state, p, o)
    return found


@domain.function(ignores="base")
def may_bear(state: State, o: Object) -> Nat:
    """How many objects may be put on o, whatever stands there now."""
    number: int = state.world.may_bear[o]
    return number


@domain.function(ignores="base")
def goal_placements(state: State, o: Object) -> tuple[Placement, ...]:
    """Unoccupied placements in which an object would be where the scene wants it."""
    found: tuple[Placement, ...] = _features().goal_placements(state, o)
    return found


@domain.function(ignores="base")
def disturbed_by(state: State, o: Object, p: Placement) -> Nat:
    """How many other misplaced objects would be obstructed more with an object at p."""
    number: int = _features().disturbed_by(state, o, p)
    return number


@domain.function(ignores="base")
def obstructions(state: State, o: Object) -> Nat:
    """alpha: what is to be taken away before o can be picked up and put at its goal: the number of
    objects in the way, and of those in the way of these."""
    number: int = _features().obstructions(state, o)
    return number


@domain.function(ignores="base")
def disturbances(state: State, o: Object) -> Nat:
    """beta: fewest misplaced objects that a goal placement of o blocks."""
    number: int = _features().disturbances(state, o)
    return number


@domain.atom
def robot_at(state: State) -> Iterable[Hashable]:
    """The pose of the base."""
    return (state.base,)


@domain.atom
def object_at(state: State) -> Iterable[Hashable]:
    """The placement of every object; for the held one, the grasp."""
    atoms: list[Hashable] = list(enumerate(state.placements))
    if state.held is not None:
        atoms[state.held] = (state.held, state.grasp)
    return atoms


@domain.atom
def arrangement(state: State) -> Iterable[Hashable]:
    """What every object rests on, and where the base is: one atom for all of it."""
    on = tuple(None if p is None else p.support for p in state.placements)
    return ((state.base, on),)


@domain.drawing
def draw(path: str, name: str) -> Picture:
    """A scene seen from above."""
    from domains.tabletop.picture import view_of_file
    from runtime.show.top_picture import TopPicture

    return TopPicture(view_of_file(path, name))


@domain.scenes
def load(path: str, options: LoadOptions) -> TabletopProblem:
    """The problem of a scene file."""
    from domains.tabletop.problem import load_problem

    return load_problem(path, options)
