"""Survival plots: how many runs are solved within how many seconds, one curve a planner."""

from __future__ import annotations

import math
from collections.abc import Sequence

from runtime.bench.job import Result
from runtime.bench.picture import BOTTOM, HEIGHT, LEFT, TOP, WIDTH, document
from runtime.bench.summary import Case, case_of, seconds_of
from sketchlang.escape import markup

COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#8c564b", "#e377c2", "#7f7f7f", "#bcbd22")
RIGHT = 20


def survival_plot(results: Sequence[Result]) -> str:
    """SVG text: the share of runs that are solved, against planning time (logarithmic)."""
    groups: dict[str, list[float]] = {}
    names = _names([case_of(result) for result in results])
    for result in results:
        groups.setdefault(names[case_of(result)], []).append(seconds_of(result))
    finite = [s for group in groups.values() for s in group if math.isfinite(s)]
    limit = max((float(result["job"]["timeout"]) for result in results), default=1.0)
    low = max(min(finite, default=limit / 10), 1e-3)
    first = math.floor(math.log10(low))
    last = max(math.log10(max(limit, *finite, low)), first + 1e-9)
    parts = _axes(first, last)
    for number, (name, seconds) in enumerate(groups.items()):
        colour = COLOURS[number % len(COLOURS)]
        dash = ' stroke-dasharray="6 3"' if number >= len(COLOURS) else ""
        parts.append(
            f'<path d="{_steps(seconds, first, last)}" stroke="{colour}" fill="none"{dash}/>'
        )
        solved = sum(math.isfinite(s) for s in seconds)
        x, y = LEFT + 12, TOP + 14 + 15 * number
        text = markup(f"{name}: {solved}/{len(seconds)}")
        parts.append(f'<text x="{x}" y="{y}" fill="{colour}">{text}</text>')
    return document(parts, "seconds of planning")


def _names(cases: Sequence[Case]) -> dict[Case, str]:
    """Curves are of planners; of sketches and robots as well, where there are several."""
    several = {
        name: len({getattr(case, name) for case in cases}) > 1 for name in ("sketch", "robot")
    }
    return {
        case: " ".join(
            [case.planner, *(getattr(case, name) for name, is_so in several.items() if is_so)]
        )
        for case in cases
    }


def _x(seconds: float, first: float, last: float) -> float:
    share = (math.log10(max(seconds, 10**first)) - first) / (last - first)
    return round(LEFT + min(share, 1.0) * (WIDTH - LEFT - RIGHT), 1)


def _y(share: float) -> float:
    return round(HEIGHT - BOTTOM - share * (HEIGHT - BOTTOM - TOP), 1)


def _steps(seconds: Sequence[float], first: float, last: float) -> str:
    """The curve: up by one run whenever one is solved."""
    path, total = f"M{LEFT},{_y(0)}", len(seconds)
    for number, value in enumerate(sorted(s for s in seconds if math.isfinite(s)), 1):
        path += f" H{_x(value, first, last)} V{_y(number / total)}"
    return path + f" H{WIDTH - RIGHT}"


def _axes(first: float, last: float) -> list[str]:
    parts = []
    for power in range(math.floor(first), math.floor(last) + 1):
        x = _x(10.0**power, first, last)
        label = f"{10.0**power:g}"
        parts.append(f'<path d="M{x},{TOP} V{HEIGHT - BOTTOM}" stroke="#dddddd"/>')
        y = HEIGHT - BOTTOM + 16
        parts.append(f'<text x="{x}" y="{y}" text-anchor="middle">{label}</text>')
    for share in (0.0, 0.5, 1.0):
        level = _y(share)
        parts.append(f'<path d="M{LEFT},{level} H{WIDTH - RIGHT}" stroke="#dddddd"/>')
        parts.append(
            f'<text x="{LEFT - 6}" y="{level + 4}" text-anchor="end">{100 * share:.0f} %</text>'
        )
    return parts
