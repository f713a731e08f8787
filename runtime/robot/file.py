"""A robot file (TOML) and the URDFs that it names, as they are written."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from runtime.robot.controllers import Controller, read_controllers
from runtime.robot.model import JERK, MobileBase
from runtime.robot.urdf import Urdf, read_urdf
from runtime.tables import Table, read_toml
from runtime.world.poses import Pose, rotation_from_rpy
from sketchlang.errors import InputError
from sketchlang.reading import read_bytes

BUILT_IN = Path(__file__).parent

FLOOR_LINK = "floor_under_base"
"""The root that a base above the floor gets, right below it."""

TOOL_LINK = "tool_frame"
"""The link that a tool frame gets which is not the frame of a link."""

BASE_TYPES = ("differential", "holonomic", "fixed")

OPENS = ("as needed", "fully")
"""How a gripper opens: to any width, or as far as it goes."""


@dataclass(frozen=True, eq=False)
class GripperFile:
    """The table `[gripper]`."""

    fingers: tuple[str, ...]
    links: tuple[str, ...]
    clearance: float
    time: float
    max_force: float | None
    max_torque: float | None
    payload: float | None
    opens_fully: bool = False


@dataclass(frozen=True, eq=False)
class RobotFile:
    """What a robot file says, and the URDF with all that it attaches, limits included.

    `joints` are the planning joints, or None for all that move between base and tool;
    `controllers` those that move the real robot, or None for the usual ones.
    """

    place: str
    name: str
    urdf: Urdf
    base_link: str
    tool_link: str
    joints: tuple[str, ...] | None
    acceleration: tuple[float, ...]
    jerk: tuple[float, ...]
    home: tuple[float, ...]
    ignored: tuple[tuple[str, str], ...]
    fixed: dict[str, float]
    limited: tuple[str, ...]
    gripper: GripperFile | None
    base: MobileBase | None
    digest: str
    controllers: tuple[Controller, ...] | None = None


def read_robot_file(path: Path) -> RobotFile:
    """Read a robot file and the URDFs that it names.

    Raises:
        InputError: one of them cannot be read, or keys or values that are none.
    """
    table = read_toml(path)
    sources = [path]
    main = path.parent / table.text("urdf")
    sources.append(main)
    urdf = read_urdf(main)
    for entry in table.tables("attach"):
        other = _attached_path(entry, path.parent)
        sources.append(other)
        urdf = _attach(urdf, entry, read_urdf(other))
    limits = table.table("limits", optional=True)
    urdf, limited = _limited(urdf, limits)
    base_link = table.text("base_link", urdf.root)
    if base_link not in urdf.shapes:
        raise table.error("base_link", f"the URDF has no link {base_link!r}")
    urdf = urdf.part(base_link)
    tool_link, urdf = _tool(table, urdf)
    base = table.table("base", optional=True)
    mobile = _base(base) if table.has("base") else None
    height = base.number("height", 0.0)
    if height:
        urdf = urdf.raised(urdf.free_name(FLOOR_LINK), height)
    acceleration = tuple(table.numbers("acceleration"))
    file = RobotFile(
        place=str(path),
        name=table.text("name"),
        urdf=urdf,
        base_link=urdf.root,
        tool_link=tool_link,
        joints=tuple(table.texts("joints")) if table.has("joints") else None,
        acceleration=acceleration,
        jerk=tuple(table.numbers("jerk")) if table.has("jerk") else _usual(acceleration),
        home=tuple(table.numbers("home")),
        ignored=tuple(table.pairs("ignored_collisions")) if table.has("ignored_collisions") else (),
        fixed=table.table("fixed_joints", optional=True).all_numbers(),
        limited=limited,
        gripper=_gripper(table.table("gripper")) if table.has("gripper") else None,
        base=mobile,
        digest=_digest(sources, urdf),
        controllers=(
            read_controllers(table.table("controllers")) if table.has("controllers") else None
        ),
    )
    table.finish()
    return file


def _usual(acceleration: tuple[float, ...]) -> tuple[float, ...]:
    """The jerks where a robot file gives none."""
    return tuple(JERK * each for each in acceleration)


def _digest(sources: list[Path], urdf: Urdf) -> str:
    """Of the files, and of the shapes that they take from other files: meshes."""
    digest = hashlib.sha256()
    for source in sources:
        digest.update(read_bytes(source))
    if any(b"<mesh" in read_bytes(source) for source in sources):
        for link, shapes in urdf.shapes.items():
            digest.update(link.encode())
            for shape in shapes:
                digest.update(repr(shape.solid).encode() + shape.pose.round(6).tobytes())
    return digest.hexdigest()


def _pose(table: Table) -> Pose:
    pose = np.zeros((3, 4))
    rpy = table.numbers("rpy", 3) if table.has("rpy") else [0.0, 0.0, 0.0]
    pose[:, :3] = rotation_from_rpy(*rpy)
    if table.has("xyz"):
        pose[:, 3] = table.numbers("xyz", 3)
    return pose


def gripper_path(name: str, folder: Path = Path()) -> Path:
    """The URDF of a gripper: a file, from a folder, or by name one that comes with the package.

    Raises:
        InputError: it is the name of none.
    """
    if name.endswith(".urdf"):
        return folder / name
    known = sorted(path.stem for path in (BUILT_IN / "grippers").glob("*.urdf"))
    if name not in known:
        raise InputError(
            f"there is no gripper {name!r}",
            hint=f"built in: {', '.join(known)}; or give the path of a file ending in .urdf",
        )
    return BUILT_IN / "grippers" / f"{name}.urdf"


def _attached_path(entry: Table, folder: Path) -> Path:
    try:
        return gripper_path(entry.text("urdf"), folder)
    except InputError as error:
        if error.place is not None:
            raise
        raise entry.error("urdf", error.message, error.hint) from None


def _attach(urdf: Urdf, entry: Table, other: Urdf) -> Urdf:
    link = entry.text("link")
    if link not in urdf.shapes:
        raise entry.error("link", f"the URDF has no link {link!r}")
    try:
        return urdf.attached(other, link, _pose(entry))
    except InputError as error:
        raise entry.error("urdf", error.message) from None


def _limited(urdf: Urdf, table: Table) -> tuple[Urdf, tuple[str, ...]]:
    """The URDF with the limits that a robot file states or overrides."""
    joints = dict(urdf.joints)
    names = []
    for name in table.keys():  # noqa: SIM118
        joint = urdf.joint(name)
        if joint is None:
            raise table.error(name, f"the URDF has no joint {name!r}")
        entry = table.table(name)
        lower, upper = entry.number("lower", joint.lower), entry.number("upper", joint.upper)
        if not lower <= upper:
            raise entry.error("lower", f"{lower:g} is above the upper limit {upper:g}")
        given = {
            "limits": entry.has("lower") and entry.has("upper"),
            "velocity": entry.has("velocity"),
        }
        joints[joint.child] = replace(
            joint,
            lower=lower,
            upper=upper,
            velocity=entry.positive("velocity", joint.velocity or 1.0),
            absent=tuple(what for what in joint.absent if not given[what]),
        )
        names.append(name)
    return replace(urdf, joints=joints), tuple(names)


def _tool(table: Table, urdf: Urdf) -> tuple[str, Urdf]:
    """The link whose frame is the tool's: one of the URDF's, or one made for it. Whether there
    is such a link, and whether the arm leads to it, is looked at later."""
    if not table.has("tool"):
        return table.text("tool_link"), urdf
    tool = table.table("tool")
    link, pose = tool.text("link"), _pose(tool)
    if link not in urdf.shapes or not (tool.has("xyz") or tool.has("rpy")):
        return link, urdf
    name = urdf.free_name(TOOL_LINK)
    return name, urdf.with_frame(name, link, pose)


def _gripper(table: Table) -> GripperFile:
    limits = {
        key: table.positive(key) if table.has(key) else None
        for key in ("max_force", "max_torque", "payload")
    }
    return GripperFile(
        fingers=tuple(table.texts("finger_joints")),
        links=tuple(table.texts("links")),
        clearance=table.positive("clearance", 0.004),
        time=table.positive("time", 0.5),
        opens_fully=_opens_fully(table),
        **limits,
    )


def _opens_fully(table: Table) -> bool:
    how = table.text("opens", OPENS[0])
    if how not in OPENS:
        known = ", ".join(map(repr, OPENS))
        raise table.error("opens", f"no gripper opens {how!r}", hint=f"known: {known}")
    return how == OPENS[1]


def _base(table: Table) -> MobileBase:
    kind = table.text("type", "differential")
    if kind not in BASE_TYPES:
        known = ", ".join(BASE_TYPES)
        raise table.error("type", f"there is no base {kind!r}", hint=f"known: {known}")
    if kind == "fixed":
        return MobileBase(0.0, 0.0, 0.0, 0.0, kind)
    hardest = table.positive("acceleration"), table.positive("angular_acceleration")
    return MobileBase(
        table.positive("velocity"),
        hardest[0],
        table.positive("angular_velocity"),
        hardest[1],
        kind,
        table.positive("jerk", JERK * hardest[0]),
        table.positive("angular_jerk", JERK * hardest[1]),
    )
