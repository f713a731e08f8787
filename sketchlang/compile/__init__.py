"""Typed sketches to evaluators: `state -> feature values`."""

from sketchlang.compile.errors import EvaluationError
from sketchlang.compile.sketch import CompiledSketch, compile_sketch, obstacles

__all__ = ["CompiledSketch", "EvaluationError", "compile_sketch", "obstacles"]
