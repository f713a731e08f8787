"""The commands as scripts use them: exit status, standard output, files."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from benchmarks.families import FAMILIES, weighted_sum
from sketchlang.cli import cli
from tests.analysis.known import PAPER

CHAIN = FAMILIES["chain"](4)
GRAY = FAMILIES["gray"](24)  # some ten seconds
ENDLESS = "sketch e\nfeature n : nat\nrule up { } -> { n++ }\nrule down { n > 0 } -> { n-- }\n"


@pytest.fixture
def sketch(tmp_path: Path) -> Path:
    path = tmp_path / "it.sketch"
    path.write_text(CHAIN)
    return path


def run(*arguments: object) -> Result:
    result = CliRunner().invoke(cli, [str(argument) for argument in arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result


def test_terminate_and_verify(sketch: Path, tmp_path: Path) -> None:
    proof = tmp_path / "proof.json"
    result = run("terminate", sketch, "--certificate", proof)
    assert result.exit_code == 0
    assert "terminates" in result.output
    assert list(tmp_path.iterdir()) == [sketch, proof] or set(tmp_path.iterdir()) == {sketch, proof}
    result = run("verify", proof, sketch)
    assert (result.exit_code, result.output) == (0, f"{proof} is valid: chain terminates.\n")
    result = run("verify", proof, sketch, "--json")
    assert json.loads(result.output) == {"valid": True, "sketch": "chain", "reason": None}


def test_verify_refuses(sketch: Path, tmp_path: Path) -> None:
    proof = tmp_path / "proof.json"
    run("terminate", sketch, "--certificate", proof)
    proof.write_text(proof.read_text().replace('"lowers": "n0"', '"lowers": "n1"'))
    result = run("verify", proof, sketch)
    assert result.exit_code == 1
    assert "altered" in result.output
    for text in ("", "no JSON", "[", "[" * 100_000, "3", "1" * 5000, '{"format": 1}', "\x00"):
        proof.write_text(text)
        result = run("verify", proof, sketch)
        assert result.exit_code == 1
        assert "refused" in result.output
    proof.write_bytes(b"\xff\xfe")
    assert run("verify", proof, sketch).exit_code == 1
    assert run("verify", tmp_path / "missing.json", sketch).exit_code == 2
    assert run("verify", tmp_path, sketch).exit_code == 2


def test_terminate_json(sketch: Path) -> None:
    result = run("terminate", sketch, "--json")
    found = json.loads(result.output)
    assert result.exit_code == 0
    assert (found["verdict"], found["method"]) == ("terminating", "rule-elimination")
    assert (found["features"], found["rules"]) == (4, 4)
    assert found["certificate"]["version"] == 1
    assert found["time_s"] >= 0


def test_terminate_refutes(sketch: Path, tmp_path: Path) -> None:
    sketch.write_text(ENDLESS)
    proof = tmp_path / "proof.json"
    result = run("terminate", sketch, "--certificate", proof)
    assert result.exit_code == 1
    assert "No certificate written" in result.output
    assert f"{sketch}:3:" in result.output
    assert not proof.exists()
    found = json.loads(run("terminate", sketch, "--json").output)
    assert found["verdict"] == "non-terminating"
    assert found["counterexample"]["rules"] == ["up", "down"]
    assert found["endless_rules"] == ["up", "down"]


def test_terminate_undecided(sketch: Path) -> None:
    sketch.write_text(GRAY)
    result = run("terminate", sketch, "--time-limit", "0.2", "--json")
    found = json.loads(result.output)
    assert result.exit_code == 1
    assert (found["verdict"], found["limit"]["kind"]) == ("undecided", "time")
    result = run("terminate", sketch, "--memory-limit", "1")
    assert result.exit_code == 1
    assert "memory limit of 1 MB" in result.output


@pytest.mark.parametrize("command", ["terminate", "coverage", "graph"])
def test_users_mistakes(command: str, tmp_path: Path) -> None:
    assert run(command, tmp_path / "missing.sketch").exit_code == 2
    assert run(command, tmp_path).exit_code == 2
    assert run(command).exit_code == 2
    assert run(command, "pick_and_place", "--no-such-option").exit_code == 2
    broken = tmp_path / "broken.sketch"
    broken.write_text("sketch b\nfeature n : nat\nrule r { n > 0 } -> { m-- }\n")
    result = run(command, broken)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "broken.sketch:3" in result.stderr


def test_files_that_cannot_be_written(sketch: Path, tmp_path: Path) -> None:
    assert run("terminate", sketch, "--certificate", tmp_path / "no" / "proof.json").exit_code == 2
    assert run("terminate", sketch, "--certificate", tmp_path).exit_code == 2
    assert run("graph", sketch, "-o", tmp_path / "no" / "it.svg").exit_code == 2
    assert list(tmp_path.iterdir()) == [sketch]


def test_a_folder_that_is_missing_is_told_before_the_work(tmp_path: Path) -> None:
    path = tmp_path / "gray.sketch"
    path.write_text(GRAY)  # takes far longer than a test
    nowhere = tmp_path / "no" / "proof.json"
    result = run("terminate", path, "--certificate", nowhere)
    assert result.exit_code == 2
    assert "there is no folder" in result.stderr


def test_coverage(sketch: Path) -> None:
    sketch.write_text(PAPER)
    result = run("coverage", sketch)
    assert result.exit_code == 1
    assert "{!H, m > 0, u > 0, v = 0}" in result.output
    assert "clear_way applies, but `v--` cannot happen: `v` is 0 there." in result.output
    found = json.loads(run("coverage", sketch, "--json", "--overlaps").output)
    assert found["gaps"][0]["valuations"] == {"H": False, "m": "> 0", "u": "> 0", "v": "= 0"}
    assert found["overlaps"] == []


def test_the_invariant_that_coverage_proposes_closes_the_gap(tmp_path: Path) -> None:
    path = tmp_path / "it.sketch"
    path.write_text(PAPER)
    proposal = run("coverage", path).output.strip().splitlines()[-1].strip()
    assert proposal == "invariant m > 0 and u > 0 -> v > 0"
    path.write_text(f"{PAPER}\n{proposal}\n")
    result = run("coverage", path)
    assert result.exit_code == 0, result.output


def test_no_invariant_is_proposed_that_makes_rules_useless(tmp_path: Path) -> None:
    path = tmp_path / "it.sketch"
    rules = "goal { n = 0 }\nrule pick { !H, n > 0 } -> { H }\n"
    path.write_text(f"sketch s\nfeature H : bool\nfeature n : nat\n{rules}")
    result = run("coverage", path)
    assert result.exit_code == 1
    assert "{H, n > 0}" in result.output
    assert "invariant" not in result.output


def test_check_warns_of_gaps(tmp_path: Path) -> None:
    path = tmp_path / "it.sketch"
    path.write_text(PAPER)
    result = run("check", path)
    assert result.exit_code == 0
    assert "warning[uncovered]: no rule for {!H, m > 0, u > 0, v = 0}" in result.output
    path.write_text(f"{PAPER}\ninvariant u > 0 -> v > 0\n")
    assert "warning" not in run("check", path).output


@pytest.mark.parametrize(
    ("name", "start"), [("a.svg", "<svg"), ("a.dot", "digraph"), ("a.mmd", "---")]
)
def test_graph_files(name: str, start: str, tmp_path: Path) -> None:
    out = tmp_path / name
    assert run("graph", "pick_and_place", "-o", out).exit_code == 0
    assert out.read_text().startswith(start)


def test_graph_output() -> None:
    assert run("graph", "pick_and_place").output.startswith("digraph")
    assert run("graph", "pick_and_place", "--format", "svg").output.startswith("<svg")
    assert run("graph", "pick_and_place", "-o", "picture.png").exit_code == 2


def test_graph_of_a_large_sketch(sketch: Path) -> None:
    sketch.write_text(FAMILIES["chain"](12))
    result = run("graph", sketch)
    assert result.exit_code == 2
    assert "--view rules" in result.stderr
    assert run("graph", sketch, "--view", "rules").exit_code == 0


def test_the_solver_of_linear_programmes_prints_nothing(tmp_path: Path) -> None:
    path = tmp_path / "sum.sketch"
    path.write_text(weighted_sum(12, 200))
    command = [sys.executable, "-m", "sketchlang", "terminate", str(path), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout)["method"] == "potentials"
    assert not done.stderr


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_ctrl_c_ends_cleanly(tmp_path: Path) -> None:
    path = tmp_path / "long.sketch"
    path.write_text(FAMILIES["dense"](24, 40, 4))  # a proof of some ten seconds
    # Who starts the tests in the background may have told them to ignore the signal.
    heeds = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    code = heeds + "from sketchlang.cli import main; main()"
    command = [sys.executable, "-c", code, "terminate"]
    process = subprocess.Popen(
        [*command, str(path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=Path(__file__).parents[2],
    )
    time.sleep(1.5)
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=20)
    assert process.returncode == 130
    assert (output, errors.strip()) == ("", "interrupted")
