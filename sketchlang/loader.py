"""Files and domains: the only part of the language that looks outside.

`load_sketch` is the chain of stages that every command begins with.
"""

from __future__ import annotations

import importlib
import os
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from sketchlang.checking.checker import CheckedSketch, check
from sketchlang.diagnostics import Diagnostic, Label, Severity
from sketchlang.domain import Domain, DomainError
from sketchlang.errors import InputError
from sketchlang.library import SCENES_OF
from sketchlang.reading import CODE_LIMIT, decoded, read_bytes, read_standard_input, read_text
from sketchlang.source import Source
from sketchlang.suggest import did_you_mean
from sketchlang.syntax import tree
from sketchlang.syntax.parser import MAX_CHARACTERS, MAX_MISTAKES, parse

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "sketchlang.domains"
"""The entry-point group in which packages offer their domains."""

_NAME = re.compile(r"[A-Za-z_]\w*")
SUFFIX = ".sketch"
"""How the names of sketches end."""

PDDL = ".pddl"
"""How the names of PDDL files end."""

MAX_BYTES = 4 * MAX_CHARACTERS
"""Bytes of a sketch that are read: four a character at most."""
_DOMAIN_PDDL = "domain.pddl"
_HERE = Path(__file__).resolve().parent.parent / "domains"


@dataclass(frozen=True)
class Loaded:
    """A sketch after all the stages that come before compiling or analysing it."""

    source: Source
    tree: tree.Tree
    checked: CheckedSketch
    diagnostics: tuple[Diagnostic, ...]

    @property
    def ok(self) -> bool:
        """Whether the sketch can be used: warnings do not count."""
        return all(found.severity is not Severity.ERROR for found in self.diagnostics)


def load_sketch(
    target: str, domain_file: str | None = None, domain: Domain | None = None
) -> Loaded:
    """Read, parse and check a sketch: a path, `-` for standard input, or a built-in name.

    `domain_file` is a Python file with a domain to use besides the installed ones, or a PDDL file
    with the domain to use; `domain` is the one to use whatever the sketch names. Raises
    `InputError` if the text or that file cannot be had.
    """
    extra: dict[str, Domain] = {}
    if domain_file is not None:
        extra, given = given_domain(domain_file)
        domain = given or domain
    return load_text(load_source(target), extra, domain)


def given_domain(domain_file: str) -> tuple[dict[str, Domain], Domain | None]:
    """What a file has that is given with `--domain`: the domains of a Python file by name, or the
    one of a PDDL file, which is used whatever the sketch names. Raises `InputError`."""
    if domain_file.endswith(PDDL):
        return {}, pddl_domain(domain_file)
    return domains_of_file(domain_file), None


def load_text(
    source: Source, extra: dict[str, Domain] | None = None, domain: Domain | None = None
) -> Loaded:
    """The same for a text that is at hand, with domains that are found before others."""
    return load_tree(*parse(source), extra, domain)


def load_tree(
    parsed: tree.Tree,
    diagnostics: list[Diagnostic],
    extra: dict[str, Domain] | None = None,
    domain: Domain | None = None,
    opened: Mapping[str, str] | None = None,
) -> Loaded:
    """The same for a tree and what was found when it was parsed.

    `opened` are texts that count instead of the files of these (real) paths, such as those that
    an editor has not saved yet.
    """
    source = parsed.source
    parsed, more = read_includes(parsed, opened)
    missing: list[Diagnostic] = []
    if domain is None:
        domain, missing = find_domain(parsed, extra or {})
    checked, found = check(parsed, domain)
    everything = [*diagnostics, *more, *missing, *found]
    main = source.name
    everything.sort(key=lambda d: (d.primary.source.name != main, d.primary.span))
    return Loaded(source, parsed, checked, tuple(everything))


# Texts.


def load_source(target: str) -> Source:
    """The text of a path, of standard input (`-`), or of a built-in sketch."""
    if target == "-":
        return Source("<stdin>", decoded(read_standard_input(MAX_BYTES), "<stdin>"))
    if not target:
        raise InputError("a name or a path of a sketch is expected, this is an empty text")
    path = Path(target)
    # Path.exists raises where a name is too long. A folder of tasks may bear a sketch's name.
    if not os.path.exists(path) or os.path.isdir(path):
        builtin = builtin_sketch(target)
        if builtin is not None:
            return _read(builtin, builtin.relative_to(_HERE.parent).as_posix())
        hint = did_you_mean(target, builtin_sketches())
        if _NAME.fullmatch(target) and not hint:
            hint = "Built-in sketches: " + ", ".join(builtin_sketches()) + "."
        return _read(path, target, hint)
    return _read(path, target)


def _read(path: Path, name: str, hint: str | None = None) -> Source:
    try:
        return Source(name, read_text(path, MAX_BYTES))
    except InputError as error:
        raise InputError(error.message, place=name, hint=hint) from None


def builtin_sketches() -> list[str]:
    """Names of the sketches that come along."""
    return sorted(path.stem for path in _builtin_paths())


def builtin_sketch(name: str) -> Path | None:
    """The file of a sketch that comes along."""
    if not _NAME.fullmatch(name):
        return None
    return next((path for path in _builtin_paths() if path.stem == name), None)


def _builtin_paths() -> Iterator[Path]:
    yield from _HERE.glob(f"*{SUFFIX}")
    yield from _HERE.glob(f"*/*{SUFFIX}")


# Includes.


def read_includes(
    parsed: tree.Tree, opened: Mapping[str, str] | None = None
) -> tuple[tree.Tree, list[Diagnostic]]:
    """The tree with the trees of all the files that it includes, and what is wrong there."""
    diagnostics: list[Diagnostic] = []
    return _expand(parsed, [parsed.source.name], {}, diagnostics, opened or {}), diagnostics


def _expand(
    parsed: tree.Tree,
    path: list[str],
    known: dict[str, tree.Tree],
    diagnostics: list[Diagnostic],
    opened: Mapping[str, str],
) -> tree.Tree:
    items: list[tree.Item] = []
    for item in parsed.items:
        if not isinstance(item, tree.Include):
            items.append(item)
            continue
        label = Label(parsed.source, item.place)
        if len(diagnostics) >= MAX_MISTAKES:
            items.append(item)
            continue
        try:
            source = _included(item, parsed.source, opened)
        except InputError as error:
            message = f"{error.place}: {error.message}" if error.place else error.message
            diagnostics.append(Diagnostic("include-not-found", message, label, hint=error.hint))
            items.append(item)
            continue
        if source.name in path:
            circle = [*path[path.index(source.name) :], source.name]
            message = "this file includes itself: " + " -> ".join(circle)
            diagnostics.append(Diagnostic("include-cycle", message, label))
            items.append(tree.Broken("include", None, item.span))
            continue
        if source.name not in known:
            if len(path) > MAX_INCLUDES:
                message = f"more than {MAX_INCLUDES} files include each other in a row"
                diagnostics.append(Diagnostic("include-cycle", message, label))
                items.append(item)
                continue
            other, found = parse(source)
            diagnostics.extend(found)
            # Not twice in a sketch: an include on a second way only repeats it.
            known[source.name] = other
            known[source.name] = _expand(other, [*path, source.name], known, diagnostics, opened)
        items.append(replace(item, tree=known[source.name]))
    return replace(parsed, items=tuple(items))


MAX_INCLUDES = 20


def _included(item: tree.Include, source: Source, opened: Mapping[str, str]) -> Source:
    if not item.quoted:
        return load_builtin(item.target)
    base = Path() if source.name == "<stdin>" else Path(source.name).parent
    path = base / item.target
    if path.suffix != SUFFIX or Path(os.path.realpath(path)).suffix != SUFFIX:
        # An excerpt of what is wrong in it would show any file to whoever sees the findings.
        raise InputError(f"only files ending in {SUFFIX} are included", place=path.as_posix())
    inside = source.name != "<stdin>" and not os.path.exists(source.name)
    if inside and (_HERE.parent / source.name).exists():
        # A built-in sketch is known by its path inside the installation.
        return _read(_HERE.parent / path, path.as_posix())
    text = opened.get(os.path.realpath(path))
    return _read(path, path.as_posix()) if text is None else Source(path.as_posix(), text)


def load_builtin(name: str) -> Source:
    """The text of a sketch that comes along."""
    path = builtin_sketch(name)
    if path is None:
        hint = did_you_mean(name, builtin_sketches()) or (
            "Built-in sketches: " + ", ".join(builtin_sketches()) + ". Put paths in quotes."
        )
        raise InputError(f"there is no built-in sketch `{name}`", hint=hint)
    return _read(path, path.relative_to(_HERE.parent).as_posix())


# Domains.


def find_domain(
    parsed: tree.Tree, extra: dict[str, Domain]
) -> tuple[Domain | None, list[Diagnostic]]:
    """The domain that a sketch or a file it includes uses, and a diagnostic if it has none."""
    use = _use(parsed)
    if use is None:
        return None, []
    item, source = use
    name = item.name.text
    label = Label(source, item.name.span)
    try:
        if item.quoted:
            return _pddl_beside(name, source), []
        found = extra.get(name) or load_domain(name)
    except InputError as error:
        message = f"{error.place}: {error.message}" if item.quoted else error.message
        return None, [Diagnostic("broken-domain", message, label, hint=error.hint)]
    if found is not None:
        return found, []
    names = sorted({*extra, *domain_names()})
    hint = did_you_mean(name, names) or (
        "Domains found: " + ", ".join(names) + ". A file with another one is given with --domain."
    )
    return None, [Diagnostic("unknown-domain", f"there is no domain `{name}`", label, hint=hint)]


def _pddl_beside(target: str, source: Source) -> Domain:
    """The domain of a PDDL file that a sketch names by its path from there."""
    base = Path() if source.name == "<stdin>" else Path(source.name).parent
    path = base / target
    if path.suffix != PDDL:
        message = f"only files ending in {PDDL} are used by path"
        raise InputError(message, place=path.as_posix(), hint=f"Write `use {path.stem}`.")
    if not path.exists() and (_HERE.parent / path).exists():
        path = _HERE.parent / path
    return pddl_domain(path.as_posix())


def pddl_domain(path: str) -> Domain:
    """The domain of a PDDL file. Raises `InputError` with what is wrong with it, and where."""
    # The folder of `domains/` that is called like the ending of a file knows what to do with it.
    found: Domain = _attribute(f"domains{PDDL}.interface", "interface_of")(path)
    return found


def used_domain(parsed: tree.Tree) -> str | None:
    """The name, or path, of the domain that a sketch or a file it includes uses."""
    use = _use(parsed)
    return None if use is None else use[0].name.text


def is_pddl_domain(path: str) -> bool:
    """Whether a PDDL file declares a domain, not a task. Raises `InputError`."""
    found: bool = _attribute(f"domains{PDDL}.show", "is_domain")(path)
    return found


def pddl_domain_of(task: str) -> Domain:
    """The domain of a PDDL task, from the file beside it. Raises `InputError`."""
    return pddl_domain(str(_attribute(f"domains{PDDL}.interface", "domain_beside")(task)))


def _use(parsed: tree.Tree) -> tuple[tree.Use, Source] | None:
    for item in parsed.items:
        if isinstance(item, tree.Use):
            return item, parsed.source
    for item in parsed.items:
        if isinstance(item, tree.Include) and item.tree is not None:
            found = _use(item.tree)
            if found is not None:
                return found
    return None


def load_domain(name: str) -> Domain | None:
    """The domain of a name: one that comes along, or one that a package offers."""
    # Built-in ones first, by their module: looking through all packages takes longer than
    # all the rest of a check.
    if _NAME.fullmatch(name):
        if (_HERE / name / _DOMAIN_PDDL).exists():
            return pddl_domain(f"{_HERE / name / _DOMAIN_PDDL}")
        if (_HERE / name / "__init__.py").exists() and name != "pddl":
            return _import_domain(f"domains.{name}", "domain", name)
    for entry in _entry_points():
        if entry.name == name:
            return _import_domain(entry.module, entry.attr, name)
    return None


def domain_names() -> list[str]:
    """Names of all domains that a sketch can use without `--domain`."""
    own = {path.parent.name for path in _HERE.glob("*/__init__.py")} - {"pddl"}
    own |= {path.parent.name for path in _HERE.glob(f"*/{_DOMAIN_PDDL}")}
    return sorted(own | {entry.name for entry in _entry_points()})


def domain_of_scene(name: str) -> str:
    """The domain of a built-in scene."""
    folder = name.partition("/")[0]
    return folder if folder in domain_names() else SCENES_OF


def _entry_points() -> list[EntryPoint]:
    from importlib.metadata import entry_points

    return list(entry_points(group=GROUP))


def _attribute(module: str, name: str) -> Any:
    """What stands in a module: domains are found, the language imports none of them."""
    return getattr(importlib.import_module(module), name)


def _import_domain(module: str, attribute: str, name: str) -> Domain:
    try:
        found = _attribute(module, attribute)
    # A module that ends the program would end the command as well.
    except (Exception, SystemExit) as error:
        raise InputError(
            f"domain `{name}` cannot be loaded: {type(error).__name__}: {error}"
        ) from error
    if not isinstance(found, Domain):
        raise InputError(f"domain `{name}` cannot be loaded: {module}:{attribute} is no Domain")
    return found


def domains_of_file(path: str) -> dict[str, Domain]:
    """The domains that a Python file declares, by name."""
    source = read_bytes(path, CODE_LIMIT)
    module = ModuleType(f"_sketchlang_domain_{Path(path).stem}")
    module.__file__ = path
    # Where dataclasses and pickle look for the module of a class.
    sys.modules[module.__name__] = module
    try:
        exec(compile(source, path, "exec", dont_inherit=True), vars(module))
    except DomainError as error:
        raise InputError(str(error), place=path) from error
    except (Exception, SystemExit) as error:
        line = _line_of(error, path)
        where = f"{path}:{line}" if line else path
        raise InputError(f"{type(error).__name__}: {error}", place=where) from error
    found = {value.name: value for value in vars(module).values() if isinstance(value, Domain)}
    if not found:
        raise InputError("declares no domain (`domain = Domain(NAME)`)", place=path)
    return found


def _line_of(error: BaseException, path: str) -> int | None:
    if isinstance(error, SyntaxError):
        return error.lineno
    line = None
    step = error.__traceback__
    while step is not None:
        if step.tb_frame.f_code.co_filename == path:
            line = step.tb_lineno
        step = step.tb_next
    return line
