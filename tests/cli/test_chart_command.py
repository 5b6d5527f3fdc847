"""`rbfem chart`: a case of one body, one of a hundred, and what is told before a long run in vain."""

import csv

from rbfem.motion.methods import METHODS

SPRUNG = {"name": "weight", "position": [0.3, 0.1, 0], "angular_velocity": [0.5, 1, 2]}
SPRUNG["loads"] = [{"spring": {"at": [0.03, 0.05, 0.1], "to": [0, 0, 0], "stiffness": 400.0}}]
COMPILED = 400  # seconds: where no test before has, every kernel is compiled


def runs_of(path):
    return list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))


def test_a_chart_of_one_body_has_every_method_that_applies(rbfem, write_case, tmp_path):
    case = write_case([SPRUNG], name="swing/case.yaml", time={"end": 1}, output={"every": 0.5}, accuracy=1e-6)
    done = rbfem("chart", case, cwd=tmp_path, timeout=COMPILED)
    assert done.returncode == 0, done.stderr
    out = tmp_path / "results/swing"
    assert {path.name for path in out.iterdir()} == {"chart.csv", "chart.png", "chart.svg", "chart.html"}
    runs = runs_of(out / "chart.csv")
    assert {run["method"] for run in runs} == set(METHODS) - {"exact"}
    assert any(run["is_stable"] == "False" for run in runs)
    assert 3.7 < float(next(run["measured_order"] for run in runs if run["method"] == "rk4")) < 4.3
    for word in ("rk4", "order here", "auto", "left out", "unstable", "chart.html"):
        assert word in done.stdout
    assert "\x1b" not in done.stdout + done.stderr and "\r" not in done.stdout + done.stderr


def test_a_chart_of_a_hundred_bodies(rbfem, write_case, tmp_path):
    rocks = {"count": 100, "place": {"in_box": [[0, 0, 0], [1, 1, 1]]}, "angular_velocity": [1, 2, 3]}
    case = write_case([rocks], time={"end": 0.2}, output={"every": 0.1}, gravity=[0, 0, -9.81])
    done = rbfem("chart", case, "-o", tmp_path / "out", timeout=COMPILED)
    assert done.returncode == 0, done.stderr
    runs = runs_of(tmp_path / "out/chart.csv")
    assert {"exact", "rk4", "euler"} <= {run["method"] for run in runs}
    assert "exact; other methods agree" in done.stdout


def test_set_changes_what_is_charted(rbfem, write_case, tmp_path):
    done = rbfem("chart", write_case([SPRUNG]), "-o", tmp_path, "--set", "time.end=-1")
    assert done.returncode == 2 and "time.end" in done.stderr


def test_an_output_that_cannot_be_written_is_told_before_anything_runs(rbfem, write_case, tmp_path):
    (tmp_path / "taken").write_text("mine")
    done = rbfem("chart", write_case([SPRUNG], time={"end": 1e5}), "-o", tmp_path / "taken/out", timeout=20)
    assert done.returncode == 2
    assert "cannot be written" in done.stderr and "Traceback" not in done.stderr


def test_the_help_says_what_is_written(rbfem):
    done = rbfem("chart", "--help")
    assert done.returncode == 0 and "chart.html" in done.stdout
