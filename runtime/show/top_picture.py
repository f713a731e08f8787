"""A top view as a picture (`sketchlang.domain.Picture`)."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from runtime.show.top_text import WIDTH, draw
from runtime.show.top_view import TopView


@dataclass(frozen=True)
class TopPicture:
    """What is seen from above."""

    view: TopView

    def text(self, width: int = WIDTH, colour: bool = False) -> list[str]:
        """Characters on a grid, and a legend."""
        return draw(self.view, width, colour)

    def svg(self) -> str:
        """A drawing."""
        from runtime.show.top_svg import svg

        return svg(self.view)

    def data(self) -> dict[str, Any]:
        """Robot, supports, objects with their goals, and outlines in metres."""
        view = self.view
        return {
            "name": view.name,
            "robot": list(view.robot),
            "supports": [{"name": name, "height": top} for name, top in view.supports],
            "objects": [asdict(thing) for thing in view.things],
            "goals": list(view.wanted),
            "outlines": [
                {"name": patch.name, "kind": patch.sort.value, "corners": patch.corners}
                for patch in view.patches
            ],
        }
