"""Domains: declared with decorators, found by name, by file, or not at all."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Any

import pytest

from sketchlang.domain import Domain, DomainError, Nat
from sketchlang.errors import InputError
from sketchlang.loader import domains_of_file, load_domain, load_sketch, load_text
from sketchlang.source import Source
from sketchlang.types import BOOL, NAT, Type


class Cell:
    pass


def one_function(function: Any, *sorts: type) -> Domain:
    domain = Domain("d")
    for sort in sorts:
        domain.sort(sort)
    domain.function(function)
    return domain


def test_signatures() -> None:
    def f(state: Any, c: Cell, n: Nat, p: bool) -> frozenset[Cell]:
        return frozenset()

    signature = one_function(f, Cell).functions["f"]
    assert signature.parameters == (Type("Cell"), NAT, BOOL)
    assert signature.result == Type("Cell", True)
    assert str(signature) == "f(Cell, nat, bool) : set of Cell"


@pytest.mark.parametrize(
    ("annotation", "expected"),
    [
        (bool, BOOL),
        (Nat, NAT),
        (Cell, Type("Cell")),
        ("Cell", Type("Cell")),
        ("Nat", NAT),
        (set[Cell], Type("Cell", True)),
        (tuple[Cell, ...], Type("Cell", True)),
        ("tuple[Cell, ...]", Type("Cell", True)),
        ("frozenset['Cell']", Type("Cell", True)),
        (Collection[Cell], Type("Cell", True)),
        (list["Cell"], Type("Cell", True)),
    ],
)
def test_annotations(annotation: Any, expected: Type) -> None:
    def f(state):  # type: ignore[no-untyped-def]
        return None

    f.__annotations__["return"] = annotation
    assert one_function(f, Cell).functions["f"].result == expected


@pytest.mark.parametrize(
    "annotation",
    [int, float, "int", None, str, tuple[Cell, Cell], frozenset[int], dict[Cell, Cell], "Cel(", 3],
)
def test_annotations_that_are_no_types(annotation: Any) -> None:
    def f(state):  # type: ignore[no-untyped-def]
        return None

    f.__annotations__["return"] = annotation
    with pytest.raises(DomainError, match="the result"):
        _ = one_function(f, Cell).functions


def test_functions_that_cannot_be_called() -> None:
    def nothing() -> bool:
        return True

    def keyword(state: Any, *, c: Cell) -> bool:
        return True

    def untyped(state, c) -> bool:  # type: ignore[no-untyped-def]
        return True

    def of_sets(state: Any, c: frozenset[Cell]) -> bool:
        return True

    for function in (nothing, keyword, untyped, of_sets):
        with pytest.raises(DomainError, match=function.__name__):
            _ = one_function(function, Cell).functions


def test_names() -> None:
    domain = Domain("d")

    def count(state: Any) -> bool:
        return True

    with pytest.raises(DomainError, match="cannot be named"):
        domain.function(count)
    domain.sort(Cell)
    with pytest.raises(DomainError, match="twice"):
        domain.sort(Cell)


def test_sorts_are_hashable() -> None:
    class Loose:
        __hash__ = None  # type: ignore[assignment]

    with pytest.raises(DomainError, match="not hashable"):
        Domain("d").sort(Loose)


def test_one_scene_loader() -> None:
    domain = Domain("d")
    domain.scenes(lambda path, options: None)
    with pytest.raises(DomainError, match="second"):
        domain.scenes(lambda path, options: None)


LAZY = '''
from __future__ import annotations
from typing import TYPE_CHECKING
from dataclasses import dataclass
from sketchlang.domain import Domain, Nat
if TYPE_CHECKING:
    from nowhere import State

domain = Domain("lazy")

@domain.function
def size(state: State, p: Peg) -> Nat:
    """How large."""
    return 1

@domain.function
def pegs(state) -> frozenset[Peg]:
    return frozenset()

@domain.sort
@dataclass(frozen=True)
class Peg:
    name: str
'''
USES = "sketch s\nuse {}\nfeature n : nat = sum p in pegs: size(p)\n"


def test_a_domain_in_a_file(tmp_path: Path) -> None:
    """Names that only the type checker knows, and sorts that follow later."""
    path = tmp_path / "lazy.py"
    path.write_text(LAZY)
    domains = domains_of_file(str(path))
    loaded = load_text(Source("t", USES.format("lazy")), domains)
    assert loaded.ok, loaded.diagnostics
    sketch = tmp_path / "s.sketch"
    sketch.write_text(USES.format("lazy"))
    assert load_sketch(str(sketch), str(path)).ok


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = 1", "declares no domain"),
        ("x = 1 / 0", r"broken.py:1: ZeroDivisionError"),
        ("\nx = (", r"broken.py:2: SyntaxError"),
        ("raise SystemExit(0)", "broken.py:1: SystemExit"),
        ("import no_such_module_at_all", "broken.py:1: ModuleNotFoundError"),
        ("from sketchlang.domain import *\nDomain('d').sort(list)", "not hashable"),
    ],
)
def test_files_that_are_no_domains(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "broken.py"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        domains_of_file(str(path))


def test_domains_of_other_packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Entry points are found without further ado, and their failures are told."""
    info = tmp_path / "others-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: others\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[sketchlang.domains]\nlazy = others_domain:domain\nbad = others_bad:domain\n"
        "none = others_domain:LAZY\n"
    )
    (tmp_path / "others_domain.py").write_text(LAZY + "\nLAZY = 3\n")
    (tmp_path / "others_bad.py").write_text("raise RuntimeError('no licence')")
    monkeypatch.syspath_prepend(tmp_path)
    found = load_domain("lazy")
    assert found is not None
    assert found.name == "lazy"
    assert load_text(Source("t", USES.format("lazy"))).ok
    for name, reason in (("bad", "RuntimeError: no licence"), ("none", "is no Domain")):
        codes = {d.code: d.message for d in load_text(Source("t", USES.format(name))).diagnostics}
        assert reason in codes["broken-domain"]
    assert load_domain("missing") is None
