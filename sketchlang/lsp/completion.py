"""What could be written at a place. The item there is rarely complete, so its tokens are looked at
and not its tree."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sketchlang.loader import builtin_sketches, domain_names
from sketchlang.lsp.state import Document
from sketchlang.source import Span
from sketchlang.syntax import tree
from sketchlang.syntax.lexer import span, tokenize
from sketchlang.syntax.mistakes import ITEM_KINDS
from sketchlang.syntax.repair import ITEMS

if TYPE_CHECKING:
    from lark import Token

QUANTIFIERS = {
    "some": "some ${1:x} in ${2:SET}: ${3:CONDITION}",
    "all": "all ${1:x} in ${2:SET}: ${3:CONDITION}",
    "count": "count ${1:x} in ${2:SET}: ${3:CONDITION}",
    "sum": "sum ${1:x} in ${2:SET}: ${3:NUMBER}",
    "min": "min ${1:x} in ${2:SET}: ${3:NUMBER}",
    "max": "max ${1:x} in ${2:SET}: ${3:NUMBER}",
}
_SNIPPETS = {
    "sketch": "sketch ${1:NAME}",
    "use": "use ${1:DOMAIN}",
    "include": "include ${1:SKETCH}",
    "bounded": "bounded feature ${1:NAME} : nat",
    "feature": "feature ${1:NAME} : ${2|bool,nat|} = ${3:EXPRESSION}",
    "define": "define ${1:NAME}(${2:x} : ${3:SORT}) = ${4:EXPRESSION}",
    "invariant": "invariant ${1:FORMULA}",
    "atoms": "atoms ${1:NAME}",
    "goal": "goal { ${1:CONDITIONS} }",
    "rule": "rule ${1:NAME} { ${2:CONDITIONS} } -> { ${3:EFFECTS} }",
}


@dataclass(frozen=True, slots=True)
class Proposal:
    """What can be written: `kind` is a word that editors have a picture for, `detail` stands
    beside it, `snippet` has places to fill in."""

    label: str
    kind: str
    detail: str = ""
    documentation: str = ""
    snippet: str | None = None


def proposals(document: Document, offset: int) -> list[Proposal]:
    """All that can be written at an offset of a document."""
    text = document.source.text[:offset]
    line = text[text.rfind("\n") + 1 :]
    if "#" in line and '"' not in line:
        return []
    tokens = [token for token in tokenize(text)[0] if token.type != "COMMENT"]
    # The word that is being written is not part of what it is written behind.
    if tokens and span(tokens[-1]).end == offset and tokens[-1].isidentifier():
        tokens.pop()
    item = _item(tokens)
    if not item or not line.strip() or (line.strip().isidentifier() and not _open(item)):
        begun = list(_items())
        return begun if not item or not _open(item) else [*_inside(document, item), *begun]
    return list(_inside(document, item))


def _item(tokens: Sequence[Token]) -> list[Token]:
    """The tokens of the last item."""
    for number in range(len(tokens) - 1, -1, -1):
        first = number == 0 or tokens[number - 1].line != tokens[number].line
        if first and tokens[number].type in ITEM_KINDS:
            return list(tokens[number:])
    return []


def _open(item: Sequence[Token]) -> bool:
    """Whether an item cannot end where it does."""
    kinds = [token.type for token in item]
    if kinds.count("_LBRACE") > kinds.count("_RBRACE") or kinds.count("_LPAR") > kinds.count(
        "_RPAR"
    ):
        return True
    unfinished = {"EQ", "_ARROW", "_COLON", "_COMMA", "_AND", "_OR", "NOT", "_PLUS", "IN", "_WHERE"}
    return kinds[-1] in unfinished | ITEM_KINDS


def _items() -> Iterator[Proposal]:
    for word in ITEMS:
        yield Proposal(word, "keyword", snippet=_SNIPPETS[word])


def _inside(document: Document, item: Sequence[Token]) -> Iterator[Proposal]:
    kinds = [token.type for token in item]
    match kinds[0]:
        case "_USE" if len(item) == 1:
            for name in domain_names():
                yield Proposal(name, "module", "domain")
        case "_INCLUDE" if len(item) == 1:
            for name in builtin_sketches():
                yield Proposal(name, "file", "built-in sketch")
        case "_ATOMS" if document.domain is not None:
            for name in document.domain.atoms:
                yield Proposal(name, "value", f"atoms of {document.domain.name}")
        case "_GOAL" | "_RULE" if kinds.count("_LBRACE") > kinds.count("_RBRACE"):
            yield from _literals(document, effects="_ARROW" in kinds)
        case "_FEATURE" | "BOUNDED" | "_DEFINE" if "EQ" not in kinds:
            if kinds[-1] == "_COLON":
                yield from _types(document, sorts=kinds[0] == "_DEFINE")
        case "_FEATURE" | "BOUNDED" | "_DEFINE" | "_INVARIANT":
            yield from _expression(document, item)


def _types(document: Document, sorts: bool) -> Iterator[Proposal]:
    yield Proposal("bool", "keyword", "true or false")
    yield Proposal("nat", "keyword", "a whole number from 0 on")
    if sorts and document.domain is not None:
        for name in document.domain.sorts:
            yield Proposal(name, "class", f"sort of {document.domain.name}")


def _literals(document: Document, effects: bool) -> Iterator[Proposal]:
    for name, kind in _features(document):
        forms: tuple[str, ...]
        if kind == "bool":
            forms = (name, f"!{name}", f"{name}?") if effects else (name, f"!{name}")
        elif effects:
            forms = (f"{name}--", f"{name}++", f"{name}?", f"!{name}++", f"!{name}--")
        else:
            forms = (f"{name} > 0", f"{name} = 0")
        for form in forms:
            yield Proposal(form, "field", kind)


def _features(document: Document) -> Iterator[tuple[str, str]]:
    for one in document.names:
        if one.declares and isinstance(one.item, tree.FeatureItem) and one.target.kind == "feature":
            yield one.target.name, one.item.kind


def _expression(document: Document, item: Sequence[Token]) -> Iterator[Proposal]:
    domain = document.domain
    sets_first = item[-1].type == "IN"
    for name in _local(item):
        yield Proposal(name, "variable", "variable")
    functions = sorted(domain.functions.items()) if domain is not None else []
    for name, function in functions:
        if sets_first and not function.result.is_set:
            continue
        snippet = f"{name}(${{1:x}})" if function.parameters else None
        yield Proposal(name, "function", str(function), function.summary, snippet)
    if sets_first:
        return
    for name, kind in _features(document):
        yield Proposal(name, "field", f"feature : {kind}")
    for one in document.names:
        if one.declares and one.target.kind == "define":
            yield Proposal(one.target.name, "function", "define")
    for word, snippet in QUANTIFIERS.items():
        yield Proposal(word, "keyword", snippet=snippet)
    for word in ("not", "and", "or", "true", "false", "where", "default"):
        yield Proposal(word, "keyword")


def _local(item: Sequence[Token]) -> list[str]:
    """Parameters, and variables of quantifiers, that were named before."""
    found: dict[str, None] = {}
    for before, token, after in zip(item, item[1:], item[2:], strict=False):
        bound = before.type in {"SOME", "ALL", "COUNT", "SUM", "MIN", "MAX"} and after.type == "IN"
        parameter = item[0].type == "_DEFINE" and after.type == "_COLON"
        if token.type == "NAME" and (bound or parameter):
            found[str(token)] = None
    return list(found)


def word_before(text: str, offset: int) -> Span:
    """The word that is being written at an offset."""
    start = offset
    while start and (text[start - 1].isalnum() or text[start - 1] == "_"):
        start -= 1
    return Span(start, offset)
