"""KinDER as a process of its own, spoken to by JSON lines over pipes."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from domains.tabletop.kinder.observed import Observation
from sketchlang.errors import InputError

CHILD = Path(__file__).with_name("child.py")

OURS = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV")
"""What says where our Python finds its modules, and must not say it to another one."""

HINT = "`make kinder` sets it up; --python names the interpreter of another environment"


class KinderProcess:
    """One environment of KinDER at a time; ends with the `with` that it is used in.

    Raises, wherever something is asked:
        InputError: the process cannot be started, or does not answer.
    """

    def __init__(self, python: Path) -> None:
        self.python = python
        self._said = tempfile.TemporaryFile()  # noqa: SIM115  (closed with the process)
        try:
            # The interpreter of a virtual environment is a link: it must not be followed.
            self._process = subprocess.Popen(
                [str(python.absolute()), "-u", str(CHILD)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._said,
                env={name: os.environ[name] for name in os.environ if name not in OURS},
                text=True,
                encoding="utf-8",
            )
        except OSError as error:
            self._said.close()
            raise InputError(
                f"KinDER's Python cannot be started: {error.strerror}",
                place=str(python),
                hint=HINT,
            ) from None

    def __enter__(self) -> KinderProcess:
        return self

    def __exit__(self, *_: object) -> None:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        with suppress(BrokenPipeError):  # it may have ended before it read everything
            self._process.stdin.close()
        try:
            self._process.wait(5)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._process.stdout.close()
        self._said.close()

    def assets(self) -> Path:
        """The folder with the URDFs of its robots."""
        return Path(self._asked({"assets": True})["assets"])

    def reset(self, env: str, seed: int) -> Observation:
        """Begin an episode of an environment."""
        return Observation.of(self._asked({"env": env, "seed": seed}))

    def step(self, action: Sequence[float]) -> Observation:
        """One step: base x, y and heading, seven joints, gripper."""
        return Observation.of(self._asked({"action": [float(value) for value in action]}))

    def _asked(self, question: dict[str, Any]) -> dict[str, Any]:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write(json.dumps(question) + "\n")
            self._process.stdin.flush()
            line = self._process.stdout.readline()
        except OSError:
            line = ""
        if not line:
            raise InputError(
                f"KinDER ended without an answer: {self._last_words()}",
                place=str(self.python),
                hint=HINT,
            )
        answer: dict[str, Any] = json.loads(line)
        if "error" in answer:
            raise InputError(f"KinDER: {answer['error']}", place=str(self.python))
        return answer

    def _last_words(self) -> str:
        self._process.wait(10)
        self._said.seek(0)
        lines = self._said.read().decode("utf-8", "replace").strip().splitlines()
        return lines[-1] if lines else f"exit status {self._process.returncode}"
