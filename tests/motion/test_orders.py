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
    sprung_box,
    two_sprung_boxes,
)

from rbfem.motion import quaternion
from rbfem.motion.methods import METHODS
from rbfem.motion.state import move

SCENES = (heavy_top, sprung_box, box_in_drag, two_sprung_boxes)
# Steps over the whole time: enough to be where the error is one power, few enough to stay above rounding.
STEPS = {
    (heavy_top, 4): (100, 140, 200, 280),
    (heavy_top, 1): (8000, 16000, 32000, 64000),
    (two_sprung_boxes, 4): (80, 112, 160, 224),
    (forced_cylinder, 4): (8, 11, 16, 22),
}
USUAL_STEPS = {1: (1000, 2000, 4000, 8000), 4: (20, 28, 40, 56)}


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


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.__name__)
def test_error_falls_with_the_order_the_table_states(method, scene):
    order = METHODS[method].order
    steps = STEPS.get((scene, order), USUAL_STEPS[order])
    slope = fitted_slope(lambda n: error_after(scene, method, n, reference_of(scene)), steps)
    assert slope == pytest.approx(order, abs=0.2)


def rates_of_the_cylinder(t):
    """Body angular velocity of `forced_cylinder` in closed form."""
    (axial, across), torque = CYLINDER_MOMENTS, 0.025
    x, y, z = 0.3, -0.9, 0.6
    phase = (across - axial) / across * (x * t + torque * t * t / (2 * axial))
    return np.array(
        [x + torque * t / axial, y * np.cos(phase) + z * np.sin(phase), -y * np.sin(phase) + z * np.cos(phase)]
    )


@pytest.mark.parametrize("method", METHODS)
def test_the_rates_of_a_forced_cylinder_converge_to_their_closed_form(method):
    def error(n_steps):
        system, state = build(forced_cylinder())
        state = move(state, 0.7 / n_steps, n_steps, method, system, "serial")
        omega = state.angular_momentum * system.bodies.inverse_moments
        return np.abs(omega - rates_of_the_cylinder(0.7)).max()

    order = METHODS[method].order
    slope = fitted_slope(error, STEPS.get((forced_cylinder, order), USUAL_STEPS[order]))
    assert slope == pytest.approx(order, abs=0.2)
