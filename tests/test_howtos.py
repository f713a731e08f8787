"""Every how-to is executed as it is written."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.pages import DOCS, read_page, run_page

PAGES = [*sorted(DOCS.glob("howto-*.md")), DOCS / "extending.md"]
NEEDS_MORE = ("howto-ros.md",)
"""Pages that something has to be prepared for; they have tests of their own."""


@pytest.mark.slow
@pytest.mark.parametrize(
    "page", [p for p in PAGES if p.name not in NEEDS_MORE], ids=lambda p: p.stem
)
def test_a_how_to_does_what_it_says(page, tmp_path) -> None:
    run_page(page, tmp_path)


def test_every_how_to_has_commands() -> None:
    assert len(PAGES) >= 6
    assert [page.name for page in PAGES if not read_page(page).commands] == []


@pytest.fixture
def folder(tmp_path) -> Path:
    (tmp_path / "here").mkdir()
    return tmp_path / "here"


def page_of(tmp_path: Path, text: str) -> Path:
    page = tmp_path / "page.md"
    page.write_text(text)
    return page


GOOD = """
```text note.txt
three words here
```

    $ cat note.txt
    three words here

```text note.txt
four
```

    $ cat note.txt
    four
    $ python - <<'END'
    print("in 0.7 s, 4 steps")
    print("other")
    print("last")
    END
    in 12 s, 5 steps
    ...
    last
    $ python -c "raise SystemExit(3)"
    $ echo $?
    3

<!-- not run: there is no such program here -->

    sketchlang launch rocket

Not a command:

    name = "table"
"""


def test_a_page_is_executed(tmp_path, folder) -> None:
    run_page(page_of(tmp_path, GOOD), folder)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("\n    three words here", "\n    two words here"),
        ("    $ echo $?\n    3\n", ""),
        ("    ...\n", ""),
        ("    last\n    $ python -c", "    least\n    $ python -c"),
        ("<!-- not run: there is no such program here -->", ""),
    ],
)
def test_a_page_that_does_not_hold_is_found(tmp_path, folder, old, new) -> None:
    text = GOOD.replace(old, new, 1)
    assert text != GOOD
    with pytest.raises(AssertionError):
        run_page(page_of(tmp_path, text), folder)
