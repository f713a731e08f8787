"""What a name or a path stands for: domains, scenes, robots, sketches."""

from __future__ import annotations

import difflib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from runtime.robot.load import built_in_robots, load_robot, robot_path
from runtime.robot.picture import RobotPicture
from runtime.solve import opened
from sketchlang.domain import Domain, LoadOptions, Picture
from sketchlang.errors import InputError
from sketchlang.inspection.picture import DomainPicture, SketchPicture
from sketchlang.library import SCENES_OF, built_in_scenes, find_scene
from sketchlang.loader import (
    PDDL,
    SUFFIX,
    builtin_sketches,
    domain_names,
    given_domain,
    is_pddl_domain,
    load_builtin,
    load_domain,
    load_sketch,
    pddl_domain,
    pddl_domain_of,
)
from sketchlang.reading import read_text, read_toml

KINDS = ("domain", "scene", "robot", "sketch")


@dataclass(frozen=True)
class Found:
    """Something with its kind and its name."""

    kind: str
    name: str
    picture: Picture


def find(name: str, kind: str | None = None, domain: str | None = None) -> list[Found]:
    """All that a built-in name stands for, or the file of a path; `kind` keeps one of them.

    `domain` is that of a scene: a name, a Python file, or the PDDL domain of a task.

    Raises:
        InputError: there is nothing of that name, or something is wrong with a file.
        SceneError: a domain's own word about its scene.
    """
    if Path(name).is_file():
        wanted = kind or _kind_of(Path(name))
        return [_FINDERS[wanted](name, domain)]
    known = {
        "domain": domain_names(),
        "scene": built_in_scenes(),
        "robot": built_in_robots(),
        "sketch": builtin_sketches(),
    }
    kinds = [one for one in KINDS if name in known[one] and kind in (None, one)]
    if not kinds:
        names = sorted({one for key in known if kind in (None, key) for one in known[key]})
        close = difflib.get_close_matches(name, names, 1)
        hint = f"did you mean {close[0]!r}?" if close else "`sketchlang list` names all there is"
        what = kind or "domain, scene, robot or sketch"
        raise InputError(f"there is no {what} {name!r}, neither a file nor built in", hint=hint)
    return [_FINDERS[one](name, domain) for one in kinds]


def source_of(name: str, kind: str | None = None) -> str:
    """The text of the file that a name stands for: a scene, a sketch or a robot.

    Raises:
        InputError: there is no such file.
    """
    if Path(name).is_file():
        return read_text(Path(name))
    if kind in (None, "scene") and name in built_in_scenes():
        return read_text(find_scene(name)[0])
    if kind in (None, "sketch") and name in builtin_sketches():
        return load_builtin(name).text
    if kind in (None, "robot") and name in built_in_robots():
        return read_text(Path(robot_path(name)))
    what = kind or "scene, sketch or robot"
    raise InputError(f"there is no {what} {name!r}", hint="`sketchlang list` names all there is")


def _kind_of(path: Path) -> str:
    """What a file is, by its name and content.

    Raises:
        InputError: it is nothing of ours.
    """
    if path.suffix == SUFFIX:
        return "sketch"
    if path.suffix == ".py":
        return "domain"
    if path.suffix == PDDL:
        return "domain" if is_pddl_domain(str(path)) else "scene"
    if path.suffix == ".toml":
        return "robot" if "urdf" in read_toml(path) else "scene"
    raise InputError(
        "neither a domain, a scene, a robot nor a sketch",
        place=str(path),
        hint="their names end in .sketch, .toml, .pddl or .py; or say what it is with --as",
    )


def _domain(name: str, _domain: str | None) -> Found:
    if name.endswith(PDDL):
        domain = pddl_domain(name)
    elif name.endswith(".py"):
        domains, _ = given_domain(name)
        domain = next(iter(domains.values()))
    else:
        loaded = load_domain(name)
        if loaded is None:
            raise InputError(f"there is no domain {name!r}")
        domain = loaded
    return Found("domain", domain.name, DomainPicture(domain))


def _robot(name: str, _domain: str | None) -> Found:
    robot = load_robot(robot_path(name))
    return Found("robot", robot.name, RobotPicture(robot))


def _sketch(name: str, _domain: str | None) -> Found:
    loaded = load_sketch(name)
    if not loaded.ok:
        raise InputError(
            "the sketch has errors", place=name, hint=f"`sketchlang check {name}` tells them"
        )
    return Found("sketch", loaded.checked.model.name, SketchPicture(loaded))


def _scene(name: str, domain: str | None) -> Found:
    path, shown = find_scene(name)
    owner = _domain_of_scene(name, path, domain)
    if owner.draw is not None:
        return Found("scene", shown, owner.draw(str(path), shown))
    if owner.load is None:
        raise InputError(f"the domain {owner.name} has no scenes")
    problem, reporting = opened(owner.name, owner.load(str(path), LoadOptions(shown)))
    return Found("scene", shown, reporting.picture(problem.initial))


def _domain_of_scene(name: str, path: Path, given: str | None) -> Domain:
    """The domain that a scene is of: the one that is named, that of its folder among those that
    come along, the PDDL domain beside a task, or the one that most scenes are of."""
    if given is not None:
        if given.endswith(PDDL):
            return pddl_domain(given)
        if given.endswith(".py"):
            return next(iter(given_domain(given)[0].values()))
        found = load_domain(given)
        if found is None:
            hint = f"domains: {', '.join(domain_names())}"
            raise InputError(f"there is no domain {given!r}", hint=hint)
        return found
    if path.suffix == PDDL:
        return pddl_domain_of(str(path))
    folder = path.resolve().parent.parent.name
    found = load_domain(folder if folder in domain_names() else SCENES_OF)
    assert found is not None, "it comes along"
    return found


_FINDERS: dict[str, Callable[[str, str | None], Found]] = {
    "domain": _domain,
    "scene": _scene,
    "robot": _robot,
    "sketch": _sketch,
}
