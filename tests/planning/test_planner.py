"""The step, the method, the backend and the plan as data."""

import dataclasses
import json
import re
import subprocess
import sys
import time

import numpy as np
import pytest

import rbfem
from rbfem.errors import InputError
from rbfem.motion.methods import METHODS
from rbfem.planning import planner

SPRUNG = {"shape": "ball", "position": [0.3, 0, 0], "loads": [{"spring": {"to": [0, 0, 0], "stiffness": 250.0}}]}
COPIES = {"name": "rock", "place": {"in_box": [[0, 0, 0], [9, 9, 9]], "orientation": "random"}}


# ------------------------------------------------------------------------------------------------------------- step


def test_a_step_beyond_the_limit_is_refused_with_the_limit_in_the_message(scene_of):
    limit = rbfem.plan(scene_of(SPRUNG)).step_limit.value
    scene = scene_of(SPRUNG, time={"end": 1, "step": 1.001 * limit})
    with pytest.raises(InputError, match=rf"time\.step: .*limit of this scene is {limit:.6g} s .*2/ω.*--beyond-limit"):
        rbfem.plan(scene)
    allowed = rbfem.plan(scene, beyond_limit=True)
    assert allowed.step.value == scene.step
    assert "on purpose" in allowed.step.reason and f"{limit:.6g}" in allowed.step.reason


def test_a_step_at_the_limit_is_taken_as_asked(scene_of):
    limit = rbfem.plan(scene_of(SPRUNG)).step_limit.value
    plan = rbfem.plan(scene_of(SPRUNG, time={"end": 1, "step": limit}))
    assert plan.step.value == limit
    assert "asked for; 1 of the limit" in plan.step.reason


@pytest.mark.parametrize(("share", "is_warned"), [(0.78, False), (0.82, True)])
def test_a_given_step_close_to_its_limit_is_warned_of(scene_of, share, is_warned):
    step = share * rbfem.plan(scene_of(SPRUNG)).step_limit.value
    time, output = {"end": 10 * step, "step": step}, {"every": 10 * step}
    warnings = rbfem.plan(scene_of(SPRUNG, time=time, output=output)).warnings
    assert any("rbfem stability" in warning for warning in warnings) == is_warned
    often = rbfem.plan(scene_of(SPRUNG, time=time, output={"every": step})).warnings
    assert often == ()  # the outputs halve it


def test_a_step_that_the_outputs_cut_is_told_with_what_they_leave(scene_of):
    cut = rbfem.plan(scene_of(SPRUNG, time={"end": 1, "step": 0.02}, output={"every": 0.01}))
    assert "the outputs cut it to 0.005 s" in cut.step.reason and "would be cheaper" in cut.step.reason
    whole = rbfem.plan(scene_of(SPRUNG, time={"end": 1, "step": 0.02}, output={"every": 0.5}))
    assert "cut" not in whole.step.reason


@pytest.mark.parametrize("spin", [5.0, 5e3])
def test_a_step_too_long_for_the_spin_is_refused_too_with_the_methods_that_stand_it(scene_of, spin):
    with pytest.raises(InputError, match=r"limit of this scene .* with rk4 \(2/spin: .*turns bodies exactly .*rkn4"):
        rbfem.plan(scene_of({"angular_velocity": [0, 0, spin]}, time={"end": 1, "step": 2.1 / spin, "method": "rk4"}))


def test_bodies_that_nothing_pushes_need_no_step(scene_of):
    plan = rbfem.plan(scene_of({"velocity": [1, 0, 0], "angular_velocity": [1, 2, 3]}, gravity=[0, 0, -9.81]))
    assert (plan.method.value, plan.step.value, plan.order, plan.verify.value) == ("exact", None, 0.0, 0)
    assert "closed form" in plan.method.reason


def test_a_smaller_accuracy_gets_a_shorter_step(scene_of):
    plans = [
        rbfem.plan(scene_of(SPRUNG, accuracy=accuracy, time={"end": 1, "method": "rkn4"})) for accuracy in (1e-3, 1e-7)
    ]
    assert plans[1].step.value < plans[0].step.value / 5  # ten times, by the order
    assert all(plan.redo and plan.pilot.value > 0 for plan in plans)


def test_the_pilot_takes_the_cheapest_of_what_it_tried_and_says_what_each_costs(scene_of):
    plan = rbfem.plan(scene_of(SPRUNG | {"angular_velocity": [1, 2, 3]}, accuracy=1e-9))
    told = plan.method.reason.partition("expected evaluations of the loads in the run: ")[2]
    costs = [re.fullmatch(r"(\w+) (?:more than )?(\d+)", one).groups() for one in told.split(", ")]
    assert costs[0][0] == plan.method.value and len(costs) == 2
    assert all(int(cost) >= int(costs[0][1]) > 0 for _, cost in costs)


def test_a_spin_does_not_limit_a_method_that_turns_bodies_exactly(scene_of):
    top = {"pivot": [0, 0, 0], "position": [0.02, 0, 0], "angular_velocity": [150, 3, 0]}
    time = {"end": 1, "step": 0.02, "method": "rkn4"}
    plan = rbfem.plan(scene_of(top, gravity=[0, 0, -9.81], time=time))
    assert 2 / 150 < plan.step.value == 0.02 < plan.step_limit.value and "does not limit it" in plan.step_limit.reason
    by_auto = rbfem.plan(scene_of(top, gravity=[0, 0, -9.81], time={"end": 1, "step": 0.02}))
    assert (by_auto.method.value, by_auto.step_limit) == ("rkn4", plan.step_limit)
    with pytest.raises(InputError, match="limit"):
        rbfem.plan(scene_of(top, gravity=[0, 0, -9.81], time=time | {"method": "rk4"}))


def test_the_pilot_steps_on_the_corners_of_ramps(scene_of):
    """A step across a corner would show order two and call for steps a hundred times shorter."""
    ramp = [[0, 0], [0.0313, 1], [0.0777, 0.2], [0.101, 1]]
    loads = [{"torque": [0.1, 0.2, 0.3], "frame": "body", "ramp": ramp}, {"drag": {"angular": 1e-4}}]
    scene = scene_of({"loads": loads, "angular_velocity": [1, 2, 3]}, accuracy=1e-9, output={"every": 1})
    plan = rbfem.plan(scene)
    assert plan.order > 6 and plan.step.value > 0.01


def test_a_given_step_is_taken_without_a_pilot(scene_of):
    plan = rbfem.plan(scene_of(SPRUNG, time={"end": 1, "step": 1e-3}))
    assert (plan.step.value, plan.pilot.value, plan.redo) == (1e-3, 0, False)


def test_dampers_rule_out_what_they_would_bring_down_to_order_two(scene_of):
    loads = [{"drag": {"linear": 1.0}}, {"torque": [0.1, 0.2, 0]}]
    plan = rbfem.plan(scene_of({"loads": loads}, accuracy=1e-8))
    assert METHODS[str(plan.method.value)].damped_order >= 4 and "dissipative" in plan.method.reason


def test_a_fast_top_is_called_weakly_turned_and_gets_the_method_for_it(scene_of):
    top = {"pivot": [0, 0, 0], "position": [0.02, 0, 0], "angular_velocity": [150, 3, 0]}
    plan = rbfem.plan(scene_of(top, gravity=[0, 0, -9.81], accuracy=1e-8))
    assert "weakly turned" in plan.method.reason and "aba864" in plan.method.reason
    slow = rbfem.plan(scene_of(top | {"angular_velocity": [5, 3, 0]}, gravity=[0, 0, -9.81], accuracy=1e-8))
    assert "weakly turned" not in slow.method.reason and "aba864" not in slow.method.reason


def test_many_swings_in_a_run_are_called_stiff_and_ramps_changing_with_time(scene_of):
    stiff = {"shape": "ball", "position": [0.3, 0, 0], "loads": [{"spring": {"to": [0, 0, 0], "stiffness": 1e9}}]}
    assert "stiff: up to" in rbfem.plan(scene_of(stiff)).method.reason
    ramped = {"loads": [{"force": [1, 0, 0], "at": [0, 0.1, 0], "ramp": [[0, 0], [0.5, 1]]}]}
    assert "change with time" in rbfem.plan(scene_of(ramped)).method.reason


def test_an_adaptive_method_gets_a_tolerance_and_refuses_a_step(scene_of):
    plan = rbfem.plan(scene_of(SPRUNG, accuracy=1e-6, time={"end": 1, "method": "dop853"}))
    assert 0.0 < plan.tolerance.value < 1e-3 and "at a hundred times the tolerance" in plan.verify.reason
    with pytest.raises(InputError, match=r"time\.step: method dop853 finds its own steps"):
        rbfem.plan(scene_of(SPRUNG, time={"end": 1, "method": "dop853", "step": 1e-3}))


def test_the_closed_form_is_refused_where_loads_act(scene_of):
    with pytest.raises(InputError, match=r"time\.method: 'exact' does not apply: loads act"):
        rbfem.plan(scene_of(SPRUNG, time={"end": 1, "method": "exact"}))


# ----------------------------------------------------------------------------------------------------------- method


def test_an_unknown_method_is_refused_with_the_nearest_and_all_names(scene_of):
    with pytest.raises(InputError, match=r"time\.method: no method 'rk5'; did you mean 'rk4'\?") as caught:
        rbfem.plan(scene_of({}, time={"end": 1, "method": "rk5"}))
    assert all(name in str(caught.value) for name in METHODS)


def test_a_method_like_no_other_is_refused_without_a_guess(scene_of):
    with pytest.raises(InputError, match=r"case\.yaml:\d+: time\.method: no method 'bdf' \(known: exact") as caught:
        rbfem.plan(scene_of({}, time={"end": 1, "method": "bdf"}))
    assert "did you mean" not in str(caught.value)


@pytest.mark.parametrize("method", METHODS)
def test_every_method_of_the_table_can_be_asked_for(scene_of, method):
    choice = rbfem.plan(scene_of({}, time={"end": 1, "method": method})).method
    assert choice.value == method and "asked for" in choice.reason


def test_euler_is_said_to_gain_energy(scene_of):
    assert "gains energy" in rbfem.plan(scene_of({}, time={"end": 1, "method": "euler"})).method.error


# ---------------------------------------------------------------------------------------------------------- backend


@pytest.fixture
def fresh(monkeypatch):
    """As in a process that has not imported numba, with kernels that were compiled before."""
    monkeypatch.setattr(planner, "clear_of_numba", lambda: True)
    monkeypatch.setattr(planner, "is_cached", lambda *kernel: True)


@pytest.mark.usefixtures("fresh")
def test_a_small_scene_is_computed_in_plain_python(scene_of):
    assert rbfem.plan(scene_of(SPRUNG)).backend.value == "python"


@pytest.mark.usefixtures("fresh")
def test_a_large_scene_is_computed_by_kernels(scene_of):
    time = {"end": 1, "step": 1e-3, "method": "rk4"}
    scene = scene_of(COPIES | {"count": 2000, "angular_velocity": [1, 2, 3]}, time=time)
    backend = rbfem.plan(scene).backend
    assert backend.value == "serial"
    assert "3e+06 steps of coasting bodies" in backend.reason  # 2000 bodies, 1000 steps, half as many of the companion


@pytest.mark.usefixtures("fresh")
def test_a_huge_scene_is_spread_over_the_cores(scene_of, monkeypatch):
    scene = scene_of(
        COPIES | {"count": 50000, "loads": [{"force": [1, 0, 0], "at": [0, 0.01, 0]}]}, time={"end": 1, "step": 1e-3}
    )
    monkeypatch.setattr(planner.os, "cpu_count", lambda: 2)
    assert rbfem.plan(scene).backend.value == "parallel"
    monkeypatch.setattr(planner.os, "cpu_count", lambda: 1)
    assert rbfem.plan(scene).backend.value == "serial"


def test_compiling_for_the_first_time_counts(scene_of, monkeypatch):
    scene = scene_of(
        COPIES | {"count": 100, "angular_velocity": [1, 2, 3]}, time={"end": 1, "step": 2e-4, "method": "rk4"}
    )
    monkeypatch.setattr(planner, "clear_of_numba", lambda: True)
    monkeypatch.setattr(planner, "is_cached", lambda *kernel: True)
    assert rbfem.plan(scene).backend.value == "serial"
    monkeypatch.setattr(planner, "is_cached", lambda *kernel: False)
    assert rbfem.plan(scene).backend.value == "python"


def test_a_fixed_body_is_no_work(scene_of, monkeypatch):
    monkeypatch.setattr(planner, "clear_of_numba", lambda: True)
    scene = scene_of({"fixed": True, "shape": "ball"}, time={"end": 1, "step": 1e-7}, output={"every": 1})
    assert rbfem.plan(scene).backend.value == "python"
    assert "no work at all" in rbfem.plan(scene).backend.reason


def test_a_whole_run_of_a_small_scene_never_imports_numba(write_case, tmp_path):
    case = write_case([SPRUNG, {"shape": "bracket", "material": "steel", "angular_velocity": [1, 2, 3]}])
    command = [sys.executable, "-X", "importtime", "-m", "rbfem", "run", str(case), "-o", str(tmp_path / "out")]
    told = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    imported = {line.rpartition("|")[2].strip() for line in told.stderr.splitlines() if line.startswith("import time:")}
    libraries = {name.split(".")[0] for name in imported}  # what importlib loads is listed by its modules only
    assert "rbfem.motion.state" in imported and "vtkmodules" in libraries  # it did run and it did write
    assert not libraries & {"numba", "llvmlite"}


# ------------------------------------------------------------------------------------------------ the plan as data


def busy_scene(scene_of):
    held = {"name": "held", "pivot": [0, 0, 1], "position": [0, 0, 0.5], "angular_velocity": [0, 0, 2]}
    copies = COPIES | {"count": 4, "angular_velocity": [1, 2, 3]}
    return scene_of(SPRUNG, held, copies, {"name": "wall", "fixed": True}, gravity=[0, 0, -9.81], time={"end": 0.2})


def test_a_plan_comes_back_from_json_and_runs_again_to_the_same_bits(scene_of, run_of):
    scene = busy_scene(scene_of)
    plan = rbfem.plan(scene)
    again = rbfem.Plan.from_dict(json.loads(json.dumps(plan.to_dict(), allow_nan=False)))
    assert again == plan
    for one, other in zip(run_of(scene, plan)[1], run_of(scene, again)[1], strict=True):
        for name in ("position", "quaternion", "velocity", "angular_velocity"):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
        assert one.balance.energy == other.balance.energy


def test_planning_twice_gives_the_same_plan(scene_of):
    assert rbfem.plan(busy_scene(scene_of)).step == rbfem.plan(busy_scene(scene_of)).step


def test_a_plan_that_was_edited_is_followed(scene_of, run_of):
    scene = busy_scene(scene_of)
    plan = rbfem.plan(scene)
    edited = dataclasses.replace(
        plan,
        step=dataclasses.replace(plan.step, value=0.001),
        method=dataclasses.replace(plan.method, value="euler"),
        verify=dataclasses.replace(plan.verify, value=False),
    )
    run, _ = run_of(scene, edited)
    assert run.cost.steps == 200
    assert run.cost.evaluations == 200
    assert run.error.estimated is None and "companion" in run.error.unknown_because


def test_a_plan_says_what_is_left_out(scene_of):
    left = "; ".join(rbfem.plan(busy_scene(scene_of)).left_out)
    for word in ("contact", "elasticity", "air", "1 fixed body"):
        assert word in left
    with_air = rbfem.plan(scene_of({"loads": [{"drag": {"linear": 1}}]}))
    assert "air" not in "; ".join(with_air.left_out)


def test_a_plan_of_a_hundred_thousand_copies_is_quick_and_small(scene_of):
    loads = [{"force": [1, 0, 0], "at": [0.01, 0, 0]}, {"drag": {"linear": 1}}]
    scene = scene_of(COPIES | {"count": 100_000, "angular_velocity": [1, 2, 3], "loads": loads})
    began = time.perf_counter()
    plan = rbfem.plan(scene)
    assert time.perf_counter() - began < 10.0  # measured: 0.8 s
    assert len(json.dumps(plan.to_dict())) < 5000  # measured: 1800
    assert plan.models[0].count == 100_000
