"""Runge-Kutta on the stacked state: any number of bodies, any number of steps, any explicit tableau, in one call."""

import numpy as np
from numpy.typing import NDArray

from rbfem.compute.loops import parallel_range
from rbfem.motion.coasting import coast
from rbfem.motion.euler_equations import quaternion_rate_world, rotation_rates
from rbfem.motion.free_flight import fly
from rbfem.motion.loads import find_omega, find_wrench
from rbfem.motion.model import (
    ANGULAR_IMPULSE,
    EXTERNAL,
    FLIES_EXACTLY,
    IMPULSE,
    IS_SYMPLECTIC_EULER,
    IS_WORLD,
    LEDGER_WIDTH,
    NORMALIZES,
    POSITION,
    QUATERNION,
    SPHERICAL,
    SPIN,
    STATE_WIDTH,
    TRANSLATING,
    VELOCITY,
    WITHOUT_POTENTIAL,
    WORK,
)
from rbfem.motion.rotation import cross, rotate_back
from rbfem.motion.sums import add, normalize

Array = NDArray[np.float64]


def step_by_runge_kutta(
    state, ledger, t, dt, n_steps, tableau, nodes, weights, flags, bodies, loads, islands, gravity, scratch
):
    """Take n_steps steps of dt from time t, in place.

    state   : (n, 13) stacked rows, see `model`      ledger : (n, 7), since the start of the run
    tableau : (stages, stages); nodes, weights : (stages,) of the method
    flags   : (4,) int64, in the columns IS_WORLD, IS_SYMPLECTIC_EULER, NORMALIZES, FLIES_EXACTLY
    bodies, loads, islands, scratch : the arrays of `model`; scratch.stage holds the state of the bodies that never move
    gravity : (3,) m/s^2
    """
    for island in parallel_range(len(islands.first) - 1):
        first, last = islands.first[island], islands.first[island + 1]
        if not bodies.is_pushed[islands.member[first]]:
            if flags[FLIES_EXACTLY]:
                fly(islands.member[first], n_steps * dt, state, bodies, gravity)
            else:
                coast(islands.member[first], dt, n_steps, nodes, weights, flags, state, bodies, gravity)
        else:
            for s in range(n_steps):
                find_stages(
                    first, last, t + s * dt, dt, tableau, nodes, flags, state, bodies, loads, islands, gravity, scratch
                )
                for i in range(first, last):
                    sum_up(islands.member[i], weights, scratch)
                    leave_step(islands.member[i], dt, state, ledger, flags, bodies, scratch)


def find_stages(first, last, t, dt, tableau, nodes, flags, state, bodies, loads, islands, gravity, scratch):
    """Rates of every stage of the bodies islands.member[first:last], which see each other's stages."""
    for stage in range(len(nodes)):
        for i in range(first, last):
            enter_stage(islands.member[i], stage, dt, tableau, flags, state, bodies, scratch)
        for i in range(first, last):
            find_rates(islands.member[i], stage, t + nodes[stage] * dt, flags, bodies, loads, gravity, scratch)


def enter_stage(b, stage, dt, tableau, flags, state, bodies, scratch):
    """Stage state y + dt Σ_j tableau[stage, j] k_j, and the angular velocity that the loads will read."""
    for j in range(STATE_WIDTH):
        scratch.stage[b, j] = state[b, j]
    for earlier in range(stage):
        shift = dt * tableau[stage, earlier]
        if shift != 0.0:
            for j in range(STATE_WIDTH):
                scratch.stage[b, j] += shift * scratch.rate[b, earlier, j]
    if not flags[IS_WORLD]:
        find_omega(b, bodies, scratch.stage, scratch.omega)
    elif bodies.model[b] != TRANSLATING:
        for j in range(3):
            scratch.omega[b, j] = scratch.stage[b, SPIN + j]


def find_rates(b, stage, t, flags, bodies, loads, gravity, scratch):
    """Newton-Euler: the rate of every column of the stage, and of the ledger."""
    find_wrench(b, t, bodies, loads, gravity, scratch.stage, scratch.omega, scratch.wrench)
    if bodies.inverse_mass[b] > 0.0:
        for j in range(3):
            scratch.rate[b, stage, POSITION + j] = scratch.stage[b, VELOCITY + j]
            scratch.rate[b, stage, VELOCITY + j] = gravity[j] + bodies.inverse_mass[b] * scratch.wrench[b, j]
    find_flow(b, stage, bodies, gravity, scratch)
    if bodies.model[b] != TRANSLATING:
        find_rotation_rates(b, stage, flags, bodies, scratch)


def find_flow(b, stage, bodies, gravity, scratch):
    """Power without potential, and force and torque from outside, gravity included: what the ledger integrates.

    The torque of a free body is about the world's origin, x × F + τ; of a held one about its pivot.
    """
    power = 0.0
    for j in range(3):
        power += scratch.wrench[b, WITHOUT_POTENTIAL + j] * scratch.stage[b, VELOCITY + j]
        power += scratch.wrench[b, WITHOUT_POTENTIAL + 3 + j] * scratch.omega[b, j]
        scratch.flow[b, stage, IMPULSE + j] = 0.0
        scratch.flow[b, stage, ANGULAR_IMPULSE + j] = scratch.wrench[b, EXTERNAL + 3 + j]
    scratch.flow[b, stage, WORK] = power
    if bodies.inverse_mass[b] > 0.0:
        m = bodies.mass[b]
        fx = scratch.wrench[b, EXTERNAL] + m * gravity[0]
        fy = scratch.wrench[b, EXTERNAL + 1] + m * gravity[1]
        fz = scratch.wrench[b, EXTERNAL + 2] + m * gravity[2]
        x, y, z = scratch.stage[b, POSITION], scratch.stage[b, POSITION + 1], scratch.stage[b, POSITION + 2]
        tx, ty, tz = cross(x, y, z, fx, fy, fz)
        scratch.flow[b, stage, IMPULSE] = fx
        scratch.flow[b, stage, IMPULSE + 1] = fy
        scratch.flow[b, stage, IMPULSE + 2] = fz
        scratch.flow[b, stage, ANGULAR_IMPULSE] += tx
        scratch.flow[b, stage, ANGULAR_IMPULSE + 1] += ty
        scratch.flow[b, stage, ANGULAR_IMPULSE + 2] += tz


def find_rotation_rates(b, stage, flags, bodies, scratch):
    """Rates of the quaternion and of the rotational variable, in the method's axes."""
    q0, q1 = scratch.stage[b, QUATERNION], scratch.stage[b, QUATERNION + 1]
    q2, q3 = scratch.stage[b, QUATERNION + 2], scratch.stage[b, QUATERNION + 3]
    x, y, z = scratch.stage[b, SPIN], scratch.stage[b, SPIN + 1], scratch.stage[b, SPIN + 2]
    i1, i2, i3 = bodies.inverse_moments[b, 0], bodies.inverse_moments[b, 1], bodies.inverse_moments[b, 2]
    tx, ty, tz = scratch.wrench[b, 3], scratch.wrench[b, 4], scratch.wrench[b, 5]
    if not flags[IS_WORLD]:
        tx, ty, tz = rotate_back(q0, q1, q2, q3, tx, ty, tz)
    p0, p1, p2, p3, x, y, z = rotation_rates(
        flags[IS_WORLD], q0, q1, q2, q3, x, y, z, i1, i2, i3, tx, ty, tz, bodies.model[b] == SPHERICAL
    )
    scratch.rate[b, stage, QUATERNION], scratch.rate[b, stage, QUATERNION + 1] = p0, p1
    scratch.rate[b, stage, QUATERNION + 2], scratch.rate[b, stage, QUATERNION + 3] = p2, p3
    scratch.rate[b, stage, SPIN], scratch.rate[b, stage, SPIN + 1], scratch.rate[b, stage, SPIN + 2] = x, y, z


def sum_up(b, weights, scratch):
    """Weighted sums over the stages, of the rates of the state and of the ledger."""
    for j in range(STATE_WIDTH):
        scratch.total[b, j] = 0.0
    for j in range(LEDGER_WIDTH):
        scratch.flow_total[b, j] = 0.0
    for stage in range(len(weights)):
        for j in range(STATE_WIDTH):
            scratch.total[b, j] += weights[stage] * scratch.rate[b, stage, j]
        for j in range(LEDGER_WIDTH):
            scratch.flow_total[b, j] += weights[stage] * scratch.flow[b, stage, j]


def leave_step(b, dt, state, ledger, flags, bodies, scratch):
    """The new state, its quaternion of unit length again where the method asks for that, and the new ledger."""
    if flags[IS_SYMPLECTIC_EULER]:
        move_with_new_velocity(b, dt, state, bodies, scratch)
    for j in range(STATE_WIDTH):
        add(b, j, dt * scratch.total[b, j], state, scratch.rest)
    for j in range(LEDGER_WIDTH):
        ledger[b, j] += dt * scratch.flow_total[b, j]
    if flags[NORMALIZES] and bodies.model[b] != TRANSLATING:
        normalize(b, state, scratch.rest)


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
