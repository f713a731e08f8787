"""What a shell proposes when the tab key is pressed: names of what comes along, beside files.

docs/editors.md says how to switch it on. Only what is needed for that is imported: the answer has
to be there at once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

import click
from click.shell_completion import CompletionItem

Completer = Callable[[click.Context, click.Parameter, str], list[CompletionItem]]

PLANNERS = ("lazy-siiw-r", "siw-r", "bfws", "iw", "brfs")
"""As in `runtime.search.planners`, which would take too long to import for one key."""

SUITES = ("paper", "baselines", "scaling", "ipc")
"""The benchmark suites that come along."""

HOME = Path(__file__).resolve().parents[2]


def _completer(names: Callable[[], Iterable[str]], files: bool = True) -> Completer:
    def complete(_c: click.Context, _p: click.Parameter, begun: str) -> list[CompletionItem]:
        found = [CompletionItem(name) for name in names() if name.startswith(begun)]
        # The shell itself adds the files that begin like this. First, since bash forgets what
        # came before it.
        return [CompletionItem(begun, type="file"), *found] if files else found

    return complete


def _sketches() -> Iterable[str]:
    from sketchlang.loader import builtin_sketches

    return builtin_sketches()


def _scenes() -> Iterable[str]:
    from sketchlang.library import built_in_scenes

    return built_in_scenes()


def _robots() -> Iterable[str]:
    return sorted(path.parent.name for path in (HOME / "runtime" / "robot").glob("*/*.toml"))


def _planners() -> Iterable[str]:
    return PLANNERS


def _suites() -> Iterable[str]:
    return SUITES


def _domains() -> Iterable[str]:
    from sketchlang.loader import domain_names

    return domain_names()


def _anything() -> Iterable[str]:
    return sorted({*_domains(), *_scenes(), *_robots(), *_sketches()})


def _codes() -> Iterable[str]:
    from sketchlang.pages import pages

    return pages()


sketches = _completer(_sketches)
scenes = _completer(_scenes)
robots = _completer(_robots)
planners = _completer(_planners, files=False)
suites = _completer(_suites)
domains = _completer(_domains)
anything = _completer(_anything)
codes = _completer(_codes, files=False)
