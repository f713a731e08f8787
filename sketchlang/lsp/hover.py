"""What is shown for the name under the pointer, as Markdown."""

from __future__ import annotations

import inspect
import re

from sketchlang.analysis.argument import argument
from sketchlang.analysis.termination import NonTerminating, Terminating
from sketchlang.checking.typed import OPEN
from sketchlang.domain import Domain, Function
from sketchlang.lsp.state import Document
from sketchlang.lsp.symbols import Occurrence
from sketchlang.model import Effect
from sketchlang.syntax import printer, tree
from sketchlang.types import Type

MAX_SENTENCES = 4
"""Sentences of a proof that are shown for one name."""

_CHANGES = {
    Effect.SET: "becomes true",
    Effect.CLEAR: "becomes false",
    Effect.DEC: "falls",
    Effect.INC: "rises",
    Effect.NOT_INC: "does not rise",
    Effect.NOT_DEC: "does not fall",
    Effect.ANY: "may change in any way",
}


def text(document: Document, found: Occurrence) -> str | None:
    """The page for a name, or None if there is nothing to say."""
    name, domain = found.target.name, document.domain
    match found.target.kind:
        case "feature":
            return _joined(
                _code(_declaration(document, name)),
                _comment(document, name),
                _changes(document, found),
                _proof(document, name),
            )
        case "define":
            return _joined(_code(_declaration(document, name)), _comment(document, name))
        case "rule":
            return _joined(_code(_declaration(document, name)), _proof(document, name))
        case "variable" | "parameter":
            return _code(f"{name} : {_sort(document, found)}")
        case "function":
            function = domain.functions.get(name) if domain is not None else None
            return _function(function, domain) if function is not None and domain else None
        case "atoms":
            family = domain.atoms.get(name) if domain is not None else None
            return _joined(f"atoms `{name}`", inspect.getdoc(family)) if family else None
        case "sort":
            sort = domain.sorts.get(name) if domain is not None else None
            return _joined(f"sort `{name}`", inspect.getdoc(sort)) if sort else None
        case "domain":
            return _domain(domain) if domain is not None and domain.name == name else None
    return None


def _joined(*parts: str | None) -> str:
    return "\n\n".join(part for part in parts if part)


def _code(text: str | None) -> str | None:
    return f"```sketch\n{text}\n```" if text else None


def _item(document: Document, name: str) -> tuple[Occurrence, tree.Item] | None:
    for one in document.names:
        if one.declares and one.target.name == name and one.target.place is None:
            return one, one.item
    return None


def _declaration(document: Document, name: str) -> str | None:
    found = _item(document, name)
    if found is None or isinstance(found[1], tree.Broken):
        return None
    return "\n".join(printer.item(found[1]))


def _comment(document: Document, name: str) -> str | None:
    """The comment lines right above a declaration."""
    found = _item(document, name)
    if found is None:
        return None
    source = found[0].source
    row = source.position(found[1].span.start)[0] - 1
    lines: list[str] = []
    while row > 0 and source.line(row).lstrip().startswith("#"):
        lines.insert(0, source.line(row).lstrip("# \t"))
        row -= 1
    return "\n".join(lines) or None


def _changes(document: Document, found: Occurrence) -> str | None:
    """What the rule around a feature does to it, or what all rules do."""
    model = document.loaded.checked.model
    names = [feature.name for feature in model.features]
    if found.target.name not in names:
        return None
    feature = names.index(found.target.name)
    inside = found.item.name.text if isinstance(found.item, tree.RuleItem) else None
    lines = []
    for rule in model.rules:
        effect = rule.effects.get(feature)
        if inside in (None, rule.name) and (effect is not None or inside is not None):
            change = _CHANGES[effect] if effect is not None else "keeps its value"
            lines.append(f"- in `{rule.name}` it {change}")
    return "\n".join(lines) or None


def _proof(document: Document, name: str) -> str | None:
    """The part of a feature or rule in the proof of termination."""
    verdict, model = document.verdict, document.loaded.checked.model
    match verdict:
        case Terminating():
            word = re.compile(rf"(?<!\w){re.escape(name)}(?!\w)")
            sentences = [
                re.sub(r"^[\d. ]+", "", line).strip()
                for line in _sentences(argument(model, verdict.steps))
                if word.search(line)
            ]
            shown = "\n".join(f"- {line}" for line in sentences[:MAX_SENTENCES])
            return _joined("The sketch terminates.", shown)
        case NonTerminating():
            return "The sketch does not terminate: `sketchlang terminate` shows how."
    return None


def _sentences(lines: list[str]) -> list[str]:
    """The lines of an argument with those that go on put together."""
    whole: list[str] = []
    for line in lines:
        if whole and line.startswith(" ") and not re.match(r"\s*\d+\. ", line):
            whole[-1] += " " + line.strip()
        else:
            whole.append(line)
    return whole


def _sort(document: Document, found: Occurrence) -> str:
    if isinstance(found.item, tree.Define):
        for parameter in found.item.parameters:
            if parameter.name.text == found.target.name and found.over is None:
                return parameter.type.text
    return str(_element(document, found.over) or "?")


def _element(document: Document, over: tree.Expr | None) -> Type | None:
    """The sort of a set's elements, as far as its text tells."""
    if over is None or document.domain is None:
        return None
    match over:
        case tree.GoalAtom(call):
            return _of_call(document, call)
        case tree.Call():
            return _of_call(document, over)
        case tree.Operation(_, operands):
            return _element(document, operands[0])
        case tree.Conditional(_, first):
            return _element(document, first)
        case tree.Comprehension(binders) if len(binders) == 1:
            return _element(document, binders[0].domain)
    return None


def _of_call(document: Document, call: tree.Call) -> Type | None:
    """The sort of the elements of a set that a call gives: a set of the domain, a relation with an
    argument left open, or a definition."""
    assert document.domain is not None
    name = call.name.text
    found = _item(document, name)
    if found is not None and isinstance(found[1], tree.Define):
        return _element(document, found[1].body)
    function = document.domain.functions.get(name)
    if function is None:
        return None
    if function.result.is_set:
        return function.result.element
    left = [
        side
        for side, argument in zip(function.parameters, call.arguments, strict=False)
        if isinstance(argument, tree.Call) and argument.name.text == OPEN
    ]
    return left[0] if len(left) == 1 else None


def _function(function: Function, domain: Domain) -> str:
    signature = str(function) if function.parameters else f"{function.name} : {function.result}"
    return _joined(
        _code(signature), inspect.getdoc(function.call), f"function of domain `{domain.name}`"
    )


def _domain(domain: Domain) -> str:
    functions = "\n".join(f"- `{one}` {one.summary}" for _, one in sorted(domain.functions.items()))
    atoms = ", ".join(f"`{name}`" for name in domain.atoms)
    return _joined(
        f"domain `{domain.name}`. {domain.summary}", functions, f"atoms {atoms}" if atoms else None
    )
