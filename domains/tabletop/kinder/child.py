"""The other side of the pipes: KinDER's environments, told what to do by JSON lines on stdin.

This file is run by the Python of KinDER's own environment and imports nothing of ours:

    {"env": "Table3D-o1", "seed": 0}    resets: {"limit": ..., "state": ..., "terminated": false}
    {"action": [11 numbers]}            steps once: the same without "limit"
    {"assets": true}                    {"assets": "FOLDER"} with the URDFs of its robots

What goes wrong in an environment is {"error": "..."}. The process ends with stdin.
"""

import json
import os
import sys
from typing import Any


def main() -> None:
    """Answer until there is nothing more to answer."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8", buffering=1)
    os.dup2(2, 1)  # the simulator prints to stdout
    environments = Environments()
    for line in sys.stdin:
        try:
            answer = environments.answer(json.loads(line))
        except Exception as error:  # whatever it is, the other side says it
            answer = {"error": f"{type(error).__name__}: {error}"}
        answers.write(json.dumps(answer) + "\n")


class Environments:
    """One environment at a time; making one takes seconds, and so it is kept for other seeds."""

    def __init__(self) -> None:
        self.name = ""
        self.env: Any = None

    def answer(self, asked: dict[str, Any]) -> dict[str, Any]:
        """The answer to one line."""
        if "assets" in asked:
            from pybullet_helpers.utils import get_assets_path  # type: ignore[import-not-found]

            return {"assets": str(get_assets_path() / "urdf")}
        if "env" in asked:
            self._open(asked["env"])
            observed, _ = self.env.reset(seed=asked["seed"])
            limit = float(self.env.action_space.high[0])
            return {"limit": limit, "state": self._state(observed), "terminated": False}
        import numpy

        action = numpy.array(asked["action"], dtype=numpy.float32)
        observed, _, terminated, _, _ = self.env.step(action)
        return {"state": self._state(observed), "terminated": bool(terminated)}

    def _open(self, name: str) -> None:
        import kinder  # type: ignore[import-not-found]

        if self.name == name:
            return
        if self.env is None:
            kinder.register_all_environments()
        else:
            self.env.close()
        self.name = ""
        self.env = kinder.make(f"kinder/{name}-v0")
        self.name = name

    def _state(self, observed: Any) -> dict[str, dict[str, Any]]:
        """Of every object its type and its features by name, in the order of the observation."""
        state = self.env.observation_space.devectorize(observed)
        found = {}
        for thing, values in state.data.items():
            features = dict(zip(state.type_features[thing.type], map(float, values), strict=True))
            found[thing.name] = {"type": thing.type.name, **features}
        return found


if __name__ == "__main__":
    main()
