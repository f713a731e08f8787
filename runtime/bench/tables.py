"""The tables of benchmark results."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from runtime.bench.job import Result
from runtime.bench.paper import PUBLISHED, SYSTEMS
from runtime.bench.statistics import quantile
from runtime.bench.summary import Case, Summary, grouped, seconds_of, summarise
from runtime.bench.table import Table, count, percent, seconds, span, varying

LABELS = ("sketch", "scene", "robot", "planner", "timeout")


def solved_table(summaries: Sequence[Summary]) -> Table:
    """Who solves what, and how many of the plans are certified."""
    return _table(
        "Solved",
        summaries,
        ("solved", "95 %", "certified"),
        lambda s: (f"{s.solved}/{s.runs}", percent(s.share), f"{s.certified}/{s.solved}"),
        "95 %: exact binomial interval of the share solved (Clopper-Pearson).",
    )


def time_table(summaries: Sequence[Summary]) -> Table:
    """How fast."""
    return _table(
        "Planning, seconds",
        summaries,
        ("median", "quartiles", "95 %", "worst"),
        _times,
        "Over all runs; one that is not solved counts as longer than its limit. 95 %: exact "
        "interval of the median by order statistics, from six runs on.",
    )


def _times(s: Summary) -> tuple[str, ...]:
    limit = s.case.timeout
    return (
        seconds(s.median, limit),
        span(s.quartiles, limit),
        span(s.interval, limit),
        seconds(s.worst, limit),
    )


def effort_table(summaries: Sequence[Summary]) -> Table:
    """What it took, and what came of it."""
    return _table(
        "Effort and plans",
        summaries,
        ("nodes", "subplans", "CPU s", "exec s"),
        _effort,
        "Medians over the solved runs: nodes expanded, processor time of planning, seconds that "
        "it takes to carry out the plan.",
    )


def _effort(s: Summary) -> tuple[str, ...]:
    processor = s.measured.get("cpu_time_s")
    return (
        count(s.measured.get("expanded")),
        count(s.measured.get("subplans")),
        "" if processor is None else seconds(processor),
        count(s.measured.get("execution_time_s")),
    )


def _table(
    title: str,
    summaries: Sequence[Summary],
    columns: tuple[str, ...],
    cells: Callable[[Summary], tuple[str, ...]],
    note: str,
) -> Table:
    labels, told = varying(LABELS, [_labels(s.case) for s in summaries])
    rows = tuple((*label, *cells(s)) for label, s in zip(told, summaries, strict=True))
    return Table(title, (*labels, *columns), rows, len(labels), (note,))


def _labels(case: Case) -> tuple[str, ...]:
    return case.sketch, case.scene, case.robot, case.planner, f"{case.timeout:g} s"


def beside_paper(summaries: Sequence[Summary]) -> Table:
    """Every system of the paper's table, and what ran here."""
    scenes = list(dict.fromkeys(s.case.scene for s in summaries))
    names = {planner: system for system, planner in SYSTEMS.items()}
    rows = []
    for scene in scenes:
        for s in (s for s in summaries if s.case.scene == scene):
            planned = s.median if s.solved else None
            execution = s.measured.get("execution_time_s")
            rows.append(
                (
                    scene,
                    names.get(s.case.planner, s.case.planner),
                    "here",
                    f"{100 * s.solved / s.runs:.0f} %",
                    _minutes(None if planned is None or planned > s.case.timeout else planned / 60),
                    _minutes(None if execution is None else execution / 60),
                    count(s.measured.get("expanded")),
                    count(s.measured.get("subplans")),
                )
            )
        rows += [
            (
                scene,
                p.system,
                "paper",
                f"{p.solved} %",
                _minutes(p.planning_min),
                _minutes(p.execution_min),
                count(p.expanded),
                count(p.subplans),
            )
            for p in PUBLISHED
            if p.scene == scene
        ]
    columns = ("scene", "system", "from", "solved", "plan", "exec", "nodes", "subplans")
    note = (
        "Minutes to plan and to carry out. here: medians, on this machine. paper: its averages "
        "over ten runs of at most 30 minutes, on an Intel i7-10610U; BFWS, Planet and PDDLStream "
        "are not run here but where their planner says `here`."
    )
    return Table("Beside the systems of the paper", columns, tuple(rows), 3, (note,))


def _minutes(value: float | None) -> str:
    if value is None:
        return ""
    return f"{value:.2f}" if value >= 0.095 else f"{value:.1g}"


def profile_table(results: Iterable[Result]) -> Table:
    """The paper's second table: what each step of X costs and lets through."""
    totals: dict[tuple[str, str], list[float]] = {}
    for result in results:
        for step, numbers in result["profile"].items():
            row = totals.setdefault((result["planner"], step), [0.0, 0.0, 0.0])
            row[0] += numbers["calls"]
            row[1] += numbers["successes"]
            row[2] += numbers["time_s"]
    rows = tuple(
        (
            planner,
            step,
            f"{calls:.0f}",
            f"{100 * successes / calls:.0f} %",
            _duration(1e6 * spent / calls),
        )
        for (planner, step), (calls, successes, spent) in totals.items()
        if calls
    )
    return Table("Steps of X", ("planner", "step", "calls", "success", "time a call"), rows)


def share_table(results: Sequence[Result]) -> Table:
    """Where the planning time goes: the steps of X, and the rest (features, samples, search)."""
    rows = []
    for case, group in grouped(results).items():
        total = sum(result["planning_time_s"] for result in group)
        if not total:
            continue
        shares = [
            sum(result["profile"].get(step, {}).get("time_s", 0.0) for result in group) / total
            for step in ("motion_plan", "inverse_kinematics")
        ]
        cells = (f"{100 * share:.0f} %" for share in [*shares, 1 - sum(shares)])
        rows.append((case.scene, case.planner, *cells))
    columns = ("scene", "planner", "MotionPlan", "InverseKinematics", "rest")
    return Table("Where the planning time goes", columns, tuple(rows))


def ratio_table(results: Sequence[Result]) -> Table:
    """How much longer every planner takes than Lazy-SIIW_R, scene by scene."""
    medians = {
        case: quantile([seconds_of(result) for result in group if result["solved"]], 0.5)
        for case, group in grouped(results).items()
        if any(result["solved"] for result in group)
    }
    lazy = {case.scene: value for case, value in medians.items() if case.planner == "lazy-siiw-r"}
    rows = tuple(
        (case.scene, case.planner, f"{value / lazy[case.scene]:.1f}")
        for case, value in medians.items()
        if case.planner != "lazy-siiw-r" and lazy.get(case.scene)
    )
    title = "Planning time, in that of Lazy-SIIW_R"
    return Table(title, ("scene", "planner", "times"), rows, 2, ("Medians over the solved runs.",))


def scaling_table(results: Sequence[Result]) -> Table:
    """Time, nodes and memory against the number of objects."""
    summaries = summarise(results)
    several = len({s.case.planner for s in summaries}) > 1
    rows = []
    for s in summaries:
        label = (str(size_of(s.case.scene)), *([s.case.planner] if several else []))
        group = [r for r in grouped(results)[s.case] if r["solved"]]
        cells = ("", "", "", "", "", "")
        if group:
            moved = max(1.0, s.measured["objects_moved"])
            processor = s.measured.get("cpu_time_s", 0.0)
            cells = (
                f"{moved:.0f}",
                seconds(quantile([r["planning_time_s"] for r in group], 0.5)),
                seconds(processor),
                f"{1000 * processor / moved:.0f}",
                f"{s.measured['expanded'] / moved:.1f}",
                count(max(r["peak_mb"] for r in group)),
            )
        rows.append((*label, f"{s.solved}/{s.runs}", *cells))
    labels = ("objects", *(["planner"] if several else []))
    columns = (*labels, "solved", "moved", "s", "CPU s", "CPU ms each", "nodes each", "MB")
    note = "Medians over the solved runs; each: for an object moved."
    return Table("Growing scenes", columns, tuple(rows), len(labels), (note,))


def size_of(scene: str) -> int:
    """The number of objects of a generated scene, from its name."""
    return int(scene.rsplit("/", 1)[-1].removesuffix(".toml").split("-")[1])


def tables_of(kind: str, results: Sequence[Result]) -> list[Table]:
    """The tables of a suite of a kind, those without rows left out."""
    summaries = summarise(results)
    found = [solved_table(summaries), time_table(summaries), effort_table(summaries)]
    if kind == "scaling":
        found = [scaling_table(results), profile_table(results), share_table(results)]
    if kind == "paper":
        found += [beside_paper(summaries), profile_table(results), share_table(results)]
        found.append(ratio_table(results))
    return [table for table in found if table.rows]


def _duration(microseconds: float) -> str:
    if microseconds < 1000:
        return f"{microseconds:.0f} us"
    return f"{microseconds / 1000:.1f} ms"
