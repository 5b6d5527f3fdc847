"""Motions whose numbers are known from elsewhere, with rk4."""

import numpy as np
import pytest
from motion_scenes import GRAVITY, Body, Setting, build, forced_cylinder, heavy_top

from rbfem.motion import quaternion
from rbfem.motion.state import angular_velocity_world, move


def run(setting, end, n_steps, method="rk4"):
    system, state = build(setting)
    return system, move(state, end / n_steps, n_steps, method, system, "serial")


def body_rates(system, state):
    return (state.angular_momentum * system.bodies.inverse_moments)[0]


# The table of verification case "heavy top" (Géradin, Cardona, Flexible Multibody Dynamics, 2001; Brüls, Cardona,
# Arnold, Mech. Mach. Theory 48:121, 2012; numbers computed in two independent ways):
# t; centre of mass; quaternion, scalar first; body rate x, z.
HEAVY_TOP = [
    (0.2, (0.60555056138, 0.59895768180, -0.52398302743),
     (-0.708279152974, 0.438781088127, 0.545728396145, 0.089399752824), (-2.6915909121, 4.9172609899)),
    (1.0, (0.17334396410, 0.64008859207, -0.74849079113),
     (0.732943980680, -0.278285719338, 0.531824611334, -0.320176142736), (-0.8220781017, -5.9232913481)),
    (2.0, (-0.15041682275, -0.72416559164, -0.67302226956),
     (0.122947135042, -0.491079892551, 0.350430030343, -0.787986887550), (0.1222332195, -5.8556245892)),
]  # fmt: skip


@pytest.mark.parametrize(("end", "center", "attitude", "rates"), HEAVY_TOP, ids=["0.2 s", "1 s", "2 s"])
def test_the_heavy_top_is_where_the_table_has_it(end, center, attitude, rates):
    # Tolerances are three times the largest error of the rows: 2.1e-12, 5e-12, 5.5e-11, the table's own digits.
    system, state = run(heavy_top(), end, round(end / 1e-5))
    q = state.quaternion[0]
    assert min(np.abs(q - attitude).max(), np.abs(q + attitude).max()) < 6e-12
    assert np.abs(quaternion.rotate(q, [0.0, 1.0, 0.0]) - center).max() < 1.5e-11
    omega = body_rates(system, state)
    assert omega[[0, 2]] == pytest.approx(rates, abs=1.6e-10)
    assert omega[1] == pytest.approx(150.0, abs=1e-11)
    assert (state.position == 0.0).all() and (state.velocity == 0.0).all()


def test_the_energy_of_the_heavy_top_is_kept():
    system, state = run(heavy_top(), 0.2, 20_000)
    kinetic = 0.5 * float(body_rates(system, state) @ state.angular_momentum[0])
    potential = 15.0 * 9.81 * quaternion.rotate(state.quaternion[0], [0.0, 1.0, 0.0])[2]
    assert kinetic + potential == pytest.approx(5435.69679086544, rel=1e-13)


DZHANIBEKOV = Setting((Body(1.0, (1.0, 2.0, 3.0), omega=(0.01, 1.0, 0.01)),))


def test_a_body_turns_over_about_its_middle_axis_when_jacobi_says():
    # Period and rates at 10 s of the torque-free body with moments 1, 2, 3: elliptic functions.
    _, state = run(DZHANIBEKOV, 10.0, 10_000)
    rates = state.angular_momentum[0] / [1.0, 2.0, 3.0]
    assert rates == pytest.approx((-0.874573437891, 0.484996187341, 0.505001220548), abs=1e-12)
    _, state = run(DZHANIBEKOV, 39.105734197288, 40_000)
    assert state.angular_momentum[0] / [1.0, 2.0, 3.0] == pytest.approx((0.01, 1.0, 0.01), abs=1e-12)


def test_a_cylinder_under_a_constant_torque_has_its_closed_rates():
    system, state = run(forced_cylinder(), 0.7, 700)
    expected = (1.83336375279934, -0.61916767865276, 0.88692242372811)
    assert body_rates(system, state) == pytest.approx(expected, abs=1e-12)


def test_a_pendulum_is_at_the_bottom_after_a_quarter_period():
    # IFToMM benchmark A01: a point mass at 1 m, let go from the horizontal, has the period 2.367841947576 s.
    pendulum = Body(1.0, (1e-3, 1.0, 1.0), arm=(1.0, 0.0, 0.0), is_held=True)
    _, state = run(Setting((pendulum,), GRAVITY), 2.367841947576 / 4, 2000)
    down = quaternion.rotate(state.quaternion[0], [1.0, 0.0, 0.0])
    assert down == pytest.approx((0.0, 0.0, -1.0), abs=1e-11)
    assert abs(state.angular_momentum[0, 1]) == pytest.approx(np.sqrt(2 * 9.81), rel=1e-11)


def test_a_thrown_body_flies_a_parabola():
    thrown = Body(velocity=(1.0, 2.0, 3.0), position=(0.5, 0.0, 1.0), omega=(1.0, 2.0, 3.0))
    _, state = run(Setting((thrown,), GRAVITY), 1.5, 100)
    assert state.position[0] == pytest.approx((2.0, 3.0, 1.0 + 4.5 - 0.5 * 9.81 * 2.25), abs=1e-13)
    assert state.velocity[0] == pytest.approx((1.0, 2.0, 3.0 - 9.81 * 1.5), abs=1e-13)


@pytest.mark.parametrize("axis", range(3))
def test_a_constant_spin_is_the_exponential(axis):
    omega = 4.0 * np.eye(3)[axis]
    start = quaternion.normalize([0.3, -0.2, 0.8, 0.4])
    system, state = run(Setting((Body(omega=tuple(omega), attitude=tuple(start)),)), 2.0, 2000)
    # The measured error is 4e-13: rk4's phase error (ω dt/2)^5/120 a step.
    expected = quaternion.product(start, quaternion.exp(2.0 * omega))
    assert quaternion.angle_between(state.quaternion[0], expected) < 2e-12
    assert angular_velocity_world(state, system.bodies)[0] == pytest.approx(quaternion.rotate(start, omega), abs=1e-12)
