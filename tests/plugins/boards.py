"""Where objects stand, as a sort of its own for sketches of the tabletop domain."""

from domains.tabletop import Object
from domains.tabletop import domain as tabletop
from sketchlang.domain import Domain

domain = Domain.extend(tabletop)


@domain.sort
class Board(int):
    """Something that things can rest on: its index in the scene."""


@domain.function(ignores="base")
def boards(state) -> tuple[Board, ...]:
    """Everything that things can rest on."""
    return tuple(Board(i) for i in range(len(state.world.grounds)))


@domain.function(ignores="base")
def on(state, o: Object, b: Board) -> bool:
    """Whether an object rests on something."""
    placement = state.placements[o]
    return placement is not None and placement.support == b
