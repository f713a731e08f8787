"""All that there is to say of a sketch: what the check found, and what analyses of it find."""

from __future__ import annotations

from sketchlang.diagnostics import Diagnostic, Label
from sketchlang.escape import visible
from sketchlang.loader import Loaded
from sketchlang.model import Rule
from sketchlang.source import Source, Span
from sketchlang.syntax import tree


def findings(loaded: Loaded) -> list[Diagnostic]:
    """All that `check` says of a sketch, in the order of the text."""
    found = list(loaded.diagnostics)
    if loaded.ok:
        found.extend(further_warnings(loaded))
    main = loaded.source.name
    found.sort(key=lambda one: (one.primary.source.name != main, one.primary.span))
    return found


def further_warnings(loaded: Loaded) -> list[Diagnostic]:
    """Findings of analyses that only make sense for a sketch without errors."""
    if not loaded.checked.model.rules:
        return []
    from sketchlang.analysis.coverage_report import warnings

    more = warnings(loaded.checked.model, Places(loaded).source, title(loaded))
    return [one for one in more if one.code != "unusable-rule" or not _explained(one, loaded)]


def _explained(unusable: Diagnostic, loaded: Loaded) -> bool:
    """Whether it was said already why a rule can never be used."""
    whole = unusable.primary
    if any(one.code == "empty-goal" for one in loaded.diagnostics):
        return True
    return any(
        one.code in ("goal-rule", "rule-against-invariant")
        and one.primary.source.name == whole.source.name
        and whole.span.start <= one.primary.span.start < whole.span.end
        for one in loaded.diagnostics
    )


class Places:
    """Where rules were written: a sketch may include others, so in more than one file."""

    def __init__(self, loaded: Loaded) -> None:
        self._main = loaded.source
        self._sources: dict[str, Source] = {}
        self._collect(loaded.tree)

    def _collect(self, parsed: tree.Tree) -> None:
        for item in parsed.items:
            if isinstance(item, tree.RuleItem):
                self._sources.setdefault(item.name.text, parsed.source)
            elif isinstance(item, tree.Include) and item.tree is not None:
                self._collect(item.tree)

    def source(self, rule: Rule) -> Source:
        """The text in which a rule stands."""
        return self._sources.get(rule.name, self._main)

    def position(self, rule: Rule, span: Span | None = None) -> str:
        """`file:line:column` of a rule, or of a span in it."""
        source = self.source(rule)
        line, column = source.position((span or rule.span).start)
        return f"{source.name}:{line}:{column}"

    def shown(self, rule: Rule, span: Span | None = None) -> str:
        """The same for people."""
        return visible(self.position(rule, span))


def title(loaded: Loaded) -> Label:
    """The sketch's name where it is declared: the place of what belongs to no item."""
    for item in loaded.tree.items:
        if isinstance(item, tree.Title):
            return Label(loaded.source, item.name.span)
    return Label(loaded.source, Span(0, 0))
