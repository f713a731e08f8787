"""Goals through a rosbridge server (ROS 2), by the package roslibpy, which only this file needs."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from typing import Any
from urllib.parse import urlsplit

from runtime.export.goals import Goal
from runtime.export.send import Answer
from sketchlang.errors import InputError
from sketchlang.escape import visible

SUCCEEDED = 4
"""Of `action_msgs/msg/GoalStatus`."""

STATUS = {
    0: "unknown",
    1: "accepted",
    2: "executing",
    3: "cancelling",
    5: "cancelled",
    6: "aborted",
}

CLOSING = 2.0
"""Seconds that the server may take to say goodbye."""

JOINT_STATES = "/joint_states"


def check_rosbridge(url: str) -> None:
    """Find out before the work whether there can be a connection.

    Raises:
        InputError: that is no address, or the package roslibpy is missing.
    """
    if find_spec("roslibpy") is None:
        raise InputError("this needs the package roslibpy", hint="install sketchlang[ros]")
    try:
        parts = urlsplit(url)
        good = parts.scheme in ("ws", "wss") and parts.hostname and (parts.port or 1)
    except ValueError:
        good = False
    if not good:
        raise InputError(
            f"{url!r} is no address of a rosbridge server", hint="such as ws://robot:9090"
        )


class RosBridge:
    """A connection to a rosbridge server.

    Raises:
        InputError: nobody answers there in time.
    """

    def __init__(self, url: str, timeout: float = 10.0) -> None:
        check_rosbridge(url)
        import roslibpy

        # It tells of what goes wrong with tracebacks; here that is an answer.
        logging.getLogger("roslibpy").addHandler(logging.NullHandler())
        logging.getLogger("roslibpy").propagate = False
        self._library = roslibpy
        self._lock = threading.Lock()
        self._waiting: dict[str, Callable[[Answer], None]] = {}
        self._clients: dict[str, Any] = {}
        parts = urlsplit(url)
        secure = parts.scheme == "wss"
        port = parts.port or (443 if secure else 9090)
        self._ros = roslibpy.Ros(parts.hostname, port, is_secure=secure)
        try:
            self._ros.run(timeout=timeout)
        except Exception as error:
            self._ros.factory.stopTrying()
            raise InputError(
                f"no rosbridge server answers within {timeout:g} s",
                place=url,
                hint="ros2 launch rosbridge_server rosbridge_websocket_launch.xml",
            ) from error
        self._ros.factory.on_ready(self._listen)
        self._ros.on("close", lambda *_: self._fail_all("the connection was lost"))

    def __enter__(self) -> RosBridge:
        return self

    def __exit__(self, *_: object) -> None:
        self._ros.factory.stopTrying()
        if self._ros.is_connected:
            closed = threading.Event()
            self._ros.on("close", lambda *_: closed.set())
            self._ros.close()
            closed.wait(CLOSING)

    def _listen(self, proto: Any) -> None:
        # roslibpy has no handler for what the server says of requests that it refuses.
        proto._message_handlers["status"] = self._status

    def _status(self, message: Mapping[str, Any]) -> None:
        if message.get("level") == "error":
            self._fail_all(visible(str(message.get("msg"))))

    def _fail_all(self, reason: str) -> None:
        with self._lock:
            waiting, self._waiting = list(self._waiting.values()), {}
        for answered in waiting:
            answered(Answer(False, reason))

    def send(self, goal: Goal, answered: Callable[[Answer], None]) -> Callable[[], None]:
        """Send a goal to the action of its controller."""
        if not self._ros.is_connected:
            answered(Answer(False, "the connection was lost"))
            return lambda: None
        action = goal.controller.action
        client = self._clients.get(action)
        if client is None:
            client = self._library.ActionClient(self._ros, action, goal.type)
            self._clients[action] = client
        key = f"{action} {id(answered)}"

        def once(answer: Answer) -> None:
            with self._lock:
                waits = self._waiting.pop(key, None)
            if waits is not None:
                waits(answer)

        with self._lock:
            self._waiting[key] = answered
        number = client.send_goal(
            self._library.Goal(goal.message),
            lambda result: once(answer_of(result)),
            lambda _: None,
            lambda result: once(answer_of(result)),
        )
        return lambda: client.cancel_goal(number)

    def joint_values(self, timeout: float) -> Mapping[str, float] | None:
        """Where the robot's joints are, from `/joint_states`; messages may hold some of them, so
        it listens until the timeout or until all that were seen came again."""
        found: dict[str, float] = {}
        again = threading.Event()

        def heard(message: Mapping[str, Any]) -> None:
            names = message["name"]
            if names and set(names) <= set(found):
                again.set()
            found.update(zip(names, map(float, message["position"]), strict=False))

        topic = self._library.Topic(self._ros, JOINT_STATES, "sensor_msgs/msg/JointState")
        topic.subscribe(heard)
        again.wait(timeout)
        topic.unsubscribe()
        return found or None


def answer_of(result: Mapping[str, Any]) -> Answer:
    """What the result of an action means: its status has to be that it succeeded, and where it
    has an error code, as trajectories do, that has to be 0."""
    status = getattr(result.get("status"), "value", result.get("status"))
    values = result.get("values")
    if isinstance(values, Mapping) and isinstance(values.get("result"), Mapping):
        values = values["result"]
    said = ""
    if isinstance(values, Mapping):
        code = values.get("error_code", 0)
        said = str(values.get("error_string") or values.get("error_msg") or "")
        if code:
            return Answer(False, visible(said) or f"error {code}")
    elif values:
        said = str(values)
    if status == SUCCEEDED:
        return Answer(True)
    name = STATUS.get(status, str(status)) if isinstance(status, int) else str(status)
    return Answer(False, visible(f"{name}: {said}" if said else f"the goal was {name}"))
