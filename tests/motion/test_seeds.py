"""The two baseline methods are the published ones, number for number: both are written out again here in NumPy."""

import numpy as np
import pytest
from motion_scenes import GRAVITY, Body, Load, Setting, build

from rbfem.motion import loads as kinds
from rbfem.motion import quaternion
from rbfem.motion.state import angular_velocity_world, move

FORCE, TORQUE = np.array([3.0, -1.0, 2.0]), np.array([0.7, -0.4, 1.1])
RAMP = ((0.0, 0.1), (0.9, 1.7))
MASS, MOMENTS = 2.0, (1.0, 2.0, 2.5)
DT, N_STEPS = 0.01, 100


def share_at(t):
    return np.interp(t, *np.transpose(RAMP))


def quaternion_product(a, b):
    scalar = a[0] * b[0] - a[1:] @ b[1:]
    return np.concatenate([[scalar], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])])


class RigidBody:
    """The class of "FEM for Rigid Body Dynamics", 20 April 2026: world axes throughout."""

    def __init__(self, mass, inertia, x, v, q, omega):
        self.M, self.I0 = mass, inertia
        self.x_cm, self.v_cm, self.q, self.omega = x.copy(), v.copy(), q.copy(), omega.copy()

    def rotation(self):
        w, x, y, z = self.q
        return np.array(
            [
                [1 - 2 * (y**2 + z**2), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x**2 + z**2), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x**2 + y**2)],
            ]
        )

    def step(self, force, torque, dt):
        self.v_cm += force / self.M * dt
        self.x_cm += self.v_cm * dt
        inertia = self.rotation() @ self.I0 @ self.rotation().T
        acceleration = np.linalg.solve(inertia, torque - np.cross(self.omega, inertia @ self.omega))
        self.omega += acceleration * dt
        self.q += 0.5 * quaternion_product(np.r_[0.0, self.omega], self.q) * dt
        self.q /= np.linalg.norm(self.q)


def rigid_body_rate(t, y):
    """dy/dt of the 13 components of "Rigid body game physics", 24 October 2019: c, q, v, ω, the quaternion as it is."""
    q, v, omega = y[3:7], y[7:10], y[10:]
    bar = q * [1, -1, -1, -1]
    columns = [quaternion_product(quaternion_product(q, np.r_[0.0, unit]), bar)[1:] for unit in np.eye(3)]
    R = np.transpose(columns)
    inertia = R @ np.diag(MOMENTS) @ R.T
    acceleration = np.linalg.solve(inertia, share_at(t) * TORQUE - np.cross(omega, inertia @ omega))
    spin = 0.5 * quaternion_product(np.r_[0.0, omega], q)
    return np.concatenate([v, spin, share_at(t) * FORCE / MASS + GRAVITY, acceleration])


def runge_kutta_step(t, h, y):
    k1 = h * rigid_body_rate(t, y)
    k2 = h * rigid_body_rate(t + h / 2, y + k1 / 2)
    k3 = h * rigid_body_rate(t + h / 2, y + k2 / 2)
    k4 = h * rigid_body_rate(t + h, y + k3)
    return y + (k1 + 2 * k2 + 2 * k3 + k4) / 6


@pytest.fixture
def pushed_body():
    loads = (Load(kinds.FORCE, tuple(FORCE), RAMP), Load(kinds.COUPLE, tuple(TORQUE), RAMP))
    body = Body(MASS, MOMENTS, (0.1, 0.2, 0.3), (0.8, -0.1, 0.5, 0.3), (1.0, 0.5, -0.2), (2.0, -1.0, 3.0), loads=loads)
    return build(Setting((body,), GRAVITY))


def test_semi_implicit_euler_is_the_published_class(pushed_body):
    system, state = pushed_body
    omega = angular_velocity_world(state, system.bodies)[0]
    seed = RigidBody(MASS, np.diag(MOMENTS), state.position[0], state.velocity[0], state.quaternion[0], omega)
    for step in range(N_STEPS):
        share = share_at(step * DT)
        seed.step(share * FORCE + MASS * GRAVITY, share * TORQUE, DT)
    end = move(state, DT, N_STEPS, "semi_implicit_euler", system, "python")
    assert np.abs(end.position[0] - seed.x_cm).max() < 1e-12
    assert np.abs(end.velocity[0] - seed.v_cm).max() < 1e-12
    assert np.abs(end.quaternion[0] - seed.q).max() < 1e-12
    assert np.abs(angular_velocity_world(end, system.bodies)[0] - seed.omega).max() < 1e-12


def test_rk4_world_is_the_published_step_and_leaves_the_quaternion_as_it_comes_out(pushed_body):
    system, state = pushed_body
    y = np.concatenate(
        [state.position[0], state.quaternion[0], state.velocity[0], angular_velocity_world(state, system.bodies)[0]]
    )
    for step in range(N_STEPS):
        y = runge_kutta_step(step * DT, DT, y)
    end = move(state, DT, N_STEPS, "rk4_world", system, "python")
    assert np.abs(end.position[0] - y[:3]).max() < 1e-12
    assert np.abs(end.quaternion[0] - y[3:7]).max() < 1e-12
    assert np.abs(end.velocity[0] - y[7:10]).max() < 1e-12
    assert np.abs(angular_velocity_world(end, system.bodies)[0] - y[10:]).max() < 1e-12
    assert 1e-12 < abs(np.linalg.norm(end.quaternion[0]) - 1.0) < 1e-6


@pytest.mark.parametrize("method", ["rk4", "semi_implicit_euler", "euler"])
def test_the_other_methods_keep_the_quaternion_at_unit_length(pushed_body, method):
    system, state = pushed_body
    end = move(state, DT, N_STEPS, method, system, "python")
    assert np.linalg.norm(end.quaternion[0]) == pytest.approx(1.0, abs=1e-15)


def test_both_baselines_go_to_the_same_motion(pushed_body):
    system, state = pushed_body
    fine = move(state, DT, N_STEPS, "rk4_world", system, "python")
    coarse = move(state, DT / 10, 10 * N_STEPS, "semi_implicit_euler", system, "python")
    assert 1e-5 < quaternion.angle_between(coarse.quaternion, quaternion.normalize(fine.quaternion))[0] < 0.1
