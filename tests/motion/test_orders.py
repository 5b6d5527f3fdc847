"""Each method reaches the order that its row of the table states, on loads of every kind."""

import functools

import numpy as np
import pytest
from motion_reference import reference_motion
from motion_scenes import (
    CYLINDER_MOMENTS,
    box_in_drag,
    build,
    forced_cylinder,
    heavy_top,
    satellite,
    sprung_box,
    swinging_box,
    two_sprung_boxes,
)

from rbfem.motion import quaternion
from rbfem.motion.methods import METHODS, Splitting
from rbfem.motion.state import move

UNDAMPED = (heavy_top, swinging_box, satellite)
DAMPED = (sprung_box, box_in_drag, two_sprung_boxes)
METHODS_WITH_A_STEP = [name for name, row in METHODS.items() if not (row.needs_free_bodies or row.is_adaptive)]
SPLITTINGS = [
    name for name in METHODS_WITH_A_STEP if isinstance(METHODS[name].scheme, Splitting) and METHODS[name].flies_exactly
]
# Steps over the whole time: enough to be where the error is one power, few enough to stay above rounding.
STEPS = {
    (heavy_top, 1): (8000, 16000, 32000, 64000),
    (heavy_top, 4): (100, 140, 200, 280),
    (heavy_top, "rkn4"): (3, 4, 5, 6),
    (heavy_top, "aba864"): (3, 4, 5, 6),
    (two_sprung_boxes, 4): (80, 112, 160, 224),
    (forced_cylinder, 4): (8, 11, 16, 22),
    (forced_cylinder, 8): (5, 6, 7, 8),
    (box_in_drag, 8): (6, 7, 8, 9),
}
USUAL_STEPS = {
    1: (1000, 2000, 4000, 8000),
    2: (100, 140, 200, 280),
    4: (20, 28, 40, 56),
    6: (8, 10, 12, 14),
    8: (12, 14, 16, 18),
}
# A slope may be so far from its order; the eighth has but a factor of two between rounding and the next power.
FARTHEST = {8: 0.5}
# Two steps of rkn6 bring the top to 2e-12 rad, the third to rounding: no slope can be fitted there.
TOO_GOOD = {(heavy_top, "rkn6")}


@functools.cache
def reference_of(scene):
    return reference_motion(scene())


def error_after(scene, method, n_steps, reference):
    """Largest error of a position (m) or an attitude (rad) of any body at the end."""
    system, state = build(scene())
    state = move(state, scene().end / n_steps, n_steps, method, system, "serial")
    attitude = quaternion.normalize(state.quaternion)
    angle = quaternion.angle_between(attitude, reference[:, 3:7])
    return max(angle.max(), np.abs(state.position - reference[:, :3]).max())


def fitted_slope(error, steps):
    return -np.polyfit(np.log(steps), np.log([error(n) for n in steps]), 1)[0]


def steps_of(scene, method, order):
    return STEPS.get((scene, method)) or STEPS.get((scene, order), USUAL_STEPS[order])


def slope_of(scene, method, order):
    steps = steps_of(scene, method, order)
    return fitted_slope(lambda n: error_after(scene, method, n, reference_of(scene)), steps)


@pytest.mark.parametrize("method", METHODS_WITH_A_STEP)
@pytest.mark.parametrize("scene", UNDAMPED, ids=lambda scene: scene.__name__)
def test_error_falls_with_the_order_the_table_states(method, scene):
    if (scene, method) in TOO_GOOD:
        steps = (1, 2)
        assert max(error_after(scene, method, n, reference_of(scene)) for n in steps) < 1e-9
        return
    order = METHODS[method].order
    assert slope_of(scene, method, order) == pytest.approx(order, abs=FARTHEST.get(order, 0.2))


@pytest.mark.parametrize("method", METHODS_WITH_A_STEP)
@pytest.mark.parametrize("scene", DAMPED, ids=lambda scene: scene.__name__)
def test_where_dampers_act_the_error_falls_with_the_damped_order_of_the_table(method, scene):
    order = METHODS[method].damped_order
    assert slope_of(scene, method, order) == pytest.approx(order, abs=FARTHEST.get(order, 0.2))


def rates_of_the_cylinder(t):
    """Body angular velocity of `forced_cylinder` in closed form."""
    (axial, across), torque = CYLINDER_MOMENTS, 0.025
    x, y, z = 0.3, -0.9, 0.6
    phase = (across - axial) / across * (x * t + torque * t * t / (2 * axial))
    return np.array(
        [x + torque * t / axial, y * np.cos(phase) + z * np.sin(phase), -y * np.sin(phase) + z * np.cos(phase)]
    )


def error_of_the_cylinder(method, n_steps):
    system, state = build(forced_cylinder())
    state = move(state, 0.7 / n_steps, n_steps, method, system, "serial")
    omega = state.angular_momentum * system.bodies.inverse_moments
    return np.abs(omega - rates_of_the_cylinder(0.7)).max()


@pytest.mark.parametrize("method", [name for name in METHODS_WITH_A_STEP if name not in (*SPLITTINGS, "spiral")])
def test_the_rates_of_a_forced_cylinder_converge_to_their_closed_form(method):
    order = METHODS[method].order
    slope = fitted_slope(lambda n: error_of_the_cylinder(method, n), steps_of(forced_cylinder, method, order))
    assert slope == pytest.approx(order, abs=FARTHEST.get(order, 0.2))


@pytest.mark.parametrize("method", SPLITTINGS)
def test_a_splitting_with_the_exact_rotor_leaves_rounding_of_a_forced_cylinder(method):
    """The phase is the integral of a spin that grows linearly: kicks in a palindrome have it exactly."""
    assert error_of_the_cylinder(method, 4) < 1e-14
