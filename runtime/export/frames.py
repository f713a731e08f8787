"""The frames of a trace, as `/tf` has them: who stands in whose frame, and where."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from runtime.export.shapes import pose_dict
from runtime.robot.model import Floats
from runtime.robot.urdf import MOVING
from runtime.trace.kinematics import Tree, guided_at, links_at, object_at
from runtime.trace.model import Trace
from runtime.world.quaternions import pose_of
from sketchlang.escape import visible


class Frames:
    """Names of frames: links have their own; things that move have theirs, or with `object_`
    before it where a link or the scene's frame is called so."""

    def __init__(self, trace: Trace, frame: str) -> None:
        self.trace, self.frame = trace, frame
        self.tree = Tree(trace.robot)
        taken = {*trace.robot.urdf.shapes, frame}
        self.things: dict[str, str] = {}
        for name in (*(thing.name for thing in trace.world.movables), *trace.guided):
            shown = visible(name)
            while shown in taken:
                shown = f"object_{shown}"
            taken.add(shown)
            self.things[name] = shown

    def fixed(self) -> Iterator[tuple[str, str, Floats]]:
        """Parent, child and transform (4, 4) of the links that never move in their parent."""
        for joint in self.tree.order:
            if joint.type not in MOVING:
                yield joint.parent, joint.child, np.vstack([joint.origin, [0, 0, 0, 1.0]])

    def at(self, time: float) -> Iterator[tuple[str, str, Floats]]:
        """The same for all that may move, at a time: the robot's root and all things in the
        scene's frame, links in their parents'."""
        links = links_at(self.trace, self.tree, time)
        yield self.frame, self.trace.robot.urdf.root, links[self.trace.robot.urdf.root]
        for joint in self.tree.order:
            if joint.type in MOVING:
                local = np.linalg.inv(links[joint.parent]) @ links[joint.child]
                yield joint.parent, joint.child, local
        for index, thing in enumerate(self.trace.world.movables):
            pose = object_at(self.trace, links, index, time)
            yield self.frame, self.things[thing.name], pose
        for name in self.trace.guided:
            yield self.frame, self.things[name], guided_at(self.trace, name, time)


def transforms(
    frames: Iterator[tuple[str, str, Floats]], stamp: dict[str, int]
) -> list[dict[str, Any]]:
    """`geometry_msgs/msg/TransformStamped` of each, as plain data."""
    found = []
    for parent, child, pose in frames:
        where = pose_dict(pose_of(pose))
        found.append(
            {
                "header": {"stamp": stamp, "frame_id": parent},
                "child_frame_id": child,
                "transform": {"translation": where["position"], "rotation": where["orientation"]},
            }
        )
    return found
