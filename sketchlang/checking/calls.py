"""Names and calls: variables, features, definitions and functions of the domain."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field

from sketchlang.checking.choices import foreign_function, offered, signature
from sketchlang.checking.declarations import Declarations, Placed
from sketchlang.checking.report import Report
from sketchlang.checking.typed import OPEN, Node, Store
from sketchlang.diagnostics import Label
from sketchlang.domain import Domain, Function
from sketchlang.source import Source, Span
from sketchlang.suggest import did_you_mean
from sketchlang.syntax import tree
from sketchlang.syntax.mistakes import FOREIGN
from sketchlang.types import BOOL, NAT, UNKNOWN, Type


@dataclass
class Binding:
    """A local name: a quantifier's variable or a definition's parameter."""

    node: Node
    place: Label
    used: bool = False


@dataclass(frozen=True)
class Scope:
    """The local names at one place and the number of quantifiers around it."""

    source: Source
    names: Mapping[str, Binding] = field(default_factory=dict)
    level: int = 0
    wants_set: bool = False

    def for_set(self) -> Scope:
        """The same scope where an expression for a set is expected."""
        return Scope(self.source, self.names, self.level, True)

    def label(self, span: Span, text: str = "") -> Label:
        """A place in the file of this scope."""
        return Label(self.source, span, text)

    def bind(self, name: str, binding: Binding) -> Scope:
        """The scope inside a quantifier."""
        return Scope(self.source, {**self.names, name: binding}, self.level + 1)


@dataclass
class Calls(ABC):
    """The part of the typer that knows names.

    `features` maps features to their index. `sound` are the definitions without mistakes of
    their own. `bodies` has the result of unfolding a definition for some arguments, so that
    definitions that use others many times cost no more than they are long. `depth` counts the
    expressions around the one that is being typed.
    """

    declarations: Declarations
    domain: Domain | None
    functions: Mapping[str, Function]
    goals: Mapping[str, Function]
    report: Report
    features: Mapping[str, int]
    store: Store = field(default_factory=Store)
    used: set[str] = field(default_factory=set)
    circular: set[str] = field(default_factory=set)
    sound: set[str] = field(default_factory=set)
    bodies: dict[tuple[str, tuple[int, ...], int], Node] = field(default_factory=dict)
    depth: int = 0

    @abstractmethod
    def node(self, expr: tree.Expr, scope: Scope) -> Node:
        """The node of an expression; of type UNKNOWN where a mistake was reported."""

    @abstractmethod
    def expect(self, expr: tree.Expr, wanted: Type, what: str, scope: Scope) -> Node:
        """The node of an expression that has to be of a given type."""

    @abstractmethod
    def is_image(self, expr: tree.Call, function: Function) -> bool:
        """Whether a call is one of a relation: arguments may be left open, or sets."""

    @abstractmethod
    def image(self, expr: tree.Call, function: Function, scope: Scope) -> Node:
        """The truth value, set or relation that such a call stands for."""

    @abstractmethod
    def applied(
        self,
        relation: Node,
        sign: str,
        arguments: tuple[tree.Expr, ...],
        place: Label,
        scope: Scope,
    ) -> Node:
        """A relation with arguments."""

    @abstractmethod
    def builtin(self, expr: tree.Call, scope: Scope) -> Node | None:
        """A call of a function of the language itself; None for other names."""

    def fits(self, given: Type, wanted: Type) -> bool:
        """Whether a value may be of a type: something can be of both sorts."""
        if given == wanted or UNKNOWN in (given, wanted):
            return True
        if not (given.is_element and wanted.is_element) or self.domain is None:
            return False
        return self.domain.overlap(given.name, wanted.name)

    def joined(self, first: Type, second: Type) -> Type | None:
        """The lowest type above two types; None if there is none."""
        if first == second:
            return first
        alike = first.is_set == second.is_set and first.is_relation == second.is_relation
        sorts = self.domain_sorts()
        if not alike or self.domain is None or not {first.name, second.name} <= sorts:
            return None
        name = self.domain.above(first.name, second.name)
        to = None
        if first.to is not None and second.to is not None:
            to = self.domain.above(first.to, second.to)
        if name is None or (first.is_relation and to is None):
            return None
        return Type(name, first.is_set, to)

    def too_deep(self, place: Label) -> None:
        """Report nesting that no evaluator could follow."""
        self.report.add(
            "nested-too-deeply",
            "with its definitions unfolded, this is nested too deeply",
            place,
            hint="Make parts of it features of their own.",
        )

    def unknown(self, place: Label) -> Node:
        """What stands for an expression with a mistake."""
        return self.store.node("unknown", UNKNOWN, place)

    def hiding(self, name: tree.Name, scope: Scope) -> None:
        """Report a local name that hides another one."""
        text = name.text
        outer = scope.names.get(text)
        if outer is not None:
            other: tuple[Label, ...] = (_with_text(outer.place, "the other one"),)
        elif text in self.declarations.features or text in self.declarations.defines:
            other = (self.declaration(text),)
        elif text in self.functions:
            other = ()
        else:
            return
        self.report.add(
            "shadowing",
            f"`{text}` hides another `{text}`",
            scope.label(name.span),
            *other,
            hint="Choose another name.",
        )

    def declaration(self, name: str) -> Label:
        """Where a feature or definition is declared."""
        declared: Placed[tree.FeatureItem] | Placed[tree.Define]
        declared = self.declarations.features.get(name) or self.declarations.defines[name]
        return declared.label(declared.item.name.span, "declared here")

    def call(self, expr: tree.Call, scope: Scope) -> Node:
        """The node of a name or call."""
        name = expr.name.text
        place = scope.label(expr.span)
        binding = scope.names.get(name)
        if binding is not None:
            binding.used = True
            if self._takes_nothing(expr, f"variable `{name}`", scope):
                return binding.node
            return self.unknown(place)
        function = self.functions.get(name)
        # A declaration of the same name is an error by itself; what is meant here shows.
        meant = function is not None and len(function.parameters) == len(expr.arguments)
        if name in self.declarations.features and not meant:
            return self._feature(expr, scope)
        if name in self.declarations.defines and not meant:
            return self._define(expr, scope)
        if function is not None:
            return self.function_call(expr, function, scope)
        builtin = self.builtin(expr, scope)
        if builtin is not None:
            return builtin
        # What stands in a call of another language's is not written for this one.
        self.report.muted += foreign_function(name) is not None
        for argument in expr.arguments:
            if not (isinstance(argument, tree.Call) and argument.name.text == OPEN):
                self.node(argument, scope)
        self.report.muted -= foreign_function(name) is not None
        self._undefined(expr.name, scope)
        return self.unknown(place)

    def function_call(self, expr: tree.Call, function: Function, scope: Scope) -> Node:
        """The node of a call of a domain's function, or of what its goal says."""
        place = scope.label(expr.span)
        if self.is_image(expr, function):
            return self.image(expr, function, scope)
        what = f"`{expr.name.text}`"
        arguments = self._arguments(expr, function.parameters, None, what, scope, function)
        if arguments is None:
            return self.store.node("unknown", function.result, place)
        return self.store.call(function, arguments, place)

    def no_goal(self, name: str, place: Label) -> None:
        """Report a name after `goal` that the goal says nothing of."""
        hint = did_you_mean(name, self.goals)
        if hint is None and self.goals:
            hint = "Known: " + ", ".join(f"`goal {goal}`" for goal in sorted(self.goals)[:8]) + "."
        where = f" of domain {self.domain.name}" if self.domain is not None else ""
        message = f"the goal{where} says nothing of `{name}`"
        self.report.add("undefined-name", message, place, hint=hint)

    def _undefined(self, name: tree.Name, scope: Scope) -> None:
        text, declarations = name.text, self.declarations
        if text in declarations.broken or declarations.incomplete:
            return
        if declarations.use is None and "use" in declarations.broken_items:
            return
        if declarations.use is not None and self.domain is None:
            return
        known = {*scope.names, *declarations.features, *declarations.defines, *self.functions}
        hint = foreign_function(text) or did_you_mean(text, known)
        if hint is None and text in FOREIGN:
            hint = f"Did you mean `{FOREIGN[text]}`?"
        if hint is None and self.domain is None:
            hint = "The sketch names no domain: `use DOMAIN` brings in its functions."
        if text in self.domain_sorts():
            hint = f"`{text}` is a sort: quantify over a set of them."
        if hint is None and self.domain is not None:
            hint = offered(self.domain.name, self.functions, scope.wants_set)
            if text in self.domain.atoms:
                hint = f"`{text}` is a family of novelty atoms. {hint or ''}".rstrip()
        where = f" in domain {self.domain.name}" if self.domain is not None else ""
        message = f"`{text}` is neither declared here nor a function{where}"
        self.report.add("undefined-name", message, scope.label(name.span), hint=hint)

    def domain_sorts(self) -> frozenset[str]:
        """Names of the domain's sorts."""
        return frozenset(self.domain.sorts) if self.domain is not None else frozenset()

    def _takes_nothing(self, expr: tree.Call, what: str, scope: Scope) -> bool:
        if not expr.arguments:
            return True
        for argument in expr.arguments:
            self.node(argument, scope)
        span = expr.arguments[0].span.to(expr.arguments[-1].span)
        message = f"{what} takes no arguments"
        self.report.add(
            "wrong-arity", message, scope.label(span), hint=f"Write `{expr.name.text}`."
        )
        return False

    def _feature(self, expr: tree.Call, scope: Scope) -> Node:
        name = expr.name.text
        self.used.add(name)
        kind = BOOL if self.declarations.features[name].item.kind == "bool" else NAT
        place = scope.label(expr.span)
        if not self._takes_nothing(expr, f"feature `{name}`", scope):
            return self.store.node("unknown", kind, place)
        return self.store.node("feature", kind, place, (), self.features[name])

    def _define(self, expr: tree.Call, scope: Scope) -> Node:
        name = expr.name.text
        self.used.add(name)
        place = scope.label(expr.span)
        declared = self.declarations.defines[name]
        wanted = tuple(self.parameter_type(p) for p in declared.item.parameters)
        label = declared.label(declared.item.name.span, "defined here")
        if not wanted and expr.arguments and name not in self.circular:
            relation = self.unfold(name, (), scope.level)
            if relation.type.is_relation:
                return self.applied(relation, "", expr.arguments, place, scope)
        arguments = self._arguments(expr, wanted, label, f"`{name}`", scope)
        if arguments is None or name in self.circular:
            return self.unknown(place)
        unfolded = self.unfold(name, arguments, scope.level)
        if not unfolded.sound and name in self.sound and all(a.sound for a in arguments):
            self.too_deep(place)
        return unfolded

    def _arguments(
        self,
        expr: tree.Call,
        wanted: tuple[Type, ...],
        declared: Label | None,
        what: str,
        scope: Scope,
        function: Function | None = None,
    ) -> tuple[Node, ...] | None:
        """The nodes of a call's arguments, or None if they do not fit."""
        given = [self.node(argument, scope) for argument in expr.arguments]
        origin = (declared,) if declared is not None else self.origin(expr)
        if len(given) != len(wanted):
            takes = f"takes {_count(len(wanted))}, "
            self.report.add(
                "wrong-arity",
                f"{what} {takes}{len(given) or 'none'} given",
                scope.label(expr.span),
                *origin,
                hint=None if function is None else signature(function, self.functions, given),
            )
            return None
        fits = True
        for number, (node, type_) in enumerate(zip(given, wanted, strict=True), 1):
            if not self.fits(node.type, type_):
                self.report.add(
                    "wrong-argument",
                    f"argument {number} of {what} must be of type {type_}, this is {a(node.type)}",
                    scope.label(expr.arguments[number - 1].span),
                    *origin,
                    hint=_one_of(node, type_, expr.name.text, len(wanted)),
                )
                fits = False
        return tuple(given) if fits else None

    def origin(self, expr: tree.Expr) -> tuple[Label, ...]:
        """Where the type of a name or call was declared."""
        if not isinstance(expr, tree.Call):
            return ()
        name = expr.name.text
        if name in self.declarations.features or name in self.declarations.defines:
            return (self.declaration(name),)
        function = self.functions.get(name)
        place = function.place() if function is not None else None
        return (place,) if place is not None else ()

    # Definitions.

    def parameter_type(self, parameter: tree.Parameter) -> Type:
        """The type that a parameter is declared with; UNKNOWN if there is none of the name."""
        name = parameter.type.text
        if name in ("bool", "nat"):
            return Type(name)
        return Type(name) if name in self.domain_sorts() else UNKNOWN

    def unfold(self, name: str, arguments: tuple[Node, ...], level: int) -> Node:
        """A definition's body with its parameters replaced by arguments."""
        key = (name, tuple(map(id, arguments)), level)
        found = self.bodies.get(key)
        if found is None:
            declared = self.declarations.defines[name]
            names = {
                parameter.name.text: Binding(node, declared.label(parameter.span))
                for parameter, node in zip(declared.item.parameters, arguments, strict=True)
            }
            # The mistakes in the body were reported where it is defined.
            self.report.muted += 1
            found = self.node(declared.item.body, Scope(declared.source, names, level))
            self.report.muted -= 1
            self.bodies[key] = found
        return found


def _one_of(given: Node, wanted: Type, name: str, arguments: int) -> str | None:
    """What to write where a set is given for one of its elements."""
    if not given.type.is_set or given.type.element != wanted or wanted.is_set:
        return None
    call = f"{name}(x)" if arguments == 1 else f"{name}(...)"
    return f"Quantify over it: `some x in {given.text}: {call}`."


def _with_text(label: Label, text: str) -> Label:
    return Label(label.source, label.span, text)


def a(type_: Type) -> str:
    """Something of a type, in a sentence."""
    if type_ == BOOL:
        return "a Boolean"
    if type_ == NAT:
        return "a number"
    if type_.is_set or type_.is_relation:
        return f"a {type_}"
    article = "an" if type_.name[0] in "AEIOU" else "a"
    return f"{article} {type_.name}"


def _count(number: int) -> str:
    return {0: "no arguments", 1: "1 argument"}.get(number, f"{number} arguments")
