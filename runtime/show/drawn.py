"""All that is to be seen of a trace at a time, for whatever draws it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from runtime.show.colours import Colour
from runtime.show.forms import Ints
from runtime.show.parts import Node, Part, parts_of
from runtime.trace.kinematics import Tree, guided_at, links_at, object_at
from runtime.trace.model import Trace
from runtime.world.poses import Floats


@dataclass(frozen=True, eq=False)
class Drawn:
    """Triangles: vertices (n, 3) and faces (m, 3) in a frame, its world pose (4, 4), a colour."""

    name: str
    vertices: Floats
    faces: Ints
    pose: Floats
    colour: Colour


class Scenery:
    """The parts of a trace, made once, to be placed at any time."""

    def __init__(self, trace: Trace) -> None:
        self.trace, self.tree = trace, Tree(trace.robot)
        self.parts: list[tuple[str, Part]] = []
        counts: dict[Node, int] = {}
        for part in parts_of(trace):
            if part.layer == "looks":
                number = counts[part.node] = counts.get(part.node, 0) + 1
                name = part.node.name if number == 1 else f"{part.node.name}_{number}"
                self.parts.append((name, part))

    def at(self, time: float) -> Iterator[Drawn]:
        """Everything at a time."""
        poses = self._poses(time)
        for name, part in self.parts:
            yield Drawn(name, part.vertices, part.faces, poses[part.node], part.colour)

    def _poses(self, time: float) -> dict[Node, Floats]:
        trace = self.trace
        links = links_at(trace, self.tree, time)
        found = {Node("link", name): pose for name, pose in links.items()}
        found[Node("world", "")] = np.eye(4)
        for fixed in trace.world.fixed:
            found[Node("fixed", fixed.name)] = guided_at(trace, fixed.name, time)
        for index, thing in enumerate(trace.world.movables):
            found[Node("object", thing.name)] = object_at(trace, links, index, time)
        return found


def drawn(trace: Trace, time: float) -> Iterator[Drawn]:
    """The same for one time only."""
    yield from Scenery(trace).at(time)
