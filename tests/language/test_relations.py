"""The checks of whole rules against a search through all small states."""

from __future__ import annotations

from itertools import product

from hypothesis import given, settings
from hypothesis import strategies as st

from sketchlang.loader import load_text
from sketchlang.model import Kind, Rule, SketchModel
from sketchlang.source import Source

NAMES = [("H", "bool"), ("n", "nat"), ("m", "nat")]
CONDITIONS = {"bool": ["{}", "!{}"], "nat": ["{} = 0", "{} > 0"]}
EFFECTS = {
    "bool": ["{}", "!{}", "{}?"],
    "nat": ["{}--", "{}++", "{}?", "!{}--", "!{}++"],
}


@st.composite
def rules(draw: st.DrawFn, name: str) -> str:
    """A rule with at most one condition and effect a feature."""
    sides = []
    for signs in (CONDITIONS, EFFECTS):
        chosen = [
            draw(st.sampled_from(signs[kind])).format(feature)
            for feature, kind in NAMES
            if draw(st.booleans())
        ]
        sides.append("{ " + ", ".join(chosen) + " }")
    return f"rule {name} {sides[0]} -> {sides[1]}"


@st.composite
def sketches(draw: st.DrawFn) -> str:
    """A sketch with all features named in its goal."""
    lines = ["sketch s", *(f"feature {name} : {kind}" for name, kind in NAMES)]
    lines.append("goal { H, n = 0, m = 0 }")
    lines += [draw(rules(f"r{i}")) for i in range(draw(st.integers(1, 3)))]
    return "\n".join(lines)


def vectors(model: SketchModel) -> list[tuple[int, ...]]:
    """All feature values up to 3, one more than the checks look at."""
    return list(product(*(range(2 if f.kind is Kind.BOOL else 4) for f in model.features)))


def pairs(model: SketchModel, rule: Rule) -> set[tuple[tuple[int, ...], tuple[int, ...]]]:
    """What a rule allows, by `Rule.satisfied_by` alone."""
    all_ = vectors(model)
    return {(a, b) for a in all_ if rule.applies(a) for b in all_ if rule.satisfied_by(a, b)}


@settings(max_examples=150, deadline=None)
@given(sketches())
def test_against_all_pairs(text: str) -> None:
    loaded = load_text(Source("t", text))
    model = loaded.checked.model
    allowed = [pairs(model, rule) for rule in model.rules]
    found = {(d.code, _line(d.primary.span.start, text)) for d in loaded.diagnostics}
    first_rule = 2 + len(NAMES) + 1
    expected = set()
    sensible = [i for i, these in enumerate(allowed) if these]
    for i, rule in enumerate(model.rules):
        line = first_rule + i
        if i not in sensible:
            expected.add(("impossible-effect", line))
            continue
        if any(a == b for a, b in allowed[i]):
            expected.add(("satisfied-at-once", line))
        if all(model.is_goal(v) for v in vectors(model) if rule.applies(v)):
            expected.add(("goal-rule", line))
        for f in rule.effects:
            if all(a[f] == b[f] for a, b in allowed[i]):
                expected.add(("redundant-effect", line))
        for j in sensible:
            if j < i and allowed[i] == allowed[j]:
                expected.add(("copied-rule", line))
                break
            if j != i and allowed[i] < allowed[j]:
                expected.add(("subsumed-rule", line))
                break
    assert found == expected, text


def _line(offset: int, text: str) -> int:
    return text.count("\n", 0, offset) + 1
