"""The parser against Lark, and its error recovery."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lark.exceptions import UnexpectedInput

from sketchlang.source import Source
from sketchlang.syntax import examples, grammar, printer
from sketchlang.syntax.mistakes import MESSAGES
from sketchlang.syntax.parser import parse
from tests.language.trees import items

SIGNS = "!= <= >= -> -- ++ ? = < > + ( ) { } , : !"
TOKENS = [*sorted(grammar.words()), *SIGNS.split(), "x", "f", "0", "7", '"p"']


def codes(text: str) -> list[str]:
    return [found.code for found in parse(Source("t", text))[1]]


def test_every_mistake_has_a_message() -> None:
    assert set(MESSAGES) == set(examples.mistakes().values())


def test_examples_that_contradict_each_other_are_noticed() -> None:
    with pytest.raises(ValueError, match="is stuck where"):
        examples.place("one\n    goal a\ntwo\n    goal !a\n    goal b\n")
    with pytest.raises(ValueError, match="is no mistake"):
        examples.place("one\n    goal { a }\n")


def grammatical(text: str) -> bool:
    """Whether Lark takes a text as one item when it reads it by itself."""
    try:
        grammar.load().parse(text)
    except UnexpectedInput:
        return False
    return True


@given(items)
def test_what_is_printed_is_parsed(item: object) -> None:
    text = "\n".join(printer.item(item))  # type: ignore[arg-type]
    assert codes(text) == []
    assert grammatical(text)


@given(items, st.data())
def test_a_damaged_item_is_reported_if_the_grammar_forbids_it(
    item: object, data: st.DataObject
) -> None:
    """One token is left out, doubled or replaced."""
    words = " ".join(printer.item(item)).split(" ")  # type: ignore[arg-type]
    place = data.draw(st.integers(0, len(words) - 1))
    words[place] = data.draw(st.sampled_from(["", f"{words[place]} {words[place]}", *TOKENS]))
    text = " ".join(words)
    if not text.strip():
        return
    found = codes(text)
    # Chained comparisons and long numbers are no matter of grammar.
    if not {"chained-comparison", "number-too-large"} & set(found):
        assert grammatical(text) == (not found), text


@settings(max_examples=300)
@given(st.lists(st.sampled_from(TOKENS), min_size=1, max_size=12))
def test_random_tokens(words: list[str]) -> None:
    text = " ".join(words)
    found = codes(text)
    if not {"chained-comparison", "number-too-large"} & set(found):
        assert grammatical(text) == (not found), text


GOOD = """\
sketch s
feature n : nat
feature H : bool
goal { n = 0 }
rule r { n > 0, !H } -> { n--, H }
"""


@pytest.mark.parametrize(
    ("line", "text", "code"),
    [
        (2, "feature n nat", "foreign-notation"),
        (3, "feature H : bol", "unknown-type"),
        (4, "gaol { n = 0 }", "unknown-item"),
        (5, "rule r { n > 0, !H } -> { n--, H", "unclosed-block"),
        (3, "feature H : bool = $", "unexpected-character"),
    ],
)
def test_one_mistake_is_one_diagnostic(line: int, text: str, code: str) -> None:
    lines = GOOD.splitlines()
    lines[line - 1] = text
    source = Source("t", "\n".join(lines))
    (found,) = parse(source)[1]
    assert found.code == code
    assert source.position(found.primary.span.start)[0] == line


def test_several_mistakes_are_found_in_order() -> None:
    text = "sketch\nfeature n nat\ngoal { n = 0 \nrule r { n > 0 } { n-- }\nfoo\n"
    source = Source("t", text)
    found = parse(source)[1]
    assert [(source.position(d.primary.span.start)[0], d.code) for d in found] == [
        (1, "foreign-notation"),
        (2, "foreign-notation"),
        (3, "unclosed-block"),
        (4, "missing-arrow"),
        (5, "unknown-item"),
    ]


def test_both_spellings() -> None:
    ascii_text = "rule r { !H, n > 0 and m = 0 } -> { H, n--, m++, !v++ }"
    signs = "rule r { ¬H ∧ n > 0 ∧ m = 0 } ↦ { H ∧ n↓ ∧ m↑ ∧ ¬v↑ }"
    from tests.language.trees import bare

    a, b = (parse(Source("t", text)) for text in (ascii_text, signs))
    assert a[1] == b[1] == []
    assert bare(a[0].items) == bare(b[0].items)


def test_words_of_other_languages() -> None:
    (found,) = parse(Source("t", "feature p : bool = exists x in s: f(x)"))[1]
    assert found.hint == "Write `some`."


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("invariant a => b", "Write `->`."),
        ("rule r { a } => { b }", "Write `rule r { a } -> { b }`."),
        ("rule r { a } ⇒ { b }", "Write `rule r { a } -> { b }`."),
        (
            "invariant a <-> b",
            "Write `=` between two Booleans, or an implication `->` for each direction.",
        ),
        (
            "rule r { n > 0 } -> { n– }",
            "Write `n--`.",
        ),
        (
            "feature n : nat bounded",
            "Write `bounded` before `feature`, as in `bounded feature n : nat`.",
        ),
    ],
)
def test_signs_of_other_languages(text: str, hint: str) -> None:
    assert parse(Source("t", text))[1][0].hint == hint
