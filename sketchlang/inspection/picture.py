"""Domains and sketches as people read them (`sketchlang.domain.Picture`)."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from sketchlang.analysis.words import counted
from sketchlang.checking.checker import CheckedSketch
from sketchlang.domain import Domain, Function, first_sentence
from sketchlang.escape import shown_line
from sketchlang.loader import Loaded
from sketchlang.syntax.formatter import format_tree
from sketchlang.syntax.tree import Tree

NARROW = 44
"""Columns for names and types at most; what is longer has its line to itself."""


def table(rows: Iterable[tuple[str, str]]) -> list[str]:
    """Names and what they are, in two columns."""
    rows = list(rows)
    wide = min(NARROW, max((len(name) for name, _ in rows), default=0))
    lines = []
    for name, about in rows:
        if len(name) > wide and about:
            lines += [f"  {name}", f"  {'':<{wide}}  {about}"]
        else:
            lines.append(f"  {name:<{wide}}  {about}".rstrip())
    return lines


def summary_of(code: Any) -> str:
    """The first sentence of a docstring of a domain's own."""
    return first_sentence(inspect.getdoc(code) if getattr(code, "__doc__", None) else None)


@dataclass(frozen=True, eq=False)
class DomainPicture:
    """A domain: its sorts, what features can call, novelty atoms, actions."""

    domain: Domain

    def text(self, width: int, colour: bool) -> list[str]:
        """One line for each."""
        domain = self.domain
        lines = [f"{domain.name}: {domain.summary}" if domain.summary else domain.name]
        parts: list[tuple[str, Mapping[str, str]]] = [
            ("sorts", self.sorts),
            ("sets", self._functions(lambda one: one.result.is_set and not one.parameters)),
            ("functions", self._functions(lambda one: not one.result.is_set or one.parameters)),
            ("what the goal says", {f"goal {f}": f.summary for f in domain.goals.values()}),
            ("novelty atoms", self.atoms),
            ("actions", self.actions),
        ]
        for title, rows in parts:
            if rows:
                lines += ["", title, *table(rows.items())]
        return list(map(shown_line, lines))

    @property
    def sorts(self) -> dict[str, str]:
        """Each sort and what it is."""
        found = {}
        for name, cls in self.domain.sorts.items():
            own = cls.__dict__.get("__doc__") or ""
            text = summary_of(cls)
            found[name] = "" if not own or text.startswith(f"{cls.__name__}(") else text
        return found

    @property
    def atoms(self) -> dict[str, str]:
        """Each family of novelty atoms and what it is."""
        return {name: summary_of(family) for name, family in self.domain.atoms.items()}

    @property
    def actions(self) -> dict[str, str]:
        """The actions of the domain's problems, and those that are added to them."""
        added = {name: summary_of(schema) for name, schema in self.domain.actions.items()}
        return {**self.domain.schemas, **added}

    def _functions(self, wanted: Any) -> dict[str, str]:
        ordered = sorted(self.domain.functions.values(), key=lambda one: one.name)
        return {_signature(one): one.summary for one in ordered if wanted(one)}

    def svg(self) -> str | None:
        """A domain is not drawn."""
        return None

    def data(self) -> dict[str, Any]:
        """The same as plain data."""
        domain = self.domain
        return {
            "name": domain.name,
            "summary": domain.summary,
            "sorts": self.sorts,
            "functions": [_data(one) for one in domain.functions.values()],
            "goals": [_data(one) for one in domain.goals.values()],
            "atoms": self.atoms,
            "actions": self.actions,
            "has_scenes": domain.load is not None,
            "has_robots": domain.has_robots,
        }


def _signature(function: Function) -> str:
    text = str(function)
    return text if function.parameters else f"{text} : {function.result}"


def _data(function: Function) -> dict[str, Any]:
    return {
        "name": function.name,
        "parameters": [str(parameter) for parameter in function.parameters],
        "result": str(function.result),
        "about": function.summary,
    }


@dataclass(frozen=True, eq=False)
class SketchPicture:
    """A sketch: its canonical text, and what it consists of."""

    loaded: Loaded

    def text(self, width: int, colour: bool) -> list[str]:
        """The text, with that of included files, and a line about it."""
        checked = self.loaded.checked
        model = checked.model
        domain = "no domain" if checked.domain is None else f"domain {checked.domain.name}"
        head = (
            f"{model.name}: {domain}, {counted(len(model.features), 'feature')}, "
            f"{counted(len(model.rules), 'rule')} ({self.loaded.source.name})"
        )
        lines = [head, ""]
        for tree in _trees(self.loaded.tree):
            if tree is not self.loaded.tree:
                lines += [f"# from {tree.source.name}"]
            lines += format_tree(tree).rstrip("\n").split("\n")
            lines.append("")
        return list(map(shown_line, lines[:-1]))

    def svg(self) -> str | None:
        """`sketchlang graph` draws sketches."""
        return None

    def data(self) -> dict[str, Any]:
        """Features, rules and goal."""
        checked = self.loaded.checked
        return {"file": self.loaded.source.name, **_model(checked)}


def _trees(tree: Tree) -> list[Tree]:
    """A tree and those that it includes, what is included first."""
    found: list[Tree] = []
    for item in tree.items:
        inner = getattr(item, "tree", None)
        if isinstance(inner, Tree):
            found += [one for one in _trees(inner) if one not in found]
    return [*found, tree]


def _model(checked: CheckedSketch) -> dict[str, Any]:
    from sketchlang.analysis.words import effect, literal

    model = checked.model
    return {
        "name": model.name,
        "domain": None if checked.domain is None else checked.domain.name,
        "features": [
            {
                "name": feature.name,
                "kind": feature.kind.value,
                "bounded": feature.bounded,
                "definition": None if node is None else node.text,
            }
            for feature, node in zip(model.features, checked.definitions, strict=True)
        ],
        "rules": [
            {
                "name": rule.name,
                "conditions": [literal(model, f, wanted) for f, wanted in rule.conditions.items()],
                "effects": [effect(model, f, kind) for f, kind in rule.effects.items()],
            }
            for rule in model.rules
        ],
        "goal": None
        if model.goal is None
        else [literal(model, f, wanted) for f, wanted in model.goal.items()],
        "invariants": [invariant.text for invariant in model.invariants],
        "atoms": list(checked.atoms),
    }
