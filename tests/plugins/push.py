"""Pushes for the tabletop domain: what is too wide for the gripper can still be moved."""

import math
from typing import NamedTuple

import numpy as np

from domains.tabletop import Object
from domains.tabletop import domain as tabletop
from domains.tabletop.actions.actions import MoveBase
from domains.tabletop.actions.executability import within_reach
from domains.tabletop.actions.reach import held_parts
from domains.tabletop.features.functions import arrangement, misplaced
from domains.tabletop.hand import APPROACH
from domains.tabletop.sampling.bases import BaseSampler
from domains.tabletop.state import SIDE, Grasp, Placement
from runtime.motion.motion import ArmMove, Carried, GripperMove
from runtime.search.problem import Rejection
from runtime.world.poses import compose, upright
from runtime.world.quaternions import pose_of
from sketchlang.domain import Domain

domain = Domain.extend(tabletop)

CLOSED = 0.01  # metres between the fingers
AIR = 0.002  # metres between the fingers and what they push, as things rest on tables
HEIGHT = 0.12  # metres above the bottom at which tall things are pushed, at most
SIDES = [k * math.pi / 2 for k in range(4)]
BASES = 6


@domain.function
def beside(state, o: Object) -> bool:
    """Whether the robot stands within 0.9 m of an object."""
    at = state.world.rests(state.placements, o)
    x, y, _ = state.base.pose
    return at is not None and math.hypot(at[0] - x, at[1] - y) < 0.9


class Push(NamedTuple):
    """Push an object straight on: a heading in its own frame (radians), and metres."""

    object: int
    side: float
    distance: float
    name: str = "push"

    def target(self, state):
        """Where the object ends."""
        x, y, yaw = state.placements[self.object].pose
        heading = yaw + self.side
        x, y = x + self.distance * math.cos(heading), y + self.distance * math.sin(heading)
        return Placement.of(x, y, yaw, state.placements[self.object].support)

    def touch(self, world):
        """Where the hand is when the fingers are at the object, as if it were a grasp."""
        item = world.items[self.object]
        height = min(HEIGHT, 0.6 * item.size[2])
        outline = np.vstack(item.section(0.0, item.size[2]))
        forward = outline @ [math.cos(self.side), math.sin(self.side)]
        across = outline @ [-math.sin(self.side), math.cos(self.side)]
        face = across[forward < forward.min() + 1e-4]
        middle = item.centre[:2] @ [-math.sin(self.side), math.cos(self.side)]
        if not face.min() + 0.01 < middle < face.max() - 0.01:
            return None  # no flat side: it would turn, or roll away
        return Grasp.of(self.side, height, family=SIDE, along=forward.min(), aside=middle)

    def after(self, state):
        return state.placed(self.object, self.target(state))

    def motion(self, executor, state, seeds):
        world, item = executor.world, executor.world.items[self.object]
        arm = executor.arm(state, seeds, self)
        # The tool frame when the fingers are just short of the object, in its own frame.
        tool = self.touch(world).tool
        tool[:, 3] -= (arm.ahead(CLOSED) + AIR) * tool[:, 0]
        standing = upright(*world.rests(state.placements, self.object))
        start = compose(standing, tool)
        ahead = start[:, 0]
        end = start.copy()
        end[:, 3] += self.distance * ahead
        before = arm.among(CLOSED)
        pushing = arm.among(CLOSED, held_parts(item, tool), without={self.object})
        after = executor.arm(self.after(state), seeds, self).among(CLOSED)
        for q in arm.postures(before, start):
            out = arm.line(start, -APPROACH * ahead, q)
            along = arm.line(start, self.distance * ahead, q)
            back = None if along is None else arm.line(end, -APPROACH * ahead, along[-1])
            if out is None or back is None:
                continue
            if not (
                arm.is_free(before, out)
                and arm.is_free(pushing, along)
                and arm.is_free(after, back)
            ):
                continue
            come = arm.way(before, world.robot.home, out[-1])
            leave = arm.way(after, back[-1], world.robot.home)
            if come is None or leave is None:
                break
            poses = []
            for share in np.linspace(0.0, 1.0, len(along)):
                moved = standing.copy()
                moved[:, 3] += share * self.distance * ahead
                poses.append(pose_of(compose(moved, item.standing)))
            return (
                GripperMove(CLOSED),
                ArmMove(come, "free"),
                ArmMove(out[::-1].copy(), "approach"),
                ArmMove(along, "push", (Carried(item.name, np.array(poses)),)),
                ArmMove(back, "retreat"),
                ArmMove(leave, "free"),
            )
        return Rejection("motion_plan", item.name)

    def text(self, world):
        return f"push {world.items[self.object].name} by {self.distance:.2f} m"

    def arguments(self, world):
        return {
            "object": world.items[self.object].name,
            "side": self.side,
            "distance": self.distance,
        }


@domain.action
class Pushes:
    """Pushes of misplaced objects towards their goals, and places to push them from."""

    def sample(self, state, attempt, rng):
        world = state.world
        here = arrangement(world, state.placements)
        bases = BaseSampler(world)
        for index in sorted(misplaced(state)):
            goal, placement = world.goal_sites(index, here), state.placements[index]
            if placement is None or goal is None or goal.support != placement.support:
                continue
            x, y, yaw = placement.pose
            way = goal.xy[np.hypot(*(goal.xy - [x, y]).T).argmin()] - [x, y]
            for side in SIDES:
                distance = way @ [math.cos(yaw + side), math.sin(yaw + side)]
                push = Push(index, side, float(distance))
                grasp = push.touch(world)
                if distance < 0.005 or grasp is None:
                    continue
                yield push
                for _ in range(BASES * 2**attempt):
                    base = bases.pose_for(state, index, placement, grasp, rng)
                    if base is not None:
                        yield MoveBase(base)

    def applicable(self, state, action):
        if isinstance(action, MoveBase):
            return state.base != action.target
        world, placement = state.world, state.placements[action.object]
        if placement is None or state.held is not None:
            return False
        if world.riders(state.placements, action.object):
            return False
        target, grasp = action.target(state), action.touch(world)
        radius = world.items[action.object].outer_radius
        stays = world.grounds[placement.support].contains(*target.pose[:2], radius)
        wanted = [(action.object, p, grasp) for p in (placement, target)]
        return stays and bool(within_reach(world, state, state.base, wanted).all())
