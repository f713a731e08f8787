"""The documentation site: every page has its place, and the playground proves in a browser."""

from __future__ import annotations

import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from docs.site import language, pages
from docs.site.build import PYODIDE, navigation, playground
from runtime.show.browser import Browser, find_browser
from tests.pages import DOCS

PACKAGES = DOCS / "site" / "node_modules" / "pyodide"


@pytest.fixture
def folder(tmp_path) -> Path:
    """A few pages, as they are staged."""
    for name in ("tutorial.md", "howto-b.md", "scenes.md", "new.md", "adr/0002-b.md", "index.md"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(f"# About `{path.stem}`\n")
    (tmp_path / "language").mkdir()
    for number in (10, 2):
        (tmp_path / "language" / f"{number}-x.md").write_text("# X\n")
    return tmp_path


def test_every_page_is_in_one_section(folder) -> None:
    found = pages.sections(folder)
    paths = [entry.path for entries in found.values() for entry in entries]
    assert sorted(paths) == sorted(set(paths))
    assert set(paths) == {
        path.relative_to(folder).as_posix() for path in folder.rglob("*.md")
    } - set(pages.ALONE)
    assert [entry.title for entry in found["How-to"]] == ["About howto-b"]
    assert [e.path for e in found["Reference"]] == [
        "language/2-x.md",
        "language/10-x.md",
        "scenes.md",
    ]
    assert [e.path for e in found["Explanation"]] == ["new.md"]
    assert [e.path for e in found["Decisions"]] == ["adr/0002-b.md"]


def test_the_navigation_is_toml(folder) -> None:
    import tomllib

    found = tomllib.loads(navigation(pages.sections(folder)))["project"]["nav"]
    names = [name for entry in found for name in entry]
    assert names == ["Home", *pages.SECTIONS, "Gallery", "Playground"]


def test_links_lead_to_pages_of_the_site(folder) -> None:
    page = folder / "adr" / "0002-b.md"
    page.write_text(
        "[a](../scenes.md#here), [b](../../tests/spec/2-x.md#y), [`c`](../../domains/c.py), "
        "[d](https://a.b/c), [e](#f), [g[1]](../../h.md) and ![i](j.png)\n"
    )
    assert pages.relinked(page, folder) == (
        "[a](../scenes.md#here), [b](../language/2-x.md#y), `c`, "
        "[d](https://a.b/c), [e](#f), g[1] and !i\n"
    )


def test_the_real_pages_have_titles_and_the_made_ones_what_they_promise() -> None:
    for path in [*DOCS.glob("*.md"), *DOCS.glob("adr/*.md")]:
        assert pages.title_of(path)
    assert "sketchlang terminate" in pages.commands()
    assert "## uncovered" in pages.diagnostics()
    named = pages.names()
    assert "## sketchlang.plan" in named
    assert "### Domain.extend" in named


def test_the_archive_is_always_the_same(tmp_path) -> None:
    first, second = tmp_path / "a.zip", tmp_path / "b.zip"
    language.pack(first)
    language.pack(second)
    assert first.read_bytes() == second.read_bytes()


@pytest.mark.slow
def test_the_packed_language_needs_nothing_else(tmp_path) -> None:
    language.pack(tmp_path / "language.zip")
    (tmp_path / "in").mkdir()
    language.try_out(tmp_path / "language.zip", tmp_path / "in")


@pytest.mark.slow
@pytest.mark.skipif(find_browser() is None, reason="there is no Chromium")
@pytest.mark.skipif(not (PACKAGES / PYODIDE[0]).exists(), reason="npm ci --prefix docs/site")
def test_the_playground_proves_without_a_network(tmp_path) -> None:
    playground(tmp_path / "playground", PACKAGES)
    handler = partial(SimpleHTTPRequestHandler, directory=str(tmp_path))
    server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with Browser() as browser:
        address = f"http://127.0.0.1:{server.server_address[1]}/playground/index.html"
        browser.call("Page.navigate", {"url": address})
        browser.wait("document.body?.dataset.state === 'ready'", 120)
        # From here on there is nobody to be asked.
        server.shutdown()
        server.server_close()

        def press(button: str, until: str, seconds: float = 60) -> None:
            browser.evaluate(f"document.getElementById('{button}').click()")
            browser.wait(f"({until}) && document.body.dataset.state === 'ready'", seconds)

        text = "document.getElementById('output').textContent"
        press("prove", f"{text}.startsWith('pick_and_place terminates')", 5)
        press("draw", "document.querySelector('#output img')?.naturalWidth > 100")
        browser.evaluate(
            "(() => { const e = document.getElementById('editor');"
            "e.value = e.value.replaceAll('!v++', 'v?'); e.oninput(); })()"
        )
        press("prove", f"{text}.startsWith('pick_and_place does not terminate')")
        browser.evaluate(
            "(() => { const e = document.getElementById('editor');"
            "e.value = 'sketch a\\nfeature n : nut\\nrule r {n>0}->{n--}\\n'; e.oninput(); })()"
        )
        browser.wait("document.querySelectorAll('#findings .error').length > 0")
        browser.evaluate(
            "(() => { const e = document.getElementById('editor');"
            "e.value = e.value.replace('nut', 'nat'); e.oninput(); })()"
        )
        press("format", "document.getElementById('editor').value.includes('{ n > 0 } -> { n-- }')")
