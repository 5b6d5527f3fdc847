"""The stepper: any number of bodies, any number of steps, any method of the table, in one call."""

import math

import numpy as np
from numpy.typing import NDArray

from rbfem.compute.loops import parallel_range
from rbfem.motion.coasting import coast
from rbfem.motion.euler_equations import quaternion_rate_world, rotation_rates
from rbfem.motion.loads import add_loads, to_world
from rbfem.motion.model import (
    ANGULAR_IMPULSE,
    IMPULSE,
    LEDGER_WIDTH,
    POSITION,
    QUATERNION,
    SPHERICAL,
    SPIN,
    STATE_WIDTH,
    TRANSLATING,
    VELOCITY,
    WORK,
)
from rbfem.motion.rotation import cross, rotate_back

Array = NDArray[np.float64]


def advance(state, ledger, t, dt, n_steps, nodes, weights, flags, bodies, loads, islands, gravity, scratch):
    """Take n_steps steps of dt from time t, in place.

    state  : (n, 13) stacked rows, see `model`      ledger : (n, 7), since the start of the run
    nodes, weights : (stages,) of the method        flags : (3,) int64: is_world, is_symplectic_euler, normalizes
    bodies, loads, islands, scratch : the arrays of `model`; scratch.stage holds the state of the bodies that never move
    gravity : (3,) m/s^2
    """
    for island in parallel_range(len(islands.first) - 1):
        first, last = islands.first[island], islands.first[island + 1]
        if not bodies.is_pushed[islands.member[first]]:
            coast(islands.member[first], dt, n_steps, nodes, weights, flags, state, bodies, gravity)
        else:
            for s in range(n_steps):
                now = t + s * dt
                take_step(
                    first, last, now, dt, nodes, weights, flags, state, ledger, bodies, loads, islands, gravity, scratch
                )


def take_step(first, last, t, dt, nodes, weights, flags, state, ledger, bodies, loads, islands, gravity, scratch):
    """One step of the bodies islands.member[first:last], which see each other's stages."""
    for stage in range(len(weights)):
        shift = nodes[stage] * dt
        for i in range(first, last):
            enter_stage(islands.member[i], shift, stage, state, flags, bodies, scratch)
        for i in range(first, last):
            find_rates(islands.member[i], t + shift, flags, bodies, loads, gravity, scratch)
            sum_up(islands.member[i], weights[stage], stage, scratch)
    for i in range(first, last):
        leave_step(islands.member[i], dt, state, ledger, flags, bodies, scratch)


def enter_stage(b, shift, stage, state, flags, bodies, scratch):
    """Stage state y + shift k of the last stage, and the angular velocity that the loads will read."""
    for j in range(STATE_WIDTH):
        scratch.stage[b, j] = state[b, j]
    if stage > 0:
        for j in range(STATE_WIDTH):
            scratch.stage[b, j] += shift * scratch.rate[b, j]
    if bodies.model[b] != TRANSLATING:
        x, y, z = scratch.stage[b, SPIN], scratch.stage[b, SPIN + 1], scratch.stage[b, SPIN + 2]
        if not flags[0]:
            i1, i2, i3 = bodies.inverse_moments[b, 0], bodies.inverse_moments[b, 1], bodies.inverse_moments[b, 2]
            x, y, z = to_world(b, x * i1, y * i2, z * i3, scratch.stage)
        scratch.omega[b, 0], scratch.omega[b, 1], scratch.omega[b, 2] = x, y, z


def find_rates(b, t, flags, bodies, loads, gravity, scratch):
    """Newton-Euler: the rate of every column of the stage, and of the ledger."""
    for j in range(STATE_WIDTH):
        scratch.wrench[b, j] = 0.0
    add_loads(b, t, bodies, loads, scratch.stage, scratch.omega, scratch.wrench)
    if bodies.inverse_mass[b] > 0.0:
        for j in range(3):
            scratch.rate[b, POSITION + j] = scratch.stage[b, VELOCITY + j]
            scratch.rate[b, VELOCITY + j] = gravity[j] + bodies.inverse_mass[b] * scratch.wrench[b, j]
    else:
        add_weight_on_arm(b, bodies, gravity, scratch)
    find_flow(b, bodies, gravity, scratch)
    if bodies.model[b] != TRANSLATING:
        find_rotation_rates(b, flags, bodies, scratch)


def add_weight_on_arm(b, bodies, gravity, scratch):
    """A body held at its reference point feels its weight as a torque: arm × m g."""
    ax, ay, az = to_world(b, bodies.arm[b, 0], bodies.arm[b, 1], bodies.arm[b, 2], scratch.stage)
    m = bodies.mass[b]
    tx, ty, tz = cross(ax, ay, az, m * gravity[0], m * gravity[1], m * gravity[2])
    scratch.wrench[b, 3] += tx
    scratch.wrench[b, 4] += ty
    scratch.wrench[b, 5] += tz
    scratch.wrench[b, 10] += tx
    scratch.wrench[b, 11] += ty
    scratch.wrench[b, 12] += tz


def find_flow(b, bodies, gravity, scratch):
    """Power without potential, and force and torque from outside, gravity included: what the ledger integrates.

    The torque of a free body is about the world's origin, x × F + τ; of a held one about its pivot.
    """
    scratch.flow[b, WORK] = scratch.wrench[b, 6]
    for j in range(3):
        scratch.flow[b, IMPULSE + j] = 0.0
        scratch.flow[b, ANGULAR_IMPULSE + j] = scratch.wrench[b, 10 + j]
    if bodies.inverse_mass[b] > 0.0:
        m = bodies.mass[b]
        fx = scratch.wrench[b, 7] + m * gravity[0]
        fy = scratch.wrench[b, 8] + m * gravity[1]
        fz = scratch.wrench[b, 9] + m * gravity[2]
        x, y, z = scratch.stage[b, POSITION], scratch.stage[b, POSITION + 1], scratch.stage[b, POSITION + 2]
        tx, ty, tz = cross(x, y, z, fx, fy, fz)
        scratch.flow[b, IMPULSE], scratch.flow[b, IMPULSE + 1], scratch.flow[b, IMPULSE + 2] = fx, fy, fz
        scratch.flow[b, ANGULAR_IMPULSE] += tx
        scratch.flow[b, ANGULAR_IMPULSE + 1] += ty
        scratch.flow[b, ANGULAR_IMPULSE + 2] += tz


def find_rotation_rates(b, flags, bodies, scratch):
    """Rates of the quaternion and of the rotational variable, in the method's axes."""
    q0, q1 = scratch.stage[b, QUATERNION], scratch.stage[b, QUATERNION + 1]
    q2, q3 = scratch.stage[b, QUATERNION + 2], scratch.stage[b, QUATERNION + 3]
    x, y, z = scratch.stage[b, SPIN], scratch.stage[b, SPIN + 1], scratch.stage[b, SPIN + 2]
    i1, i2, i3 = bodies.inverse_moments[b, 0], bodies.inverse_moments[b, 1], bodies.inverse_moments[b, 2]
    tx, ty, tz = scratch.wrench[b, 3], scratch.wrench[b, 4], scratch.wrench[b, 5]
    if not flags[0]:
        tx, ty, tz = rotate_back(q0, q1, q2, q3, tx, ty, tz)
    p0, p1, p2, p3, x, y, z = rotation_rates(
        flags[0], q0, q1, q2, q3, x, y, z, i1, i2, i3, tx, ty, tz, bodies.model[b] == SPHERICAL
    )
    scratch.rate[b, QUATERNION], scratch.rate[b, QUATERNION + 1] = p0, p1
    scratch.rate[b, QUATERNION + 2], scratch.rate[b, QUATERNION + 3] = p2, p3
    scratch.rate[b, SPIN], scratch.rate[b, SPIN + 1], scratch.rate[b, SPIN + 2] = x, y, z


def sum_up(b, weight, stage, scratch):
    """Weighted sum of the rates over the stages."""
    if stage == 0:
        for j in range(STATE_WIDTH):
            scratch.total[b, j] = weight * scratch.rate[b, j]
    else:
        for j in range(STATE_WIDTH):
            scratch.total[b, j] += weight * scratch.rate[b, j]
    for j in range(LEDGER_WIDTH):
        before = scratch.flow_total[b, j] if stage > 0 else 0.0
        scratch.flow_total[b, j] = before + weight * scratch.flow[b, j]


def leave_step(b, dt, state, ledger, flags, bodies, scratch):
    """The new state, its quaternion of unit length again where the method asks for that, and the new ledger."""
    if flags[1]:
        move_with_new_velocity(b, dt, state, bodies, scratch)
    for j in range(STATE_WIDTH):
        state[b, j] += dt * scratch.total[b, j]
    for j in range(LEDGER_WIDTH):
        ledger[b, j] += dt * scratch.flow_total[b, j]
    if flags[2] and bodies.model[b] != TRANSLATING:
        square = 0.0
        for j in range(QUATERNION, QUATERNION + 4):
            square += state[b, j] * state[b, j]
        scale = 1.0 / math.sqrt(square)
        for j in range(QUATERNION, QUATERNION + 4):
            state[b, j] *= scale


def move_with_new_velocity(b, dt, state, bodies, scratch):
    """Symplectic Euler: position and attitude move with the velocities at the end of the step."""
    if bodies.inverse_mass[b] > 0.0:
        for j in range(3):
            scratch.total[b, POSITION + j] = state[b, VELOCITY + j] + dt * scratch.total[b, VELOCITY + j]
    if bodies.model[b] != TRANSLATING:
        p0, p1, p2, p3 = quaternion_rate_world(
            state[b, QUATERNION],
            state[b, QUATERNION + 1],
            state[b, QUATERNION + 2],
            state[b, QUATERNION + 3],
            state[b, SPIN] + dt * scratch.total[b, SPIN],
            state[b, SPIN + 1] + dt * scratch.total[b, SPIN + 1],
            state[b, SPIN + 2] + dt * scratch.total[b, SPIN + 2],
        )
        scratch.total[b, QUATERNION], scratch.total[b, QUATERNION + 1] = p0, p1
        scratch.total[b, QUATERNION + 2], scratch.total[b, QUATERNION + 3] = p2, p3
