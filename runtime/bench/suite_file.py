"""Suites as TOML files. All that is wrong with a file is told in one run, with table, key and line.

    sketches = ["pick_and_place", "mine.sketch"]
    scenes = ["sorting/3t-02", "tasks/*.pddl"]
    planners = ["lazy-siiw-r", "siw-r"]
    robots = ["my_robot.toml"]    # where the domain has robots
    seeds = 10                    # 0 to 9; or a list, or "3-7"
    timeout = 60                  # seconds

Paths start from the folder of the file. With `[[block]]` tables there are several such products;
what stands above them counts for each block that does not say otherwise.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from runtime.bench.job import located
from runtime.bench.suite import MOST_RUNS, SEEDS, TIMEOUT, Block, Suite
from runtime.entry import Document, Entry, known
from runtime.robot.load import built_in_robots, robot_path
from runtime.search.planners import DEFAULT, PLANNERS
from runtime.solve import open_task
from sketchlang.checking.checker import CheckedSketch
from sketchlang.compile import obstacles
from sketchlang.diagnostics import Severity
from sketchlang.domain import SceneError
from sketchlang.errors import InputError
from sketchlang.library import find_scene
from sketchlang.loader import PDDL, load_sketch, pddl_domain_of

HERE = Path(__file__).resolve().parent
BUILT_IN = ("paper", "baselines")
"""Suites whose files come along."""

KEYS = ("sketches", "scenes", "planners", "robots", "seeds", "timeout", "k_max", "domain")
MOST_SEED = 1 << 31
MOST_TIMEOUT = 1e6


def built_in_suite(name: str) -> Suite:
    """A suite that comes along."""
    return read_suite(HERE / f"{name}.toml", "paper", doubting=False)


def read_suite(path: Path, tables: str = "plain", doubting: bool = True) -> Suite:
    """The suite of a file; `doubting`: whether its sketches can be run on its scenes is tried.

    Raises:
        InputError: what is wrong with it; `CollectedInputError` where it is several things.
    """
    document = Document(path)
    root = document.root
    name = root.text("name", path.stem)
    given = root.tables("block")
    reader = _Reader(document, path.parent)
    if given:
        blocks = [reader.block(entry, root) for entry in given]
    else:
        if root.has("block"):
            root.problem("block", "is empty")
        blocks = [reader.block(root, root)]
    if sum(block.runs for block in blocks) > MOST_RUNS:
        root.problem(None, f"has more than {MOST_RUNS} runs")
    if document.sound and doubting:
        for entry, block in zip(given or [root], blocks, strict=True):
            reader.check_together(entry, root, block)
    document.finish()
    return Suite(name, tuple(blocks), str(path.parent), tables)


@dataclass(frozen=True)
class _Reader:
    document: Document
    folder: Path

    def block(self, entry: Entry, root: Entry) -> Block:
        """The block of a table; what it lacks is taken from the top of the file."""
        for key in KEYS:
            entry.has(key)  # so that none of them is taken for a slip of another
        sketches = self.names(entry, root, "sketches", None, self.sketch)
        scenes = self.scenes(entry, root)
        planners = self.names(entry, root, "planners", [DEFAULT], _planner)
        robots = self.names(entry, root, "robots", [""], self.robot)
        holder = _holder(entry, root, "domain")
        domain = holder.text("domain", "")
        if domain and not Path(located(str(self.folder), domain)).is_file():
            holder.problem("domain", f"there is no file {domain!r}")
        return Block(
            sketches, scenes, planners, _seeds(_holder(entry, root, "seeds")), robots,
            _within(_holder(entry, root, "timeout"), "timeout", TIMEOUT, MOST_TIMEOUT),
            int(_within(_holder(entry, root, "k_max"), "k_max", 2, 3, whole=True)), domain,
        )  # fmt: skip

    def names(
        self,
        entry: Entry,
        root: Entry,
        key: str,
        default: list[str] | None,
        wrong: Callable[[str], InputError | None],
    ) -> tuple[str, ...]:
        """A list of names, each of them looked at, twice the same told."""
        holder = _holder(entry, root, key)
        if default is not None and not holder.has(key):
            return tuple(default)
        found = holder.names(key)
        for number, name in enumerate(found):
            if name in found[:number]:
                holder.problem(key, f"{name!r} stands there twice")
            error = wrong(name)
            if error is not None:
                holder.problem(key, error.message, error.hint)
        return tuple(dict.fromkeys(found))

    def scenes(self, entry: Entry, root: Entry) -> tuple[str, ...]:
        """The scenes, patterns among them made to what they match."""
        holder = _holder(entry, root, "scenes")
        found: list[str] = []
        for name in holder.names("scenes"):
            if re.search(r"[*?\[]", name) and not Path(located(str(self.folder), name)).exists():
                matches = list(_matching(self.folder, name))
                if not matches:
                    holder.problem("scenes", f"nothing matches {name!r}", "from the file's folder")
                found += matches
                continue
            try:
                find_scene(located(str(self.folder), name))
            except InputError as error:
                holder.problem("scenes", error.message, error.hint)
            if name in found:
                holder.problem("scenes", f"{name!r} stands there twice")
            found.append(name)
        return tuple(dict.fromkeys(found))

    def sketch(self, name: str) -> InputError | None:
        """What is wrong with a sketch, whatever it is used for."""
        try:
            load_sketch(located(str(self.folder), name))
        except InputError as error:
            return InputError(f"{name!r}: {error.message}", hint=error.hint)
        return None

    def robot(self, name: str) -> InputError | None:
        """What is wrong with a robot's name."""
        try:
            path = robot_path(located(str(self.folder), name))
        except InputError:
            hint = known("built in", name, built_in_robots())
            return InputError(f"there is no robot {name!r}", hint=hint)
        return None if path.is_file() else InputError(f"there is no robot file {name!r}")

    def check_together(self, entry: Entry, root: Entry, block: Block) -> None:
        """Whether each sketch can be run on the scenes: on one scene of every domain."""
        folder = str(self.folder)
        domains: dict[str, Any] = {}
        for scene in block.scenes:
            path = located(folder, scene)
            try:
                domain = pddl_domain_of(path) if path.endswith(PDDL) else None
            except InputError as error:
                message = f"{scene!r}: {error}".partition("\n")[0]
                _holder(entry, root, "scenes").problem("scenes", message, error.hint)
                continue
            domains.setdefault("" if domain is None else str(Path(path).parent), domain)
        for sketch in block.sketches:
            for where, domain in domains.items():
                wrong = self.unfit(sketch, block, domain)
                if wrong is not None:
                    on = f" on the tasks in {where}" if where else ""
                    holder = _holder(entry, root, "sketches")
                    holder.problem("sketches", f"{sketch!r}{on}: {wrong}")

    def unfit(self, sketch: str, block: Block, domain: Any) -> str | None:
        """Why a sketch cannot be run with a domain."""
        folder = str(self.folder)
        try:
            file = located(folder, block.domain) if block.domain else None
            loaded = load_sketch(located(folder, sketch), file, domain)
        except InputError as error:
            return error.message
        for found in loaded.diagnostics:
            if found.severity is Severity.ERROR:
                line = loaded.source.position(found.primary.span.start)[0]
                return f"line {line}: {found.message}"
        for obstacle in obstacles(loaded.checked):
            return obstacle.message
        used = loaded.checked.domain
        assert used is not None, "one of the obstacles"
        if any(block.robots) and not used.has_robots:
            return f"the domain {used.name} has no robots"
        return None if domain is not None else self.unloaded(loaded.checked, block)

    def unloaded(self, checked: CheckedSketch, block: Block) -> str | None:
        """Why a scene of a block is none for a sketch. (PDDL tasks are not tried: to ground some
        of them takes as long as to solve them.)"""
        for scene in block.scenes:
            if not scene.endswith(PDDL):
                try:
                    open_task(checked, located(str(self.folder), scene))
                except (InputError, SceneError) as error:
                    return f"on {scene!r}: {error}".partition("\n")[0]
        return None


def _holder(entry: Entry, root: Entry, key: str) -> Entry:
    """Where a key is given: in the table itself or at the top of the file."""
    if entry is root or entry.has(key):
        root.ignore([key])
        return entry
    return root if root.has(key) else entry


def _planner(name: str) -> InputError | None:
    if name in PLANNERS:
        return None
    return InputError(f"there is no planner {name!r}", hint=known("planners", name, PLANNERS))


def _seeds(entry: Entry) -> tuple[int, ...]:
    """So many seeds from 0, a list of them, or the first and the last."""
    value = entry.data.get("seeds", SEEDS) if entry.has("seeds") else SEEDS
    if isinstance(value, str) and (span := re.fullmatch(r"(\d{1,9})-(\d{1,9})", value)):
        first, last = int(span[1]), int(span[2])
        found: Sequence[object] = range(first, min(last, first + MOST_RUNS) + 1)
    elif isinstance(value, int) and not isinstance(value, bool):
        found = range(min(value, MOST_RUNS))
    else:
        found = value if isinstance(value, list) else []
    fine = [s for s in found if isinstance(s, int) and not isinstance(s, bool)]
    if not fine or len(fine) < len(found) or not all(0 <= s < MOST_SEED for s in fine):
        hint = 'a number of runs from 1 on, a list of seeds, or "FIRST-LAST"'
        entry.problem("seeds", f"are no seeds: {str(value)[:40]}", hint)
        return (0,)
    return tuple(dict.fromkeys(fine))


def _within(entry: Entry, key: str, default: float, most: float, whole: bool = False) -> float:
    value = entry.positive(key, default)
    if value > most or (whole and value != int(value)):
        kind = "a whole number" if whole else "a number"
        entry.problem(key, f"expected {kind} up to {most:g}, found {value:g}")
        return default
    return value


def _matching(folder: Path, pattern: str) -> Iterator[str]:
    """Scenes and tasks that match, `p2` before `p10`; no domains of PDDL."""
    try:
        found = [path for path in folder.glob(pattern) if path.is_file()]
    except (ValueError, NotImplementedError, OSError):  # an absolute pattern
        return
    for path in sorted(found, key=lambda path: natural(path.as_posix())):
        if not (path.suffix == PDDL and "domain" in path.name):
            yield path.relative_to(folder).as_posix()


def natural(text: str) -> list[tuple[int, str]]:
    """A key by which numbers in texts are sorted as numbers."""
    parts = re.split(r"(\d+)", text)
    return [(int(part), "") if part.isdigit() else (-1, part) for part in parts]
