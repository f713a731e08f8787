"""The sketch language: text in, values out.

The package is pure: it knows nothing of geometry and touches files only in
`sketchlang.loader`. `docs/architecture.md` says where everything is.
"""

__version__ = "0.1.0"
