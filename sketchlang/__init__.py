"""The sketch language: text in, values out; and, in front of it, all that Python users need.

`load`, `check`, `terminate` and `plan` are those of `sketchlang.api`, which is imported when one
of them is first used: the language itself knows nothing of geometry, and touches files only in
`sketchlang.loader` and its neighbours. `docs/architecture.md` says where everything is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sketchlang.version import __version__

if TYPE_CHECKING:
    from sketchlang.api import Plan, Result, check, load, plan, terminate

__all__ = ["Plan", "Result", "__version__", "check", "load", "plan", "terminate"]


def __getattr__(name: str) -> Any:
    if name in __all__:
        return _offered(name)
    raise AttributeError(f"module 'sketchlang' has no attribute {name!r}")


def _offered(name: str) -> Any:
    from sketchlang.guard import in_the_way

    trouble = in_the_way()
    if trouble is not None:
        raise ImportError(trouble)
    from sketchlang import api

    return getattr(api, name)
