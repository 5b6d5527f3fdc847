"""A state that is no longer a number stops the run with words, not with a traceback."""

import json

import numpy as np
import pytest

import rbfem
from rbfem.errors import RunError
from rbfem.results.record import record
from rbfem.results.report import Clock

SPRING = {"spring": {"to": [0, 0, 0], "stiffness": 20000.0}}


def sprung(scene_of, step, method="semi_implicit_euler", lever=None, **keys):
    spring = {"spring": {"to": [0, 0, 0], "stiffness": 20000.0} | ({"at": lever} if lever else {})}
    body = {"name": "weight", "shape": "ball", "position": [0.1, 0, 0], "loads": [spring]}
    return scene_of(body, time={"end": 20, "step": step, "method": method}, output={"every": 1}, **keys)


@pytest.mark.parametrize("lever", [None, [0.05, 0, 0.02]])
@pytest.mark.parametrize("method", ["rk4", "rk4_world", "semi_implicit_euler", "euler"])
def test_a_state_that_grows_without_bound_ends_the_run_naming_body_and_time(scene_of, method, lever):
    scene = sprung(scene_of, step=0.2, method=method, lever=lever)
    run = rbfem.simulate(scene, rbfem.plan(scene, beyond_limit=True))
    with pytest.raises(RunError, match=r"t = \d+ s .*'weight'.*method " + method):
        list(run)


def test_the_report_of_a_run_that_blew_up_is_valid_json_up_to_its_last_good_frame(scene_of, tmp_path):
    scene = sprung(scene_of, step=0.2)
    with pytest.raises(RunError):
        record(scene, rbfem.plan(scene, beyond_limit=True), tmp_path / "out", Clock(), lambda frame: None)
    report = json.loads((tmp_path / "out/report.json").read_text())
    assert report["final"]["time"] < 20
    assert any("before its time" in warning for warning in report["warnings"])


def test_a_companion_that_blows_up_makes_the_error_unknown_not_zero(scene_of, run_of):
    scene = sprung(scene_of, step="auto")
    limit = rbfem.plan(scene).step_limit.value
    run, frames = run_of(sprung(scene_of, step=0.9 * limit))
    assert np.abs(frames[-1].position).max() < 1.0
    assert run.error.estimated is None
    assert any("companion" in warning for warning in run.warnings)
