"""Records that are kept: what a file has is not played again, and what is no record is said."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from domains.tabletop.kinder import run
from domains.tabletop.kinder.kept import records_in, write_records
from domains.tabletop.kinder.run import Record
from sketchlang.cli import cli


def record(env: str = "Table3D-o1", seed: int = 0, success: bool = True) -> Record:
    reason = None if success else "no plan: \u03b1"
    return Record(env, seed, success, True, 0.25, 1.0, 12, 1, 3, 0.0, reason)


def call(path: Path, seeds: str, python: str = "nowhere/python") -> Result:
    chosen = ["--envs", "Table3D-o1,Table3D-o2", "--seeds", seeds]
    return CliRunner().invoke(
        cli, ["bench", "kinder", *chosen, "--keep", str(path), "--python", python]
    )


def test_records_come_back(tmp_path) -> None:
    path = tmp_path / "kinder.jsonl"
    assert records_in(path) == []
    kept = [record(), record(seed=1, success=False)]
    write_records(path, kept)
    assert records_in(path) == kept


def test_a_file_with_all_of_them_is_a_table_without_kinder(tmp_path) -> None:
    path = tmp_path / "kinder.jsonl"
    kept = [record(f"Table3D-o{o}", seed, seed != 1) for seed in range(3) for o in (1, 2)]
    write_records(path, kept)
    done = call(path, "0-1")
    assert done.exit_code == 1
    lines = [line.split() for line in done.stdout.splitlines()]
    assert [line[:2] for line in lines[1:]] == [
        ["Table3D-o1", "1/2"],
        ["Table3D-o2", "1/2"],
        ["all", "2/4"],
    ]
    assert call(path, "2").exit_code == 0
    assert call(path, "3").exit_code == 2  # KinDER would be needed
    assert records_in(path) == kept


def test_what_is_missing_is_played_and_kept_as_it_ends(tmp_path, monkeypatch) -> None:
    """Two runs that are killed at their second problem, and one that is not."""
    path, played = tmp_path / "kinder.jsonl", []

    class Process:
        def __init__(self, python: Path) -> None: ...
        def __enter__(self) -> Process:
            return self

        def __exit__(self, *_: object) -> None: ...
        def assets(self) -> Path:
            return tmp_path

    def play(kinder, robot, env: str, seed: int, timeout: float) -> Record:
        if len(played) in (1, 3) and dying.pop():
            raise KeyboardInterrupt
        played.append((env, seed))
        return record(env, seed)

    monkeypatch.setattr(run, "KinderProcess", Process)
    monkeypatch.setattr(run, "make_robot", lambda *_: None)
    monkeypatch.setattr(run, "run_problem", play)
    dying = [False, True, False, True]
    codes = [call(path, "0-2", str(tmp_path / "bin" / "python")).exit_code for _ in range(3)]
    assert codes[-1] == 0
    assert 0 not in codes[:2]
    wanted = [(f"Table3D-o{o}", seed) for o in (1, 2) for seed in range(3)]
    assert played == wanted
    assert [(kept.env, kept.seed) for kept in records_in(path)] == wanted


@pytest.mark.parametrize(
    "change",
    [
        {"seed": 1.5},
        {"seed": True},
        {"success": 1},
        {"planning_s": float("nan")},
        {"reason": 3},
        {"more": 1},
    ],
)
def test_what_is_no_record_is_said_and_left_alone(tmp_path, change) -> None:
    path = tmp_path / "kinder.jsonl"
    text = json.dumps(record().as_json()) + "\n" + json.dumps(record(seed=1).as_json() | change)
    path.write_text(text)
    done = call(path, "0")
    assert done.exit_code == 2
    assert "line 2" in done.output
    assert path.read_text() == text


def test_a_second_record_of_a_problem_is_said(tmp_path) -> None:
    path = tmp_path / "kinder.jsonl"
    path.write_text(2 * (json.dumps(record().as_json()) + "\n"))
    done = call(path, "0")
    assert done.exit_code == 2
    assert "second one" in done.output
