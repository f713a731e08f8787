"""What the plots share: small SVGs of our own, known by a mark."""

from __future__ import annotations

from collections.abc import Sequence

WIDTH, HEIGHT, LEFT, BOTTOM, TOP = 640, 360, 64, 48, 24

MARK = "<!-- sketchlang bench -->"
"""In every plot: a picture without it is somebody's own."""


def document(parts: Sequence[str], below: str) -> str:
    """An SVG of parts, with axes and a text below them."""
    axis = f"M{LEFT},{TOP} V{HEIGHT - BOTTOM} H{WIDTH - 20}"
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" '
        'font-family="sans-serif" font-size="12">'
    )
    return (
        "\n".join(
            [
                head,
                MARK,
                f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
                f'<text x="{WIDTH / 2}" y="{HEIGHT - 10}" text-anchor="middle">{below}</text>',
                *parts,
                f'<path d="{axis}" stroke="black" fill="none"/>',
                "</svg>",
            ]
        )
        + "\n"
    )
