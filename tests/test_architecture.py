"""Imports go one way, and names stay where they belong."""

from __future__ import annotations

import ast
import importlib
import re
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("grammars", "sketchlang", "runtime", "domains")
HEAVY = ("numpy", "numba", "scipy", "trimesh", "ompl", "fcl", "pybullet", "networkx")


def modules(*folders: str) -> list[Path]:
    """Python files of folders, relative to the root."""
    return sorted(
        path.relative_to(ROOT) for folder in folders for path in (ROOT / folder).rglob("*.py")
    )


def by_name() -> dict[str, Path]:
    """Every module of ours, by its name."""
    return {
        ".".join(path.with_suffix("").parts).removesuffix(".__init__"): path
        for path in modules(*PACKAGES)
    }


BY_NAME = by_name()
COMMANDS = [name for name in BY_NAME if name.startswith("sketchlang.cli.")]


def names(node: ast.Import | ast.ImportFrom, path: Path) -> Iterator[str]:
    """Absolute module names that a statement imports."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
        return
    package = list(path.parts[: len(path.parts) - node.level]) if node.level else []
    prefix = ".".join([*package, *([node.module] if node.module else [])])
    yield prefix
    yield from (f"{prefix}.{alias.name}" for alias in node.names)


def is_type_checking(node: ast.stmt) -> bool:
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)


Reader = Callable[[ast.Import | ast.ImportFrom, Path], Iterator[str]]


def called_for(node: ast.AST) -> Iterator[str]:
    """Modules that a call of `import_module` or `__import__` names; a name that is made when the
    program runs stands for every module of ours that begins as its fixed part does."""
    if not (isinstance(node, ast.Call) and node.args):
        return
    if ast.unparse(node.func).rpartition(".")[2] not in ("import_module", "__import__"):
        return
    match node.args[0]:
        case ast.Constant(value=str(name)):
            yield name
        case ast.JoinedStr(values=[ast.Constant(value=str(start)), *_]):
            yield from (name for name in BY_NAME if name.startswith(start))


@cache
def parsed(path: Path) -> ast.Module:
    return ast.parse((ROOT / path).read_text(encoding="utf-8"))


def imports(path: Path, lazy: bool, of: Reader = names) -> set[str]:
    """What a file imports: when it is loaded, or with `lazy` at any time; never for types only.
    `of` are the names of a statement."""
    found: set[str] = set()
    pending: list[ast.AST] = list(parsed(path).body)
    while pending:
        node = pending.pop()
        if isinstance(node, ast.Import | ast.ImportFrom):
            found |= set(of(node, path))
        elif isinstance(node, ast.stmt) and is_type_checking(node):
            pending += node.orelse
        elif lazy or not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            found |= set(called_for(node))
            pending += ast.iter_child_nodes(node)
    return found


def files_of(node: ast.Import | ast.ImportFrom, path: Path) -> Iterator[str]:
    """Modules of ours that a statement needs: `from a import b` needs a.b where that is a module,
    and what stands in a otherwise."""
    every = list(names(node, path))
    members = every[isinstance(node, ast.ImportFrom) :]
    for name in members:
        yield name if name in BY_NAME else name.rpartition(".")[0]


def circles(graph: dict[str, set[str]]) -> list[set[str]]:
    """Modules that can come back to themselves: each with all those on its circles."""

    def reached(start: str) -> set[str]:
        seen: set[str] = set()
        pending = [start]
        while pending:
            new = graph[pending.pop()] - seen
            seen |= new
            pending += new
        return seen

    after = {name: reached(name) for name in graph}
    found = []
    for name, beyond in after.items():
        circle = {other for other in beyond if name in after[other]}
        if name in beyond and circle not in found:
            found.append(circle)
    return found


def within(name: str, packages: tuple[str, ...]) -> bool:
    return any(name == package or name.startswith(package + ".") for package in packages)


def test_the_reader_of_imports_sees_them(tmp_path, monkeypatch) -> None:
    """Guards the tests below against passing because nothing is read."""
    assert "numpy" in imports(Path("runtime/robot/model.py"), lazy=False)
    assert "domains.tabletop.problem.load_problem" in imports(
        Path("domains/tabletop/__init__.py"), lazy=True
    )
    assert "domains.tabletop.problem" not in imports(
        Path("domains/tabletop/__init__.py"), lazy=False
    )
    assert len(modules(*PACKAGES)) > 50


@pytest.mark.parametrize("path", modules("grammars"), ids=str)
def test_grammars_import_nothing_of_the_others(path) -> None:
    assert not [n for n in imports(path, lazy=True) if within(n, PACKAGES[1:])]


ARRAYS = ("listed_graph", "listed_piece", "listing", "valuations", "verify_ranks")
"""Analyses of all valuations at once, which the others import when it comes to that."""

ARRAY_MODULES = tuple(f"sketchlang.analysis.{name}" for name in ARRAYS)

ABOVE = ("cli", "api.py", "__main__.py")
"""What stands above the runtime and the domains."""

LANGUAGE = [
    path for path in modules("sketchlang") if path.parts[1] not in ("cli", "api.py", "__main__.py")
]


@pytest.mark.parametrize("path", LANGUAGE, ids=str)
def test_the_language_knows_neither_runtime_nor_domains_nor_geometry(path) -> None:
    above = [n for n in imports(path, lazy=True) if within(n, ("runtime", "domains"))]
    assert not above
    loaded = imports(path, lazy=False)
    if path.stem in ARRAYS:
        assert "numpy" in loaded
    else:
        assert not [n for n in loaded if within(n, (*HEAVY, *ARRAY_MODULES))]


@pytest.mark.parametrize("path", LANGUAGE, ids=str)
def test_the_language_does_not_import_its_command_line(path) -> None:
    assert not [n for n in imports(path, lazy=True) if within(n, ("sketchlang.cli",))]


@pytest.mark.parametrize("path", modules("runtime", "domains"), ids=str)
def test_runtime_and_domains_do_not_import_the_command_line(path) -> None:
    assert not [n for n in imports(path, lazy=True) if within(n, ("sketchlang.cli",))]


@pytest.mark.parametrize("path", modules("runtime"), ids=str)
def test_the_runtime_imports_no_domain(path) -> None:
    assert not [n for n in imports(path, lazy=True) if within(n, ("domains",))]


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        ('importlib.import_module("runtime.solve")', {"runtime.solve"}),
        ('__import__("domains.blocks")', {"domains.blocks"}),
        ('import_module(f"sketchlang.cli.{name}")', set(COMMANDS)),
        ("import_module(name)", set()),
        ('print("runtime.solve")', set()),
    ],
)
def test_imports_by_name_are_found(call, expected) -> None:
    assert set(called_for(ast.parse(call, mode="eval").body)) == expected


def test_circles_are_found() -> None:
    graph = {"a": {"b"}, "b": {"c", "d"}, "c": {"b"}, "d": set(), "e": {"e"}}
    assert circles(graph) == [{"b", "c"}, {"e"}]


def test_no_file_is_in_a_circle_of_imports() -> None:
    """Those inside functions and by `import_module` included; those for types only are not, and
    neither is that a module's package is imported before it. Domains are found by a name that a
    sketch, a file or an entry point gives, which is no import of the file that looks."""
    graph = {
        name: imports(path, lazy=True, of=files_of) & set(BY_NAME) for name, path in BY_NAME.items()
    }
    assert "runtime.robot.derived" in graph["runtime.robot.load"]  # inside a function
    assert "sketchlang.cli.check" in graph["sketchlang.cli"]  # by a name with a fixed part
    assert sum(map(len, graph.values())) > 1000
    assert circles(graph) == []


GEOMETRY = tuple(
    f"runtime.{name}"
    for name in ("kernels", "motion", "robot", "world", "judge", "plan", "trace", "physics")
)


@pytest.mark.parametrize("path", modules("runtime/search"), ids=str)
def test_the_search_knows_nothing_of_geometry(path) -> None:
    assert not [n for n in imports(path, lazy=True) if within(n, GEOMETRY)]


@pytest.mark.parametrize("path", modules("runtime/judge"), ids=str)
def test_the_judge_shares_no_collision_code_with_the_planner(path) -> None:
    planning = ("runtime.kernels", "domains.tabletop.sampling", "runtime.search", "numba", "ompl")
    planning += tuple(f"runtime.motion.{m}" for m in ("base", "rrt", "arm_context", "room"))
    assert not [n for n in imports(path, lazy=True) if within(n, planning)]


@pytest.mark.parametrize("path", modules("runtime/kernels"), ids=str)
def test_kernels_import_kernels_only(path) -> None:
    own = [n for n in imports(path, lazy=True) if within(n, ("runtime",))]
    assert all(within(n, ("runtime.kernels",)) for n in own)


def test_one_place_in_the_runtime_names_the_default_robot() -> None:
    from runtime.robot.load import built_in_robots

    for name in built_in_robots():
        lines = [
            f"{path}: {line.strip()}"
            for path in modules("runtime", "domains")
            for line in (ROOT / path).read_text(encoding="utf-8").splitlines()
            if name in line.lower()
        ]
        assert len(lines) <= 1, lines


TEXTS = {".py", ".md", ".toml", ".sketch", ".lark", ".txt", ".urdf", ".yml", ".yaml", ".lock", ""}
OWN_TOP = ("grammars", "sketchlang", "runtime", "domains", "tests", "docs", "benchmarks", ".ci")


def texts() -> list[Path]:
    """Text files of the project."""
    inside = [path for top in OWN_TOP for path in (ROOT / top).rglob("*")]
    return [
        path
        for path in [*ROOT.iterdir(), *inside]
        if path.is_file()
        and path.suffix in TEXTS
        and path.name != ".git"
        and not {"__pycache__", "node_modules"} & set(path.parts)
    ]


FOREIGN = re.compile(
    r"(?<![\w.])/(work|root|home|mnt|opt)\b(?!:)"  # paths of one machine
    r"|(pypi|pythonhosted|conda|npmjs)\.(org|com)|index-url[ =]+\S*://|/simple/"  # registries
)


def test_no_file_names_a_machine_or_a_registry() -> None:
    """Paths of one machine, and where packages come from, do not belong into a project."""
    found = [
        f"{path.relative_to(ROOT)}: {line.strip()[:80]}"
        for path in texts()
        if path != Path(__file__).resolve()
        for line in path.read_text(encoding="utf-8", errors="replace").splitlines()
        if FOREIGN.search(line)
    ]
    assert found == []
    assert len(texts()) > 100


@pytest.mark.parametrize(
    "line",
    # In pieces, for this file is no exception.
    [
        "see /" + "work/main",
        "pip install --index-" + "url https://host/x",
        "https://py" + "pi.org/p",
    ],
)
def test_foreign_names_are_recognised(line) -> None:
    assert FOREIGN.search(line)


PAGE = ROOT / "docs" / "architecture.md"
PATH = re.compile(
    r"`((?:sketchlang|runtime|domains|grammars|tests|docs|benchmarks|editors)/[\w./]*)`"
)


@pytest.mark.parametrize(
    "page", ["docs/architecture.md", "docs/api.md", "README.md", "CONTRIBUTING.md"]
)
def test_what_a_page_points_to_is_there(page) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    links = re.findall(r"\]\((?!https?:)([^)#]+)", text)
    missing = [path for path in PATH.findall(text) if not (ROOT / path).exists()]
    missing += [link for link in links if not (ROOT / page).parent.joinpath(link).exists()]
    assert missing == []


def test_the_page_has_a_line_for_every_room() -> None:
    """A room is a folder with modules of ours; one inside another may go without a line, except
    in the two largest domains."""
    named = {path.rstrip("/") for path in PATH.findall(PAGE.read_text(encoding="utf-8"))}
    folders = {path.parent for path in modules("sketchlang", "runtime", "domains")}
    rooms = {
        folder.as_posix()
        for folder in folders
        if len(folder.parts) == 2
        or folder.parts[:2] in (("domains", "tabletop"), ("domains", "pddl"))
    }
    assert len(rooms) > 20
    assert rooms - named == set()


def test_the_constants_of_the_page_are_where_it_says() -> None:
    found = re.findall(
        r"`([A-Z_]+)`(?: and `([A-Z_]+)`)? in `([\w/.]+)`", PAGE.read_text(encoding="utf-8")
    )
    assert len(found) >= 2
    for *constants, path in found:
        text = (ROOT / path).read_text(encoding="utf-8")
        assert all(re.search(rf"^{name} = ", text, re.M) for name in constants if name)


def test_the_stages_of_the_page_are_functions() -> None:
    lines = re.findall(r"^    (\w+)\(.*\) +-> .*?(sketchlang[\w.]+)$", PAGE.read_text(), re.M)
    assert [name for name, _ in lines] == ["load_source", "parse", "check", "compile_sketch"]
    for name, module in lines:
        assert callable(getattr(importlib.import_module(module), name))


def test_all_benchmarks_can_be_imported() -> None:
    """Nobody runs them every day: what they ask of other modules has to be there."""
    names = [path.stem for path in (ROOT / "benchmarks").glob("*.py") if path.stem != "__init__"]
    assert len(names) > 10
    for name in names:
        importlib.import_module(f"benchmarks.{name}")
