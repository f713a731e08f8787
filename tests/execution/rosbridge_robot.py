"""A robot behind a rosbridge server, without time: goals are reached at once.

It speaks the protocol's part for ROS 2 actions and for `/joint_states`, refuses goals that name
other joints than those of the controller or that do not begin where the joints are, and can be
told to fail.
"""

from __future__ import annotations

import json
import threading
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from websockets.exceptions import ConnectionClosed
from websockets.sync.server import Server, ServerConnection, serve

from runtime.export.goals import TYPES
from runtime.export.messages import track_of
from runtime.robot.controllers import Controller

SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
JUMP = 1e-3


@dataclass
class Robot:
    """`values` of the joints, where the `base` is, and the `goals` that were carried out, as
    (action, message). Of the goals with the numbers `together`, which are sent at once, the one
    number `fails` fails half way, once, and the others are then moving still."""

    controllers: tuple[Controller, ...]
    values: dict[str, float]
    base: tuple[float, float] | None = None
    together: range = range(0)
    fails: int = -1
    held: list[dict[str, Any]] = field(default_factory=list)
    goals: list[tuple[str, dict[str, Any]]] = field(default_factory=list)
    cancelled: list[str] = field(default_factory=list)
    lock: Any = field(default_factory=threading.Lock)

    def serve(self) -> Server:
        """A server on a free port of this machine."""
        server = serve(self._talk, "127.0.0.1", 0)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        return server

    def _talk(self, connection: ServerConnection) -> None:
        with suppress(ConnectionClosed):
            self._listen(connection)

    def _listen(self, connection: ServerConnection) -> None:
        for text in connection:
            message = json.loads(text)
            match message["op"]:
                case "send_action_goal":
                    with self.lock:
                        answered, *answer = self._goal(message)
                    if answered is not None:
                        connection.send(json.dumps(_result(answered, *answer)))
                case "cancel_action_goal":
                    self.cancelled.append(message["action"])
                    connection.send(json.dumps(_result(message, CANCELED, {})))
                case "subscribe":
                    half = len(self.values) // 2
                    names = list(self.values)
                    # In two parts, as robots with several sources do, and again and again.
                    for part in (names[:half], names[half:]) * 3:
                        state = {"name": part, "position": [self.values[n] for n in part]}
                        told = {"op": "publish", "topic": message["topic"], "msg": state}
                        connection.send(json.dumps(told))

    def _goal(self, message: dict[str, Any]) -> tuple[dict[str, Any] | None, int, Any]:
        """A goal that has ended by now, if one has; its status, and the values of its result."""
        number = len(self.goals) + len(self.held)
        if number in self.together:
            self.held.append(message)
            if len(self.held) < len(self.together):
                return None, 0, None
            failed = self.held[self.fails - self.together.start]
            for each in self.held:
                self._carry_out(each, 0.4)
            self.together, self.held = range(0), []
            return failed, ABORTED, {"error_code": -4, "error_string": "path tolerance violated"}
        wrong = self._carry_out(message)
        if wrong:
            return message, ABORTED, {"error_code": -1, "error_string": wrong}
        self.goals.append((message["action"], message["args"]))
        return message, SUCCEEDED, {"error_code": 0, "error_string": ""}

    def _carry_out(self, message: dict[str, Any], share: float = 1.0) -> str | None:
        """Go to where a goal is after a share of its time; what is wrong with it."""
        action, goal = message["action"], message["args"]
        (controller,) = [c for c in self.controllers if c.action == action]
        if message["action_type"] != TYPES[controller.type]:
            return "another type"
        if controller.moves_base:
            poses = goal["path"]["poses"]
            last = poses[round(share * (len(poses) - 1))]["pose"]["position"]
            self.base = (last["x"], last["y"])
            return None
        if goal["trajectory"]["joint_names"] != list(controller.joints):
            return "other joints"
        track = track_of(goal["trajectory"])
        here = np.array([self.values[name] for name in controller.joints])
        if np.abs(track.values[0] - here).max() > JUMP:
            return "it would jump"
        there = track.at(np.array([share * float(track.times[-1])]))[0][0]
        self.values.update(zip(controller.joints, there.tolist(), strict=True))
        return None


def _result(message: dict[str, Any], status: int, values: Any) -> dict[str, Any]:
    return {
        "op": "action_result",
        "id": message["id"],
        "action": message["action"],
        "values": values,
        "status": status,
        "result": status == SUCCEEDED,
    }
