"""One page for every diagnostic: what it means, why it matters, an example, what to do.

The pages are Markdown. `sketchlang explain CODE` prints them, and the tests run their examples
and compare what is printed with the page.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files

FILES = ("syntax", "names", "types", "rules", "coverage", "running")


@dataclass(frozen=True, slots=True)
class Page:
    """A page: its code, whether it is about an `error` or a `warning`, a summary of one
    sentence, and the rest as Markdown."""

    code: str
    severity: str
    summary: str
    body: str


@cache
def pages() -> dict[str, Page]:
    """All pages by code, in the order of the files."""
    found: dict[str, Page] = {}
    for name in FILES:
        text = files(__name__).joinpath(f"{name}.md").read_text(encoding="utf-8")
        for section in ("\n" + text).split("\n## ")[1:]:
            code, _, rest = section.partition("\n")
            head, _, body = rest.strip().partition("\n\n")
            severity, _, summary = head.replace("\n", " ").partition(". ")
            found[code] = Page(code, severity, summary, body)
    return found
