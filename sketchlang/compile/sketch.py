"""A sketch that can be run."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from sketchlang.checking.checker import CheckedSketch
from sketchlang.checking.typed import Node
from sketchlang.compile.closures import Compiler, Layout
from sketchlang.compile.errors import BrokenPromiseError, EvaluationError
from sketchlang.compile.invariants import truth
from sketchlang.compile.seam import Frame, Run
from sketchlang.diagnostics import Diagnostic, Label
from sketchlang.domain import Function, position_of
from sketchlang.model import Kind, SketchModel
from sketchlang.source import Span

CAREFUL_STATES = 8
"""So many states are evaluated with every domain function called twice ..."""

CAREFUL_EVERY = 1024
"""... and later on every so many-th state."""


@dataclass(frozen=True)
class CompiledSketch:
    """A sketch with evaluators.

    `evaluate(state)` returns one value a feature, Booleans as 0 and 1, and raises
    `EvaluationError` where a domain function or an invariant breaks its promise.
    `atoms` are the functions that list the novelty atoms of a state. `functions[i]` are the
    domain functions that feature i depends on. `goal_test` is the domain's own test, if it has
    one, that stands in for the sketch's goal when a plan is searched.
    """

    model: SketchModel
    evaluate: Callable[[Any], tuple[int, ...]]
    atoms: tuple[Callable[[Any], Iterable[Hashable]], ...]
    functions: tuple[tuple[Function, ...], ...] = ()
    goal_test: Callable[[Any], bool] | None = None

    @cached_property
    def ignores(self) -> frozenset[str]:
        """The parts of a state that all functions of the features declare to ignore."""
        used = [function.ignores for functions in self.functions for function in functions]
        return frozenset.intersection(*used) if used else frozenset()

    def confirm(self, state: Any, values: tuple[int, ...]) -> None:
        """Compare values that were remembered for a state which differs in ignored parts only.

        Raises:
            EvaluationError: a function looks at what it declares to ignore.
        """
        for i, (now, then) in enumerate(zip(self.evaluate(state), values, strict=True)):
            if now == then:
                continue
            named = ", ".join(f"{f.name} ({f.position})" for f in self.functions[i])
            ignored = ", ".join(sorted(self.ignores))
            raise EvaluationError(
                f"its value is {now}, and {then} in a state that differs in {ignored} only, "
                f"which its functions declare to ignore: {named}",
                feature=self.model.features[i].name,
                expression=self.model.features[i].name,
                state=state,
            )


def obstacles(checked: CheckedSketch) -> list[Diagnostic]:
    """What keeps a sketch without errors from being run; empty if nothing does."""
    source = checked.source
    if checked.domain is None:
        start = Label(source, Span(0, 0))
        return [
            Diagnostic(
                "no-domain",
                "a sketch that uses no domain can be checked and proved, but not run",
                start,
                hint="Write `use DOMAIN`.",
            )
        ]
    return [
        Diagnostic(
            "feature-without-definition",
            f"feature `{feature.name}` has no definition, so the sketch cannot be run",
            place,
            hint=f"Write `feature {feature.name} : {feature.kind.value} = EXPRESSION`.",
        )
        for feature, place, definition in zip(
            checked.model.features, checked.places, checked.definitions, strict=True
        )
        if definition is None
    ]


def compile_sketch(checked: CheckedSketch, plain: bool = False) -> CompiledSketch:
    """The evaluators of a sketch that has no errors and no `obstacles`. With `plain`, they are
    the compiler's own even where the domain has quicker ones."""
    domain = checked.domain
    definitions = [definition for definition in checked.definitions if definition is not None]
    if domain is None or len(definitions) != len(checked.definitions):
        raise ValueError("; ".join(found.message for found in obstacles(checked)))
    families = [(name, domain.atoms[name]) for name in checked.atoms]
    if not families and domain.default_atoms is not None:
        families = [("all", domain.default_atoms)]
    atoms = tuple(_guarded(family, name) for name, family in families)
    if domain.evaluator is not None and not plain:
        return CompiledSketch(checked.model, domain.evaluator(checked), atoms, (), domain.goal_test)
    layout = Layout(len(definitions), definitions)
    evaluators = []
    for careful in (True, False):
        compiler = Compiler(domain, layout, careful)
        steps = []
        for index in checked.order:
            run = compiler.run(definitions[index])
            if checked.model.features[index].kind is Kind.BOOL:
                run = _as_number(run)
            steps.append((layout.feature(index), run))
        evaluators.append(_evaluator(checked, layout, steps))
    used = _functions(definitions)
    return CompiledSketch(checked.model, _alternating(*evaluators), atoms, used, domain.goal_test)


def _functions(definitions: Sequence[Node]) -> tuple[tuple[Function, ...], ...]:
    """The domain functions that each feature depends on, through other features as well."""
    found: list[dict[str, Function]] = []
    for definition in definitions:
        functions: dict[str, Function] = {}
        pending = [definition]
        seen: set[Node] = set()
        while pending:
            node = pending.pop()
            if node in seen:
                continue
            seen.add(node)
            pending += node.parts
            value = node.value[0] if node.kind == "image" else node.value  # type: ignore[index]
            if isinstance(value, Function):
                functions[value.name] = value
            elif node.kind == "feature" and isinstance(node.value, int):
                pending.append(definitions[node.value])
        found.append(functions)
    return tuple(tuple(functions.values()) for functions in found)


def _guarded(
    family: Callable[[Any], Iterable[Hashable]], name: str
) -> Callable[[Any], tuple[Hashable, ...]]:
    """A family of atoms that tells what is wrong with the domain's function."""

    def atoms(state: Any) -> tuple[Hashable, ...]:
        try:
            found = tuple(family(state))
            hash(found)
        except Exception as error:
            words = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
            raise EvaluationError(
                f"the atoms {name} cannot be listed: {words}",
                expression=f"atoms {name}",
                function=name,
                position=position_of(family, ""),
                state=state,
            ) from error
        return found

    return atoms


def _as_number(run: Run) -> Run:
    return lambda frame: 1 if run(frame) else 0


def _alternating(
    careful: Callable[[Any], tuple[int, ...]], quick: Callable[[Any], tuple[int, ...]]
) -> Callable[[Any], tuple[int, ...]]:
    states = 0

    def evaluate(state: Any) -> tuple[int, ...]:
        nonlocal states
        states += 1
        if states <= CAREFUL_STATES or states % CAREFUL_EVERY == 0:
            return careful(state)
        return quick(state)

    return evaluate


def _evaluator(
    checked: CheckedSketch, layout: Layout, steps: list[tuple[int, Run]]
) -> Callable[[Any], tuple[int, ...]]:
    model = checked.model
    empty: Frame = [None] * layout.size
    first = layout.first_feature
    end = first + len(model.features)
    invariants = [(truth(invariant.formula), invariant.text) for invariant in model.invariants]
    memories = layout.memories

    def evaluate(state: Any) -> tuple[int, ...]:
        frame = empty.copy()
        frame[0] = state
        for place in memories:
            frame[place] = {}
        slot = first
        try:
            for slot, run in steps:
                frame[slot] = run(frame)
        except Exception as error:
            raise _failure(checked, slot - first, error, state) from error
        values = tuple(frame[first:end])
        for holds, text in invariants:
            if not holds(values):
                raise _violation(model, text, values, state)
        return values

    return evaluate


def _failure(
    checked: CheckedSketch, index: int, error: Exception, state: object
) -> EvaluationError:
    name = checked.model.features[index].name
    if isinstance(error, BrokenPromiseError):
        return EvaluationError(
            error.reason,
            feature=name,
            expression=error.expression,
            function=error.function,
            position=error.position,
            state=state,
        )
    # The elements of a set can fail as well: when compared, hashed, or changed meanwhile.
    definition = checked.definitions[index]
    return EvaluationError(
        f"{type(error).__name__}: {error}",
        feature=name,
        expression=definition.text if definition is not None else name,
        state=state,
    )


def _violation(
    model: SketchModel, text: str, values: tuple[int, ...], state: object
) -> EvaluationError:
    listed = ", ".join(
        f"{feature.name} = {value}" for feature, value in zip(model.features, values, strict=True)
    )
    return EvaluationError(f"the invariant does not hold: {listed}", expression=text, state=state)
