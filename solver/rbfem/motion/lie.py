"""The commutator-free Runge-Kutta method of order four on the group of rotations.

Attitudes are composed of exponentials of rates in body axes, so the quaternion stays one; the angular momentum is that
in world axes, whose rate is the torque alone.
Source: Celledoni, Marthinsen, Owren, Future Generation Computer Systems 19:341, 2003.
"""

from rbfem.compute.loops import parallel_range
from rbfem.motion.loads import find_omega, find_wrench
from rbfem.motion.model import (
    LEDGER_WIDTH,
    POSITION,
    QUATERNION,
    SPIN,
    STATE_WIDTH,
    TRANSLATING,
    VELOCITY,
)
from rbfem.motion.rotation import exp, multiply, rotate, rotate_back, rotation_change
from rbfem.motion.runge_kutta import find_flow
from rbfem.motion.sums import add, add_turn, normalize

STAGES = 4


def step_on_group(state, ledger, t, dt, n_steps, bodies, loads, islands, gravity, scratch):
    """Take n_steps steps of dt from time t, in place; the arguments are those of `step_by_runge_kutta`."""
    for island in parallel_range(len(islands.first) - 1):
        first, last = islands.first[island], islands.first[island + 1]
        for s in range(n_steps):
            for stage in range(STAGES):
                share = 0.0 if stage == 0 else (1.0 if stage == 3 else 0.5)
                for i in range(first, last):
                    enter_group_stage(islands.member[i], stage, share * dt, dt, state, bodies, scratch)
                for i in range(first, last):
                    find_group_rates(islands.member[i], stage, t + (s + share) * dt, bodies, loads, gravity, scratch)
            for i in range(first, last):
                leave_group_step(islands.member[i], dt, state, ledger, bodies, scratch)
        for i in range(first, last):
            if bodies.model[islands.member[i]] != TRANSLATING:
                normalize(islands.member[i], state, scratch.rest)


def enter_group_stage(b, stage, shift, dt, state, bodies, scratch):
    """Stage state: y + shift k of the stage before, but the attitude as the exponentials give it."""
    for j in range(STATE_WIDTH):
        scratch.stage[b, j] = state[b, j]
    if stage > 0:
        for j in range(3):
            scratch.stage[b, POSITION + j] += shift * scratch.rate[b, stage - 1, POSITION + j]
            scratch.stage[b, VELOCITY + j] += shift * scratch.rate[b, stage - 1, VELOCITY + j]
        if bodies.model[b] != TRANSLATING:
            turn_stage(b, stage, shift, dt, state, scratch)
    find_omega(b, bodies, scratch.stage, scratch.omega)


def turn_stage(b, stage, shift, dt, state, scratch):
    """Attitudes q exp(½h k₁), q exp(½h k₂) and q exp(½h k₁) exp(h (k₃ - ½ k₁)), and L in their body axes."""
    q0, q1 = state[b, QUATERNION], state[b, QUATERNION + 1]
    q2, q3 = state[b, QUATERNION + 2], state[b, QUATERNION + 3]
    lx, ly, lz = rotate(q0, q1, q2, q3, state[b, SPIN], state[b, SPIN + 1], state[b, SPIN + 2])
    lx += shift * scratch.rate[b, stage - 1, SPIN]
    ly += shift * scratch.rate[b, stage - 1, SPIN + 1]
    lz += shift * scratch.rate[b, stage - 1, SPIN + 2]
    first = 0 if stage == 3 else stage - 1
    q0, q1, q2, q3 = turned(
        q0, q1, q2, q3,
        0.5 * dt * scratch.rate[b, first, QUATERNION],
        0.5 * dt * scratch.rate[b, first, QUATERNION + 1],
        0.5 * dt * scratch.rate[b, first, QUATERNION + 2],
    )  # fmt: skip
    if stage == 3:
        q0, q1, q2, q3 = turned(
            q0, q1, q2, q3,
            dt * (scratch.rate[b, 2, QUATERNION] - 0.5 * scratch.rate[b, 0, QUATERNION]),
            dt * (scratch.rate[b, 2, QUATERNION + 1] - 0.5 * scratch.rate[b, 0, QUATERNION + 1]),
            dt * (scratch.rate[b, 2, QUATERNION + 2] - 0.5 * scratch.rate[b, 0, QUATERNION + 2]),
        )  # fmt: skip
    set_attitude(b, q0, q1, q2, q3, scratch.stage)
    x, y, z = rotate_back(q0, q1, q2, q3, lx, ly, lz)
    scratch.stage[b, SPIN], scratch.stage[b, SPIN + 1], scratch.stage[b, SPIN + 2] = x, y, z


def turned(q0, q1, q2, q3, x, y, z):
    """q exp(v): a further turn by the rotation vector v in body axes.

    >>> turned(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    (1.0, 0.0, 0.0, 0.0)
    """
    e0, e1, e2, e3 = exp(x, y, z)
    return multiply(q0, q1, q2, q3, e0, e1, e2, e3)


def set_attitude(b, q0, q1, q2, q3, rows):
    """Write a quaternion into a row."""
    rows[b, QUATERNION], rows[b, QUATERNION + 1] = q0, q1
    rows[b, QUATERNION + 2], rows[b, QUATERNION + 3] = q2, q3


def find_group_rates(b, stage, t, bodies, loads, gravity, scratch):
    """Velocity, acceleration, ω in body axes and the torque in world axes."""
    find_wrench(b, t, bodies, loads, gravity, scratch.stage, scratch.omega, scratch.wrench)
    for j in range(3):
        if bodies.inverse_mass[b] > 0.0:
            scratch.rate[b, stage, POSITION + j] = scratch.stage[b, VELOCITY + j]
            scratch.rate[b, stage, VELOCITY + j] = gravity[j] + bodies.inverse_mass[b] * scratch.wrench[b, j]
        scratch.rate[b, stage, QUATERNION + j] = bodies.inverse_moments[b, j] * scratch.stage[b, SPIN + j]
        scratch.rate[b, stage, SPIN + j] = scratch.wrench[b, 3 + j]
    find_flow(b, stage, bodies, gravity, scratch)


def leave_group_step(b, dt, state, ledger, bodies, scratch):
    """The classical weights for what is added, two exponentials for the attitude.

    L in world axes changes by an impulse alone; in body axes it changes by that impulse, turned there, and by what the
    turn of the axes makes of the sum.
    """
    for j in range(3):
        add(b, POSITION + j, dt * classical_mean(b, POSITION + j, scratch.rate), state, scratch.rest)
        add(b, VELOCITY + j, dt * classical_mean(b, VELOCITY + j, scratch.rate), state, scratch.rest)
    for j in range(LEDGER_WIDTH if bodies.is_pushed[b] else 0):
        ledger[b, j] += dt * classical_mean(b, j, scratch.flow)
    if bodies.model[b] == TRANSLATING:
        return
    q0, q1 = state[b, QUATERNION], state[b, QUATERNION + 1]
    q2, q3 = state[b, QUATERNION + 2], state[b, QUATERNION + 3]
    ix = dt * classical_mean(b, SPIN, scratch.rate)
    iy = dt * classical_mean(b, SPIN + 1, scratch.rate)
    iz = dt * classical_mean(b, SPIN + 2, scratch.rate)
    ix, iy, iz = rotate_back(q0, q1, q2, q3, ix, iy, iz)
    t0, t1, t2, t3 = 1.0, 0.0, 0.0, 0.0
    for outer in range(2):
        near, far = (3.0, -1.0) if outer == 0 else (-1.0, 3.0)
        x = group_mean(b, 0, near, far, scratch.rate)
        y = group_mean(b, 1, near, far, scratch.rate)
        z = group_mean(b, 2, near, far, scratch.rate)
        t0, t1, t2, t3 = turned(t0, t1, t2, t3, dt * x, dt * y, dt * z)
    add_turn(b, t0, t1, t2, t3, state, scratch.rest)
    x, y, z = state[b, SPIN] + ix, state[b, SPIN + 1] + iy, state[b, SPIN + 2] + iz
    x, y, z = rotation_change(t0, -t1, -t2, -t3, x, y, z)
    add(b, SPIN, ix + x, state, scratch.rest)
    add(b, SPIN + 1, iy + y, state, scratch.rest)
    add(b, SPIN + 2, iz + z, state, scratch.rest)


def classical_mean(b, j, rate):
    """(k₁ + 2 k₂ + 2 k₃ + k₄)/6 of column j."""
    return (rate[b, 0, j] + 2.0 * (rate[b, 1, j] + rate[b, 2, j]) + rate[b, 3, j]) / 6.0


def group_mean(b, j, near, far, rate):
    """(near k₁ + 2 k₂ + 2 k₃ + far k₄)/12 of the rate of rotation about body axis j."""
    j = QUATERNION + j
    return (near * rate[b, 0, j] + 2.0 * (rate[b, 1, j] + rate[b, 2, j]) + far * rate[b, 3, j]) / 12.0
