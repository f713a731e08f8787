"""A layered layout in the manner of Sugiyama, Tagawa and Toda (1981).

Boxes lie in rows, arrows lead downwards but for those that close a cycle. An arrow is a
chain of points, one in each row it passes; its label is the point in the middle and takes
space like a box. The steps: turn around arrows that close cycles, give rows, order the rows
so that few arrows cross, and give each row's items x so that chains are straight.
"""

from __future__ import annotations

import itertools
from bisect import bisect_right, insort
from collections.abc import Sequence
from dataclasses import dataclass, field

GAP_X = 18.0
GAP_Y = 26.0
SWEEPS = 24
"""How often rows are gone through, downwards and upwards in turn."""
MOST_VISITS = 60_000
"""Of items in all sweeps: nobody finds arrow by arrow his way through a picture with more."""


@dataclass
class Item:
    """A box, a label, or a point of an arrow: size, row, place in the row, centre."""

    width: float
    height: float
    row: int = 0
    x: float = 0.0
    y: float = 0.0
    above: list[Item] = field(default_factory=list)
    below: list[Item] = field(default_factory=list)


@dataclass
class Chain:
    """The items of one arrow from its source to its target; `turned` if it leads upwards."""

    items: list[Item]
    label: Item | None
    turned: bool


@dataclass
class Layout:
    """Where everything is; the picture reaches from (0, 0) to `width`, `height`."""

    boxes: list[Item]
    chains: list[Chain | None]
    width: float
    height: float


def lay_out(
    sizes: Sequence[tuple[float, float]],
    arrows: Sequence[tuple[int, int]],
    labels: Sequence[tuple[float, float] | None],
) -> Layout:
    """Places boxes of these sizes, arrows between them and labels on arrows.

    A loop has no chain: it is drawn at its box.
    """
    boxes = [Item(width, height) for width, height in sizes]
    turned = _closing(len(sizes), arrows)
    _rows(boxes, arrows, turned)
    chains: list[Chain | None] = []
    items = list(boxes)
    for (source, target), label, back in zip(arrows, labels, turned, strict=True):
        if source == target:
            chains.append(None)
            continue
        upper, lower = (target, source) if back else (source, target)
        inner = [Item(0.0, 0.0, row) for row in range(boxes[upper].row + 1, boxes[lower].row)]
        middle = inner[len(inner) // 2] if label is not None else None
        if middle is not None and label is not None:
            middle.width, middle.height = label
        items += inner
        chain = [boxes[upper], *inner, boxes[lower]]
        for first, second in itertools.pairwise(chain):
            first.below.append(second)
            second.above.append(first)
        chains.append(Chain(chain[::-1] if back else chain, middle, back))
    rows: list[list[Item]] = [[] for _ in range(max((item.row for item in items), default=0) + 1)]
    for item in items:
        rows[item.row].append(item)
    rows = _ordered([row for row in rows if row])
    height = _give_y(rows)
    width = _give_x(rows)
    return Layout(boxes, chains, width, height)


def _closing(count: int, arrows: Sequence[tuple[int, int]]) -> list[bool]:
    """Arrows that lead back to a box from which a depth-first search is still under way."""
    out: list[list[int]] = [[] for _ in range(count)]
    entered = [0] * count
    for number, (source, target) in enumerate(arrows):
        out[source].append(number)
        entered[target] += source != target
    back = [False] * len(arrows)
    state = [0] * count  # 0 not seen, 1 under way, 2 done
    for root in sorted(range(count), key=lambda box: entered[box] > 0):
        if state[root]:
            continue
        state[root] = 1
        path = [(root, iter(out[root]))]
        while path:
            box, rest = path[-1]
            for number in rest:
                target = arrows[number][1]
                if state[target] == 1:
                    back[number] = True
                elif state[target] == 0:
                    state[target] = 1
                    path.append((target, iter(out[target])))
                    break
            else:
                state[box] = 2
                path.pop()
    return back


def _rows(boxes: list[Item], arrows: Sequence[tuple[int, int]], turned: list[bool]) -> None:
    """Two rows further down for each arrow: labels lie in the rows between."""
    down = [
        (target, source) if back else (source, target)
        for (source, target), back in zip(arrows, turned, strict=True)
        if source != target
    ]
    for _ in boxes:
        changed = False
        for upper, lower in down:
            if boxes[lower].row < boxes[upper].row + 2:
                boxes[lower].row = boxes[upper].row + 2
                changed = True
        if not changed:
            break
    # A box that nothing leads to goes right above the first box that it leads to.
    for number, box in enumerate(boxes):
        lower_rows = [boxes[lower].row for upper, lower in down if upper == number]
        if lower_rows and all(lower != number for _, lower in down):
            box.row = min(lower_rows) - 2


def _ordered(rows: list[list[Item]]) -> list[list[Item]]:
    """Rows ordered by the mean place of neighbours, downwards and upwards in turn."""
    best = [list(row) for row in rows]
    fewest = _crossings(best)
    current = [list(row) for row in rows]
    for sweep in range(_sweeps(rows)):
        place = {id(item): i for row in current for i, item in enumerate(row)}
        downwards = sweep % 2 == 0
        for row in current if downwards else reversed(current):
            weights = {}
            for item in row:
                near = item.above if downwards else item.below
                places = [place[id(other)] for other in near]
                weights[id(item)] = sum(places) / len(places) if places else place[id(item)]
            row.sort(key=lambda item: weights[id(item)])
            place.update((id(item), i) for i, item in enumerate(row))
        crossings = _crossings(current)
        if crossings < fewest:
            best, fewest = [list(row) for row in current], crossings
    return best


def _sweeps(rows: list[list[Item]]) -> int:
    """Fewer for a large picture: at least one downwards and one upwards."""
    return max(2, min(SWEEPS, MOST_VISITS // max(1, sum(map(len, rows)))))


def _crossings(rows: list[list[Item]]) -> int:
    total = 0
    for row, following in itertools.pairwise(rows):
        place = {id(item): i for i, item in enumerate(following)}
        ends = [end for item in row for end in sorted(place[id(other)] for other in item.below)]
        seen: list[int] = []
        for end in ends:
            total += len(seen) - bisect_right(seen, end)
            insort(seen, end)
    return total


def _give_y(rows: list[list[Item]]) -> float:
    y = 0.0
    for row in rows:
        height = max((item.height for item in row), default=0.0)
        for item in row:
            item.y = y + height / 2
        y += height + GAP_Y
    return max(y - GAP_Y, 0.0)


def _give_x(rows: list[list[Item]]) -> float:
    """As near as possible to the neighbours' mean, in order and with gaps between."""
    for row in rows:
        x = 0.0
        for item in row:
            item.x = x + item.width / 2
            x += item.width + GAP_X
    for sweep in range(_sweeps(rows)):
        downwards = sweep % 2 == 0
        for row in rows if downwards else reversed(rows):
            wishes = []
            for item in row:
                near = (item.above if downwards else item.below) or item.above or item.below
                wishes.append(sum(o.x for o in near) / len(near) if near else item.x)
            _place(row, wishes)
    left = min((item.x - item.width / 2 for row in rows for item in row), default=0.0)
    for row in rows:
        for item in row:
            item.x -= left
    return max((item.x + item.width / 2 for row in rows for item in row), default=0.0)


def _place(row: list[Item], wishes: list[float]) -> None:
    """The positions nearest to the wishes (least squares) that keep order and distance.

    With the distances taken off, positions must only not decrease: pool adjacent violators.
    """
    offsets = [0.0]
    for left, right in itertools.pairwise(row):
        offsets.append(offsets[-1] + (left.width + right.width) / 2 + GAP_X)
    pools: list[tuple[float, int]] = []  # mean, size
    for wish, offset in zip(wishes, offsets, strict=True):
        mean, size = wish - offset, 1
        while pools and pools[-1][0] > mean:
            other, count = pools.pop()
            mean = (other * count + mean * size) / (count + size)
            size += count
        pools.append((mean, size))
    i = 0
    for mean, size in pools:
        for _ in range(size):
            row[i].x = mean + offsets[i]
            i += 1
