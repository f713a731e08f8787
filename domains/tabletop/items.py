"""Objects as the planner handles them: how they stand, and how a hand takes them.

An item is an object on one of its faces (`faces.py`). Its *standing frame* has z up and its
origin under the middle of the smallest upright box around it, at the height of its bottom.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from domains.tabletop.hand import Hand
from domains.tabletop.outlines import Slab, around, room_within
from domains.tabletop.pads import SNUG, Polyhedron, across, firm
from domains.tabletop.rims import PALM_AIR, outermost, rim_of
from domains.tabletop.state import DOWN, END, PINCH, SIDE, SLANT, SLOPE, TOP, UNIT, Grasp
from domains.tabletop.steps import beside_steps
from runtime.world.body import Body, Part
from runtime.world.outline import vertices_and_edges
from runtime.world.packed import UPRIGHT
from runtime.world.poses import Floats, Pose, apply, compose, upright
from runtime.world.solids import Box, Solid
from runtime.world.world import Movable

GRASP_HEIGHT = 0.12
"""Metres above the object's bottom, as published; lower for objects that are not as tall."""

PINCH_DEPTH = 0.03
"""Metres that the fingers reach over the edge of what they pinch."""

ASLANT_DEPTH = 0.01
"""Metres that a hand which comes aslant reaches over the near side of what it takes, at least."""

LEVEL = 1e-6
"""Metres by which what counts as upright or level may be off."""

ASIDE = 0.01
"""Metres from above its centre of mass that a thing is taken at its end, at least."""

EVEN = 0.001
"""Metres by which an end may be wider in one place than in another."""

SIDE_LENGTH = 0.01
"""Metres of an edge of an outline that counts as a side."""


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
    """One movable object on a face. `standing` (3, 4) is its body's frame in its standing frame;
    `symmetry` is how many turns about z map it to itself, 24 where any does; `face` is the number
    of the face."""

    name: str
    body: Body
    standing: Pose
    symmetry: int
    face: int = 0

    @classmethod
    def of(
        cls, thing: Movable, yaw: float, symmetry: int, face: int = 0
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
        return cls(thing.name, thing.body, standing, symmetry, face), (x, y, z, yaw)

    @property
    def corners(self) -> Floats:
        """Corners (n, 3), in the standing frame, of polyhedra around the parts."""
        return np.vstack([vertices for vertices, _ in self._outlines])

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """The object's solids in the standing frame."""
        return tuple(_squared(p.solid, compose(self.standing, p.pose)) for p in self.body.parts)

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
    def is_box(self) -> bool:
        """Whether it is nothing but an upright box."""
        return len(self.parts) == 1 and isinstance(self.parts[0].solid, Box)

    @cached_property
    def inner_radius(self) -> float:
        """Radius of an upright cylinder about the middle that the object, seen from above, fills,
        or nearly so, metres; 0 where its middle is outside of it, as that of a triangle is."""
        if self.is_box:
            return min(self.size[0], self.size[1]) / 2
        return max(0.0, *(room_within(outline) for outline in self.section(0.0, self.size[2])))

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

    def section(self, low: float, high: float) -> list[Floats]:
        """What is between two heights, seen from above: the corners (n, 2) of the convex outline
        of each part, counter-clockwise."""
        found = []
        for vertices, edges in self._outlines:
            inside = (vertices[:, 2] >= low - 1e-9) & (vertices[:, 2] <= high + 1e-9)
            points = [vertices[inside, :2]]
            ends = vertices[np.array(edges)]  # (e, 2, 3)
            for z in (low, high):
                a, b = ends[:, 0], ends[:, 1]
                crosses = (a[:, 2] - z) * (b[:, 2] - z) < 0
                a, b = a[crosses], b[crosses]
                share = (z - a[:, 2]) / (b[:, 2] - a[:, 2])
                points.append(a[:, :2] + share[:, None] * (b[:, :2] - a[:, :2]))
            outline = around(np.vstack(points))
            if len(outline):
                found.append(outline)
        return found

    def holds(self, hand: Hand, family: int, angles: Floats) -> Hold | None:
        """How a hand takes the object at some headings (k,) in its standing frame; None where
        it cannot at all."""
        if family in DOWN and self._by_its_rim(hand):
            return self._rim_holds(hand, angles) if family == TOP else None
        gripped = self._gripped(hand, family)
        if gripped is None:
            return None
        return self._across(hand, family, angles, *gripped)

    def _across(
        self, hand: Hand, family: int, angles: Floats, height: float, outlines: list[Floats]
    ) -> Hold:
        """The hold with all that is at its height between the fingers."""
        ahead = np.array([np.cos(angles), np.sin(angles)])
        forward = np.vstack(outlines) @ ahead  # (n, k)
        near, far = forward.min(axis=0), forward.max(axis=0)
        behind, before = self._reach(hand, hand.pads, family, height)
        if family == PINCH:
            along = near + np.minimum(PINCH_DEPTH, (far - near) / 2)
            fits = along - near <= hand.back - PALM_AIR
        elif family == TOP:
            # A long thing is taken over its centre of mass, where it hangs level.
            along = self.centre[:2] @ ahead
            fits = np.full(len(angles), True)
        elif family == END:
            along = far - hand.fingertip
            fits = along - self.centre[:2] @ ahead >= ASIDE
            # As wide at the tip, where the sides are straight.
            ends = [Slab(outlines, angles, start, far) for start in (along - behind, along)]
            fits &= np.abs(ends[0].width - ends[1].width) <= EVEN
            fits &= np.abs(ends[0].middle - ends[1].middle) <= EVEN
        elif family == SLANT:
            # The palm stays behind the upper edge on the near side.
            along = np.minimum(0.0, near + self._room_aslant(hand) - (self.size[2] - height))
            fits = along >= near + np.minimum(ASLANT_DEPTH, (far - near) / 4) - 1e-9
        else:
            along = np.minimum(0.0, near + hand.back - PALM_AIR)
            fits = along > near + np.minimum(0.01, (far - near) / 4)
        slab = Slab(outlines, angles, along - behind, along + before)
        if family == PINCH:
            width = np.full(len(angles), self.size[2])
        else:
            width = slab.width
            behind, before = self._reach(hand, hand.flat, family, height)
            touched = Slab(outlines, angles, along - behind, along + before)
            fits = fits & across(touched) & (width - touched.width <= SNUG)
        fits = fits & (width > 0) & (width + 2 * hand.clearance <= hand.max_opening + 1e-9)
        fits = fits & self._is_borne(hand, angles, along, slab.middle)
        return self._firmly(hand, angles, Hold(family, height, width, along, slab.middle, fits))

    def _firmly(self, hand: Hand, angles: Floats, hold: Hold) -> Hold:
        """The hold without the headings at which the pads would slip off a shape whose faces are
        not all upright or level, or that has several parts."""
        chosen = np.flatnonzero(hold.fits)
        if self._is_prism or not len(chosen):
            return hold
        tools = np.array([self.grasp(hold, k, float(angles[k])).tool for k in chosen.tolist()])
        fits = np.full(len(angles), False)
        fits[chosen] = firm(self._polyhedra, tools, hand.flat, hold.width[chosen])
        return replace(hold, fits=fits)

    @cached_property
    def _is_prism(self) -> bool:
        """Whether it is one solid that looks the same at each of its heights."""
        if len(self._outlines) != 1:
            return False
        corners = self._outlines[0][0]
        low = corners[:, 2] < self.size[2] / 2
        ends = [around(corners[chosen, :2]) for chosen in (low, ~low)]
        level = np.minimum(corners[:, 2], self.size[2] - corners[:, 2])
        return bool(np.abs(level).max() < LEVEL) and (
            ends[0].shape == ends[1].shape and bool(np.abs(ends[0] - ends[1]).max() < LEVEL)
        )

    @cached_property
    def _polyhedra(self) -> list[Polyhedron]:
        return [Polyhedron.of(corners, edges) for corners, edges in self._outlines]

    @cached_property
    def sides(self) -> Floats:
        """Headings (k,) in the standing frame along which a hand meets a side squarely, [0, 2 pi);
        none for what is round."""
        if self.symmetry >= 24:
            return np.zeros(0)
        found = []
        for outline in self.section(0.0, self.size[2]):
            edges = np.roll(outline, -1, axis=0) - outline
            long = np.hypot(edges[:, 0], edges[:, 1]) > SIDE_LENGTH
            bearing = np.arctan2(edges[long, 1], edges[long, 0])
            found += [bearing + turn * math.pi / 2 for turn in range(4)]
        return (
            np.unique(np.round(np.concatenate(found) % (2 * math.pi), 6)) if found else np.zeros(0)
        )

    def _gripped(self, hand: Hand, family: int) -> tuple[float, list[Floats]] | None:
        """The height of the grasp centre, and what is between the fingers there."""
        if family not in self._known_grips:
            height = self._grasp_height(hand, family)
            found = None
            if height is not None:
                outlines = self.section(*self._between(hand, family, height))
                found = (height, outlines) if outlines else None
            self._known_grips[family] = found
        return self._known_grips[family]

    def _by_its_rim(self, hand: Hand) -> bool:
        """Whether from above a rim of the object, or a knob on it, fits between the fingers along
        more headings than all of it does."""
        known = self._known_rims
        if TOP not in known:
            known[TOP] = None
            rim = rim_of(self.parts, self.size[2], hand) if len(self.parts) > 1 else None
            outlines = [] if rim is None else self.section(rim - hand.tip, self.size[2])
            if rim is not None and outlines:
                known[TOP] = (rim, outlines)
                gripped = self._gripped(hand, TOP)
                angles = np.concatenate([self.sides, np.arange(24.0) * math.pi / 12])
                whole = 0
                if gripped is not None:
                    whole = int(self._across(hand, TOP, angles, *gripped).fits.sum())
                if whole and whole >= int(self._rim_holds(hand, angles).fits.sum()):
                    known[TOP] = None
        return known[TOP] is not None

    def _rim_holds(self, hand: Hand, angles: Floats) -> Hold:
        """How a hand takes the object from above by the part of its rim that is on the left,
        beside its centre of mass."""
        rim = self._known_rims[TOP]
        assert rim is not None
        height, outlines = rim
        along = self.centre[:2] @ np.array([np.cos(angles), np.sin(angles)])
        width, middle, fits = outermost(
            outlines, angles, along - hand.pad, along + hand.pad, hand.finger_width
        )
        fits &= width + 2 * hand.clearance <= hand.max_opening + 1e-9
        borne = self._is_borne(hand, angles, along, middle)
        borne = np.where(fits, borne, False)
        return self._firmly(hand, angles, Hold(TOP, height, width, along, middle, borne))

    def _between(self, hand: Hand, family: int, height: float) -> tuple[float, float]:
        """The heights between which the fingers are that grip at a height."""
        if family == SIDE:
            return height - hand.pad, height + hand.pad
        if family == SLANT:
            above, below = _reach_aslant(hand)
            return max(0.0, height - below), min(self.size[2], height + above)
        return (max(0.0, height - hand.tip) if family in DOWN else 0.0), self.size[2]

    def _reach(self, hand: Hand, pads: Floats, family: int, height: float) -> tuple[float, float]:
        """Metres along the heading, behind and before the centre of a grasp at a height, between
        which pads are that close on the object, from the lowest x and z to the highest (2, 2)."""
        (back, below), (tip, above) = (-pads[0]).tolist(), pads[1].tolist()
        wide = max(below, above)
        if family == TOP:
            return wide, wide
        if family == END:
            wide = min(wide, hand.fingertip)
            return wide, wide
        if family == SLANT:
            # Pads that lean back are above it before they end.
            room = 2 * SLOPE * wide + self.size[2] - height
            return min(SLOPE * (back + wide), room), SLOPE * (tip + wide)
        return back, tip

    @cached_property
    def _known_grips(self) -> dict[int, tuple[float, list[Floats]] | None]:
        return {}

    @cached_property
    def _known_rims(self) -> dict[int, tuple[float, list[Floats]] | None]:
        return {}

    def _grasp_height(self, hand: Hand, family: int) -> float | None:
        tall = self.size[2]
        if family == SIDE:
            wanted = min(GRASP_HEIGHT, 0.6 * tall)
            if len(self.parts) == 1:
                return wanted
            return beside_steps(self.section, wanted, hand.pad, tall)
        if family == PINCH:
            return tall / 2
        if family == SLANT:
            lowest = max(
                _reach_aslant(hand)[1] + PALM_AIR, tall - self._room_aslant(hand) + ASLANT_DEPTH
            )
            height = max(min(GRASP_HEIGHT, tall / 2), lowest)
            return height if height <= tall - min(0.005, tall / 4) else None
        lowest = hand.tip + PALM_AIR
        highest = tall - min(0.01, tall / 2)
        deepest = tall - hand.back + PALM_AIR  # the palm stays above the top
        height = max(min(tall / 2, highest), lowest, deepest)
        if height - hand.tip > tall - min(0.008, tall / 2):
            return None  # the fingers end above it
        return height

    @staticmethod
    def _room_aslant(hand: Hand) -> float:
        """Metres, along the level or upright, between the grasp centre and a palm that comes
        aslant."""
        return (hand.back - PALM_AIR) / SLOPE

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
            self.face,
        )

    def width(self, hand: Hand, grasp: Grasp) -> float:
        """Metres between the fingers of a grasp, wherever its centre is."""
        if grasp.family == TOP and self._by_its_rim(hand):
            return float(self._rim_holds(hand, np.array([grasp.heading])).width[0])
        gripped = self._gripped(hand, grasp.family)
        height = grasp.height * UNIT
        if gripped is not None and abs(gripped[0] - height) < UNIT:
            outlines = gripped[1]
        else:
            outlines = self.section(*self._between(hand, grasp.family, height))
        if grasp.family == PINCH or not outlines:
            return self.size[2]
        behind, before = self._reach(hand, hand.pads, grasp.family, height)
        along = np.array([grasp.along * UNIT])
        slab = Slab(outlines, np.array([grasp.heading]), along - behind, along + before)
        return float(slab.width[0])


def _reach_aslant(hand: Hand) -> tuple[float, float]:
    """Metres that fingers which come aslant reach behind the grasp centre, along the level, and
    above it; and ahead of it, and below it."""
    return SLOPE * (hand.back + hand.pad), SLOPE * (hand.tip + hand.pad)


def _squared(solid: Solid, pose: Pose) -> Part:
    """A solid at a pose; a box that stands on a side has its z up."""
    up = np.abs(pose[2, :3])
    axis = int(np.argmax(up))
    if not isinstance(solid, Box) or axis == 2 or up[axis] < 1 - UPRIGHT:
        return Part(solid, pose)
    order = [(axis + 1) % 3, (axis + 2) % 3, axis]
    turned = np.column_stack([pose[:, order], pose[:, 3]])
    return Part(Box((solid.size[order[0]], solid.size[order[1]], solid.size[order[2]])), turned)


def why_not(item: Item, hand: Hand, families: Sequence[int]) -> str | None:
    """Why no hand of some families can take an object, in a few words; None where one can."""
    angles: Floats = np.concatenate([item.sides, np.arange(48.0) * math.pi / 24])
    holds = [item.holds(hand, family, angles) for family in families]
    if any(hold is not None and hold.fits.any() for hold in holds):
        return None
    if 9.81 * item.body.mass > hand.max_weight:
        return f"weighs {item.body.mass:.1f} kg, more than the gripper bears"
    squarely = len(item.sides) or len(angles)
    widths = [float(hold.width[:squarely].min()) for hold in holds if hold is not None]
    widest = hand.max_opening - 2 * hand.clearance
    if widths and min(widths) > widest:
        narrowest = 1000 * min(widths)
        return (
            f"is {narrowest:.0f} mm across at its narrowest, the gripper takes {1000 * widest:.0f}"
        )
    stronger = replace(hand, max_torque=math.inf)
    holds = [item.holds(stronger, family, angles) for family in families]
    if any(hold is not None and hold.fits.any() for hold in holds):
        return "cannot be held: its weight is too far from where the gripper reaches"
    return "cannot be held: the fingers do not reach far enough around it"
