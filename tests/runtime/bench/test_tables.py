"""Tables: what they say, in columns that fit, escaped for Markdown and LaTeX."""

from __future__ import annotations

import csv
import json
import re
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.bench.paper import PUBLISHED
from runtime.bench.summary import summarise
from runtime.bench.survival import survival_plot
from runtime.bench.table import Table
from runtime.bench.tables import (
    beside_paper,
    ratio_table,
    scaling_table,
    solved_table,
    tables_of,
    time_table,
)
from runtime.bench.write.data import as_csv, as_json
from runtime.bench.write.latex import escaped, latex
from runtime.bench.write.markdown import WIDTH, markdown
from tests.runtime.bench.runs import job, result

SCENES = tuple(dict.fromkeys(p.scene for p in PUBLISHED))
PLANNERS = ("lazy-siiw-r", "siw-r", "bfws", "iw", "brfs")


def results(scenes=SCENES[:2], planners=PLANNERS[:2], seeds: int = 4):
    return [
        result(job(seed, planner, scene), 0.5 + 0.37 * seed if planner != "iw" else None)
        for scene in scenes
        for planner in planners
        for seed in range(seeds)
    ]


def row(table: Table, *labels: str) -> dict[str, str]:
    """The cells of the row with these labels, by column."""
    (found,) = [row for row in table.rows if set(labels) <= set(row[: table.labels])]
    return dict(zip(table.columns, found, strict=True))


def test_tables_count_what_was_solved_and_certified() -> None:
    found = [result(job(0), 1.0), result(job(1), 3.0, valid=False), result(job(2), None)]
    cells = row(solved_table(summarise(found)), "sorting/3t-02")
    assert cells["solved"] == "2/3"
    assert cells["certified"] == "1/2"
    assert cells["95 %"] == "9-99 %"


def test_runs_that_are_not_solved_count_as_longer_than_their_limit() -> None:
    found = [result(job(0), 1.0), result(job(1), 2.0), result(job(2), None)]
    cells = row(time_table(summarise(found)), "siw-r")
    assert cells["median"] == "2.00"
    assert cells["worst"] == "> 60"
    worse = row(time_table(summarise([*found, result(job(3), None)])), "siw-r")
    assert worse["median"] == "> 60"
    assert worse["quartiles"] == "1.75-"
    assert worse["95 %"] == "-"


def test_tables_of_the_scenes_of_the_paper_are_whole() -> None:
    """Nothing has to be made a heading so that they fit."""
    for table in tables_of("plain", results(SCENES, PLANNERS)):
        assert not any(line.startswith("scene:") for line in markdown(table)), table.title


def test_growing_scenes_are_told_for_each_object_moved() -> None:
    runs = [result(job(n, scene="x/sorting-28.toml"), 2.0, objects_moved=14) for n in range(3)]
    table = scaling_table([*runs, result(job(0, scene="sorting-56.toml"), None)])
    assert row(table, "28")["CPU ms each"] == f"{1000 * 0.5 / 14:.0f}"
    assert row(table, "28")["nodes each"] == f"{10 / 14:.1f}"
    assert row(table, "56")["solved"] == "0/1"
    assert all(len(line) <= WIDTH for line in markdown(table))


def test_every_system_of_the_paper_has_its_row() -> None:
    table = beside_paper(summarise(results(SCENES, PLANNERS)))
    told = [row[:3] for row in table.rows]
    assert len(told) == len(set(told)) == len(PUBLISHED) + len(SCENES) * len(PLANNERS)
    assert all((p.scene, p.system, "paper") in told for p in PUBLISHED)
    streams = {name for scene, name, _ in told if name.startswith("PDDLStream")}
    assert len(streams) == 4
    assert ("words/tamp", "BFWS", "here") in told


def test_ratios_compare_with_the_lazy_planner() -> None:
    found = [result(job(0, "lazy-siiw-r"), 1.0), result(job(0), 2.5)]
    assert row(ratio_table(found), "siw-r")["times"] == "2.5"


@pytest.mark.parametrize("kind", ["plain", "paper"])
@pytest.mark.parametrize("scene", ["sorting/3t-02", "a/very/long/way/to/a/scene/with/words/" * 3])
def test_columns_fit_the_terminal(kind, scene) -> None:
    found = results((*SCENES, scene), PLANNERS)
    for table in tables_of(kind, found):
        for line in markdown(table):
            assert len(line) <= WIDTH or line == f"scene: {scene}", line


def test_a_cell_cannot_end_its_row() -> None:
    lines = markdown(Table("", ("a", "b"), (("x|y\nz", "1"),), 1))
    assert len(lines) == 3
    assert re.findall(r"(?<!\\)\|", lines[2]) == ["|"] * 3


UNESCAPE = {
    r"\textbackslash{}": "\\",
    r"\textasciitilde{}": "~",
    r"\textasciicircum{}": "^",
    r"\textless{}": "<",
    r"\textgreater{}": ">",
    r"\textbar{}": "|",
    r"{\char34}": '"',
    r"{\char96}": "`",
    r"{\char36}": "$",
    "-{}": "-",
}


@given(text=st.text(st.characters(min_codepoint=32, max_codepoint=126)))
def test_texts_in_latex_are_printed_as_they_are(text) -> None:
    """Reading the escapes gives the text, and no character with a meaning stands alone."""
    written = escaped(text)
    pattern = "|".join(map(re.escape, UNESCAPE)) + r"|\\[&%#_{}]"
    assert re.sub(pattern, lambda m: UNESCAPE.get(m[0], m[0][-1]), written) == text
    assert not re.search(r"[&%$#_{}~^\\<>|\"]|--", re.sub(pattern, "", written))


def test_latex_has_as_many_columns_as_its_layout() -> None:
    for table in tables_of("paper", results(SCENES, PLANNERS)):
        text = "\n".join(latex(table))
        layout = re.search(r"begin\{tabular\}\{([lr]+)\}", text)
        assert layout is not None
        rows = re.findall(r"^\{\}(.*) \\\\$", text, re.M)
        assert len(rows) == len(table.rows) + 1
        assert {len(re.findall(r"(?<!\\)&", row)) for row in rows} == {len(layout[1]) - 1}
        for name in ("table", "tabular"):
            assert text.count(rf"\begin{{{name}}}") == text.count(rf"\end{{{name}}}") == 1


def test_characters_that_fonts_lack_are_told_by_number() -> None:
    assert escaped("ü") == r"\texttt{U+00FC}"
    assert "\n" not in escaped("a\nb")


def test_csv_and_json_have_a_case_each_and_the_same_numbers() -> None:
    found = [*results(), result(job(0, "iw"), None)]
    summaries = summarise(found)
    rows = list(csv.DictReader(as_csv(summaries)))
    cases = json.loads(as_json("mine", summaries, []))["cases"]
    assert len(rows) == len(cases) == 5
    for line, case in zip(rows, cases, strict=True):
        assert line == {name: "" if v is None else str(v) for name, v in case.items()}
    assert cases[-1]["median"] is None
    assert cases[-1]["solved"] == 0


def test_the_survival_plot_has_a_curve_for_every_planner() -> None:
    picture = ElementTree.fromstring(survival_plot(results(SCENES, PLANNERS, 3)))
    texts = [element.text for element in picture.iter() if element.tag.endswith("text")]
    for planner in PLANNERS:
        assert f"{planner}: {0 if planner == 'iw' else 24}/24" in texts
    curves = [
        element.get("d")
        for element in picture.iter()
        if element.tag.endswith("path") and element.get("stroke", "").startswith("#")
        and element.get("stroke") != "#dddddd"
    ]  # fmt: skip
    assert len(curves) == len(PLANNERS)
    assert sorted(curve.count("V") for curve in curves) == [0, 24, 24, 24, 24]


def test_an_empty_plot_is_a_picture() -> None:
    ElementTree.fromstring(survival_plot([]))
