"""Which function of the domain a node asks."""

from __future__ import annotations

from sketchlang.checking.typed import Node
from sketchlang.domain import Function


def function_of(node: Node) -> Function | None:
    """The function of a call, or of an image under it; None for every other node."""
    if node.kind == "call":
        assert isinstance(node.value, Function)
        return node.value
    return node.value[0] if node.kind == "image" else None  # type: ignore[index]
