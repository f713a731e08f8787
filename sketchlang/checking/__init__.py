"""Names, types and rules: a syntax tree to a sketch that analyses and compiler can use."""

from sketchlang.checking.checker import CheckedSketch, check

__all__ = ["CheckedSketch", "check"]
