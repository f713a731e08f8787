"""What a robot that carries out an action notices of the world."""

from __future__ import annotations

import numpy as np

from domains.tabletop.loop.disturb import Disturber
from domains.tabletop.loop.sensing import LOOKS, Seen, Senses
from domains.tabletop.loop.ways import Ways
from domains.tabletop.scene.model import Scene
from runtime.trace.model import Trace

MOVED = 0.015
"""Metres from where it was planned with, beyond which an object counts as moved."""


class Watcher:
    """Looks at the world during one action of a trace, that of a number.

    `seen` is what was planned with. The first thing that is not so is the `surprise`. Drives
    are stopped then. With `ways`, those of the arm, an action goes on where its way is free
    and what it reaches for has not moved. What the gripper holds is not looked at: fingers
    feel it (`Follower.lost`).
    """

    def __init__(
        self,
        trace: Trace,
        number: int,
        seen: Seen,
        scene: Scene,
        disturber: Disturber,
        senses: Senses,
        ways: Ways | None,
    ) -> None:
        self.trace, self.number, self.seen = trace, number, seen
        self.action = trace.actions[number]
        self.scene, self.disturber, self.senses, self.ways = scene, disturber, senses, ways
        self.surprise: str | None = None
        self.in_vain = False  # what the arm reaches for is elsewhere

    def __call__(self, time: float) -> str | None:
        self.disturber.act(self.scene, self.trace, self.number, time)
        if self.surprise is None:
            self.surprise = self._surprise(time)
        if self.surprise is None:
            return None
        goes_on = (
            self.ways is not None
            and not self.in_vain
            and self.ways.on_is_free(self.trace, time, self.action.end)
        )
        return None if goes_on else self.surprise

    def _surprise(self, time: float) -> str | None:
        names = [thing.name for thing in self.scene.objects]
        known = {obstacle.name for obstacle in self.scene.obstacles}
        for name, *_ in self.disturber.obstacles:
            if name not in known:
                return f"{name} is in view"
        now = self.senses.look(LOOKS)
        target = self._reaches_for(time)
        own = self.action.object
        for index, (before, after) in enumerate(zip(self.seen.objects, now.objects, strict=True)):
            if index in {now.held, self.seen.held} or names[index] == own != target:
                continue
            aimed_at = names[index] == target
            limit = self._clearance() if aimed_at else MOVED
            if np.linalg.norm(before[:3] - after[:3]) > limit + 4 * self.disturber.noise / 3:
                self.in_vain = aimed_at
                return f"{names[index]} has moved"
        return None

    def _clearance(self) -> float:
        """Metres by which what the arm reaches for may be elsewhere: the fingers would knock
        over what stands further beside."""
        return MOVED if self.ways is None else self.ways.robot.gripper.clearance

    def _reaches_for(self, time: float) -> str | None:
        """What the fingers are going to close on, until they do."""
        coming = [g for g in self.trace.grips if time < g.start < self.action.end and g.attach]
        return coming[0].object if coming else None
