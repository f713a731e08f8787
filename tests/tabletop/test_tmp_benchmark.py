"""Problems in the format of the public benchmark for task and motion planning, as scenes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from click.testing import CliRunner

from domains.tabletop.scene.load import load_scene
from domains.tabletop.tmp_benchmark.allowed import allowed
from domains.tabletop.tmp_benchmark.names import candidates
from sketchlang.cli.import_ import command
from sketchlang.cli.run import command as run_command
from sketchlang.cli.validate import command as validate_command
from sketchlang.source import Source

POSE = "{c} {s_} 0 {x} {s} {c} 0 {y} 0 0 1 {z}"
REGION = (
    "<sssp><xmin>{x0}</xmin><xmax>{x1}</xmax><ymin>{y0}</ymin><ymax>{y1}</ymax>"
    "<zmin>{z}</zmin><zmax>{z}</zmax></sssp>"
)
GRASP = '<grasps><gc type="side"><axis>0 0 1</axis></gc></grasps>'
STICK = (0.04, 0.04, 0.2)


def pose(x: float, y: float, z: float, turn: float = 0.0) -> str:
    c, s = np.cos(turn), np.sin(turn)
    return POSE.format(c=c, s=s, s_=-s, x=x, y=y, z=z)


class Files:
    """A problem that grows, and its folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.things: list[str] = []
        (folder / "meshes").mkdir()
        self.facts = "(on-surface rs1 table1)"
        table = trimesh.creation.box((0.8, 1.2, 0.75))
        table.apply_translation((0.0, 0.1, 0.375))
        self.mesh("table", table)
        self.add("table1", "table", pose(1.1, -0.1, 0.0), region=(-0.3, 0.3, -0.4, 0.6, 0.75))
        self.box("stick", STICK)
        self.add("stick_red1", "stick", pose(0.95, 0.1, 0.752), movable=True)

    def mesh(self, name: str, mesh: trimesh.Trimesh) -> None:
        mesh.export(self.folder / "meshes" / f"{name}.obj")

    def box(self, name: str, size: tuple[float, float, float]) -> None:
        box = trimesh.creation.box(size)
        box.apply_translation((0.0, 0.0, size[2] / 2))
        self.mesh(name, box)

    def add(self, name, mesh, at, movable=False, region=None) -> None:
        area = ""
        if region is not None:
            x0, x1, y0, y1, z = region
            area = REGION.format(x0=x0, x1=x1, y0=y0, y1=y1, z=z)
        self.things.append(
            f"<obj><name>{name}</name><geom>{mesh}.obj</geom><pose>{at}</pose>"
            f"<moveable>{str(movable).lower()}</moveable>{GRASP if movable else ''}{area}</obj>"
        )

    def write(self, goal: str, start: str = pose(0.0, 0.0, -0.67)) -> tuple[Path, Path]:
        xml, pddl = self.folder / "p.xml", self.folder / "p.pddl"
        xml.write_text(
            f"<problem><objects>{''.join(self.things)}</objects><robots><robot>"
            f"<basepose>{start}</basepose><movebase>false</movebase></robot></robots></problem>"
        )
        # The benchmark's own files lack their last parenthesis, too.
        pddl.write_text(f"(define (problem p) (:domain d) (:init {self.facts}) (:goal {goal})\n")
        return xml, pddl

    def bring_in(self, goal: str, *options: str, start: str = pose(0.0, 0.0, -0.67)):
        out = self.folder / "scene.toml"
        files = [str(path) for path in self.write(goal, start)]
        return CliRunner().invoke(command, ["tmp", *files, *options, "--out", str(out)]), out


@pytest.fixture
def files(tmp_path) -> Files:
    return Files(tmp_path)


def test_things_are_where_the_problem_has_them(files: Files) -> None:
    turn = np.pi / 6
    files.add("stick_red2", "stick", pose(1.2, 0.3, 0.752, turn), movable=True)
    done, out = files.bring_in("(and (on-surface rs2 table1) (on-surface rs1 table1))")
    assert done.exit_code == 0, done.output
    scene = load_scene(out)
    (table,) = scene.world.fixed
    low, high = (end + table.pose[:, 3] for end in table.body.bounds)
    assert low == pytest.approx([0.7, -0.6, 0.0], abs=1e-6)
    assert high == pytest.approx([1.5, 0.6, 0.75], abs=1e-6)
    second = scene.world.movables[1]
    assert second.pose[:2, 3] == pytest.approx([1.2, 0.3], abs=1e-6)
    assert np.ptp(second.body.bounds, axis=0) == pytest.approx(STICK)
    assert second.pose[1, 0] == pytest.approx(np.sin(turn), abs=1e-6)


def test_an_imported_problem_is_solved_at_its_mark(files: Files) -> None:
    files.box("mark", (0.06, 0.06, 0.001))
    files.add("target_red1", "mark", pose(1.0, -0.3, 0.751), region=(0, 0, 0, 0, 0.001))
    done, out = files.bring_in("(and (on-surface rs1 rt1))")
    assert done.exit_code == 0, done.output
    ran = CliRunner().invoke(run_command, ["pick_and_place", str(out), "--json"])
    assert ran.exit_code == 0, ran.output
    goal = load_scene(out).goals[0]
    assert (goal.x, goal.y) == pytest.approx((1.0, -0.3))


def test_objects_in_one_another_are_refused_or_moved_apart(files: Files) -> None:
    files.add("stick_red2", "stick", pose(0.95, 0.1, 0.752), movable=True)
    done, out = files.bring_in("(on-surface rs1 table1)")
    assert done.exit_code == 2
    assert "start in one another" in done.output
    assert "--separate-overlaps" in done.output
    assert not out.exists()
    done, out = files.bring_in("(on-surface rs1 table1)", "--separate-overlaps")
    assert done.exit_code == 0, done.output
    assert "stick_red2 starts in stick_red1: moved by" in done.output
    one, two = (thing.pose[:2, 3] for thing in load_scene(out).world.movables)
    assert 0.04 < np.linalg.norm(one - two) < 0.2


@pytest.mark.parametrize("ending", ["xml", "pddl"])
def test_what_is_read_is_not_written_over(files: Files, ending: str) -> None:
    read = files.write("(on-surface rs1 table1)")
    before = [path.read_bytes() for path in read]
    link = files.folder / "link.toml"
    link.symlink_to(files.folder / f"p.{ending}")
    for out in (files.folder / f"p.{ending}", link):
        done = CliRunner().invoke(command, ["tmp", *map(str, read), "--out", str(out)])
        assert done.exit_code == 2
        assert "would overwrite what is read" in done.output
    assert [path.read_bytes() for path in read] == before


def test_a_robot_that_has_no_room_starts_near_by(files: Files) -> None:
    done, out = files.bring_in("(on-surface rs1 table1)", start=pose(0.6, 0.0, -0.67))
    assert done.exit_code == 0, done.output
    assert "no room where the PR2 starts" in done.output
    x, y, _ = load_scene(out).world.robot_start
    assert 0.0 < x < 0.6
    assert y == pytest.approx(0.0, abs=1e-6)


def test_a_choice_for_one_object(files: Files) -> None:
    files.box("tray", (0.3, 0.3, 0.01))
    files.add("blue_tray", "tray", pose(1.2, -0.9, 0.6), region=(-0.15, 0.15, -0.15, 0.15, 0.01))
    goal = "(or (and (on-surface rs1 table1)) (and (on-surface rs1 blue-tray)))"
    done, out = files.bring_in(goal)
    assert done.exit_code == 0, done.output
    assert "any = [" in out.read_text()
    load_scene(out)


@pytest.mark.parametrize(
    ("goal", "said"),
    [
        ("(on-surface rs9 table1)", "nothing in the XML file is called like `rs9`"),
        ("(clear rs1)", "`clear` is not supported in a goal"),
        ("(and (on-surface rs1 table1) (on rs1 rs2))", "on two things at once"),
        (
            "(or (and (on-surface rs1 table1) (on rs2 rs1)) (and (on-surface rs2 table1)))",
            "hang together",
        ),
        ("(on-surface rs1 post)", "it is no peg, and has no place for things"),
        ("(on-surface rs table1)", "nothing in the XML file is called like"),
    ],
)
def test_what_a_scene_cannot_say_is_named(files: Files, goal: str, said: str) -> None:
    files.add("stick_red2", "stick", pose(1.2, 0.3, 0.752), movable=True)
    files.box("rod", (0.02, 0.02, 0.1))
    files.add("post", "rod", pose(1.3, -0.3, 0.75))
    done, out = files.bring_in(goal)
    assert done.exit_code == 2
    assert said in done.output
    assert not out.exists()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("<pose>1.0 -0.0 0", "<pose>0 0 1"), "leans"),
        (("stick.obj", "other.obj"), "a mesh that is not there"),
        (('type="side"', 'type="sida"'), "Did you mean `side`?"),
        (("<basepose>", "<base>"), "not well-formed"),
        (("<obj>", "<thing>"), "not well-formed"),
        (("<pose>1.0", "<pose>one"), "not 12 numbers"),
    ],
)
def test_a_damaged_problem_is_refused_with_what_is_wrong(files: Files, change, said) -> None:
    xml, pddl = files.write("(on-surface rs1 table1)")
    assert change[0] in xml.read_text()
    xml.write_text(xml.read_text().replace(*change))
    arguments = ["tmp", str(xml), str(pddl), "--out", str(files.folder / "scene.toml")]
    done = CliRunner().invoke(command, arguments)
    assert done.exit_code == 2
    assert said in done.output


def test_what_the_two_files_do_not_agree_about_is_said(files: Files) -> None:
    files.box("tray", (0.3, 0.3, 0.01))
    files.add("blue_tray", "tray", pose(1.2, -0.9, 0.6), region=(-0.15, 0.15, -0.15, 0.15, 0.01))
    files.facts = "(on-surface rs1 blue-tray)"
    done, _ = files.bring_in("(on-surface rs1 table1)")
    assert "stick_red1 starts on table1, as the XML has it; the PDDL says blue_tray" in done.output


def test_names_are_matched_from_the_surest_way_on() -> None:
    things = ["stick_red1", "target_red1", "stick_red11", "block_a", "red_tray", "table", "table2"]
    assert candidates("rs1", things) == ["stick_red1"]
    assert candidates("rt1", things) == ["target_red1"]
    assert candidates("a", things) == ["block_a"]
    assert candidates("red-tray", things) == ["red_tray"]
    assert candidates("table", things) == ["table"]
    assert candidates("x1", things) == []
    assert candidates("d1", ["disc1", "disc2", "drum1"]) == ["disc1", "drum1"]


MOVES = """(define (domain d) (:predicates (clear ?x) (on ?x ?y) (smaller ?x ?y))
  (:action move :parameters (?disc ?from ?to)
    :precondition (and (smaller ?to ?disc) (on ?disc ?from) (clear ?disc) (clear ?to))
    :effect (and (clear ?from) (on ?disc ?to) (not (on ?disc ?from)) (not (clear ?to)))))
"""


def lid(radius: float) -> trimesh.Trimesh:
    """A cap with a cavity below and a knob of the same width as the rod on it."""
    turns = np.arange(24) * 2 * np.pi / 24
    rings = [(0.02, 0.0), (radius, 0.0), (radius, 0.065), (0.012, 0.065), (0.012, 0.12)]
    rows = [
        np.column_stack([r * np.cos(turns), r * np.sin(turns), 0 * turns + z]) for r, z in rings
    ]
    rows = [rows[0] + [0, 0, 0.06], *rows]  # up the inner side, out, up, in, and up the knob
    n, faces = 24, []
    for i in range(len(rows) - 1):
        for k in range(n):
            a, b = i * n + k, i * n + (k + 1) % n
            faces += [(a, b, b + n), (a, b + n, a + n)]
    faces += [(0, k + 1, k) for k in range(1, n - 1)]
    faces += [
        (n * (len(rows) - 1), n * (len(rows) - 1) + k, n * (len(rows) - 1) + k + 1)
        for k in range(1, n - 1)
    ]
    return trimesh.Trimesh(np.vstack(rows), np.array(faces), process=False)


def hanoi(files: Files) -> tuple:
    rod = trimesh.creation.cylinder(0.012, 0.055, sections=24)
    rod.apply_translation((0, 0, 0.0275))
    files.mesh("rod", rod)
    for k, y in enumerate((0.2, 0.05, -0.1), 1):
        files.add(f"peg{k}", "rod", pose(1.0, y, 0.752), region=(0, 0, 0, 0, 0.0))
    for k, (radius, z) in enumerate(((0.03, 0.818), (0.038, 0.752)), 1):
        files.mesh(f"lid{k}", lid(radius))
        files.add(
            f"disc{k}", f"lid{k}", pose(1.0, 0.2, z), movable=True, region=(0, 0, 0, 0, 0.065)
        )
    sizes = [
        f"(smaller {big} {small})"
        for small, big in (
            *((f"d{d}", f"peg{k}") for d in (1, 2) for k in (1, 2, 3)),
            ("d1", "d2"),
        )
    ]
    files.facts = f"(on d2 peg1) (on d1 d2) {' '.join(sizes)}"
    return files.bring_in("(and (on d2 peg3) (on d1 d2))", "--any-grasp")


def test_discs_over_pegs_are_solved_and_certified(files: Files) -> None:
    (files.folder / "domain.pddl").write_text(MOVES)
    done, out = hanoi(files)
    assert done.exit_code == 0, done.output
    assert "sketchlang run towers" in done.output
    scene = load_scene(out)
    discs = {thing.name: thing for thing in scene.world.movables}
    pegs = {"peg1", "peg2", "peg3"}
    assert discs["disc1"].only_on == {*pegs, "disc2/ring"}
    assert discs["disc2"].only_on == pegs
    assert discs["stick_red1"].only_on is None
    plan = str(files.folder / "plan.json")
    ran = CliRunner().invoke(run_command, ["towers", str(out), "--out", plan])
    assert ran.exit_code == 0, ran.output
    valid = CliRunner().invoke(validate_command, [plan])
    assert valid.exit_code == 0, valid.output


def test_without_their_domain_discs_may_go_anywhere(files: Files) -> None:
    done, out = hanoi(files)
    assert done.exit_code == 0, done.output
    assert "sketchlang run pick_and_place" in done.output
    assert all(thing.only_on is None for thing in load_scene(out).world.movables)


@pytest.mark.parametrize(
    ("change", "pairs"),
    [
        (("(smaller ?to ?disc) ", ""), None),  # nothing is asked for
        (("(not (clear ?to))", "(not (clear ?to)) (not (smaller ?to ?disc))"), None),  # it changes
        (("(smaller ?to ?disc)", "(smaller ?to ?disc) (ok ?to)"), {("d1", "d2")}),
        ((":effect (and", ":effect (and (on ?disc ?from)"), None),  # another way to put it
    ],
)
def test_what_actions_allow_is_what_no_action_changes(change, pairs) -> None:
    source = Source("d.pddl", MOVES.replace(*change))
    facts = {("smaller", "d2", "d1"), ("smaller", "peg1", "d1"), ("ok", "d2")}
    assert allowed(source, facts, "on") == pairs
