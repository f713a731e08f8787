"""A replay as one page that needs nothing else: no network, no other files."""

from __future__ import annotations

import re
from importlib import resources

from runtime.trace.model import Trace
from runtime.trace.write import to_json
from sketchlang.escape import all_visible, dumps, markup

_PLACE = re.compile(r"@(TITLE|STYLE|TRACE|THREE|SCRIPT)@")


def page(trace: Trace) -> str:
    """The HTML of a trace's replay."""
    parts = {
        "TITLE": markup(f"{trace.world.name} · {trace.sketch.name}"),
        "STYLE": _asset("replay.css"),
        # A `<` within JSON is always in a string: it must not end or open an element.
        "TRACE": dumps(all_visible(to_json(trace)), compact=True).replace("<", "\\u003c"),
        "THREE": _script(_asset("three.min.js")),
        "SCRIPT": _script(_asset("replay.js")),
    }
    return _PLACE.sub(lambda match: parts[match.group(1)], _asset("replay.html"))


def _asset(name: str) -> str:
    return resources.files("runtime.show").joinpath("assets", name).read_text(encoding="utf-8")


def _script(text: str) -> str:
    return text.replace("</script", "<\\/script")
