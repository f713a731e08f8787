"""The phrasebook, and characters that nobody sees."""

from __future__ import annotations

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sketchlang.diagnostics import Diagnostic
from sketchlang.source import Source
from sketchlang.syntax import phrases, shapes
from sketchlang.syntax.formatter import format_source
from sketchlang.syntax.grammar import words
from sketchlang.syntax.parser import parse
from sketchlang.syntax.repair import ITEMS, failure

EXAMPLES = [(phrase, *pair) for phrase in phrases.phrases() for pair in phrase.examples]


def found(text: str) -> list[Diagnostic]:
    return parse(Source("t", text))[1]


def mended(text: str) -> str:
    """A text with what its diagnostics would put in, from its end to its beginning."""
    for one in reversed(found(text)):
        assert one.fix is not None, one
        text = text[: one.fix.span.start] + one.fix.text + text[one.fix.span.end :]
    return text


@pytest.mark.parametrize(("phrase", "wrong", "right"), EXAMPLES, ids=lambda value: str(value)[:60])
def test_an_example_is_one_mistake_with_the_right_way(
    phrase: phrases.Phrase, wrong: str, right: str
) -> None:
    (only,) = found(wrong)
    assert only.code == phrase.code
    assert mended(wrong).split() == right.split()
    assert found(right) == []


def test_phrases_that_mend_have_examples_that_show_it() -> None:
    without = [
        phrase.pattern for phrase in phrases.phrases() if phrase.mends and not phrase.examples
    ]
    # Comments of other languages leave no item behind that could be compared.
    assert all("c>" in pattern or "“" in pattern for pattern in without), without


def test_places_are_those_that_are_meant() -> None:
    known = {*ITEMS, "conditions", "effects", "unknown"}
    assert {place for phrase in phrases.phrases() for place in phrase.within} <= known
    assert {phrase.at for phrase in phrases.phrases()} <= {"", "start", "line", "end"}
    assert {phrase.stands_for for phrase in phrases.phrases()} <= {"", *ITEMS}


def test_all_mistakes_of_an_item_are_found() -> None:
    text = "rule r { n is positive && H == true } -> { n -= 1; H := false, m may change }"
    assert len(found(text)) == 7
    assert mended(text) == "rule r { n > 0 , H } -> { n--, !H, m? }"


LITERALS = st.sampled_from(["n > 0", "!H", "m = 0", "H"])
EFFECTS = st.sampled_from(["n--", "!H", "m?", "!v++"])


@given(
    st.lists(LITERALS, max_size=3),
    st.lists(EFFECTS, min_size=1, max_size=3),
    st.sampled_from(["->", "=>", "-->", "→", "⟹", "|->", "then"]),
    st.sampled_from(["{}", "()", "[]", "⟨⟩"]),
    st.sampled_from(["rule r ", "rule r: ", "rule r = ", "r: ", "rule r when "]),
)
def test_rules_in_other_shapes(
    conditions: list[str], effects: list[str], arrow: str, signs: str, head: str
) -> None:
    left, right = (f"{signs[0]}{', '.join(part)}{signs[1]}" for part in (conditions, effects))
    text = f"{head}{left} {arrow} {right}"
    if failure(text) is None:
        return
    (whole,) = {whole for whole in shapes.rules(text) if failure(whole) is None}
    listed = f"{{ {', '.join(conditions)} }}" if conditions else "{}"
    assert whole == f"rule r {listed} -> {{ {', '.join(effects)} }}"
    assert format_source(Source("t", mended(text))).rstrip() == whole


def test_no_text_is_too_strange() -> None:
    """Every run of words of the language and signs of others ends with a diagnosis."""
    vocabulary = [
        *sorted(words()),
        *[
            "|",
            "&",
            "-",
            "*",
            "/",
            "%",
            "~",
            "^",
            ";",
            ".",
            "[",
            "]",
            "'",
            "`",
            "(",
            ")",
            "{",
            "}",
            "?",
            ":",
            "=",
            "<",
            ">",
            ",",
            "+",
            "#",
            '"',
            "Δ",
        ],
    ]

    @given(st.lists(st.sampled_from([*vocabulary, "n", "0", "\n"]), min_size=1, max_size=15))
    def check(parts: list[str]) -> None:
        text = " ".join(parts)
        for one in found(text):
            assert 0 <= one.primary.span.start <= one.primary.span.end <= len(text)
            if one.fix is not None:
                assert 0 <= one.fix.span.start <= one.fix.span.end <= len(text)

    check()


GOOD = "sketch s\nfeature n : nat  # packages\ngoal { n = 0 }\nrule r { n > 0 } -> { n-- }\n"
COMMENT = GOOD.index("packages") + 3
SIGNS = [
    chr(code) for code in range(0x3000) if unicodedata.category(chr(code)) in {"Cc", "Cf", "Zl"}
]


@pytest.mark.parametrize(
    "sign", sorted({*SIGNS} - {"\n", "\t", "\r"}), ids=lambda s: f"{ord(s):04X}"
)
def test_hidden_characters_are_reported_wherever_they_are(sign: str) -> None:
    for place in (GOOD.index("goal"), COMMENT):
        text = GOOD[:place] + sign + GOOD[place:]
        codes = [one.code for one in found(text)]
        joins = unicodedata.category(sign) == "Cf" and unicodedata.bidirectional(sign) == "BN"
        letter = unicodedata.category(sign) == "Cf" and unicodedata.bidirectional(sign) in {
            "AN",
            "AL",
            "ON",
            "NSM",
        }
        if place == COMMENT and (joins or letter) and sign not in "\u200e\u200f\u061c":
            continue
        assert codes == ["hidden-character"], hex(ord(sign))
        assert mended(text) == GOOD


@pytest.mark.parametrize("sign", ["\u00a0", "\u2003", "\u3000", "\u202f"])
def test_spaces_of_another_kind(sign: str) -> None:
    text = GOOD.replace("{ n-- }", f"{{{sign}n-- }}")
    (one,) = found(text)
    assert one.code == "hidden-character"
    assert mended(text) == GOOD
    assert found(GOOD.replace("packages", f"some{sign}packages")) == []


def test_a_return_by_itself_is_hidden_and_with_a_line_break_it_is_not() -> None:
    assert found(GOOD.replace("\n", "\r\n")) == []
    assert [one.code for one in found(GOOD.replace("packages", "packages\rrule"))] == [
        "hidden-character"
    ]
