"""The longest stable steps: theory against measurement, on cases and on the sprung, damped, spinning body."""

import csv

import numpy as np
import pytest

from rbfem.motion.methods import METHODS
from rbfem.study.amplification import stable_step
from rbfem.study.stability import COLUMNS, as_csv, longest_stable, measure, notes, table
from rbfem.study.stability_map import growth
from rbfem.study.stability_picture import RATIOS, SHOWN, draw
from rbfem.study.stability_picture import SWINGS as SWINGS_SHOWN

BALL_MASS = 1000 * 4 / 3 * np.pi * 0.1**3
OMEGA = 40.0
STUDIES = {}
SWINGS = np.arange(0.02, 3.0, 0.02)


def swinging(damping_ratio):
    """A ball on a spring that swings along it alone, at OMEGA."""
    spring = {"to": [0, 0, 0.5], "stiffness": BALL_MASS * OMEGA**2, "rest_length": 0.48}
    spring["damping"] = 2 * damping_ratio * BALL_MASS * OMEGA
    return {"shape": "ball", "loads": [{"spring": spring}]}


def limit(method, damping_ratio=0.0, spin_ratio=0.0):
    """dt ω_max of the sprung body up to which nothing grows."""
    full = np.full_like(SWINGS, 1.0)
    grown = growth(method, SWINGS, damping_ratio * full, spin_ratio * full)
    return SWINGS[np.argmax(grown > 0) - 1]


@pytest.fixture
def study_of(scene_of):
    """The study of the swinging ball, made once for each damping ratio."""

    def study(damping_ratio):
        if damping_ratio not in STUDIES:
            STUDIES[damping_ratio] = measure(scene_of(swinging(damping_ratio)))
        return STUDIES[damping_ratio]

    return study


@pytest.mark.parametrize("damping_ratio", [0.0, 0.4])
def test_limits_on_a_case_are_those_of_theory(study_of, damping_ratio):
    study = study_of(damping_ratio)
    assert study.fastest.oscillation == pytest.approx(OMEGA) and study.damping_ratio == pytest.approx(damping_ratio)
    found = {one.method: one for one in study.limits}
    explicit = 2 * (np.hypot(1, damping_ratio) - damping_ratio) / OMEGA
    for method in ("semi_implicit_euler", "spiral"):
        assert found[method].step == pytest.approx(explicit, rel=0.03)
    assert found["kdk"].step == pytest.approx(2 / OMEGA, rel=0.03)
    assert found["rk4"].step == pytest.approx({0.0: 2 * 2**0.5, 0.4: 2.634}[damping_ratio] / OMEGA, rel=0.03)
    for one in study.limits:
        if one.method in ("kdk", "semi_implicit_euler", "rk4", "lie_rk4", "spiral", "dlm"):
            assert one.is_limit and one.theory == pytest.approx(one.step, rel=0.03)


def test_explicit_euler_is_said_to_be_stable_at_no_step(study_of):
    study = study_of(0.0)
    euler = next(one for one in study.limits if one.method == "euler")
    assert euler.step == 0.0 and euler.theory == 0.0
    assert any("stable at no step" in said and "euler" in said for said in notes(study))
    assert "none" in next(line for line in table(study) if line.split()[0] == "euler")


def test_the_table_has_its_columns_and_a_row_for_every_method_with_equal_steps(study_of):
    study = study_of(0.0)
    rows = list(csv.DictReader(as_csv(study).splitlines()))
    assert tuple(rows[0]) == COLUMNS
    assert [row["method"] for row in rows] == [name for name in METHODS if name not in ("exact", "dop853")]
    assert set(study.left_out) == {"exact", "dop853"}
    kdk = next(row for row in rows if row["method"] == "kdk")
    assert float(kdk["step_omega_max"]) == pytest.approx(OMEGA * float(kdk["step"]), rel=1e-12)


def test_where_nothing_swings_is_damped_or_spins_there_is_no_limit(scene_of):
    study = measure(scene_of({"velocity": [1, 0, 0]}, gravity=[0, 0, -9.81]))
    assert study.limits == () and study.fastest.step_limit == np.inf


def test_a_free_spin_limits_what_gains_energy_from_it_and_not_what_keeps_it(scene_of):
    study = measure(scene_of({"angular_velocity": [1, 2, 3]}))
    found = {one.method: one for one in study.limits}
    assert not found["dlm"].is_limit and not found["lie_rk4"].is_limit
    assert found["euler"].step == 0.0 and found["semi_implicit_euler"].step == 0.0
    assert "kdk" in study.left_out


@pytest.mark.parametrize(
    ("method", "expected"), [("kdk", 2.0), ("dlm", 2.0), ("semi_implicit_euler", 2.0), ("rk4", 2.83)]
)
def test_without_spin_and_damping_the_sprung_body_has_the_limit_of_the_table(method, expected):
    assert limit(method) == pytest.approx(expected, rel=0.03)
    assert METHODS[method].oscillation_limit == pytest.approx(stable_step(method, 1.0, 0.0), rel=2e-3)


@pytest.mark.parametrize("damping_ratio", [0.1, 0.5, 1.0])
def test_an_explicit_dashpot_costs_step_and_an_implicit_one_does_not(damping_ratio):
    rule = 2 * (np.hypot(1, damping_ratio) - damping_ratio)
    assert limit("spiral", damping_ratio) == pytest.approx(rule, rel=0.03)
    assert limit("semi_implicit_euler", damping_ratio) == pytest.approx(rule, abs=0.04)
    assert limit("kdk", damping_ratio) == pytest.approx(2.0, rel=0.03)


def test_a_spin_of_a_third_ruins_the_world_frame_euler_and_not_the_exact_rotor():
    assert limit("semi_implicit_euler", spin_ratio=0.3) < 0.4
    assert limit("kdk", spin_ratio=0.3) == pytest.approx(1.96, abs=0.04)


@pytest.mark.parametrize("name", [name for name in METHODS if name != "exact"])
def test_the_limits_of_the_table_are_those_of_the_matrix_of_a_step(name):
    assert stable_step(name, 3.0, 0.0) * 3.0 == pytest.approx(METHODS[name].oscillation_limit, abs=0.01)


def test_damping_alone_limits_an_explicit_step_to_two_over_its_rate_and_the_implicit_one_not_at_all():
    assert stable_step("euler", 0.0, 5.0) == pytest.approx(2 / 10, rel=3e-3)
    assert stable_step("kdk", 0.0, 5.0) == np.inf
    assert stable_step("rk4", 0.0, 0.0) == np.inf


def test_the_search_comes_to_half_a_percent():
    assert longest_stable(lambda step: step <= 0.731, 0.01, 10.0) == pytest.approx(0.731, rel=0.006)


def test_the_picture_has_a_bar_for_every_method_and_two_maps_for_each_that_is_shown(study_of):
    study = study_of(0.4)
    empty = np.zeros((len(RATIOS), len(SWINGS_SHOWN)))
    figure = draw(study, dict.fromkeys(SHOWN, (empty, empty)))
    bars, *panels = figure.axes
    assert [label.get_text() for label in bars.get_yticklabels()] == [one.method for one in study.limits]
    assert len(panels) == 2 * len(SHOWN)
    told = "\n".join(text.get_text() for text in figure.texts)
    assert "A reference body, not this case" in told


def test_the_number_of_a_bar_stands_at_the_end_of_its_own_bar(study_of):
    study = study_of(0.4)
    empty = np.zeros((len(RATIOS), len(SWINGS_SHOWN)))
    bars = draw(study, dict.fromkeys(SHOWN, (empty, empty))).axes[0]
    place_of = {round(text.get_position()[1]): text.get_position()[0] for text in bars.texts}
    ends = {place: one.step * study.rate for place, one in enumerate(study.limits) if one.step}
    assert all(place_of[place] == pytest.approx(end, rel=0.15) for place, end in ends.items())
