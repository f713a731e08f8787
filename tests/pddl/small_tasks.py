"""One small task for each domain that has a sketch of its own."""

from __future__ import annotations


def _task(domain: str, objects: str, init: str, goal: str) -> str:
    return (
        f"(define (problem small) (:domain {domain})\n(:objects {objects})\n"
        f"(:init {init})\n(:goal (and {goal})))\n"
    )


def _grid(width: int, height: int, ways: dict[str, tuple[int, int]], cell: str) -> list[str]:
    """Facts that link the cells of a grid; a way's pair is the step from its second cell."""
    return [
        f"({way} {cell}{x + dx}{y + dy} {cell}{x}{y})"
        for way, (dx, dy) in ways.items()
        for x in range(width)
        for y in range(height)
        if 0 <= x + dx < width and 0 <= y + dy < height
    ]


_SIDES = {"up": (0, 1), "down": (0, -1), "right": (1, 0), "left": (-1, 0)}
_CELLS = [f"t{x}{y}" for x in range(2) for y in range(3)]
_FLOOR = _grid(2, 3, _SIDES, "t") + [f"(clear {cell})" for cell in _CELLS if cell != "t00"]
_ROOMS = [
    fact.replace(way, "conn")
    for way, step in _SIDES.items()
    for fact in _grid(3, 2, {way: step}, "c")
]
_PARTS = " ".join(
    f"(shape p{i} oblong) (surface-condition p{i} rough) (painted p{i} red) (temperature p{i} cold)"
    for i in range(3)
)

TASKS = {
    "barman": _task(
        "barman",
        "left right - hand  l0 l1 l2 - level  d1 d2 - dispenser  i1 i2 - ingredient"
        "  c1 c2 - cocktail  s1 s2 s3 - shot  shaker1 - shaker",
        "(ontable s1) (ontable s2) (ontable s3) (ontable shaker1) (dispenses d1 i1)"
        " (dispenses d2 i2)"
        " (clean s1) (clean s2) (clean s3) (clean shaker1) (empty s1) (empty s2) (empty s3)"
        " (empty shaker1) (handempty left) (handempty right) (shaker-empty-level shaker1 l0)"
        " (shaker-level shaker1 l0) (next l0 l1) (next l1 l2) (cocktail-part1 c1 i1)"
        " (cocktail-part2 c1 i2) (cocktail-part1 c2 i2) (cocktail-part2 c2 i1)",
        "(contains s1 c1) (contains s2 c2)",
    ),
    "childsnack": _task(
        "child-snack",
        "a b c - child  b1 b2 b3 - bread-portion  c1 c2 c3 - content-portion"
        "  s1 s2 s3 s4 - sandwich  t1 - tray  table1 table2 - place",
        "(at t1 kitchen) (at_kitchen_bread b1) (at_kitchen_bread b2) (at_kitchen_bread b3)"
        " (at_kitchen_content c1) (at_kitchen_content c2) (at_kitchen_content c3)"
        " (no_gluten_bread b2) (no_gluten_content c3) (notexist s1) (notexist s2) (notexist s3)"
        " (notexist s4) (allergic_gluten b) (not_allergic_gluten a) (not_allergic_gluten c)"
        " (waiting a table1) (waiting b table2) (waiting c table1)",
        "(served a) (served b) (served c)",
    ),
    "driverlog": _task(
        "driverlog",
        "d1 d2 t1 t2 o1 o2 s0 s1 s2 p01",
        "(driver d1) (driver d2) (truck t1) (truck t2) (obj o1) (obj o2) (location s0)"
        " (location s1)"
        " (location s2) (location p01) (at d1 s0) (at d2 s2) (at t1 s1) (at t2 s2) (empty t1)"
        " (empty t2)"
        " (at o1 s0) (at o2 s2) (path s0 p01) (path p01 s0) (path s1 p01) (path p01 s1)"
        " (link s0 s1) (link s1 s0) (link s1 s2) (link s2 s1)",
        "(at o1 s2) (at o2 s0) (at t1 s0) (at d1 s1)",
    ),
    "floortile": _task(
        "floor-tile",
        f"r - robot  black white - color  {' '.join(_CELLS)} - tile",
        f"(robot-at r t00) (robot-has r white) (available-color white) (available-color black)"
        f" {' '.join(_FLOOR)}",
        "(painted t01 black) (painted t02 white) (painted t11 white) (painted t12 black)",
    ),
    "grid": _task(
        "grid",
        "c00 c01 c10 c11 c20 c21 k1 k2 round square",
        "(place c00) (place c01) (place c10) (place c11) (place c20) (place c21) (key k1) (key k2)"
        " (shape round) (shape square) (key-shape k1 round) (key-shape k2 square) (arm-empty)"
        " (at k1 c01) (at k2 c11) (locked c10) (lock-shape c10 round) (locked c21)"
        " (lock-shape c21 square) (open c00) (open c01) (open c11) (open c20) (at-robot c00) "
        + " ".join(_ROOMS),
        "(at k1 c21) (at k2 c00)",
    ),
    "schedule": _task(
        "schedule",
        "p0 p1 p2 - part  oblong - ashape  red blue - colour  w1 - width  front - anorient",
        f"{_PARTS} (has-bit drill-press w1) (can-orient drill-press front)"
        " (has-paint immersion-painter blue) (has-paint spray-painter red)",
        "(shape p0 cylindrical) (surface-condition p0 polished) (painted p0 blue)"
        " (has-hole p1 w1 front) (painted p1 blue) (surface-condition p2 smooth)",
    ),
    "tpp": _task(
        "tpp-propositional",
        "g1 g2 - goods  t1 - truck  m1 m2 - market  d1 - depot  l0 l1 l2 - level",
        "(next l1 l0) (next l2 l1) (on-sale g1 m1 l2) (on-sale g2 m2 l1) (on-sale g1 m2 l0)"
        " (on-sale g2 m1 l0) (ready-to-load g1 m1 l0) (ready-to-load g2 m2 l0)"
        " (ready-to-load g1 m2 l0) (ready-to-load g2 m1 l0) (stored g1 l0) (stored g2 l0)"
        " (loaded g1 t1 l0) (loaded g2 t1 l0) (at t1 d1) (connected d1 m1) (connected m1 d1)"
        " (connected m1 m2) (connected m2 m1)",
        "(stored g1 l2) (stored g2 l1)",
    ),
    "gripper": _task(
        "gripper",
        "a b b1 b2 b3 left right",
        "(room a) (room b) (ball b1) (ball b2) (ball b3) (gripper left) (gripper right)"
        " (at-robby b)"
        " (free left) (free right) (at b1 a) (at b2 a) (at b3 b)",
        "(at b1 b) (at b2 b) (at b3 a)",
    ),
    "miconic": _task(
        "miconic",
        "p1 p2 p3 - passenger  f1 f2 f3 - floor",
        "(above f1 f2) (above f1 f3) (above f2 f3) (lift-at f2) (origin p1 f1) (destin p1 f3)"
        " (origin p2 f3) (destin p2 f2) (origin p3 f1) (destin p3 f2)",
        "(served p1) (served p2) (served p3)",
    ),
    "logistics": _task(
        "logistics",
        "o1 o2 t1 t2 a1 l11 l12 l21 l22 c1 c2",
        "(obj o1) (obj o2) (truck t1) (truck t2) (airplane a1) (city c1) (city c2) (location l11)"
        " (location l12) (location l21) (location l22) (airport l11) (airport l21) (in-city l11 c1)"
        " (in-city l12 c1) (in-city l21 c2) (in-city l22 c2) (at t1 l11) (at t2 l21) (at a1 l21)"
        " (at o1 l12) (at o2 l21)",
        "(at o1 l22) (at o2 l22)",
    ),
    "blocksworld": _task(
        "blocksworld",
        "a b c d e",
        "(on a b) (on b c) (ontable c) (ontable d) (on e d) (clear a) (clear e) (handempty)",
        "(on c d) (on d a) (on b e)",
    ),
    "visitall": _task(
        "grid-visit-all",
        "c00 c01 c10 c11 c20 c21 - place",
        "(at-robot c10) (visited c10) " + " ".join(f.replace("conn", "connected") for f in _ROOMS),
        "(visited c00) (visited c01) (visited c21) (visited c20)",
    ),
    "spanner": _task(
        "spanner",
        "bob - man  s1 s2 s3 - spanner  n1 n2 - nut  shed l1 l2 gate - location",
        "(at bob shed) (at s1 l1) (at s2 l1) (at s3 l2) (useable s1) (useable s2) (useable s3)"
        " (at n1 gate) (at n2 gate) (loose n1) (loose n2) (link shed l1) (link l1 l2)"
        " (link l2 gate)",
        "(tightened n1) (tightened n2)",
    ),
}
