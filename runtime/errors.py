"""`sketchlang.errors`, under the name it had."""

from sketchlang.errors import InputError

__all__ = ["InputError"]
