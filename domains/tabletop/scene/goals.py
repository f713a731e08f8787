"""Goals of a scene file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from domains.tabletop.scene.furniture import contains, refuse_far
from domains.tabletop.scene.model import (
    AnyGoal,
    Goal,
    HeldGoal,
    PoseGoal,
    RegionGoal,
    SingleGoal,
    WordGoal,
)
from domains.tabletop.scene.objects import Drawn, Placed, point_in, support_named
from runtime.entry import Entry, known

DEFAULT_TOLERANCE = 0.005
"""Metres; the published tolerance of point goals."""

KEYS = ("on", "at", "yaw", "tolerance", "held")
"""What says where an object is to be."""


@dataclass
class Wanted:
    """The goals that were read so far."""

    goals: dict[int, Goal]
    word: WordGoal | None = None
    words: int = 0


class GoalReader:
    """Reads goals about some objects."""

    def __init__(self, drawn: Sequence[Drawn], placed: Placed) -> None:
        self.drawn, self.placed = drawn, placed
        self.by_name = {thing.name: i for i, thing in reversed(list(enumerate(drawn)))}

    def read(self, scene: Entry) -> Wanted:
        """All goals of a scene."""
        wanted = Wanted({})
        entries = scene.tables("goal")
        others: list[Entry] = []
        for entry in entries:
            if entry.has("word"):
                wanted.words += 1
                if wanted.words > 1:
                    entry.problem("word", "a scene can ask for one word only")
                wanted.word = self._word(entry) or wanted.word
            else:
                others.append(entry)
                self._goal(entry, wanted)
        if others and wanted.words:
            others[0].problem(None, "a scene asks for a word or for other goals, not both")
        if not entries and not (scene.has("goal") and not scene.sound):
            scene.problem(
                None,
                "a scene needs at least one [[goal]]",
                'for example: [[goal]] colour = "blue", on = "table1"',
            )
        return wanted

    def _goal(self, entry: Entry, wanted: Wanted) -> None:
        about = self._objects(entry)
        if entry.has("any"):
            entry.refuse(KEYS, "belongs into one of the goals of `any`")
            choices = entry.inside("any")
            if not choices and entry.sound:
                entry.problem("any", "is empty")
            for index in about:
                found = [self._single(choice, index) for choice in choices]
                goals = tuple(goal for goal in found if goal is not None)
                if len(goals) == len(found) and goals:
                    self._add(entry, index, AnyGoal(goals), wanted)
            return
        before = entry.sound
        for index in about:
            goal = self._single(entry, index)
            if goal is not None:
                self._add(entry, index, goal, wanted)
            elif before:
                return  # the same is wrong for every object of the colour
        if not about:
            self._ask(entry)

    def _ask(self, entry: Entry) -> None:
        """Keys that are right in themselves, though it is not known for what object."""
        for key in KEYS:
            entry.has(key)

    def _add(self, entry: Entry, index: int, goal: Goal, wanted: Wanted) -> None:
        if index in wanted.goals:
            entry.problem(
                None,
                f"{self.drawn[index].name!r} has two goals",
                "`any = [{...}, {...}]` says that one of several will do",
            )
        wanted.goals[index] = goal

    def _objects(self, entry: Entry) -> list[int]:
        """The objects that a goal is about."""
        if entry.has("object"):
            entry.refuse(["colour"], "a goal is for an `object` or for a `colour`, not both")
            name = entry.text("object")
            if name and name not in self.by_name:
                names = [thing.name for thing in self.drawn]
                hint = known("objects", name, names)
                entry.problem("object", f"there is no object named {name!r}", hint)
            return [self.by_name[name]] if name in self.by_name else []
        if not entry.has("colour"):
            entry.problem(None, "a goal is for an `object` or for all of a `colour`")
            return []
        colour = entry.text("colour")
        found = [i for i, thing in enumerate(self.drawn) if thing.colour == colour]
        if not found and colour:
            colours = [thing.colour for thing in self.drawn if thing.colour is not None]
            entry.problem("colour", f"no object is {colour!r}", known("colours", colour, colours))
        return found

    def _single(self, entry: Entry, index: int) -> SingleGoal | None:
        """What is wanted of one object, or None with a problem."""
        if entry.has("held"):
            entry.refuse(("on", "at", "yaw", "tolerance"), "an object that is held is nowhere else")
            if not entry.flag("held", True):
                entry.problem("held", "held = false asks for nothing")
            return HeldGoal() if entry.sound else None
        if not entry.has("on") and not entry.has("at"):
            entry.problem(None, "a goal says `on` what or `at` which point, or `held = true`")
            return None
        return self._region(entry, index) if not entry.has("at") else self._pose(entry, index)

    def _region(self, entry: Entry, index: int) -> RegionGoal | None:
        entry.refuse(["tolerance", "yaw"], "only goals with `at` have one")
        names = entry.names("on")
        if len(names) > 1:
            entry.problem("on", "only a goal with `at` can rest on several things")
        bearers = self._bearers(entry, names, index)
        return RegionGoal(bearers[0]) if bearers and entry.sound else None

    def _bearers(self, entry: Entry, names: Sequence[str], index: int) -> list[int]:
        """The supports of some names; fewer, with problems, where there are none."""
        found = []
        for name in names:
            if name == self.drawn[index].name:
                entry.problem("on", f"{name!r} cannot rest on itself")
                continue
            support = support_named(entry, "on", name, self.placed, self.by_name)
            thing = self.placed.objects[index]
            if support is None:
                continue
            if thing is not None and thing.only_on is not None and support not in thing.only_on:
                entry.problem("on", f"{thing.name!r} may not rest on {name!r}: see its `only_on`")
            found.append(support)
        return found

    def _pose(self, entry: Entry, index: int) -> PoseGoal | None:
        tolerance = entry.positive("tolerance", DEFAULT_TOLERANCE)
        yaw = math.radians(entry.number("yaw")) if entry.has("yaw") else None
        names = entry.names("on") if entry.has("on") else []
        bearers = self._bearers(entry, names, index)
        if isinstance(entry.data["at"], str):
            return self._at_start(entry, index, bearers, yaw, tolerance)
        x, y = entry.numbers("at", 2)
        refuse_far(entry, "at", (x, y))
        if not entry.sound:
            return None
        if not bearers:
            found = self.placed.found_at(x, y)
            if isinstance(found, str):
                entry.problem("at", found, self.placed.nearest(x, y))
                return None
            bearers = [found]
        elif self.placed.supports[bearers[0]].owner in self.by_name:
            return self._on_object(entry, bearers, x, y, yaw, tolerance)
        elif len(bearers) == 1 and not contains(self.placed.world[bearers[0]], x, y):
            entry.problem("at", f"({x:g}, {y:g}) is not on {names[0]!r}")
            return None
        return PoseGoal(bearers[0], x, y, yaw, tolerance, tuple(bearers[1:]))

    def _on_object(
        self,
        entry: Entry,
        bearers: list[int],
        x: float,
        y: float,
        yaw: float | None,
        tolerance: float,
    ) -> PoseGoal | None:
        """On something that can be moved points are given from the middle of its top."""
        top = self.placed.supports[bearers[0]]
        if len(bearers) == 1 and (abs(x) > top.half[0] or abs(y) > top.half[1]):
            entry.problem(
                "at",
                f"({x:g}, {y:g}) is not on {top.name!r}",
                f"points on an object are given from the middle of its top, along its own axes: "
                f"{top.half[0]:.3g} and {top.half[1]:.3g} m at most",
            )
            return None
        return PoseGoal(bearers[0], x, y, yaw, tolerance, tuple(bearers[1:]))

    def _at_start(
        self, entry: Entry, index: int, bearers: list[int], yaw: float | None, tolerance: float
    ) -> PoseGoal | None:
        thing = self.placed.objects[index]
        if entry.data["at"] != "start":
            hint = known("there is", entry.data["at"], ["start"])
            entry.problem("at", 'expected a list of 2 numbers, or "start"', hint)
        elif bearers:
            entry.problem("on", "an object that is to be where it began is on what it was on")
        if thing is None or not entry.sound:
            return None
        start = thing.rests
        x, y = start.x, start.y
        here = self.placed.world[start.support]
        if here.owner in self.by_name:
            x, y = point_in(here, x, y)
        return PoseGoal(start.support, x, y, yaw, tolerance, start.others)

    def _word(self, entry: Entry) -> WordGoal | None:
        word, pitch = entry.text("word"), entry.positive("pitch")
        tolerance = entry.positive("tolerance", DEFAULT_TOLERANCE)
        letters = [thing.letter for thing in self.drawn if thing.letter is not None]
        missing = sorted({c for c in word if letters.count(c) < word.count(c)})
        if missing:
            entry.problem(
                "word",
                f"not enough blocks with the letters {', '.join(missing)} for {word!r}",
                f"the blocks have the letters {''.join(sorted(letters))}"
                if letters
                else 'blocks need `letter = "A"`',
            )
        name = entry.text("on")
        found = support_named(entry, "on", name, self.placed, self.by_name) if name else None
        blocks = [thing for thing in self.placed.objects if thing and thing.letter in set(word)]
        if found is None or not entry.sound or not blocks:
            return None
        depth = max(thing.size[0] for thing in blocks)
        if pitch < depth:
            entry.problem("pitch", f"blocks of {depth:g} m do not fit a pitch of {pitch:g} m")
        if pitch * (len(word) - 1) + depth > 2 * max(self.placed.supports[found].half):
            entry.problem("word", f"{word!r} is longer than {name!r}")
        return WordGoal(word, found, pitch, tolerance)
