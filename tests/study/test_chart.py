"""The files of the chart: every run is in them, the page needs nothing from outside."""

import csv
import json
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import pytest

from rbfem.errors import RunError
from rbfem.study.chart import COLUMNS, as_csv, as_svg, draw, write_chart
from rbfem.study.chart_page import page
from rbfem.study.summary import HEAD, by_cost, notes, rows
from rbfem.study.work_precision import Point, WorkPrecision

STEPS = [0.4 / 2**k for k in range(8)]


def line(method, order, evaluations, first=0):
    """Runs whose error is (step / 0.2)^order / 10; those with a step above 0.15 are unstable."""
    return tuple(
        Point(
            method=method,
            step=step,
            tolerance=None,
            steps=round(1 / step),
            evaluations=round(evaluations / step),
            seconds=1e-6 * evaluations / step,
            error=float("inf") if step > 0.3 else 0.1 * (step / 0.2) ** order,
            is_stable=step < 0.15,
        )
        for step in STEPS[first:]
    )


@pytest.fixture
def study():
    points = line("rk4", 4, 4) + line("euler", 1, 1) + line("semi_implicit_euler", 1, 1.5)
    chosen = replace(points[5], evaluations=points[5].evaluations * 3 // 2)
    return WorkPrecision(
        case="swing",
        title='A <"swing"> & more',
        n_bodies=2,
        end_time=1.0,
        accuracy=1e-5,
        points=points,
        chosen=chosen,
        is_auto=True,
        reference="dop853 at tolerance 1e-14",
        orders={"rk4": 4, "euler": 1, "semi_implicit_euler": 1},
        floor=1e-7,
        left_out={"exact": "loads act", "drift": "loads act", "other": "too slow"},
    )


def ids_of_runs(svg):
    return {name for name in re.findall(r'id="([^"]+)"', svg) if name.startswith("run-")}


def test_the_table_has_a_row_for_every_run_and_numbers_that_read_back(study):
    head, *table = csv.reader(as_csv(study).splitlines())
    assert tuple(head) == COLUMNS
    assert len(table) == len(study.points) + 1
    for row, point in zip(table, (*study.points, study.chosen), strict=True):
        told = dict(zip(head, row, strict=True))
        assert (told["method"], float(told["step"]), float(told["error"])) == (point.method, point.step, point.error)
        assert (int(told["evaluations"]), float(told["seconds"])) == (point.evaluations, point.seconds)
        assert told["is_stable"] == str(point.is_stable) and told["tolerance"] == ""
    assert [row[-1] for row in table].count("True") == 1 and table[-1][-1] == "True"
    assert {row[0]: float(row[2]) for row in table} == pytest.approx({"rk4": 4, "euler": 1, "semi_implicit_euler": 1})


def test_every_run_is_drawn_in_both_panels_the_unstable_ones_too(study):
    assert not all(point.is_stable for point in study.points)
    expected = {f"run-{i}-{cost}" for i in range(len(study.points) + 1) for cost in ("seconds", "evaluations")}
    assert ids_of_runs(as_svg(draw(study))) == expected


def test_unstable_runs_stand_above_all_others_and_below_the_top(study):
    axes = draw(study).axes[0]
    heights = {one.get_gid(): one.get_ydata()[0] for one in axes.lines if one.get_gid()}
    stable = [heights[f"run-{i}-seconds"] for i, point in enumerate(study.points) if point.is_stable]
    unstable = [heights[f"run-{i}-seconds"] for i, point in enumerate(study.points) if not point.is_stable]
    assert max(stable) < min(unstable) and max(unstable) < axes.get_ylim()[1]
    assert min(stable) > axes.get_ylim()[0]


def test_a_run_below_three_times_the_floor_is_hollow(study):
    figure = draw(study)
    lines = {one.get_gid(): one for one in figure.axes[1].lines if one.get_gid()}
    for index, point in enumerate(study.points):
        if point.is_stable:
            is_hollow = lines[f"run-{index}-evaluations"].get_markerfacecolor() == "white"
            assert is_hollow == (point.error <= 3e-7)
    assert any(point.error <= 3e-7 for point in study.points)


def test_a_run_without_cost_or_error_has_a_place(study):
    free = replace(study.points[-1], evaluations=0, seconds=0.0, error=0.0)
    svg = as_svg(draw(replace(study, points=(*study.points, free))))
    assert f"run-{len(study.points)}-evaluations" in ids_of_runs(svg)
    assert not re.search(r'"[^"]*\bnan\b[^"]*"', svg)


def test_the_drawing_tells_the_case_the_accuracy_and_the_choice(study):
    texts = [text.get_text() for axes in draw(study).axes for text in axes.texts]
    assert "auto: rk4" in texts and "accepted: 1e-05" in texts and "unstable" in texts
    figure = draw(study)
    assert figure.texts[0].get_text() == study.title
    labels = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert {"rk4   4.0 (4)", "euler   1.0 (1)"} <= set(labels)
    assert labels[-1].startswith("auto, with trial run and check")
    asked = draw(replace(study, is_auto=False)).legends[-1].get_texts()[-1].get_text()
    assert asked.startswith("as asked, with check")


def test_the_page_has_every_run_and_no_address_from_outside(study):
    text = page(study, as_svg(draw(study)))
    runs = json.loads(re.search(r"const runs = (\[.*?\]);\n\nconst", text, re.DOTALL).group(1))
    assert [run[0] for run in runs[:-1]] == [point.method for point in study.points]
    assert runs[-1][0].endswith(study.chosen.method)
    assert all(len(run) == 6 for run in runs)
    for index, point in enumerate(study.points):
        assert runs[index][4] == f"{point.evaluations}" and runs[index][5] == ("yes" if point.is_stable else "no")
    assert {f"run-{i}-seconds" for i in range(len(runs))} <= ids_of_runs(text)
    addresses = {address for address in re.findall(r'https?://[^"\s<>\')]+', text)}
    assert addresses <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}  # names, not places
    assert not re.findall(r"<(?:link|img|iframe|script)[^>]*(?:src|href)=|@import|url\((?!#)", text)


def test_a_title_cannot_break_the_page(study):
    text = page(replace(study, title="</script><b>"), as_svg(draw(study)))
    assert text.count("</script>") == 1 and "&lt;/script&gt;&lt;b&gt;" in text


def test_the_drawing_inside_the_page_is_well_formed(study):
    text = page(study, as_svg(draw(study)))
    ElementTree.fromstring(text[text.index("<svg") : text.index("</svg>") + len("</svg>")])


def test_the_summary_has_the_cheapest_run_within_the_accuracy_of_each_method(study):
    table = {row[0]: dict(zip(HEAD, row, strict=True)) for row in rows(study)}
    assert list(table) == by_cost(study) and by_cost(study)[0] == "rk4"
    within = [p for p in study.of("rk4") if p.is_stable and p.error <= study.accuracy]
    assert table["rk4"]["evaluations"] == str(min(p.evaluations for p in within))
    assert table["euler"]["step, s"] == "none" and table["euler"]["error"].startswith("≥")
    assert (table["rk4"]["order here"], table["rk4"]["in table"]) == ("4.0", "4")


def test_the_notes_tell_whether_the_choice_keeps_the_accuracy(study):
    assert "within" in dict(notes(study))["auto"]
    assert "ABOVE" in dict(notes(replace(study, accuracy=1e-20)))["auto"]
    assert "within" in dict(notes(replace(study, is_auto=False)))["as asked"]


def test_the_notes_tell_the_reference_what_is_unstable_and_what_is_left_out(study):
    told = dict(list(notes(study))[:-1])
    assert "dop853 at tolerance 1e-14" in told["reference"] and "1e-07" in told["reference"]
    assert "euler (stable from 0.1 s)" in told["unstable"]
    assert told["left out"] == "exact, drift: loads act"


def test_a_study_without_an_unstable_run_says_why(study):
    tame = replace(study, points=tuple(point for point in study.points if point.is_stable))
    assert dict(notes(tame))["unstable"].startswith("nothing")


def test_all_files_are_written_and_the_same_study_gives_the_same_drawing(study, tmp_path):
    assert [path.name for path in write_chart(study, tmp_path)] == ["chart.csv", "chart.png", "chart.svg", "chart.html"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["chart.csv", "chart.html", "chart.png", "chart.svg"]
    assert (tmp_path / "chart.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "chart.svg").read_text(encoding="utf-8") == as_svg(draw(study))


def test_a_folder_that_is_gone_is_told(study, tmp_path):
    with pytest.raises(RunError, match=r"chart\.csv: could not be written"):
        write_chart(study, tmp_path / "gone")
