"""A plot of planning time and nodes for each object moved, as a small SVG of our own."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median
from typing import Any

from runtime.bench.picture import BOTTOM, HEIGHT, LEFT, TOP, WIDTH, document


def scaling_plot(results: Sequence[dict[str, Any]], sizes: Sequence[int]) -> str:
    """SVG text: milliseconds and expanded nodes an object moved, against the objects.

    `results` are those of generated scenes, `sizes` the number of objects of each result.
    """
    points: dict[int, list[dict[str, Any]]] = {}
    for size, result in zip(sizes, results, strict=True):
        if result["solved"]:
            points.setdefault(size, []).append(result)
    rows = sorted(points.items())
    time = [
        (n, median(1000 * r["planning_time_s"] / max(1, r["objects_moved"]) for r in g))
        for n, g in rows
    ]
    nodes = [(n, median(r["expanded"] / max(1, r["objects_moved"]) for r in g)) for n, g in rows]
    parts: list[str] = []
    if rows:
        right = max(n for n, _ in time)
        parts += _curve(time, right, "#1f77b4", "ms an object moved", 0)
        parts += _curve(nodes, right, "#d62728", "nodes expanded an object moved", 1)
        for n, _ in rows:
            x = _x(n, right)
            parts.append(
                f'<text x="{x}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{n}</text>'
            )
    return document(parts, "objects")


def _x(n: float, right: float) -> float:
    return round(LEFT + n / right * (WIDTH - LEFT - 40), 1)


def _curve(
    points: Sequence[tuple[int, float]], right: float, colour: str, label: str, place: int
) -> list[str]:
    """One curve from zero to its own greatest value, with its values written beside it."""
    greatest = max(value for _, value in points) * 1.25 or 1.0
    marks = []
    corners = []
    for n, value in points:
        x = _x(n, right)
        y = round(HEIGHT - BOTTOM - value / greatest * (HEIGHT - BOTTOM - TOP), 1)
        corners.append(f"{x},{y}")
        shown = f"{value:.0f}" if value >= 10 else f"{value:.1f}"
        marks.append(f'<circle cx="{x}" cy="{y}" r="3" fill="{colour}"/>')
        marks.append(f'<text x="{x + 5}" y="{y - 6}" fill="{colour}">{shown}</text>')
    legend = f'<text x="{LEFT + 12 + 200 * place}" y="16" fill="{colour}">{label}</text>'
    line = f'<polyline points="{" ".join(corners)}" fill="none" stroke="{colour}"/>'
    return [line, *marks, legend]
