"""The text of a sketch, and where its rules stand in it."""

from __future__ import annotations

from runtime.trace.model import RuleText, TraceSketch
from sketchlang.errors import InputError
from sketchlang.loader import Loaded, load_sketch
from sketchlang.syntax import tree

HINT = "name the sketch that the plan was made with: --sketch FILE"


def load_trace_sketch(target: str, domain_file: str | None = None) -> TraceSketch:
    """The sketch of a file or built-in name.

    Raises:
        InputError: it cannot be read, or has errors.
    """
    if target == "-":  # standard input is for what a user asks for, not for what a file says
        raise InputError("the sketch has no name", hint=HINT)
    try:
        loaded = load_sketch(target, domain_file)
    except InputError as error:
        raise InputError(error.message, place=error.place, hint=HINT) from None
    if not loaded.ok:
        raise InputError(
            "the sketch has errors",
            place=target,
            hint=f"`sketchlang check {target}` lists them; a domain of your own is given with "
            "--domain FILE",
        )
    return trace_sketch(loaded)


def trace_sketch(loaded: Loaded) -> TraceSketch:
    """The same for a sketch that was loaded and has no errors."""
    texts: list[tuple[str, str]] = []
    rules: list[RuleText] = []

    def collect(parsed: tree.Tree) -> None:
        number = len(texts)
        texts.append((parsed.source.name.rpartition("/")[2], parsed.source.text))
        for item in parsed.items:
            if isinstance(item, tree.RuleItem):
                rules.append(RuleText(item.name.text, number, item.span.start, item.span.end))
            elif isinstance(item, tree.Include) and item.tree is not None:
                collect(item.tree)

    collect(loaded.tree)
    model = loaded.checked.model
    features = tuple((feature.name, feature.kind.value) for feature in model.features)
    return TraceSketch(model.name, tuple(texts), features, tuple(rules))
