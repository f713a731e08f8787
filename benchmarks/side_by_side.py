"""Termination proofs beside those of pyrunir, which lives in an environment of its own.

    python -m venv .pyrunir && .pyrunir/bin/python -m pip install pyrunir==0.7.0
    python -m benchmarks.side_by_side --python .pyrunir/bin/python

Each line is a sketch of `benchmarks/families.py`: the verdict and the processor time of the proof
alone, of this project and of pyrunir's complete procedure, one after the other in processes of
their own, and the ratio. Libraries are loaded before the clock starts, theirs as ours: the first
proof of a process that lists valuations takes some 0.3 s more. A proof that takes longer than
`--time-limit` is given up. pyrunir knows no `?`: what a rule may change is what it does not name.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks.families import FAMILIES
from sketchlang.loader import load_text
from sketchlang.model import Effect, Kind, SketchModel
from sketchlang.source import Source

SKETCHES = (
    "chain:12,relay:12,copies:10,gray:16,gray:18,gray:20,closed:16,weighted_sum:16:400,"
    "weighted_sum:20:200,weighted_sum:20:600,weighted_sum:60:2000,ring:12,ring:32,"
    "token:12,token:16,token:40,dense:12:100,dense:24:200,dense:30:200"
)
OURS = """
import json, sys, time
import highspy, numpy, scipy.sparse.csgraph
from sketchlang.analysis import balance, listed_piece, listing, numbers, potential, short_cycles
from sketchlang.analysis import sieve, weights
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.termination import decide_termination
from sketchlang.loader import load_text
from sketchlang.source import Source
text = open(sys.argv[1]).read()
model = load_text(Source("s", text), {}).checked.model
cpu = time.process_time()
verdict = decide_termination(model, Budget(float(sys.argv[2])))
cpu = max(1e-4, time.process_time() - cpu)
print(json.dumps([type(verdict).__name__, cpu]))
"""
THEIRS = """
import json, sys, time
from pathlib import Path
from pypddl.formalism import ParserOptions
from pyrunir.kr import DomainContext
from pyrunir.kr.ps.base.dl import parse_sketch, structural_termination
from pytyr.formalism.planning import Parser
parser = Parser(Path(sys.argv[1]), ParserOptions())
domain = parser.get_domain()
context = DomainContext(domain)
sketch = parse_sketch(open(sys.argv[2]).read(), domain, context.base_repository)
cpu = time.process_time()
result = structural_termination(sketch, max_features=64)
cpu = max(1e-4, time.process_time() - cpu)
name = "Terminating" if result.is_terminating() else "NonTerminating"
print(json.dumps([name, cpu]), flush=True)
import os
os._exit(0)
"""


WORDS = {
    Effect.SET: "positive",
    Effect.CLEAR: "negative",
    Effect.DEC: "decreases",
    Effect.INC: "increases",
    Effect.ANY: "",
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--python", required=True, help="an interpreter with pyrunir")
    parser.add_argument("--sketches", default=SKETCHES, help="family:features[:rules[:seed]],...")
    parser.add_argument("--time-limit", type=float, default=60.0, help="seconds a proof")
    arguments = parser.parse_args()
    print(f"{'sketch':<22}{'verdict':>16}{'CPU s':>8}{'pyrunir':>18}{'CPU s':>8}{'ratio':>8}")
    for name in arguments.sketches.split(","):
        family, *numbers = name.split(":")
        text = FAMILIES[family](*map(int, numbers))
        with tempfile.TemporaryDirectory() as folder:
            ours = _ours(Path(folder), text, arguments.time_limit)
            theirs = _theirs(Path(folder), text, arguments.python, arguments.time_limit)
        ratio = "-" if ours[1] is None or theirs[1] is None else f"{ours[1] / theirs[1]:.2f}"
        cells = ["-" if s is None else f"{s:.3f}" for s in (ours[1], theirs[1])]
        print(
            f"{name:<22}{ours[0]:>16}{cells[0]:>8}{theirs[0]:>18}{cells[1]:>8}{ratio:>8}",
            flush=True,
        )


Answer = tuple[str, float | None]


def _ours(folder: Path, text: str, limit: float) -> Answer:
    path = folder / "ours.sketch"
    path.write_text(text)
    return _asked([sys.executable, "-c", OURS, str(path), str(limit)], limit + 20)


def _theirs(folder: Path, text: str, python: str, limit: float) -> Answer:
    model = load_text(Source("sketch", text), {}).checked.model
    if any(effect not in WORDS for rule in model.rules for effect in rule.effects.values()):
        return "has no such sign", None
    (folder / "domain.pddl").write_text(_domain(model))
    (folder / "theirs.sketch").write_text(_translated(model))
    files = [str(folder / "domain.pddl"), str(folder / "theirs.sketch")]
    return _asked([python, "-c", THEIRS, *files], limit)


def _asked(command: list[str], limit: float) -> Answer:
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit, check=False)
    except subprocess.TimeoutExpired:
        return "time", None
    lines = done.stdout.strip().splitlines()
    if not lines or not lines[-1].startswith("["):
        said = (done.stderr.strip().splitlines() or [f"status {done.returncode}"])[-1]
        print(f"  {said[:90]}", file=sys.stderr)
        return "refused", None
    verdict, cpu = json.loads(lines[-1])
    return verdict, cpu


def _domain(model: SketchModel) -> str:
    predicates = " ".join(f"(p{number} ?x)" for number in range(len(model.features)))
    return (
        f"(define (domain d) (:requirements :strips) (:predicates {predicates})"
        " (:action a :parameters (?x) :precondition (p0 ?x) :effect (not (p0 ?x))))"
    )


def _translated(model: SketchModel) -> str:
    """The sketch as pyrunir reads it."""
    features, rules = [], []
    for number, feature in enumerate(model.features):
        kind, value = (
            ("boolean", "b_nonempty") if feature.kind is Kind.BOOL else ("numerical", "n_count")
        )
        concept = f'(c_atomic_state "p{number}")'
        features.append(f"(:{kind} (:symbol f{number}) (:expression ({value} {concept})))")
    for number, rule in enumerate(model.rules):
        conditions = [
            f"({_test(model, f, truth)} f{f})" for f, truth in sorted(rule.conditions.items())
        ]
        effects = []
        for f in range(len(model.features)):
            effect = rule.effects.get(f)
            if effect is None:
                effects.append(f"(unchanged f{f})")
            elif WORDS[effect]:
                effects.append(f"({WORDS[effect]} f{f})")
        rules.append(
            f"(:rule (:symbol r{number}) (:expression (:conditions {' '.join(conditions)})"
            f" (:effects {' '.join(effects)})))"
        )
    return f"(:sketch (:features {' '.join(features)}) (:rules {' '.join(rules)}))"


def _test(model: SketchModel, feature: int, truth: bool) -> str:
    if model.features[feature].kind is Kind.BOOL:
        return "positive" if truth else "negative"
    return "greater_zero" if truth else "equal_zero"


if __name__ == "__main__":
    main()
