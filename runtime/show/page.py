"""A replay as one page that needs nothing else: no network, no other files."""

from __future__ import annotations

import re
from importlib import resources
from typing import Any

from runtime.show.pack import packed
from runtime.show.parts import Node, parts_of
from runtime.show.policy import policy_svg
from runtime.trace.model import Trace
from runtime.trace.valuations import valuations
from runtime.trace.write import to_json
from runtime.world.solids import Box
from sketchlang.escape import all_visible, dumps, markup

_PLACE = re.compile(r"@(TITLE|STYLE|PAYLOAD|START|THREE|SCRIPT|GRAPH)@")

SCRIPTS = (
    *("time", "model", "letters", "pointer", "stage", "camera"),
    *("panel", "view", "player", "compare", "main"),
)
"""The files of the page's script, in the order in which they need each other."""


def page(trace: Trace, against: Trace | None = None, start: float = 0.0) -> str:
    """The HTML of a trace's replay, beside another one if there is one; it opens at `start`
    seconds."""
    title = f"{trace.world.name} · {trace.sketch.name}"
    payload = [_payload(each) for each in (trace, against) if each is not None]
    script = "\n".join(_asset(f"js/{name}.js") for name in SCRIPTS)
    parts = {
        "TITLE": markup(title if against is None else f"{trace.world.name} · two plans"),
        "STYLE": _asset("replay.css"),
        # A `<` within JSON is always in a string: it must not end or open an element.
        "PAYLOAD": dumps(all_visible(payload), compact=True).replace("<", "\\u003c"),
        "START": f"{start:g}",
        "THREE": _script(_asset("three.min.js")),
        "SCRIPT": _script(f'"use strict";\n(() => {{\n{script}}})();\n'),
        "GRAPH": "" if against is not None else policy_svg(trace),
    }
    return _PLACE.sub(lambda match: parts[match.group(1)], _asset("replay.html"))


def _payload(trace: Trace) -> dict[str, Any]:
    """What a page knows of a trace: its data without shapes, and the shapes as triangles."""
    data = to_json(trace)
    for thing in (*data["world"]["fixed"], *data["world"]["objects"]):
        thing.pop("solids")
        thing.pop("mesh", None)
    data["robot"].pop("links")
    data["robot"].pop("looks", None)
    return {
        "trace": data,
        "scene": _scene(trace),
        "valuations": [
            {"begun": round(v.begun, 6), "time": round(v.time, 6), "values": dict(v.values)}
            for v in valuations(trace)
        ],
    }


def _scene(trace: Trace) -> dict[str, Any]:
    nodes = [Node("world", "")]
    nodes += [Node("fixed", thing.name) for thing in trace.world.fixed]
    nodes += [Node("object", thing.name) for thing in trace.world.movables]
    nodes += [Node("link", link) for link in trace.robot.urdf.shapes]
    numbers = {node: number for number, node in enumerate(nodes)}
    return {
        "nodes": [{"kind": node.kind, "name": node.name} for node in nodes],
        "parts": [packed(part, numbers) for part in parts_of(trace)],
        "letters": _letters(trace, numbers),
    }


def _letters(trace: Trace, numbers: dict[Node, int]) -> list[dict[str, Any]]:
    """The letters of blocks that are one box: its size and its middle in the block's frame."""
    found = []
    for thing in trace.world.movables:
        parts = thing.body.parts
        if thing.label and len(parts) == 1 and isinstance(parts[0].solid, Box):
            found.append(
                {
                    "node": numbers[Node("object", thing.name)],
                    "label": thing.label,
                    "size": list(parts[0].solid.size),
                    "middle": parts[0].pose[:, 3].tolist(),
                }
            )
    return found


def _asset(name: str) -> str:
    return resources.files("runtime.show").joinpath("assets", name).read_text(encoding="utf-8")


def _script(text: str) -> str:
    return text.replace("</script", "<\\/script")
