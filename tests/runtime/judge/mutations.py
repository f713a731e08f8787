"""Ways to spoil a plan, or the world that it is of: by a little, or by much."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from runtime.world.body import Body, Part
from runtime.world.goals import RestsAt, RestsOn
from runtime.world.poses import compose, upright
from runtime.world.solids import Box
from runtime.world.world import Fixed, Support, World

Json = dict[str, Any]
Rng = np.random.Generator
Mutation = Callable[[Json, Rng], None]


def mutated(data: Json, number: int) -> tuple[str, Json]:
    """A plan spoilt in the way of a number, and the name of the way."""
    rng = np.random.default_rng(1000 + number)
    way = PLANS[number % len(PLANS)]
    spoilt = copy.deepcopy(data)
    way(spoilt, rng)
    return way.__name__, spoilt


def _pieces(data: Json, kind: str, key: str | None = None) -> list[Json]:
    found = [p for action in data["actions"] for p in action["pieces"] if p["type"] == kind]
    return [p for p in found if key is None or key in p]


def _one(entries: list[Any], rng: Rng) -> Any:
    return entries[int(rng.integers(len(entries)))]


def _size(rng: Rng, low: float, high: float) -> float:
    """A size between two, any order of magnitude as likely."""
    return float(np.exp(rng.uniform(math.log(low), math.log(high))))


def arm_way_point(data: Json, rng: Rng) -> None:
    path = _one([p for p in _pieces(data, "arm") if len(p["path"]) > 2], rng)["path"]
    row = path[int(rng.integers(1, len(path) - 1))]
    row[int(rng.integers(len(row)))] += float(rng.choice([-1, 1])) * _size(rng, 0.01, 1.0)


def arm_end(data: Json, rng: Rng) -> None:
    row = _one(_pieces(data, "arm"), rng)["path"][-1]
    row[int(rng.integers(len(row)))] += _size(rng, 0.002, 0.3)


def arm_faster(data: Json, rng: Rng) -> None:
    piece = _one(_pieces(data, "arm"), rng)
    piece["times"] = [t * float(rng.uniform(0.2, 0.9)) for t in piece["times"]]


def arm_jerked(data: Json, rng: Rng) -> None:
    """All of a motion at one speed: it starts and ends at full speed."""
    piece = _one([p for p in _pieces(data, "arm") if p["times"][-1] > 0.3], rng)
    steps = np.linalg.norm(np.diff(piece["path"], axis=0), axis=1)
    done = np.concatenate([[0.0], np.cumsum(steps)]) / max(steps.sum(), 1e-9)
    piece["times"] = (done * piece["times"][-1]).tolist()


def arm_hurries_at_the_end(data: Json, rng: Rng) -> None:
    piece = _one([p for p in _pieces(data, "arm") if len(p["times"]) > 3], rng)
    piece["times"][-1] = piece["times"][-2] + 0.1 * (piece["times"][-1] - piece["times"][-2])


def arm_short_of_way_points(data: Json, rng: Rng) -> None:
    """Straight from the first to the last way point."""
    piece = _one([p for p in _pieces(data, "arm") if len(p["path"]) > 3], rng)
    piece["path"] = [piece["path"][0], piece["path"][-1]]
    piece["times"] = [0.0, piece["times"][-1] * 4]


def base_way_point(data: Json, rng: Rng) -> None:
    pose = _one(_one(_pieces(data, "base"), rng)["poses"], rng)
    pose[int(rng.integers(3))] += float(rng.choice([-1, 1])) * _size(rng, 0.002, 1.0)


def base_faster(data: Json, rng: Rng) -> None:
    piece = _one(_pieces(data, "base"), rng)
    piece["times"] = [t * float(rng.uniform(0.3, 0.9)) for t in piece["times"]]


def base_turn_at_mean_speed(data: Json, rng: Rng) -> None:
    """A turn in the time that full speed takes, without speeding up or slowing down."""
    turns = [
        (p, i)
        for p in _pieces(data, "base")
        for i in range(len(p["poses"]) - 1)
        if abs(p["poses"][i + 1][2] - p["poses"][i][2]) > 0.3
    ]
    piece, i = _one(turns, rng)
    seconds = abs(piece["poses"][i + 1][2] - piece["poses"][i][2]) / 1.2
    spared = piece["times"][i + 1] - piece["times"][i] - seconds
    piece["times"] = [t if k <= i else t - spared for k, t in enumerate(piece["times"])]


def base_arc(data: Json, rng: Rng) -> None:
    """Turns while it drives."""
    piece = _one(_pieces(data, "base"), rng)
    i = int(rng.integers(len(piece["poses"]) - 1))
    a, b = np.array(piece["poses"][i]), np.array(piece["poses"][i + 1])
    piece["poses"].insert(i + 1, ((a + b) / 2 + [0.01, 0.01, 0.2]).tolist())
    half = (piece["times"][i] + piece["times"][i + 1]) / 2
    piece["times"] = [*piece["times"][: i + 1], half, *(t + 9 for t in piece["times"][i + 1 :])]


def fingers_at_once(data: Json, rng: Rng) -> None:
    piece = _one(_pieces(data, "gripper"), rng)
    piece["times"] = [0.0, float(rng.choice([0.0, 0.02, 0.1]))]


def opening(data: Json, rng: Rng) -> None:
    _one(_pieces(data, "gripper"), rng)["opening"] += float(rng.choice([-1, 1])) * _size(
        rng, 0.001, 0.05
    )


def release_pose(data: Json, rng: Rng) -> None:
    pose = _one(_pieces(data, "gripper", "release"), rng)["release"]["pose"]
    pose[int(rng.integers(3))] += float(rng.choice([-1, 1])) * _size(rng, 0.002, 0.1)


def release_turn(data: Json, rng: Rng) -> None:
    pose = _one(_pieces(data, "gripper", "release"), rng)["release"]["pose"]
    turn = 2 * math.atan2(pose[5], pose[6]) + _size(rng, 0.02, 2.0)
    pose[3:] = [0.0, 0.0, math.sin(turn / 2), math.cos(turn / 2)]


def release_support(data: Json, rng: Rng) -> None:
    release = _one(_pieces(data, "gripper", "release"), rng)["release"]
    release["on"] = str(rng.choice(["table9", "floor", "moon"]))


def attach_other(data: Json, rng: Rng) -> None:
    attach = _one(_pieces(data, "gripper", "attach"), rng)["attach"]
    attach["body"] = next(name for name in data["objects"] if name != attach["body"])


def never_attached(data: Json, rng: Rng) -> None:
    del _one(_pieces(data, "gripper", "attach"), rng)["attach"]


def never_released(data: Json, rng: Rng) -> None:
    del _one(_pieces(data, "gripper", "release"), rng)["release"]


def piece_missing(data: Json, rng: Rng) -> None:
    action = _one([a for a in data["actions"] if len(a["pieces"]) > 1], rng)
    action["pieces"].pop(int(rng.integers(len(action["pieces"]))))


def last_motion_missing(data: Json, rng: Rng) -> None:
    """The arm does not come home at the end."""
    data["actions"][-1]["pieces"].pop()


def pieces_swapped(data: Json, rng: Rng) -> None:
    pieces = _one([a for a in data["actions"] if len(a["pieces"]) > 2], rng)["pieces"]
    i = int(rng.integers(len(pieces) - 1))
    pieces[i], pieces[i + 1] = pieces[i + 1], pieces[i]


def action_missing(data: Json, rng: Rng) -> None:
    data["actions"].pop(int(rng.integers(len(data["actions"]))))


def action_missing_quietly(data: Json, rng: Rng) -> None:
    gone = data["actions"].pop(int(rng.integers(len(data["actions"]))))
    data["subgoals"][gone["subgoal"]]["actions"] -= 1


def actions_swapped(data: Json, rng: Rng) -> None:
    i = int(rng.integers(len(data["actions"]) - 1))
    actions = data["actions"]
    actions[i], actions[i + 1] = actions[i + 1], actions[i]


def digest(data: Json, rng: Rng) -> None:
    data[str(rng.choice(["scene", "robot"]))]["digest"] = "0" * 64


def start(data: Json, rng: Rng) -> None:
    data["base_start"][int(rng.integers(3))] += _size(rng, 0.002, 1.0)


def names(data: Json, rng: Rng) -> None:
    if rng.random() < 0.5:
        data["objects"].reverse()
    else:
        data["robot"]["joints"].reverse()


def features(data: Json, rng: Rng) -> None:
    subgoal = _one(data["subgoals"], rng)
    values = subgoal[str(rng.choice(["before", "after"]))]
    values[str(rng.choice(sorted(values)))] += 1


PLANS: list[Mutation] = [
    arm_way_point,
    arm_end,
    arm_faster,
    arm_jerked,
    arm_hurries_at_the_end,
    arm_short_of_way_points,
    base_way_point,
    base_faster,
    base_turn_at_mean_speed,
    base_arc,
    fingers_at_once,
    opening,
    release_pose,
    release_turn,
    release_support,
    attach_other,
    never_attached,
    never_released,
    piece_missing,
    last_motion_missing,
    pieces_swapped,
    action_missing,
    action_missing_quietly,
    actions_swapped,
    digest,
    start,
    names,
    features,
]


# -- worlds ------------------------------------------------------------------------------------


def spoilt(world: World, number: int) -> tuple[str, World]:
    """A world changed in the way of a number, under the digest that it had."""
    rng = np.random.default_rng(2000 + number)
    way = WORLDS[number % len(WORLDS)]
    return way.__name__, way(world, rng)


def thing_moved(world: World, rng: Rng) -> World:
    i = int(rng.integers(len(world.movables)))
    x, y = rng.normal(size=2) * _size(rng, 0.001, 0.2)
    turn = float(rng.normal() * _size(rng, 0.01, 0.5))
    thing = world.movables[i]
    pose = compose(thing.pose, upright(x, y, 0.0, turn))
    things = (*world.movables[:i], replace(thing, pose=pose), *world.movables[i + 1 :])
    return replace(world, movables=things)


def thing_of_another_size(world: World, rng: Rng) -> World:
    i = int(rng.integers(len(world.movables)))
    thing = world.movables[i]
    part = thing.body.parts[0]
    assert isinstance(part.solid, Box)
    a, b, c = (s + float(rng.normal() * _size(rng, 0.001, 0.03)) for s in part.solid.size)
    size = max(0.01, a), max(0.01, b), max(0.05, c)
    body = Body((Part(Box(size), upright(0, 0, size[2] / 2, 0)),), 0.1, (0.0, 0.0, size[2] / 2))
    things = (*world.movables[:i], replace(thing, body=body), *world.movables[i + 1 :])
    return replace(world, movables=things)


def furniture_moved(world: World, rng: Rng) -> World:
    i = int(rng.integers(len(world.fixed)))
    thing, step = world.fixed[i], rng.normal(size=2) * _size(rng, 0.01, 0.3)
    pose = compose(thing.pose, upright(*step, 0.0, 0.0))
    fixed = (*world.fixed[:i], replace(thing, pose=pose), *world.fixed[i + 1 :])
    return replace(world, fixed=fixed)


def something_in_the_way(world: World, rng: Rng) -> World:
    half = _size(rng, 0.01, 0.3)
    x, y = rng.uniform(-1.5, 1.5, 2)
    body = Body((Part(Box((half, half, 2.0)), upright(0, 0, 1.0, 0)),), 0.0, (0.0, 0.0, 1.0))
    return replace(world, fixed=(*world.fixed, Fixed("post", body, upright(x, y, 0.0, 0.0))))


def support_smaller(world: World, rng: Rng) -> World:
    factor = float(rng.uniform(0.1, 0.9))
    return replace(world, supports=tuple(_shrunk(s, factor) for s in world.supports))


def _shrunk(support: Support, factor: float) -> Support:
    return replace(support, half=(support.half[0] * factor, support.half[1] * factor))


def support_at_another_height(world: World, rng: Rng) -> World:
    height = float(rng.choice([-1, 1])) * _size(rng, 0.003, 0.2)
    lifted = tuple(
        replace(s, pose=compose(upright(0, 0, height, 0), s.pose)) for s in world.supports
    )
    return replace(world, supports=lifted)


def other_goal(world: World, rng: Rng) -> World:
    i = int(rng.integers(len(world.goals)))
    goal = world.goals[i]
    supports = [s.name for s in world.supports]
    if isinstance(goal, RestsOn):
        goal = replace(goal, support=str(rng.choice(supports)))
    elif isinstance(goal, RestsAt):
        goal = replace(goal, x=goal.x + _size(rng, 0.005, 0.5))
    return replace(world, goals=(*world.goals[:i], goal, *world.goals[i + 1 :]))


def robot_elsewhere(world: World, rng: Rng) -> World:
    x, y, yaw = world.robot_start
    return replace(world, robot_start=(x + _size(rng, 0.002, 1.0), y, yaw))


def another_version(world: World, rng: Rng) -> World:
    return replace(world, digest="f" * 64)


WORLDS: list[Callable[[World, Rng], World]] = [
    thing_moved,
    thing_of_another_size,
    furniture_moved,
    something_in_the_way,
    support_smaller,
    support_at_another_height,
    other_goal,
    robot_elsewhere,
    another_version,
    thing_moved,
]
