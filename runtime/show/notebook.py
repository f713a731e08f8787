"""A replay page within another page: for notebooks."""

from __future__ import annotations

import html
from dataclasses import dataclass


@dataclass(frozen=True)
class Embedded:
    """A page in a frame, `height` pixels high, as wide as there is room; notebooks show it where it
    is the value of a cell."""

    page: str
    height: int

    def _repr_html_(self) -> str:
        # The frame may run the page's own script, and reach nothing of the notebook.
        return (
            f'<iframe title="Replay" sandbox="allow-scripts" width="100%" height="{self.height}" '
            f'style="border: 0; border-radius: 8px" srcdoc="{html.escape(self.page)}"></iframe>'
        )
