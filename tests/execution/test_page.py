"""The replay page in a headless browser: no network, no errors, it plays and it seeks."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from runtime.show.browser import Browser, find_browser
from runtime.show.notebook import Embedded
from runtime.show.page import page
from runtime.trace.kinematics import Tree, links_at, object_at
from runtime.trace.model import Event
from runtime.trace.valuations import valuations, values_at

needs_browser = pytest.mark.skipif(find_browser() is None, reason="there is no Chromium")


def test_the_page_is_one_small_file(trace) -> None:
    text = page(trace)
    assert len(text) < 2_000_000
    assert "src=" not in text.partition('<script type="application/json"')[0]
    assert "@PAYLOAD@" not in text
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
        values = values_at(valuations(trace), moment)
        assert state["values"]["m"] == str(values["m"])
        assert state["values"]["H"] == ("true" if values["H"] else "false")
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
    browser.evaluate("document.querySelectorAll('#subgoals button')[2].click()")
    assert browser.evaluate("replay.time") == pytest.approx(trace.subgoals[2].start, abs=1e-5)


def press(browser: Browser, key: str) -> None:
    """A key as a person presses it; what has the focus gets it."""
    codes = {"PageUp": 33, "PageDown": 34, "End": 35, "Home": 36, "ArrowLeft": 37, "ArrowRight": 39}
    code = codes.get(key) or ord(key.upper())
    event = {"key": key, "windowsVirtualKeyCode": code} | ({"text": key} if len(key) == 1 else {})
    browser.call("Input.dispatchKeyEvent", {"type": "keyDown"} | event)
    browser.call("Input.dispatchKeyEvent", {"type": "keyUp"} | event)


def click_on(browser: Browser, name: str) -> None:
    """A click as a person makes it: it moves the focus."""
    script = f"(({{x, y}}) => [x + 5, y + 5])(document.getElementById('{name}')"
    x, y = browser.evaluate(f"{script}.getBoundingClientRect())")
    at = {"x": x, "y": y, "button": "left", "clickCount": 1}
    for kind in ("mousePressed", "mouseReleased"):
        browser.call("Input.dispatchMouseEvent", {"type": kind} | at)


@needs_browser
def test_keys_work_after_a_click_on_a_button(browser, trace) -> None:
    browser.evaluate("replay.play(false); replay.seek(0)")
    click_on(browser, "forward")
    second, third = (subgoal.start for subgoal in trace.subgoals[1:3])
    assert browser.evaluate("replay.time") == pytest.approx(second, abs=1e-5)
    press(browser, "PageDown")
    assert browser.evaluate("replay.time") == pytest.approx(third, abs=1e-5)
    press(browser, "PageUp")
    assert browser.evaluate("replay.time") == pytest.approx(second, abs=1e-5)
    press(browser, " ")
    assert browser.evaluate("replay.playing")
    assert browser.evaluate("replay.time") < third - 1
    browser.evaluate("document.getElementById('labels').focus()")
    press(browser, "PageDown")
    assert browser.evaluate("replay.time") >= third - 1e-5
    browser.evaluate("replay.play(false); document.activeElement.blur()")


@needs_browser
def test_a_plan_without_actions_and_its_verdict(trace, tmp_path) -> None:
    events = (Event(0.1, "verdict", "the object is lost"), Event(0.2, "verdict", "goal reached"))
    path = tmp_path / "replay.html"
    empty = replace(trace, subgoals=(), actions=(), events=events, duration=1.0)
    path.write_text(page(empty), encoding="utf-8")
    with Browser(640, 400) as browser:
        browser.open(path)
        browser.evaluate("replay.seek(0.5)")
        for key, time in (("PageUp", 0.0), ("PageDown", 1.0)):
            press(browser, key)
            assert browser.evaluate("replay.time") == time
        assert not [e for e in browser.events if e["method"] == "Runtime.exceptionThrown"]
        colours = browser.evaluate(
            "[...document.querySelectorAll('#events button')].map((e) => getComputedStyle(e).color)"
        )
    assert colours[0] == "rgb(179, 38, 30)"
    assert colours[1] != colours[0]


@needs_browser
def test_keys_do_all_that_the_mouse_does(browser, trace) -> None:
    browser.evaluate("replay.play(false); replay.seek(10)")
    steps = {"ArrowRight": 11.0, "ArrowLeft": 10.0, "Home": 0.0, "End": trace.duration}
    for key, moment in steps.items():
        press(browser, key)
        assert browser.evaluate("replay.time") == pytest.approx(moment, abs=1e-4)
    cameras = []
    for _ in range(5):
        press(browser, "c")
        cameras.append(browser.evaluate("document.getElementById('camera').value"))
    assert sorted(cameras) == ["auto", "follow", "gripper", "overview", "top"]
    for key, box in (("n", "labels"), ("b", "solids"), ("d", "dark")):
        script = f"document.getElementById('{box}').checked"
        before = browser.evaluate(script)
        press(browser, key)
        assert browser.evaluate(script) is not before
        press(browser, key)
    press(browser, "?")
    assert browser.evaluate("document.getElementById('keys').open")
    browser.evaluate("document.getElementById('keys').close()")


@needs_browser
def test_everything_can_be_reached_by_tab_and_has_a_name(browser) -> None:
    nameless = browser.evaluate(
        "[...document.querySelectorAll('button, input, select, a')].filter((e) => e.tabIndex >= 0"
        " && !(e.getAttribute('aria-label') || e.textContent.trim() || e.closest('label')))"
        ".map((e) => e.outerHTML)"
    )
    assert nameless == []


@needs_browser
def test_a_page_that_stands_still_is_a_link_to_its_moment(trace, browser, tmp_path) -> None:
    browser.evaluate("replay.play(false); replay.seek(31.5)")
    assert browser.evaluate("location.hash") == "#t=31.5"
    browser.evaluate("location.hash = '#t=12.5'")
    browser.wait("replay.time === 12.5")


@needs_browser
def test_draw_calls_are_few_and_the_robot_is_large(browser, trace) -> None:
    for share in (0.1, 0.5, 0.9):
        browser.evaluate(f"replay.camera('auto'); replay.seek({share * trace.duration})")
        browser.evaluate("replay.draw()")
        assert browser.evaluate("replay.calls[0].calls") < 60
        assert browser.evaluate("replay.robotHeight") > 0.25


@needs_browser
def test_two_plans_stand_side_by_side(trace, tmp_path) -> None:
    path = tmp_path / "both.html"
    short = replace(trace, duration=trace.duration / 2)
    path.write_text(page(trace, short), encoding="utf-8")
    with Browser(800, 400) as browser:
        browser.open(path)
        assert browser.evaluate("document.querySelectorAll('.view canvas').length") == 2
        assert browser.evaluate("replay.duration") == pytest.approx(trace.duration, abs=1e-5)
        browser.evaluate("replay.seek(20); replay.draw()")
        captions = "[...document.querySelectorAll('.caption')].map((e) => e.textContent)"
        same = browser.evaluate(captions)
        assert same[0] == same[1]
        browser.evaluate("document.getElementById('scaled').click(); replay.draw()")
        moment = 10.0
        running = [a for a in trace.actions if a.start <= moment < a.end]
        said = browser.evaluate(captions)[1]
        assert any(action.text in said for action in running)
        assert not [e for e in browser.events if e["method"] == "Runtime.exceptionThrown"]


@needs_browser
def test_a_notebook_shows_it_in_a_frame(trace, tmp_path) -> None:
    path = tmp_path / "notebook.html"
    frame = Embedded(page(trace, start=12.5), 300)._repr_html_()
    path.write_text(f"<!doctype html><title>notebook</title>{frame}", encoding="utf-8")
    with Browser(640, 400) as browser:
        # A frame that may reach nothing of its notebook is a target of its own.
        attach = {"autoAttach": True, "waitForDebuggerOnStart": False, "flatten": True}
        browser.call("Target.setAutoAttach", attach)
        browser.call("Page.navigate", {"url": path.as_uri()})
        browser.wait("document.querySelector('iframe')")
        until, sessions = time.monotonic() + 60, []
        while not sessions and time.monotonic() < until:
            browser.evaluate("0")  # what happens meanwhile is read with the answer
            found = [
                e["params"] for e in browser.events if e["method"] == "Target.attachedToTarget"
            ]
            sessions = [e["sessionId"] for e in found if e["targetInfo"]["type"] == "iframe"]
        with browser.within(str(sessions[0])):
            browser.wait("window.replay && replay.frames > 0")
            assert browser.evaluate("replay.time") == 12.5
            assert str(browser.evaluate("document.getElementById('clock').textContent")).startswith(
                "0:12 / "
            )
        assert not [e for e in browser.events if e["method"] == "Runtime.exceptionThrown"]


@needs_browser
@pytest.mark.slow
def test_sixty_objects_are_a_few_draw_calls_and_a_small_file(tmp_path) -> None:
    import sketchlang

    path = tmp_path / "replay.html"
    result = sketchlang.plan("pick_and_place", "warehouse/shelves", seed=0)
    result.plan.replay(path)
    assert len(result.task.plan.world.scene.world.movables) >= 60
    assert path.stat().st_size < 4_000_000
    with Browser(640, 400) as browser:
        browser.open(path)
        for share in (0.1, 0.5, 0.9):
            browser.evaluate(f"replay.seek({share} * replay.duration); replay.draw()")
            assert browser.evaluate("replay.calls[0].calls") < 60
            assert browser.evaluate("replay.robotHeight") > 0.25
