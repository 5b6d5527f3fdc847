"""The measuring behind the chart: what is compared, how orders, floor and front come out of it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rbfem.planning.applicable import applicable_methods
from rbfem.planning.plan import Choice
from rbfem.planning.planner import plan
from rbfem.study import work_precision as study_of
from rbfem.study.work_precision import Point, fitted_order, floor_of, measured, pareto_front, sweep

# A brick on a spring off its centre: its limit is less than 0.1 s, so that steps beyond it fit between the outputs.
SPRUNG = {
    "position": [0.3, 0.1, 0],
    "angular_velocity": [0.5, 1, 2],
    "loads": [{"spring": {"at": [0.03, 0.05, 0.1], "to": [0, 0, 0], "stiffness": 400.0}}],
}
COARSE_OUTPUT = {"time": {"end": 1}, "output": {"every": 0.5}}


def make(method="rk4", step=0.1, error=0.1, seconds=1.0, evaluations=40, is_stable=True):
    return Point(method, step, None, round(1 / step), evaluations, seconds, error, is_stable)


def swept(scene, method):
    made = replace(plan(scene), backend=Choice("serial", "as in a chart"))
    reference = reference_of(scene, made)
    return sweep(scene, made, method, reference), reference


def reference_of(scene, made):
    return study_of._reference(scene, made, [name for name, reason in applicable_methods(scene).items() if not reason])


@pytest.fixture
def sprung(scene_of):
    return scene_of(SPRUNG, **COARSE_OUTPUT)


def test_rk4_shows_its_order_on_a_smooth_spring(sprung):
    points, _ = swept(sprung, "rk4")
    assert fitted_order(points, 1e-12) == pytest.approx(4.0, abs=0.2)


def test_steps_go_from_beyond_stability_to_where_the_error_stops_falling(sprung):
    points, _ = swept(sprung, "rk4")
    limit = plan(sprung).step_limit.value
    assert points[0].step > 2 * limit and not points[0].is_stable
    assert [point.step for point in points] == sorted({point.step for point in points}, reverse=True)
    assert all(point.step == pytest.approx(sprung.end_time / point.steps) for point in points if point.is_stable)
    best = min(point.error for point in points)
    assert best < 1e-10
    assert min(point.error for point in points[-2:]) >= 0.8 * min(point.error for point in points[:-2])


def test_the_steps_of_a_chart_begin_at_the_limit_of_all_methods_whichever_the_plan_has_chosen(scene_of):
    top = {"pivot": [0, 0, 0], "position": [0.02, 0, 0], "angular_velocity": [150, 0, 0]}
    scene = scene_of(top, gravity=[0, 0, -9.81], time={"end": 1, "method": "rkn4"})
    assert study_of._limit_of_all(scene).value == pytest.approx(2 / 150)
    assert plan(scene).step_limit.value > 3 / 150
    assert study_of._limit_of_all(scene_of({"velocity": [1, 0, 0]})).value is None


def test_a_run_that_blows_up_is_a_point_with_an_infinite_error(scene_of):
    body = SPRUNG | {"loads": [{"spring": {"to": [0, 0, 0], "stiffness": 1e6}}]}
    points, _ = swept(scene_of(body, **COARSE_OUTPUT), "rk4")
    assert math.isinf(points[0].error) and not points[0].is_stable
    assert points[-1].is_stable and points[-1].error < 1e-6


def test_energy_made_up_is_unstable_although_the_state_is_finite(sprung):
    points, _ = swept(sprung, "euler")
    wild = [point for point in points if not point.is_stable]
    assert any(math.isfinite(point.error) for point in wild)
    assert all(point.error >= study_of.LOST for point in wild)


def test_an_error_is_a_share_of_the_radius_or_an_angle_whichever_is_larger(sprung):
    _, reference = swept(sprung, "euler")
    radius = sprung.bounding_radius[0]
    frame = type("Moved", (), {"position": reference.position[1] + [0, 0.3 * radius, 0], "quaternion": None})
    frame.quaternion = reference.quaternion[1]
    assert study_of._distance(frame, reference.position[1], reference.quaternion[1], radius) == pytest.approx(0.3)
    frame.quaternion = np.roll(reference.quaternion[1], 1)  # some other attitude, far away
    assert study_of._distance(frame, reference.position[1], reference.quaternion[1], radius) > 0.3


def test_the_runs_of_a_method_keep_within_the_evaluations_of_a_chart(scene_of, monkeypatch):
    monkeypatch.setattr(study_of, "MOST_EVALUATIONS", 3000)
    points, _ = swept(scene_of(SPRUNG, **COARSE_OUTPUT), "semi_implicit_euler")
    assert len(points) >= study_of.FEWEST_RUNS
    assert max(point.evaluations for point in points) <= 3000
    assert max(point.evaluations for point in points) > 1500


def test_many_bodies_get_fewer_evaluations_each(scene_of):
    place = {"in_box": [[0, 0, 0], [1, 1, 1]]}
    many = scene_of({"count": 100, "place": place})
    assert study_of.most_evaluations(many) == study_of.MOST_BODY_EVALUATIONS // 100


def test_an_adaptive_method_is_swept_over_tolerances(sprung):
    points, _ = swept(sprung, "dop853")
    tolerances = [point.tolerance for point in points]
    assert len(points) >= 4 and tolerances == sorted(tolerances, reverse=True)
    assert set(tolerances) <= set(study_of.TOLERANCES)
    assert points[-1].error < 1e-10 < points[0].error


def test_the_exact_motion_is_the_reference_of_a_body_that_nothing_pushes(scene_of):
    scene = scene_of({"angular_velocity": [0.1, 5, 0.1]}, time={"end": 1}, output={"every": 0.25})
    assert applicable_methods(scene)["exact"] == ""
    points, reference = swept(scene, "exact")
    assert reference.method == "exact"
    assert len(points) == 1 and points[0].error < 1e-13
    assert swept(scene, "rk4")[0][-1].error < 1e-10


def test_the_error_of_the_run_of_a_plan_is_its_true_error(scene_of):
    """Explicit Euler on a parabola is off by g dt t / 2."""
    time = {"end": 1, "step": 0.01, "method": "euler"}
    scene = scene_of({"shape": "ball"}, gravity=[0, 0, -9.81], time=time, output={"every": 1})
    made = plan(scene)
    reference = reference_of(scene, made)
    point = measured(scene, made, reference)
    assert point.error == pytest.approx(0.5 * 9.81 * 0.01 / 0.1, rel=1e-9)
    assert (point.step, point.is_stable) == (pytest.approx(0.01), True)
    assert point.steps == 150  # with the companion run that checks it


def test_an_order_needs_three_points_clear_of_floor_and_plateau():
    line = [make(step=2.0**-k, error=2.0 ** (-4 * k)) for k in range(2, 8)]
    assert fitted_order(line, 1e-12) == pytest.approx(4.0)
    assert fitted_order(line, line[2].error / 10.0) is None
    unstable = [replace(point, is_stable=False) for point in line[:-2]]
    assert fitted_order([*unstable, *line[-2:]], 1e-12) is None


def test_an_order_is_not_spoilt_by_a_coarse_plateau_or_by_rounding_at_the_fine_end():
    clean = [make(step=2.0**-k, error=2.0 ** (-6 * k)) for k in range(2, 6)]
    coarse = [make(step=0.5 * 1.4**-k, error=0.09 - 0.01 * k) for k in range(3)]
    fine = [make(step=2.0 ** (-6 - k), error=error) for k, error in enumerate((3e-9, 5e-9, 2e-9))]
    assert fitted_order([*coarse, *clean, *fine], 1e-12) == pytest.approx(6.0, abs=0.05)


def test_the_floor_is_what_two_successive_runs_of_one_method_agree_to():
    falling = [make(error=error) for error in (1e-3, 1e-9, 3e-12, 2e-12)]
    lucky = [make(error=error) for error in (1e-3, 1e-15, 1e-9)]
    assert floor_of([falling, lucky]) == 3e-12
    assert floor_of([[make(error=0.0)] * 2]) == np.finfo(float).eps


@given(
    st.lists(
        st.builds(
            make,
            error=st.sampled_from([1e-9, 1e-6, 1e-3, 0.1, 1.0]) | st.floats(1e-12, 10),
            seconds=st.sampled_from([0.1, 0.2]) | st.floats(1e-3, 10),
            evaluations=st.integers(1, 20),
            is_stable=st.booleans(),
        ),
        max_size=12,
    ),
    st.sampled_from(["seconds", "evaluations"]),
)
def test_the_pareto_front_is_what_brute_force_finds(points, cost):
    stable = [point for point in points if point.is_stable]

    def beats(a, b):
        pair_a, pair_b = (getattr(a, cost), a.error), (getattr(b, cost), b.error)
        return pair_a != pair_b and pair_a[0] <= pair_b[0] and pair_a[1] <= pair_b[1]

    best = {(getattr(p, cost), p.error) for p in stable if not any(beats(other, p) for other in stable)}
    front = pareto_front(points, cost)
    assert {(getattr(p, cost), p.error) for p in front} == best
    assert len(front) == len(best)


def test_below_the_floor_the_cheaper_of_two_is_the_front():
    cheap, dear = make(error=3e-13, evaluations=10), make(error=1e-15, evaluations=20)
    assert pareto_front([cheap, dear], "evaluations", floor=1e-12) == (cheap,)
    assert pareto_front([cheap, dear], "evaluations") == (cheap, dear)
