"""A body that nothing pushes but uniform gravity: no wrench, no ledger, no neighbour, everything in local numbers."""

import math

from rbfem.motion.euler_equations import quaternion_rate_world, rotation_rates
from rbfem.motion.model import (
    IS_SYMPLECTIC_EULER,
    IS_WORLD,
    NORMALIZES,
    POSITION,
    QUATERNION,
    SPHERICAL,
    SPIN,
    TRANSLATING,
    VELOCITY,
)


def coast(b, dt, n_steps, nodes, weights, flags, state, bodies, gravity):
    """The steps of `step_by_runge_kutta` for body b when its translation is a parabola and its rotation is torque-free.

    The same formulas as in the general stepper with the wrench left out; the tests hold the two against each other.
    """
    lag = 0.0  # Σ weights nodes: how much of g dt² the position sees within a step
    for stage in range(len(weights)):
        lag += weights[stage] * nodes[stage]
    if flags[IS_SYMPLECTIC_EULER]:
        lag = 1.0
    # Σ over the steps k of dt (v + k dt g + lag dt g), added up in closed form: a million additions would round.
    duration, fallen = n_steps * dt, dt * dt * n_steps * (0.5 * (n_steps - 1) + lag)
    for j in range(3):
        state[b, POSITION + j] += duration * state[b, VELOCITY + j] + fallen * gravity[j]
        state[b, VELOCITY + j] += duration * gravity[j]
    if bodies.model[b] != TRANSLATING:
        spin(b, dt, n_steps, nodes, weights, flags, state, bodies)


def spin(b, dt, n_steps, nodes, weights, flags, state, bodies):
    """Torque-free rotation of body b by n_steps steps."""
    r1, r2, r3 = bodies.inverse_moments[b, 0], bodies.inverse_moments[b, 1], bodies.inverse_moments[b, 2]
    is_spherical = bodies.model[b] == SPHERICAL
    q0, q1 = state[b, QUATERNION], state[b, QUATERNION + 1]
    q2, q3 = state[b, QUATERNION + 2], state[b, QUATERNION + 3]
    x, y, z = state[b, SPIN], state[b, SPIN + 1], state[b, SPIN + 2]
    for _ in range(n_steps):
        s0, s1, s2, s3, sx, sy, sz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        k0, k1, k2, k3, kx, ky, kz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for stage in range(len(weights)):
            h = nodes[stage] * dt
            k0, k1, k2, k3, kx, ky, kz = rotation_rates(
                flags[IS_WORLD],
                q0 + h * k0,
                q1 + h * k1,
                q2 + h * k2,
                q3 + h * k3,
                x + h * kx,
                y + h * ky,
                z + h * kz,
                r1,
                r2,
                r3,
                0.0,
                0.0,
                0.0,
                is_spherical,
            )
            w = weights[stage] * dt
            s0, s1, s2, s3 = s0 + w * k0, s1 + w * k1, s2 + w * k2, s3 + w * k3
            sx, sy, sz = sx + w * kx, sy + w * ky, sz + w * kz
        x, y, z = x + sx, y + sy, z + sz
        if flags[IS_SYMPLECTIC_EULER]:
            s0, s1, s2, s3 = quaternion_rate_world(q0, q1, q2, q3, dt * x, dt * y, dt * z)
        q0, q1, q2, q3 = q0 + s0, q1 + s1, q2 + s2, q3 + s3
        if flags[NORMALIZES]:
            scale = 1.0 / math.sqrt(q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)
            q0, q1, q2, q3 = q0 * scale, q1 * scale, q2 * scale, q3 * scale
    state[b, QUATERNION], state[b, QUATERNION + 1] = q0, q1
    state[b, QUATERNION + 2], state[b, QUATERNION + 3] = q2, q3
    state[b, SPIN], state[b, SPIN + 1], state[b, SPIN + 2] = x, y, z
