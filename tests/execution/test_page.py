"""The replay page in a headless browser: no network, no errors, it plays and it seeks."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from runtime.trace.kinematics import Tree, links_at, object_at
from runtime.view.browser import Browser, find_browser
from runtime.view.page import page

needs_browser = pytest.mark.skipif(find_browser() is None, reason="there is no Chromium")


def test_the_page_is_one_small_file(trace) -> None:
    text = page(trace)
    assert len(text) < 2_000_000
    assert "src=" not in text.partition('<script type="application/json"')[0]
    assert "@TRACE@" not in text
    assert "default-src 'none'" in text


@pytest.fixture(scope="module")
def browser(trace, tmp_path_factory) -> Iterator[Browser]:
    path: Path = tmp_path_factory.mktemp("page") / "replay.html"
    path.write_text(page(trace), encoding="utf-8")
    with Browser(640, 400) as opened:
        opened.open(path)
        yield opened


@needs_browser
def test_it_loads_without_network_and_errors(browser) -> None:
    urls = [
        event["params"]["request"]["url"]
        for event in browser.events
        if event["method"] == "Network.requestWillBeSent"
    ]
    assert len(urls) == 1
    assert urls[0].startswith("file:")
    assert not [e for e in browser.events if e["method"] == "Runtime.exceptionThrown"]
    assert not [e for e in browser.events if e["method"] == "Runtime.consoleAPICalled"]
    logged = [e["params"]["entry"] for e in browser.events if e["method"] == "Log.entryAdded"]
    assert not [entry for entry in logged if entry["level"] == "error"]


@needs_browser
def test_rule_features_and_objects_are_in_step_with_the_time(browser, trace) -> None:
    tree = Tree(trace.robot)
    for number, subgoal in enumerate(trace.subgoals):
        moment = (subgoal.start + subgoal.end) / 2
        browser.evaluate(f"replay.seek({moment})")
        browser.wait("replay.fresh")
        state = browser.evaluate("replay.state")
        assert (state["subgoal"], state["rule"]) == (number, subgoal.rule)
        assert len(state["lit"]) == 1
        assert state["lit"][0].startswith(f"rule {subgoal.rule} ")
        assert state["values"]["m"] == str(subgoal.before["m"])
        links = links_at(trace, tree, moment)
        for index, position in enumerate(state["objects"]):
            expected = object_at(trace, links, index, moment)[:3, 3]
            assert position == pytest.approx(expected.tolist(), abs=1e-4)


@needs_browser
def test_it_plays_and_pauses(browser) -> None:
    browser.evaluate("replay.seek(0); replay.speed(16); replay.play()")
    browser.wait("replay.time > 2")
    browser.evaluate("replay.play(false)")
    stopped = browser.evaluate("replay.time")
    time.sleep(0.2)
    assert browser.evaluate("replay.time") == stopped


@needs_browser
def test_a_click_on_a_subgoal_goes_there(browser, trace) -> None:
    browser.evaluate("document.querySelectorAll('#subgoals li')[2].click()")
    assert browser.evaluate("replay.time") == pytest.approx(trace.subgoals[2].start, abs=1e-5)
