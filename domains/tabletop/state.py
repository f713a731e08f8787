"""States of the pick-and-place domain (paper, State-Space S).

Poses are quantised to integers where they enter the planner, here, and compared exactly
from then on: a novelty table needs equality that is transitive.
"""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from domains.tabletop.world import TabletopWorld
    from runtime.world.poses import Floats, Pose

UNIT = 1e-5
"""Metres and radians of one step of a quantised coordinate."""

TURN = round(2 * math.pi / UNIT)

SIDE, TOP, PINCH, SLANT, END = 0, 1, 2, 3, 4
"""Families of approaches. SIDE: the hand comes in horizontally, its fingers on the left and the
right. TOP: it comes straight down. PINCH: horizontally, one finger above and one below. SLANT:
halfway between SIDE and TOP, its fingers on the left and the right. END: straight down as TOP, but
on the end of a long thing that is ahead, in place of its middle."""

DOWN = (TOP, END)
"""Those that come straight down."""

FAMILIES = ("side", "top", "pinch", "slant")

USUAL = (SIDE, TOP, PINCH)
"""Those that are thought of where a scene does not say which."""

SLOPE = math.sqrt(0.5)
"""Sine and cosine of the angle between a hand that comes aslant and the level."""


def quantise(value: float) -> int:
    """A length in whole steps."""
    return round(value / UNIT)


def quantise_angle(angle: float) -> int:
    """An angle in whole steps of one turn, [0, 2 pi)."""
    return round(angle / UNIT) % TURN


class Placement(NamedTuple):
    """Where an object rests: quantised x, y and heading, and the index of the support.

    On a support that can be moved (the top of another object, a tray) x, y and heading are
    those in the support's own frame: what stands there goes where its support goes. `face` is
    the side that it stands on, 0 for that at the start (`faces.py`).
    """

    x: int
    y: int
    yaw: int
    support: int
    face: int = 0

    @classmethod
    def of(cls, x: float, y: float, yaw: float, support: int, face: int = 0) -> Placement:
        return cls(quantise(x), quantise(y), quantise_angle(yaw), support, face)

    @property
    def pose(self) -> tuple[float, float, float]:
        """x, y in metres, heading in radians."""
        return self.x * UNIT, self.y * UNIT, self.yaw * UNIT


class BasePose(NamedTuple):
    """Where the robot stands: quantised x, y and heading."""

    x: int
    y: int
    yaw: int

    @classmethod
    def of(cls, x: float, y: float, yaw: float) -> BasePose:
        return cls(quantise(x), quantise(y), quantise_angle(yaw))

    @property
    def pose(self) -> tuple[float, float, float]:
        """x, y in metres, heading in radians."""
        return self.x * UNIT, self.y * UNIT, self.yaw * UNIT


class Grasp(NamedTuple):
    """A grasp, in the standing frame of the object (`items.py`) on one of its faces.

    `angle` is the quantised heading of the hand, `height` that of the grasp centre above the
    object's bottom; `along` and `aside` are where the centre is, along the heading and to its
    left. `flipped` turns the hand over. For TOP and END, the heading is where the hand's upper side
    (SIDE: its tip) points.
    """

    angle: int
    height: int
    flipped: bool = False
    family: int = SIDE
    along: int = 0
    aside: int = 0
    face: int = 0

    @classmethod
    def of(
        cls,
        angle: float,
        height: float,
        flipped: bool = False,
        family: int = SIDE,
        along: float = 0.0,
        aside: float = 0.0,
        face: int = 0,
    ) -> Grasp:
        return cls(
            quantise_angle(angle),
            quantise(height),
            flipped,
            family,
            quantise(along),
            quantise(aside),
            face,
        )

    @property
    def heading(self) -> float:
        """Heading of the hand in the object's frame, radians."""
        return self.angle * UNIT

    def centre(self, at: tuple[float, float, float, float]) -> tuple[float, float, float]:
        """The grasp centre for an object that rests at x, y, height and heading, metres."""
        c, s = math.cos(at[3] + self.heading), math.sin(at[3] + self.heading)
        along, aside = self.along * UNIT, self.aside * UNIT
        x, y = at[0] + c * along - s * aside, at[1] + s * along + c * aside
        return x, y, at[2] + self.height * UNIT

    @property
    def up(self) -> Floats:
        """What direction (3,) of the tool frame points up where the object stands."""
        return self.tool[2, :3].copy()

    @property
    def tool(self) -> Pose:
        """The tool frame (x: approach, y: the fingers close) in the standing frame (3, 4)."""
        c, s = math.cos(self.heading), math.sin(self.heading)
        along, aside, height = self.along * UNIT, self.aside * UNIT, self.height * UNIT
        x, y = c * along - s * aside, s * along + c * aside
        turn = -1.0 if self.flipped else 1.0
        if self.family == SIDE:
            axes = [[c, -s * turn, 0.0], [s, c * turn, 0.0], [0.0, 0.0, turn]]
        elif self.family in DOWN:
            axes = [[0.0, -s * turn, c * turn], [0.0, c * turn, s * turn], [-1.0, 0.0, 0.0]]
        elif self.family == SLANT:
            k, up = SLOPE, SLOPE * turn
            axes = [[k * c, -s * turn, up * c], [k * s, c * turn, up * s], [-k, 0.0, up]]
        else:
            axes = [[c, 0.0, s * turn], [s, 0.0, -c * turn], [0.0, turn, 0.0]]
        import numpy as np  # here, for `check` reads this file as well

        return np.column_stack([axes, [x, y, height]])


@dataclass(frozen=True, slots=True)
class State:
    """The robot's base pose, where every object rests (None: held), and the grasp.

    Between actions the arm is in its home posture. `facts` are what further actions of a domain
    add: pairs of a name and a value, by name. `world` gives domain functions access to the
    scene's geometry; it is the same object in all states of one run.
    """

    base: BasePose
    placements: tuple[Placement | None, ...]
    held: int | None = None
    grasp: Grasp | None = None
    facts: tuple[tuple[str, Hashable], ...] = ()
    world: TabletopWorld = field(compare=False, repr=False, default=None)  # type: ignore[assignment]

    def driven(self, base: BasePose) -> State:
        """The robot stands elsewhere."""
        return State(base, self.placements, self.held, self.grasp, self.facts, self.world)

    def picked(self, index: int, grasp: Grasp) -> State:
        """An object is in the hand."""
        placements = (*self.placements[:index], None, *self.placements[index + 1 :])
        return State(self.base, placements, index, grasp, self.facts, self.world)

    def placed(self, index: int, placement: Placement) -> State:
        """An object rests somewhere, and the hand is empty if it held it."""
        placements = (*self.placements[:index], placement, *self.placements[index + 1 :])
        if index != self.held:
            return replace(self, placements=placements)
        return State(self.base, placements, None, None, self.facts, self.world)

    def fact(self, name: str, default: Hashable = None) -> Hashable:
        """The value of a fact."""
        return dict(self.facts).get(name, default)

    def with_fact(self, name: str, value: Hashable) -> State:
        """The same state with another value of a fact."""
        facts = {**dict(self.facts), name: value}
        return replace(self, facts=tuple(sorted(facts.items(), key=lambda item: item[0])))
