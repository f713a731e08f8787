"""One run of a benchmark: everything that its result depends on."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

Result = dict[str, Any]
"""What came of a run, as stores keep it: the object that `run --json` prints, and the job."""


@dataclass(frozen=True, order=True)
class Versions:
    """Digests of the contents of what a run reads: it is another run when one of them changes."""

    sketch: str = ""
    scene: str = ""
    robot: str = ""
    tool: str = ""


@dataclass(frozen=True, order=True)
class Job:
    """One planning. Names are as a suite writes them; `folder` is where paths among them start,
    and no part of what makes a run the same. An empty robot is the domain's own, and an empty
    domain file the one that the sketch names."""

    sketch: str
    scene: str
    planner: str
    seed: int
    timeout: float
    robot: str = ""
    k_max: int = 2
    domain: str = ""
    versions: Versions = Versions()
    folder: str = field(default="", compare=False)

    def located(self, name: str) -> str:
        """The path of a name of this job, where it is one; else the name of what comes along."""
        return located(self.folder, name)

    @property
    def digest(self) -> str:
        """A short text that no other job has."""
        text = json.dumps(as_data(self), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:24]


def located(folder: str, name: str) -> str:
    """The path of a name that starts from a folder, if there is such a file; else the name."""
    path = Path(folder) / name
    try:
        # A folder of tasks bears the name of its domain's sketch, and is none.
        return str(path) if name and path.is_file() else name
    except (OSError, ValueError):  # a name that is too long, or has a NUL
        return name


KEYS = tuple(f.name for f in fields(Job) if f.compare)
"""What of a job is its key, and stands in stores."""


def as_data(job: Job) -> dict[str, Any]:
    """A job as plain data."""
    data = asdict(job)
    return {key: data[key] for key in KEYS}


def job_of(data: Mapping[str, Any], folder: str = "") -> Job:
    """The job of plain data, whose paths start from a folder."""
    return Job(**{**data, "versions": Versions(**data["versions"])}, folder=folder)


def key(result: Result) -> Job:
    """The job that a result belongs to."""
    return job_of(result["job"])


def new_result(job: Job, values: Result) -> Result:
    """A result as stores have them: what was found, with the job."""
    return values | {"job": as_data(job)}
