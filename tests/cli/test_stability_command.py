"""`rbfem stability`: what it prints and writes."""

import csv

from rbfem.motion.methods import METHODS

SPRUNG = {"name": "weight", "position": [0.3, 0.1, 0], "angular_velocity": [0.5, 1, 2]}
SPRUNG["loads"] = [{"spring": {"at": [0.03, 0.05, 0.1], "to": [0, 0, 0], "stiffness": 400.0, "damping": 1.0}}]


def test_the_limits_are_printed_and_written(rbfem, write_case, tmp_path):
    done = rbfem("stability", write_case([SPRUNG], name="swing/case.yaml"), cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    out = tmp_path / "results/swing"
    assert {path.name for path in out.iterdir()} == {"stability.csv", "stability.png", "stability.svg"}
    rows = list(csv.DictReader((out / "stability.csv").read_text(encoding="utf-8").splitlines()))
    assert {row["method"] for row in rows} == set(METHODS) - {"exact", "dop853"}
    for word in ("kdk", "times ω_max", "ζ =", "dop853 was not tried", "stability.svg"):
        assert word in done.stdout
    assert "\x1b" not in done.stdout + done.stderr


def test_a_case_without_a_limit_is_told_so(rbfem, write_case, tmp_path):
    done = rbfem("stability", write_case([{"velocity": [1, 0, 0]}]), "-o", tmp_path / "out")
    assert done.returncode == 0 and "nothing limits the step" in done.stdout
    assert list((tmp_path / "out").iterdir()) == []


def test_an_output_that_cannot_be_written_is_told_before_anything_runs(rbfem, write_case, tmp_path):
    (tmp_path / "taken").write_text("mine")
    done = rbfem("stability", write_case([SPRUNG]), "-o", tmp_path / "taken/out", timeout=20)
    assert done.returncode == 2
    assert "cannot be written" in done.stderr and "Traceback" not in done.stderr
