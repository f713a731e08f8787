"""Published sketches, and small ones built to be difficult, with what is known of them.

Most are from Bonet and Geffner, "General Policies, Representations, and Planning Width"
(AAAI 2021), or from papers and tools on qualitative numeric planning; the sketch of
Dalmau-Moreno et al. (ICAPS 2024) is `pick_and_place`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from sketchlang.model import SketchModel
from tests.analysis.notation import model


@dataclass(frozen=True)
class Known:
    """`endless` are the rules that can fire for ever, without goal and bounds; with nats
    declared bounded it is `endless_bounded`. The goal never makes a difference here."""

    name: str
    booleans: str
    nats: str
    rules: tuple[str, ...]
    goal: str | None = None
    endless: str = ""
    endless_bounded: str | None = None

    def variant(self, goal: bool, bounded: bool) -> SketchModel:
        wanted = self.goal if goal else None
        return model(self.name, self.booleans, self.nats, self.rules, goal=wanted, bounded=bounded)

    def endless_rules(self, bounded: bool) -> set[str]:
        if bounded and self.endless_bounded is not None:
            return set(self.endless_bounded.split())
        return set(self.endless.split())


_delivery = partial(Known, booleans="H", nats="p t n", goal="n=0")
_PICK = ("!H m>0 u>0 -> H I? m? u? v--", "H !I -> !H I? m?", "H I -> !H I?")

KNOWN = (
    Known("goal_counter", "", "g", ("g>0 -> g--",), "g=0"),
    Known("clear", "H", "n", ("!H n>0 -> H n--", "H n>0 -> !H"), "n=0"),
    Known("boxes", "", "m n", ("m>0 -> m--", "m=0 n>0 -> n-- m?"), "n=0"),
    _delivery(
        "delivery_policy",
        rules=("!H p>0 -> p-- t?", "!H p=0 -> H", "H t>0 -> t--", "H n>0 t=0 -> !H n-- p?"),
    ),
    _delivery("delivery_0", rules=()),
    _delivery("delivery_1", rules=("H -> !H p? t?",)),
    _delivery("delivery_2", rules=("!H -> H p? t?",)),
    _delivery("delivery_3", rules=("H -> !H p? t?", "!H -> H p? t?"), endless="r1 r2"),
    _delivery("delivery_4", rules=("n>0 -> n-- H? p? t?",)),
    _delivery("delivery_5", rules=("!H -> H p? t?", "n>0 -> n-- H? p? t?")),
    _delivery("delivery_6", rules=("!H p>0 -> p-- t?",)),
    _delivery("delivery_7", rules=("H t>0 -> t-- p?",)),
    _delivery(
        "delivery_8",
        rules=(
            "!H -> H p? t?",
            "n>0 -> n-- H? p? t?",
            "!H p>0 -> p-- t?",
            "H t>0 -> t-- p?",
        ),
    ),
    Known("pick_and_place", "H I", "m u v", ("!H m>0 u=0 -> H I m-- u? !v++", *_PICK), "!H m=0"),
    Known(
        "pick_and_place_with_v_free",
        "H I",
        "m u v",
        ("!H m>0 u=0 -> H I m-- u? v?", *_PICK),
        "!H m=0",
        endless="r1 r2 r3 r4",
    ),
    Known("nested", "", "X Y", ("X>0 Y=0 -> X-- Y++", "X>0 Y>0 -> Y--"), "X=0"),
    Known("qualitative_1", "p", "X Y", ("X>0 p -> X-- !p", "!p -> p")),
    Known("qualitative_2", "p", "X Y", ("X>0 p -> X-- !p", "!p -> p X++"), endless="r1 r2"),
    Known("oscillator", "b", "", ("!b -> b", "b -> !b"), endless="r1 r2"),
    Known("up_and_down", "", "n", ("n>0 -> n--", "-> n++"), endless="r1 r2"),
    Known("up_only", "", "n", ("-> n++",), endless="r1", endless_bounded=""),
    Known("no_change", "p", "", ("!p -> !p",), endless="r1"),
    Known("no_effect", "p", "n", ("->",), endless="r1"),
    Known("anything", "", "n", ("n>0 -> n?",), endless="r1"),
    Known("lexicographic", "", "a b c", ("a>0 -> a-- b? c?", "a=0 b>0 -> b-- c?", "c>0 -> c--")),
)

PAPER = """\
sketch pick_and_place
feature H : bool
feature I : bool
feature m : nat
feature u : nat
feature v : nat
goal { !H, m = 0 }
rule pick_clear  { !H, m > 0, u = 0 } -> { H, I, m--, u?, !v++ }
rule clear_way   { !H, m > 0, u > 0 } -> { H, I?, m?, u?, v-- }
rule put_aside   { H, !I }            -> { !H, I?, m? }
rule put_at_goal { H, I }             -> { !H, I? }
"""
"""The sketch exactly as published, in the language; the built-in one may say more."""
