"""Every case of `cases/` is run whole, into a folder, and held against what it says itself about its answer."""

import json
from pathlib import Path

import pytest

import rbfem
from rbfem.results.record import record
from rbfem.results.report import Clock

CASES = Path(__file__).parents[1] / "cases"
FOLDERS = sorted(path.parent for path in CASES.glob("*/case.yaml"))

# What a case is known to warn of, by its folder; anything else is a failure.
KNOWN_WARNINGS: dict[str, tuple[str, ...]] = {}


def test_there_are_cases():
    assert len(FOLDERS) >= 11


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_a_case_meets_its_expectations_without_a_warning(folder, tmp_path):
    scene = rbfem.load(folder)
    shown = []
    report = record(scene, rbfem.plan(scene), tmp_path, Clock(), shown.append)
    assert report["expect"], "a case says what is known about its answer"
    assert len(report["expect"]) == len(scene.expectations)
    missed = {f"{one['quantity']} at {one['at']:g}": one["error"] for one in report["expect"] if not one["pass"]}
    assert missed == {}
    unknown = [said for said in report["warnings"] if not said.endswith(KNOWN_WARNINGS.get(folder.name, ("\0",)))]
    assert unknown == []
    assert report["error"]["estimated"] <= report["error"]["asked"]
    assert json.loads((tmp_path / "report.json").read_text()) == json.loads(json.dumps(report))
    assert len(list((tmp_path / "frames").glob(f"{folder.name}_[0-9]*.vtu"))) == len(shown)


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_a_case_says_in_words_what_it_shows(folder):
    lines = (folder / "case.yaml").read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("# ") and rbfem.load(folder).title
