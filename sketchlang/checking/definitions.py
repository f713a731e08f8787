"""The definitions of features, and `define`: each typed after those that it uses."""

from __future__ import annotations

from sketchlang.checking.calls import Binding, Scope
from sketchlang.checking.declarations import Declarations, Placed
from sketchlang.checking.expressions import Typer
from sketchlang.checking.order import names_in, order
from sketchlang.checking.typed import Node
from sketchlang.diagnostics import Label
from sketchlang.suggest import did_you_mean
from sketchlang.syntax import tree
from sketchlang.types import BOOL, NAT, UNKNOWN


def definition_order(declarations: Declarations, typer: Typer) -> list[str]:
    """Features and definitions with the used before their users; circles are errors."""
    uses: dict[str, list[str]] = {}
    # A declaration that hides a function is an error by itself.
    functions = frozenset(typer.functions)
    for name, feature in declarations.features.items():
        body = feature.item.definition
        uses[name] = list(names_in(body, functions)) if body is not None else []
    for name, define in declarations.defines.items():
        bound = frozenset(parameter.name.text for parameter in define.item.parameters)
        uses[name] = list(names_in(define.item.body, functions | bound))
    ordered, circles = order(uses)
    for circle in circles:
        typer.circular.update(circle)
        labels = [typer.declaration(name) for name in circle]
        path = " -> ".join(f"`{name}`" for name in [*circle, circle[0]])
        alone = len(circle) == 1
        message = "a definition uses itself" if alone else "definitions use each other"
        typer.report.add("circular-definition", f"{message}: {path}", *labels)
    return ordered


def type_definitions(
    ordered: list[str], declarations: Declarations, typer: Typer
) -> tuple[Node | None, ...]:
    """The typed definition of every feature, None for those without one."""
    typed: dict[str, Node] = {}
    for name in ordered:
        define = declarations.defines.get(name)
        feature = declarations.features.get(name)
        if define is not None:
            _check_define(name, define, declarations, typer)
        elif feature is not None and feature.item.definition is not None:
            wanted = BOOL if feature.item.kind == "bool" else NAT
            what = f"the definition of `{name}`"
            scope = Scope(feature.source)
            typed[name] = typer.expect(feature.item.definition, wanted, what, scope)
    return tuple(typed.get(name) for name in declarations.features)


def _check_define(
    name: str, placed: Placed[tree.Define], declarations: Declarations, typer: Typer
) -> None:
    """Check a body once by itself, with the parameters as variables."""
    names: dict[str, Binding] = {}
    for level, parameter in enumerate(placed.item.parameters):
        label = placed.label(parameter.name.span)
        if parameter.name.text in names:
            place = names[parameter.name.text].place
            first = Label(place.source, place.span, "first declared here")
            message = f"parameter `{parameter.name.text}` is declared twice"
            typer.report.add("duplicate-parameter", message, label, first)
            continue
        type_ = typer.parameter_type(parameter)
        if type_ == UNKNOWN:
            _unknown_sort(parameter.type, placed, declarations, typer)
        typer.hiding(parameter.name, Scope(placed.source))
        node = typer.store.variable(level, type_, label)
        names[parameter.name.text] = Binding(node, label)
    scope = Scope(placed.source, names, len(placed.item.parameters))
    body = typer.node(placed.item.body, scope)
    if not body.sound:
        return
    typer.sound.add(name)
    for text, binding in names.items():
        if not binding.used:
            message = f"parameter `{text}` is never used"
            typer.report.add("unused-parameter", message, binding.place)


def _unknown_sort(
    name: tree.Name, placed: Placed[tree.Define], declarations: Declarations, typer: Typer
) -> None:
    if typer.domain is None and (declarations.use or "use" in declarations.broken_items):
        return
    sorts = typer.domain_sorts()
    hint = did_you_mean(name.text, {*sorts, "bool", "nat"})
    if hint is None and sorts:
        hint = "Sorts of this domain: " + ", ".join(f"`{sort}`" for sort in sorted(sorts)) + "."
    message = f"there is no type `{name.text}`"
    typer.report.add("unknown-sort", message, placed.label(name.span), hint=hint)
