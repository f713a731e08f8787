"""What execute, replay and export write: where, when, as a whole, and never over their input."""

from __future__ import annotations

import json
import os
import struct
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner, Result

pytest.importorskip("pybullet")

from domains.tabletop.scene.worlds import find_world
from runtime.export import bag
from runtime.physics import simulation as physics
from runtime.physics.execute import Report
from runtime.physics.tracking import Tracking
from runtime.show import camera, encoder, pictures, software
from runtime.show.browser import find_browser
from runtime.show.drawn import drawn
from runtime.show.moments import moments
from runtime.show.pictures import write_film
from runtime.show.software import LENS, RIGHT, UP, Studio
from runtime.trace.write import write_trace
from sketchlang.cli.execute import command as execute
from sketchlang.cli.execute import largest_errors, summary
from sketchlang.cli.export import command as export
from sketchlang.cli.replay import command as replay
from sketchlang.errors import InputError

LOOP = ["pick_and_place", "sorting/3t-02", "--closed-loop"]


@pytest.fixture
def trace_file(trace, tmp_path) -> Path:
    """A trace of half a second, in the folder of the test."""
    path = tmp_path / "short.json"
    write_trace(replace(trace, duration=0.5), path)
    return path


def call(command: click.Command, *arguments: object) -> Result:
    return CliRunner().invoke(command, [str(argument) for argument in arguments])


def refused(done: Result, *words: str) -> None:
    """An end with status 2 and a message."""
    assert done.exit_code == 2, done.output
    for word in words:
        assert word in done.stderr


@pytest.fixture
def no_work(monkeypatch) -> None:
    """Fails where a command begins to work."""

    def work(*_: object) -> None:
        raise AssertionError("the work began")

    monkeypatch.setattr("runtime.trace.load.load_trace", work)
    monkeypatch.setattr("domains.tabletop.loop.closed_loop.ClosedLoop.__init__", work)


# -- where ---------------------------------------------------------------------------------------


@pytest.mark.usefixtures("no_work")
@pytest.mark.parametrize(
    ("command", "option"),
    [(replay, "--html"), (replay, "--trace"), (export, "--glb"), (execute, "--trace")],
)
def test_an_output_does_not_overwrite_the_input(command, option, trace_file) -> None:
    before = trace_file.read_bytes()
    link = trace_file.parent / "link.json"
    link.symlink_to(trace_file)
    for path in (
        trace_file,
        trace_file.parent / ".." / trace_file.parent.name / "short.json",
        link,
    ):
        refused(call(command, trace_file, option, path), option, "overwrite what is read")
    assert trace_file.read_bytes() == before


@pytest.mark.usefixtures("no_work")
def test_two_outputs_are_two_files(trace_file, tmp_path) -> None:
    path = tmp_path / "x"
    refused(call(replay, trace_file, "--html", path, "--trace", path), "what --html writes")
    refused(call(export, trace_file, "--glb", path, "--trajectory", path), "overwrite")


@pytest.mark.usefixtures("no_work")
def test_a_closed_loop_does_not_overwrite_its_scene(tmp_path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text("old")
    refused(
        call(execute, "pick_and_place", scene, "--closed-loop", "--trace", scene), "would overwrite"
    )
    assert scene.read_text() == "old"


# -- when ----------------------------------------------------------------------------------------


@pytest.mark.usefixtures("no_work")
@pytest.mark.parametrize(
    ("command", "option"),
    [
        *((replay, option) for option in ("--html", "--png", "--mp4", "--trace")),
        *((export, option) for option in ("--trajectory", "--bag", "--glb")),
        (execute, "--trace"),
    ],
)
def test_missing_folders_are_found_before_the_work(command, option, trace_file, tmp_path) -> None:
    path = tmp_path / "no" / "such.mp4"
    refused(call(command, trace_file, option, path), "there is no folder")


@pytest.mark.usefixtures("no_work")
def test_a_closed_loop_looks_ahead(tmp_path) -> None:
    refused(call(execute, *LOOP, "--trace", tmp_path / "no" / "t.json"), "there is no folder")


@pytest.mark.usefixtures("no_work")
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="there is no folder without files to make")
@pytest.mark.parametrize(
    ("command", "option"), [(replay, "--html"), (export, "--bag"), (execute, "--trace")]
)
def test_folders_without_room_are_found_before_the_work(command, option, trace_file) -> None:
    refused(call(command, trace_file, option, "/proc/output"), "/proc/output: cannot be written")


@pytest.mark.usefixtures("no_work")
def test_names_that_are_too_long_are_found_before_the_work(trace_file, tmp_path) -> None:
    refused(call(replay, trace_file, "--html", tmp_path / ("x" * 300)), "cannot be written")


def test_a_pipe_as_output(trace_file) -> None:
    # In a process of its own, whose standard output is a pipe.
    main = "from sketchlang.cli import main; main()"
    command = [sys.executable, "-c", main, "replay", str(trace_file), "--trace", "/dev/stdout"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.startswith('{"format":"sketchlang-trace"')


@pytest.mark.usefixtures("no_work")
def test_a_film_needs_a_name_of_a_film(trace_file, tmp_path) -> None:
    pytest.importorskip("imageio_ffmpeg")
    refused(call(replay, trace_file, "--mp4", tmp_path / "film"), "ends in .mp4")


# -- the closed loop's trace ---------------------------------------------------------------------


def closed_loop(monkeypatch, happened, *arguments: object) -> Result:
    """A closed loop that ends at once with a trace, or with none."""
    from domains.tabletop.loop.closed_loop import ClosedLoop, Verdict

    verdict = Verdict(True, None, 0, 0, 1.0, (), ())
    monkeypatch.setattr(ClosedLoop, "__init__", lambda *_: None)
    monkeypatch.setattr(ClosedLoop, "run", lambda _: (verdict, happened))
    return call(execute, *LOOP, *arguments)


def test_a_closed_loop_says_where_its_trace_is(monkeypatch, trace, tmp_path) -> None:
    path = tmp_path / "t.json"
    done = closed_loop(monkeypatch, trace, "--trace", path)
    assert f"trace written to {path}" in done.stdout
    assert path.exists()
    json.loads(closed_loop(monkeypatch, trace, "--trace", path, "--json").stdout)


def test_a_closed_loop_says_that_there_is_no_trace(monkeypatch, tmp_path) -> None:
    path = tmp_path / "t.json"
    done = closed_loop(monkeypatch, None, "--trace", path)
    assert "nothing was done: no trace was written" in done.stdout
    assert not path.exists()
    done = closed_loop(monkeypatch, None, "--trace", path, "--json")
    json.loads(done.stdout)
    assert "no trace was written" in done.stderr


# -- ranges --------------------------------------------------------------------------------------


@pytest.mark.parametrize("speed", ["inf", "nan", "1e-12", "-1", "101"])
def test_speeds_are_sensible(speed, trace_file, tmp_path) -> None:
    done = call(replay, trace_file, "--mp4", tmp_path / "f.mp4", "--speed", speed)
    refused(done, "--speed")


@pytest.mark.parametrize("time", ["inf", "nan", "-1", "1.0"])
def test_models_are_of_a_time_within(time, trace_file, tmp_path) -> None:
    path = tmp_path / "m.glb"
    refused(call(export, trace_file, "--glb", path, "--at", time), "--at")
    assert not path.exists()


def test_the_end_as_it_is_printed_is_within(trace_file, tmp_path) -> None:
    assert call(export, trace_file, "--glb", tmp_path / "m.glb", "--at", 0.504).exit_code == 0


# -- as a whole or not at all --------------------------------------------------------------------


def names(folder: Path) -> set[str]:
    return {entry.name for entry in folder.iterdir()}


@pytest.fixture
def no_browser(monkeypatch) -> None:
    """As on a machine without Chromium."""
    monkeypatch.setattr(camera, "find_browser", lambda: None)


@pytest.mark.usefixtures("no_browser")
@pytest.mark.parametrize("error", [KeyboardInterrupt, RuntimeError])
def test_a_film_that_is_interrupted_leaves_the_old_one(error, trace, tmp_path, monkeypatch) -> None:
    pytest.importorskip("imageio_ffmpeg")
    path, frames = tmp_path / "film.mp4", iter(range(2))
    path.write_text("old")
    picture = Studio.picture

    def interrupted(self: Studio, time: float) -> software.Image:
        if next(frames, None) is None:
            raise error
        return picture(self, time)

    monkeypatch.setattr(Studio, "picture", interrupted)
    with pytest.raises(error):
        write_film(trace, path, 8.0)
    assert path.read_text() == "old"
    assert names(tmp_path) == {"film.mp4"}


@pytest.mark.usefixtures("no_browser")
@pytest.mark.parametrize(("name", "start", "mark"), [("f.MP4", 4, b"ftyp"), ("f.gif", 0, b"GIF8")])
def test_a_film_is_written(name, start, mark, trace, tmp_path) -> None:
    pytest.importorskip("imageio_ffmpeg")
    path, said, done = tmp_path / name, [], []
    short = replace(trace, duration=0.6)
    write_film(short, path, 8.0, 0.2, 0.5, lambda *counts: done.append(counts), said.append)
    assert path.read_bytes()[start : start + 4] == mark
    assert names(tmp_path) == {name}
    assert done[-1] == (len(done), len(done))
    assert "no Chromium" in said[0]


@pytest.mark.usefixtures("no_browser")
def test_an_encoder_that_fails_is_told_of(trace, tmp_path, monkeypatch, capfd) -> None:
    package = pytest.importorskip("imageio_ffmpeg")
    path = tmp_path / "film.mp4"
    monkeypatch.setattr(package, "get_ffmpeg_exe", lambda: "/bin/false")
    with pytest.raises(InputError, match="encoder"):
        write_film(replace(trace, duration=0.3), path, 8.0)
    assert not capfd.readouterr().err
    assert not names(tmp_path)


@pytest.mark.skipif(find_browser() is None, reason="there is no Chromium")
def test_pictures_and_films_are_taken_of_the_page(trace, tmp_path, monkeypatch) -> None:
    pytest.importorskip("imageio_ffmpeg")
    film, said = tmp_path / "f.mp4", []
    monkeypatch.setattr(pictures, "FILM", replace(encoder.FILM, size=(320, 180)))
    write_film(replace(trace, duration=0.3), film, 8.0, say=said.append)
    assert film.read_bytes()[4:8] == b"ftyp"
    assert not said
    with camera.camera_of(trace, (480, 270), view="overview") as shooting:
        first, later = (shooting.shot(share * trace.duration) for share in (0.0, 0.5))
    assert first.startswith(b"\x89PNG")
    assert first[16:24] == struct.pack(">II", 480, 270)
    assert first != later


@pytest.mark.usefixtures("no_browser")
def test_what_a_page_would_show_better_is_said(trace_file, tmp_path) -> None:
    done = call(replay, trace_file, "--png", tmp_path / "pictures")
    assert done.exit_code == 0, done.output
    assert "there is no Chromium: drawn by the software renderer" in done.stderr
    assert "pictures written" in done.stdout


def test_a_film_ends_after_it_begins(trace_file, tmp_path) -> None:
    film = tmp_path / "f.gif"
    refused(call(replay, trace_file, "--gif", film, "--from", 5, "--to", 4), "--to", "not after")
    refused(call(replay, trace_file, "--gif", film, "--against", trace_file), "--html")


def test_a_bag_that_is_interrupted_leaves_nothing(trace, tmp_path, monkeypatch) -> None:
    pytest.importorskip("rosbags")
    path, short = tmp_path / "bag", replace(trace, duration=0.5)

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(bag, "_messages", interrupted)
        with pytest.raises(KeyboardInterrupt):
            bag.write_bag(short, path)
    assert not names(tmp_path)
    bag.write_bag(short, path)
    assert names(tmp_path) == {"bag"}
    assert names(path) == {"bag.db3", "metadata.yaml"}


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="there is no folder without files to make")
def test_a_bag_that_cannot_be_written_is_an_input_error(trace) -> None:
    pytest.importorskip("rosbags")
    with pytest.raises(InputError, match="cannot be written"):
        bag.write_bag(trace, Path("/proc/bag"))


# -- options and names ---------------------------------------------------------------------------


@pytest.mark.parametrize("option", ["--scene", "--robot", "--sketch"])
@pytest.mark.parametrize(("command", "output"), [(replay, "--html"), (export, "--glb")])
def test_a_trace_takes_no_scene(command, output, option, trace_file, tmp_path) -> None:
    done = call(command, trace_file, output, tmp_path / "x", option, "tiago")
    refused(done, "a trace holds its scene", option)


@pytest.mark.parametrize("option", ["--scene", "--robot", "--sketch"])
def test_a_trace_is_executed_with_its_own_scene(option, trace_file) -> None:
    refused(call(execute, trace_file, option, "tiago"), "a trace holds its scene", option)


@pytest.mark.usefixtures("no_work")
@pytest.mark.parametrize("option", ["--scene", "--sketch"])
def test_a_closed_loop_takes_scene_and_sketch_as_arguments(option) -> None:
    refused(call(execute, *LOOP, option, "x"), "the closed loop takes SKETCH and SCENE")


@pytest.mark.parametrize(
    ("key", "name"), [("scene", "done.toml"), ("robot", "mine.toml"), ("robot", "mine")]
)
def test_what_a_plan_names_and_is_not_here_can_be_given(key, name, plan_data, tmp_path) -> None:
    plan = tmp_path / "plan.json"
    plan_data[key]["name"] = name
    plan.write_text(json.dumps(plan_data), encoding="utf-8")
    done = call(replay, plan, "--html", tmp_path / "x.html")
    refused(done, name, f"give --{key} FILE")
    done = call(replay, plan, "--html", tmp_path / "x.html", f"--{key}", f"other-{name}")
    refused(done, f"other-{name}")
    assert "FILE" not in done.stderr


# -- the window ----------------------------------------------------------------------------------


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere there is always a display")
@pytest.mark.parametrize("display", [{}, {"DISPLAY": ":97"}])
def test_a_window_needs_a_display(display, trace_file) -> None:
    # In a process of its own: PyBullet would end it.
    main = "from sketchlang.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", main, "execute", str(trace_file), "--gui"],
        capture_output=True,
        text=True,
        env={"PATH": "/usr/bin:/bin"} | display,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert "there is no display" in done.stderr
    assert "leave --gui out" in done.stderr


def test_a_window_that_does_not_open_is_an_input_error(monkeypatch) -> None:
    import pybullet
    from pybullet_utils import bullet_client

    def fails(*_: object) -> None:
        raise pybullet.error("Cannot connect to graphics server")

    monkeypatch.setattr(physics, "_display_opens", lambda: True)
    monkeypatch.setattr(bullet_client, "BulletClient", fails)
    with pytest.raises(InputError, match="does not start"):
        physics.connect(True)


# -- what is said and seen -----------------------------------------------------------------------


def test_errors_of_sliding_joints_are_lengths(trace) -> None:
    slides = [trace.robot.joint(name).type == "prismatic" for name in trace.robot.joints]
    assert any(slides)
    tracking = Tracking()
    tracking.add(np.array([0.001, 0.002, 0.003, *np.where(slides, 0.02, 0.004)]))
    report = _report(tracking)
    assert largest_errors(report, trace.robot) == {
        "base_m": 0.002,
        "heading_rad": 0.003,
        "turning_joints_rad": 0.004,
        "sliding_joints_m": 0.02,
    }
    text = "\n".join(summary(_report(tracking), "plan", trace.robot))
    assert "base 2.0 mm 3.0 mrad, joints 4.0 mrad 20.0 mm" in text


def _report(tracking: Tracking) -> Report:
    from runtime.physics.execute import FinalPose

    return Report(1.0, tracking, (), (), (FinalPose("box", 0.0, 0.0, 0.0),), ())


@pytest.mark.parametrize("scene", [None, "words/tamp", "sorting/4t-28"])
def test_the_camera_sees_the_whole_scene(scene, trace) -> None:
    if scene is not None:
        there = find_world(scene)
        # Objects where they start; the robot drives as it did in the other scene.
        spans = [trace.objects[0]] * len(there.movables)
        trace = replace(trace, world=there, objects=tuple(spans))
    studio = Studio(trace, (320, 180))
    studio.close()
    slope = np.tan(np.radians(LENS / 2))
    for _, time in moments(trace):
        for thing in drawn(trace, time):
            corners = thing.vertices @ thing.pose[:3, :3].T + thing.pose[:3, 3] - studio.eye
            depth = slope * (corners @ (studio.target - studio.eye))
            assert (np.abs(corners @ UP) < depth).all()
            assert (np.abs(corners @ RIGHT) < 16 / 9 * depth).all()


def test_the_floor_fills_the_picture(trace) -> None:
    studio = Studio(trace, (320, 180))
    try:
        image = studio.picture(0.0)
    finally:
        studio.close()
    assert not (image == 255).all(axis=2).any()  # the renderer's white is nowhere


def test_the_floor_of_a_wide_scene_is_not_of_a_million_tiles(trace) -> None:
    far = replace(trace, base=replace(trace.base, values=1000 * trace.base.values))
    studio = Studio(far, (160, 90))
    try:
        assert studio.bullet.getNumBodies() < 2500
    finally:
        studio.close()


def test_what_native_code_prints_does_not_come_out_at_the_end() -> None:
    """C buffers standard output where it is no terminal, unless Python is told not to."""
    code = "from runtime.physics.simulation import connect; connect(False).disconnect()"
    buffered = {k: v for k, v in os.environ.items() if k != "PYTHONUNBUFFERED"}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, env=buffered, check=True)
    assert done.stdout == ""
    assert done.stderr == ""
