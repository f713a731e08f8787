"""The check as a whole. The other files of this package know one part of it each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sketchlang.checking import formulas
from sketchlang.checking.calls import Scope
from sketchlang.checking.comments import note_includes
from sketchlang.checking.declarations import Placed, collect
from sketchlang.checking.definitions import definition_order, type_definitions
from sketchlang.checking.expressions import Typer
from sketchlang.checking.invariants import Stated, satisfiable
from sketchlang.checking.relations import Relations, RulePlace
from sketchlang.checking.report import Report
from sketchlang.checking.rules import RuleReader
from sketchlang.checking.typed import Node
from sketchlang.diagnostics import Diagnostic, Label
from sketchlang.domain import Domain, DomainError, Function
from sketchlang.model import Feature, Invariant, Kind, Not, Rule, SketchModel
from sketchlang.source import Source, Span
from sketchlang.suggest import did_you_mean
from sketchlang.syntax import tree
from sketchlang.types import BOOL


@dataclass(frozen=True)
class CheckedSketch:
    """A sketch after the check. With errors among the diagnostics it is only what could be
    understood, and must not be compiled.

    `places[i]` is where feature i is declared (spans in the model belong to the file that an
    item stands in, which an `include` may have brought in), `definitions[i]` its definition,
    or None where it has none. `order` lists the features with every one after those that its
    definition uses. `atoms` are the names of the families of novelty atoms.
    """

    source: Source
    model: SketchModel
    domain: Domain | None
    places: tuple[Label, ...] = ()
    definitions: tuple[Node | None, ...] = ()
    order: tuple[int, ...] = ()
    atoms: tuple[str, ...] = ()


def check(
    parsed: tree.Tree, domain: Domain | None = None
) -> tuple[CheckedSketch, list[Diagnostic]]:
    """Check a tree against the domain that it uses (None: none is known)."""
    checker = _Checker(parsed, domain)
    checked = checker.run()
    main = parsed.source.name
    # In the order of the text; what an included file is to blame for comes last.
    found = sorted(
        checker.report.diagnostics,
        key=lambda d: (d.primary.source.name != main, d.primary.source.name, d.primary.span),
    )
    return checked, found


class _Checker:
    def __init__(self, parsed: tree.Tree, domain: Domain | None) -> None:
        self.tree = parsed
        self.source = parsed.source
        self.domain = domain
        self.report = Report()
        self.declarations = collect(parsed, self.report)
        declared = self.declarations
        self.is_part = declared.title is None and "sketch" not in declared.broken_items
        self.functions: Mapping[str, Function] = self._functions()
        self.index = {name: i for i, name in enumerate(self.declarations.features)}
        goals = domain.goals if domain is not None and self.functions else {}
        self.typer = Typer(
            self.declarations, domain, self.functions, goals, self.report, self.index
        )

    def run(self) -> CheckedSketch:
        declarations = self.declarations
        note_includes(self.tree, self.report)
        self._title()
        self._clashes()
        ordered = definition_order(declarations, self.typer)
        definitions = type_definitions(ordered, declarations, self.typer)
        features = tuple(
            Feature(
                name,
                Kind.BOOL if placed.item.kind == "bool" else Kind.NAT,
                placed.item.bounded,
                placed.item.span,
            )
            for name, placed in declarations.features.items()
        )
        for placed in declarations.features.values():
            if placed.item.bounded and placed.item.kind == "bool":
                label = placed.label(placed.item.span)
                message = f"`{placed.item.name.text}` is a Boolean: it is bounded anyway"
                self.report.add("bounded-boolean", message, label, hint="Remove `bounded`.")
        reader = RuleReader(
            features, self.index, declarations, self.report, frozenset(self.functions)
        )
        rules = tuple(reader.rule(placed) for placed in declarations.rules.values())
        goal = self._goal(reader)
        invariants, stated = self._invariants()
        self._relations(reader, rules, goal, invariants, stated)
        self._unused()
        name = declarations.title.item.name.text if declarations.title else "sketch"
        model = SketchModel(name, features, rules, goal, invariants)
        order_ = tuple(self.index[name] for name in ordered if name in self.index)
        places = tuple(p.label(p.item.name.span) for p in declarations.features.values())
        return CheckedSketch(
            self.source, model, self.domain, places, definitions, order_, self._atoms()
        )

    # The sketch as a whole.

    def _functions(self) -> Mapping[str, Function]:
        if self.domain is None:
            return {}
        try:
            return self.domain.functions
        except DomainError as error:
            use = self.declarations.use
            label = use.label(use.item.name.span) if use else Label(self.source, Span(0, 0))
            self.report.add("broken-domain", str(error), label)
            self.declarations.incomplete = True
            return {}

    def _title(self) -> None:
        declarations = self.declarations
        if self.is_part:
            first = self.tree.items[0].span if self.tree.items else Span(0, 0)
            self.report.add(
                "no-title",
                "this file names no sketch, so it is only a part for others to include",
                Label(self.source, Span(first.start, first.start)),
                hint="Begin with `sketch NAME` if it is a sketch.",
            )
        elif not declarations.rules and not declarations.broken_items & {"rule", ""}:
            end = len(self.source.text.rstrip())
            self.report.add(
                "no-rules",
                "the sketch has no rules: its only subgoals are the goal states",
                Label(self.source, Span(end, end)),
                hint="Write `rule NAME { CONDITIONS } -> { EFFECTS }`.",
            )

    def _clashes(self) -> None:
        """Features and definitions that hide a function of the domain."""
        declared: list[Placed[tree.FeatureItem] | Placed[tree.Define]]
        declared = [*self.declarations.features.values(), *self.declarations.defines.values()]
        for placed in declared:
            name = placed.item.name
            function = self.functions.get(name.text)
            if function is not None and self.domain is not None:
                place = function.place()
                self.report.add(
                    "function-name",
                    f"`{name.text}` is a function of domain {self.domain.name}",
                    placed.label(name.span),
                    *([place] if place else []),
                    hint="Choose another name.",
                )

    # Goal, invariants, atoms, rules.

    def _goal(self, reader: RuleReader) -> dict[int, bool] | None:
        placed = self.declarations.goal
        if placed is None:
            if "goal" not in self.declarations.broken_items and not self.is_part:
                end = len(self.source.text.rstrip())
                self.report.add(
                    "no-goal",
                    "the sketch names no goal: only the scene can say when a run is over",
                    Label(self.source, Span(end, end)),
                    hint="Write `goal { CONDITIONS }`.",
                )
            return None
        if not placed.item.block.literals:
            self.report.add(
                "empty-goal",
                "without a condition every state is a goal state, and nothing is left to do",
                placed.label(placed.item.block.span),
                hint="Write `goal { CONDITIONS }`, for example `goal { n = 0 }`.",
            )
        return reader.conditions(placed.item.block, placed.source)[0]

    def _invariants(self) -> tuple[tuple[Invariant, ...], list[Label]]:
        """The invariants that can hold, each on its own, and where they stand."""
        found, places = [], []
        for placed in self.declarations.invariants:
            scope = Scope(placed.source)
            node = self.typer.expect(placed.item.formula, BOOL, "an invariant", scope)
            if node.type != BOOL or not node.sound:
                continue
            made = formulas.invariant(placed, node, self.report)
            if made is None:
                continue
            if not satisfiable(made.formula, {}):
                label = placed.label(placed.item.formula.span)
                self.report.add("impossible-invariant", "this can never hold", label)
                continue
            if not satisfiable(Not(made.formula), {}):
                label = placed.label(placed.item.formula.span)
                message = "this holds whatever the values are, so it says nothing"
                self.report.add("idle-invariant", message, label, hint="Remove it.")
            found.append(made)
            places.append(placed.label(placed.item.formula.span))
        return tuple(found), places

    def _atoms(self) -> tuple[str, ...]:
        names: dict[str, Label] = {}
        for placed in self.declarations.atoms:
            for name in placed.item.names:
                label = placed.label(name.span)
                if name.text in names:
                    message = f"`{name.text}` is listed twice"
                    place = names[name.text]
                    first = Label(place.source, place.span, "first listed here")
                    self.report.add("repeated-atom", message, label, first)
                    continue
                names[name.text] = label
                if self.domain is not None and name.text not in self.domain.atoms:
                    families = ", ".join(f"`{family}`" for family in self.domain.atoms)
                    listed = f"Families of this domain: {families}." if families else None
                    hint = did_you_mean(name.text, self.domain.atoms) or listed
                    if name.text in self.functions:
                        hint = f"`{name.text}` is a function. {listed or ''}".strip()
                    message = f"domain {self.domain.name} has no atoms `{name.text}`"
                    self.report.add("unknown-atoms", message, label, hint=hint)
        return tuple(names)

    def _relations(
        self,
        reader: RuleReader,
        rules: tuple[Rule, ...],
        goal: Mapping[int, bool] | None,
        invariants: tuple[Invariant, ...],
        stated: list[Label],
    ) -> None:
        places = []
        for placed in self.declarations.rules.values():
            item = placed.item
            places.append(
                RulePlace(
                    placed.source,
                    item.name.span,
                    item.effects.span,
                    _spans(item.conditions, self.index),
                    _spans(item.effects, self.index),
                )
            )
        relations = Relations(reader.features, rules, places, reader.faulty, self.report)
        wanted = self.declarations.goal
        place = None if wanted is None else wanted.label(wanted.item.block.span)
        relations.check(goal, place, Stated(invariants, stated, self.report))

    def _unused(self) -> None:
        declarations = self.declarations
        blocks = [placed.item.conditions for placed in declarations.rules.values()]
        blocks += [placed.item.effects for placed in declarations.rules.values()]
        if declarations.goal is not None:
            blocks.append(declarations.goal.item.block)
        # Wrong literals count as well, so not the rules of the model.
        used = {literal.name.text for block in blocks for literal in block.literals}
        used |= self.typer.used
        # A broken item may be what uses them.
        if declarations.broken_items or declarations.incomplete or self.is_part:
            return
        for name, placed in declarations.features.items():
            if declarations.rules and name not in used and name not in self.functions:
                self.report.add(
                    "unused-feature",
                    f"feature `{name}` is named nowhere, so no subgoal may change it",
                    placed.label(placed.item.name.span),
                    hint="Name it in the rules or remove it.",
                )
        for name, define in declarations.defines.items():
            if name not in used:
                message = f"definition `{name}` is never used"
                self.report.add("unused-define", message, define.label(define.item.name.span))


def _spans(block: tree.Block, index: Mapping[str, int]) -> dict[int, Span]:
    spans: dict[int, Span] = {}
    for literal in block.literals:
        feature = index.get(literal.name.text)
        if feature is not None:
            spans.setdefault(feature, literal.span)
    return spans
