"""Objects as the planner handles them: how they stand, and how a hand takes them.

An object keeps the side on which it stands at the start. Its *standing frame* has z up and its
origin under the middle of the smallest upright box around it, at the height of its bottom;
turning the object about z is all that a placement does.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from domains.tabletop.hand import Hand
from domains.tabletop.state import PINCH, SIDE, TOP, Grasp
from runtime.world.body import Body, Part
from runtime.world.outline import vertices_and_edges
from runtime.world.poses import Floats, Pose, apply, compose, upright
from runtime.world.world import Movable

GRASP_HEIGHT = 0.12
"""Metres above the object's bottom, as published; lower for objects that are not as tall."""

PINCH_DEPTH = 0.03
"""Metres that the fingers reach over the edge of what they pinch."""

PALM_AIR = 0.004
"""Metres left between the palm, or the tips of the fingers, and what they must not touch."""

FRICTION = 0.6
"""Fingers hold what they touch on two sides if the points are nearly opposite: the tangent of
the angle by which they may be beside each other, well within what friction bears."""

TOUCHING = 2e-4
"""Metres from the outermost point within which an outline touches a finger."""


@dataclass(frozen=True, eq=False)
class Hold:
    """How a hand of one family takes an object, for several headings (k,) in its standing frame:
    `width` between the fingers, centre of the grasp `along` the heading and `aside` of it, and
    `fits`, whether a hand can take it so. `height` is that of the centre. Metres."""

    family: int
    height: float
    width: Floats
    along: Floats
    aside: Floats
    fits: Floats


@dataclass(frozen=True, eq=False)
class Item:
    """One movable object. `standing` (3, 4) is its body's frame in its standing frame;
    `symmetry` is how many turns about z map it to itself, 24 where any does."""

    name: str
    body: Body
    standing: Pose
    symmetry: int

    @classmethod
    def of(
        cls, thing: Movable, yaw: float, symmetry: int
    ) -> tuple[Item, tuple[float, float, float, float]]:
        """The item of a movable that has a heading at the start, and x, y, bottom and heading of
        its standing frame in the world."""
        turned = compose(upright(0.0, 0.0, 0.0, -yaw), thing.pose)
        loose = cls(thing.name, thing.body, turned, symmetry)
        points = loose.corners
        low, high = points.min(axis=0), points.max(axis=0)
        foot = np.array([*(low + high)[:2] / 2, low[2]])
        standing = turned.copy()
        standing[:, 3] -= foot
        x, y, z = apply(upright(0.0, 0.0, 0.0, yaw), foot[None])[0].tolist()
        return cls(thing.name, thing.body, standing, symmetry), (x, y, z, yaw)

    @property
    def corners(self) -> Floats:
        """Corners (n, 3), in the standing frame, of polyhedra around the parts."""
        return np.vstack([vertices for vertices, _ in self._outlines])

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """The object's solids in the standing frame."""
        return tuple(Part(p.solid, compose(self.standing, p.pose)) for p in self.body.parts)

    @cached_property
    def _outlines(self) -> list[tuple[Floats, list[tuple[int, int]]]]:
        """Corners (n, 3) in the standing frame, and edges, of a polyhedron around each part."""
        found = []
        for part in self.parts:
            vertices, edges = vertices_and_edges(part.solid)
            found.append((apply(part.pose, vertices), edges))
        return found

    @cached_property
    def size(self) -> tuple[float, float, float]:
        """Of the smallest upright box around it, along x, y and z of the standing frame."""
        points = self.corners
        x, y, z = (points.max(axis=0) - points.min(axis=0)).tolist()
        return x, y, z

    @property
    def inner_radius(self) -> float:
        """Radius of an upright cylinder that is inside, or nearly so, metres."""
        return min(self.size[0], self.size[1]) / 2

    @cached_property
    def outer_radius(self) -> float:
        """Radius of the smallest upright cylinder around it about the middle, metres."""
        points = self.corners
        return float(np.hypot(points[:, 0], points[:, 1]).max())

    @cached_property
    def centre(self) -> Floats:
        """The centre of mass (3,) in the standing frame."""
        middle: Floats = apply(self.standing, np.array([self.body.centre]))[0]
        return middle

    @cached_property
    def kind(self) -> tuple[object, ...]:
        """Equal for objects that look and weigh the same as they stand."""
        solids = tuple((p.solid, tuple(np.round(p.pose, 9).ravel().tolist())) for p in self.parts)
        return solids, round(self.body.mass, 6)

    def section(self, low: float, high: float) -> Floats:
        """Corners (n, 2) of what is between two heights, seen from above."""
        found = [np.zeros((0, 2))]
        for vertices, edges in self._outlines:
            inside = (vertices[:, 2] >= low - 1e-9) & (vertices[:, 2] <= high + 1e-9)
            found.append(vertices[inside, :2])
            ends = vertices[np.array(edges)]  # (e, 2, 3)
            for z in (low, high):
                a, b = ends[:, 0], ends[:, 1]
                crosses = (a[:, 2] - z) * (b[:, 2] - z) < 0
                a, b = a[crosses], b[crosses]
                share = (z - a[:, 2]) / (b[:, 2] - a[:, 2])
                found.append(a[:, :2] + share[:, None] * (b[:, :2] - a[:, :2]))
        return np.vstack(found)

    def holds(self, hand: Hand, family: int, angles: Floats) -> Hold | None:
        """How a hand takes the object at some headings (k,) in its standing frame; None where
        it cannot at all."""
        gripped = self._gripped(hand, family)
        if gripped is None:
            return None
        height, points = gripped
        forward = points @ np.array([np.cos(angles), np.sin(angles)])  # (n, k)
        across = points @ np.array([-np.sin(angles), np.cos(angles)])
        near, far = forward.min(axis=0), forward.max(axis=0)
        aside = (across.max(axis=0) + across.min(axis=0)) / 2
        if family == PINCH:
            width = np.full(len(angles), self.size[2])
            along = near + np.minimum(PINCH_DEPTH, (far - near) / 2)
            fits = (along - near) <= hand.back - PALM_AIR
        else:
            width = across.max(axis=0) - across.min(axis=0)
            along = np.zeros(len(angles)) if family == SIDE else (near + far) / 2
            if family == TOP:
                # A long thing is taken over its centre of mass, where it hangs level.
                middle = self.centre[:2] @ np.array([np.cos(angles), np.sin(angles)])
                along = middle
                fits = np.ones(len(angles), dtype=bool)
            else:
                deepest = near + hand.back - PALM_AIR
                along = np.minimum(along, deepest)
                fits = along > near + min(0.01, 0.25 * float(np.ptp(points[:, 0])))
            fits = fits & (_slip(forward, across) <= FRICTION * width)
        fits = fits & (width + 2 * hand.clearance <= hand.max_opening + 1e-9)
        fits = fits & self._is_borne(hand, angles, along, aside)
        return Hold(family, height, width, along, aside, fits)

    def _gripped(self, hand: Hand, family: int) -> tuple[float, Floats] | None:
        """The height of the grasp centre, and corners (n, 2) of what is between the fingers."""
        if family not in self._known_grips:
            height = self._grasp_height(hand, family)
            found = None
            if height is not None:
                low, high = {
                    SIDE: (height - hand.pad, height + hand.pad),
                    TOP: (max(0.0, height - hand.tip), self.size[2]),
                    PINCH: (0.0, self.size[2]),
                }[family]
                points = self.section(low, high)
                found = (height, points) if len(points) else None
            self._known_grips[family] = found
        return self._known_grips[family]

    @cached_property
    def _known_grips(self) -> dict[int, tuple[float, Floats] | None]:
        return {}

    def _grasp_height(self, hand: Hand, family: int) -> float | None:
        tall = self.size[2]
        if family == SIDE:
            return min(GRASP_HEIGHT, 0.6 * tall)
        if family == PINCH:
            return tall / 2
        lowest = hand.tip + PALM_AIR
        highest = tall - min(0.01, tall / 2)
        deepest = tall - hand.back + PALM_AIR  # the palm stays above the top
        height = max(min(tall / 2, highest), lowest, deepest)
        if height - hand.tip > tall - min(0.008, tall / 2):
            return None  # the fingers end above it
        return height

    def _is_borne(self, hand: Hand, angles: Floats, along: Floats, aside: Floats) -> Floats:
        """Whether the hand can bear the object's weight, and the torque of it."""
        c, s = np.cos(angles), np.sin(angles)
        x, y = self.centre[0], self.centre[1]
        lever = np.hypot(c * x + s * y - along, c * y - s * x - aside)
        weight = 9.81 * self.body.mass
        borne: Floats = np.full(len(angles), weight <= hand.max_weight) & (
            weight * lever <= hand.max_torque
        )
        return borne

    def grasp(self, hold: Hold, k: int, angle: float, flipped: bool = False) -> Grasp:
        """The grasp of the k-th heading of a hold, which is `angle` in the standing frame."""
        return Grasp.of(
            angle,
            hold.height,
            flipped,
            hold.family,
            float(hold.along[k]),
            float(hold.aside[k]),
        )


def _slip(forward: Floats, across: Floats) -> Floats:
    """How far, along the heading, the points at which fingers touch an outline on the left and
    on the right are beside each other (k,), for points (n, k) in the frame of each heading."""
    left = across >= across.max(axis=0) - TOUCHING
    right = across <= across.min(axis=0) + TOUCHING
    low_left = np.where(left, forward, np.inf).min(axis=0)
    high_left = np.where(left, forward, -np.inf).max(axis=0)
    low_right = np.where(right, forward, np.inf).min(axis=0)
    high_right = np.where(right, forward, -np.inf).max(axis=0)
    slip: Floats = np.maximum(np.maximum(low_left - high_right, low_right - high_left), 0.0)
    return slip


def why_not(item: Item, hand: Hand, families: Sequence[int]) -> str | None:
    """Why no hand of some families can take an object, in a few words; None where one can."""
    angles = np.linspace(0.0, 2 * math.pi, 48, endpoint=False)
    holds = [item.holds(hand, family, angles) for family in families]
    if any(hold is not None and hold.fits.any() for hold in holds):
        return None
    if 9.81 * item.body.mass > hand.max_weight:
        return f"weighs {item.body.mass:.1f} kg, more than the gripper bears"
    widths = [float(hold.width.min()) for hold in holds if hold is not None]
    widest = hand.max_opening - 2 * hand.clearance
    if widths and min(widths) > widest:
        narrowest = 1000 * min(widths)
        return (
            f"is {narrowest:.0f} mm across at its narrowest, the gripper takes {1000 * widest:.0f}"
        )
    return "cannot be held: its weight is too far from where the gripper reaches"
