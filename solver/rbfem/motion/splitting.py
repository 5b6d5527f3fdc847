"""Splitting methods: free flight and kicks of the loads in turn.

Between kicks a body flies freely, which is solved exactly; at a kick it stands still and the loads change its velocity.
With loads that depend on attitude, position and time only, both parts are exact and every order follows from the
coefficients alone. What depends on the velocity, dampers and drag, enters a kick by the implicit midpoint rule.
Source: McLachlan, Quispel, Splitting methods, Acta Numerica 11:341, 2002.
"""

from rbfem.compute.loops import parallel_range
from rbfem.motion.euler_equations import angular_momentum_rate_body
from rbfem.motion.free_flight import CONSTANT_RATE, EXACT_ROTOR, fly, fly_on
from rbfem.motion.loads import add_damping, find_omega, find_wrench, to_world
from rbfem.motion.model import (
    ANGULAR_IMPULSE,
    EXTERNAL,
    IMPULSE,
    POSITION,
    QUATERNION,
    SPIN,
    STATE_WIDTH,
    TRANSLATING,
    VELOCITY,
    WITHOUT_POTENTIAL,
    WORK,
)
from rbfem.motion.rotation import cross, rotate_back
from rbfem.motion.sums import add, normalize

# Rows of the solver's memory: change of velocity, residual, direction, and what the matrix makes of the direction.
CHANGE, RESIDUAL, DIRECTION, IMAGE = 0, 1, 2, 3

CONVERGED = 1e-30  # of the squared norm of the residual, which shrinks to rounding within a few directions


def step_by_splitting(
    state,
    ledger,
    t,
    dt,
    n_steps,
    coefficients,
    times,
    begins_with_kick,
    rotor,
    bodies,
    loads,
    islands,
    gravity,
    scratch,
):
    """Take n_steps steps of dt from time t, in place.

    coefficients     : (k,) shares of dt of the parts, which alternate; the first and the last are of one kind, and
                       where two steps meet they are done as one
    times            : (k,) shares of dt that have been flown when a part begins
    begins_with_kick : whether the first part is a kick      rotor : a code of `free_flight`
    The other arguments are those of `step_by_runge_kutta`.
    """
    for island in parallel_range(len(islands.first) - 1):
        first, last = islands.first[island], islands.first[island + 1]
        if not bodies.is_pushed[islands.member[first]] and rotor == EXACT_ROTOR:
            fly(islands.member[first], n_steps * dt, state, bodies, gravity)
            continue
        for s in range(n_steps):
            for part in range(len(coefficients)):
                share = coefficients[part]
                if part == 0 and s > 0:
                    share = 0.0
                elif part == len(coefficients) - 1 and s < n_steps - 1:
                    share += coefficients[0]
                if share == 0.0:
                    continue
                if (part % 2 == 0) == begins_with_kick:
                    now = t + (s + times[part]) * dt
                    kick(
                        first, last, now, share * dt, islands.is_damped[island], rotor,
                        state, ledger, bodies, loads, islands, gravity, scratch,
                    )  # fmt: skip
                else:
                    for i in range(first, last):
                        drift(islands.member[i], share * dt, rotor, state, ledger, bodies, gravity, scratch)
        for i in range(first, last):
            if bodies.model[islands.member[i]] != TRANSLATING:
                normalize(islands.member[i], state, scratch.rest)


def drift(b, duration, rotor, state, ledger, bodies, gravity, scratch):
    """Free flight, and what the weight brings into the ledger of a body that has one."""
    if bodies.inverse_mass[b] > 0.0 and bodies.is_pushed[b]:
        weigh(b, duration, state, ledger, bodies, gravity)
    fly_on(b, duration, rotor, state, scratch.rest, bodies, gravity)


def weigh(b, duration, state, ledger, bodies, gravity):
    """Impulse of the weight in free flight: the parabola's own share of ∫ x dt is parallel to it and turns nothing."""
    m, x = bodies.mass[b], state[b, POSITION] + 0.5 * duration * state[b, VELOCITY]
    y = state[b, POSITION + 1] + 0.5 * duration * state[b, VELOCITY + 1]
    z = state[b, POSITION + 2] + 0.5 * duration * state[b, VELOCITY + 2]
    fx, fy, fz = m * gravity[0], m * gravity[1], m * gravity[2]
    add_impulse(b, duration, fx, fy, fz, 0.0, 0.0, 0.0, x, y, z, ledger)


def kick(first, last, t, duration, is_damped, rotor, state, ledger, bodies, loads, islands, gravity, scratch):
    """Change the velocities of an island as its loads at time t do in `duration`, everything standing where it is."""
    for i in range(first, last):
        b = islands.member[i]
        for j in range(STATE_WIDTH):
            scratch.stage[b, j] = state[b, j]
        find_omega(b, bodies, state, scratch.omega)
    evaluate(first, last, t, bodies, loads, islands, gravity, scratch)
    if is_damped and rotor != CONSTANT_RATE:
        find_midpoint(first, last, duration, state, bodies, loads, islands, scratch)
        evaluate(first, last, t, bodies, loads, islands, gravity, scratch)
    for i in range(first, last):
        receive(islands.member[i], duration, rotor, state, ledger, bodies, scratch)


def evaluate(first, last, t, bodies, loads, islands, gravity, scratch):
    """What acts on every body of an island, at its stage."""
    for i in range(first, last):
        b = islands.member[i]
        find_wrench(b, t, bodies, loads, gravity, scratch.stage, scratch.omega, scratch.wrench)


def receive(b, duration, rotor, state, ledger, bodies, scratch):
    """Velocity and angular momentum after a kick; its work is that of the mean of the velocities before and after."""
    find_omega(b, bodies, state, scratch.omega)
    power = power_without_potential(b, state, scratch)
    if bodies.inverse_mass[b] > 0.0:
        share = duration * bodies.inverse_mass[b]
        for j in range(3):
            add(b, VELOCITY + j, share * scratch.wrench[b, j], state, scratch.rest)
    if bodies.model[b] != TRANSLATING:
        torque_kick(b, duration, rotor, state, bodies, scratch)
    find_omega(b, bodies, state, scratch.omega)
    ledger[b, WORK] += 0.5 * duration * (power + power_without_potential(b, state, scratch))
    fx, fy, fz = scratch.wrench[b, EXTERNAL], scratch.wrench[b, EXTERNAL + 1], scratch.wrench[b, EXTERNAL + 2]
    tx, ty, tz = scratch.wrench[b, EXTERNAL + 3], scratch.wrench[b, EXTERNAL + 4], scratch.wrench[b, EXTERNAL + 5]
    x, y, z = state[b, POSITION], state[b, POSITION + 1], state[b, POSITION + 2]
    if bodies.inverse_mass[b] == 0.0:
        fx, fy, fz = 0.0, 0.0, 0.0
    add_impulse(b, duration, fx, fy, fz, tx, ty, tz, x, y, z, ledger)


def power_without_potential(b, state, scratch):
    """Power of the loads without a potential at the velocities of `state` and scratch.omega."""
    power = 0.0
    for j in range(3):
        power += scratch.wrench[b, WITHOUT_POTENTIAL + j] * state[b, VELOCITY + j]
        power += scratch.wrench[b, WITHOUT_POTENTIAL + 3 + j] * scratch.omega[b, j]
    return power


def torque_kick(b, duration, rotor, state, bodies, scratch):
    """Angular momentum in body axes after the torque has acted for `duration`.

    The rotor of constant rate has no gyroscopic term of its own; there it comes with the torque, by two steps of the
    strongly stable Runge-Kutta method of order three.
    """
    q0, q1 = state[b, QUATERNION], state[b, QUATERNION + 1]
    q2, q3 = state[b, QUATERNION + 2], state[b, QUATERNION + 3]
    tx, ty, tz = rotate_back(q0, q1, q2, q3, scratch.wrench[b, 3], scratch.wrench[b, 4], scratch.wrench[b, 5])
    if rotor == CONSTANT_RATE:
        x, y, z = state[b, SPIN], state[b, SPIN + 1], state[b, SPIN + 2]
        r1, r2, r3 = bodies.inverse_moments[b, 0], bodies.inverse_moments[b, 1], bodies.inverse_moments[b, 2]
        for _ in range(2):
            x, y, z = strongly_stable_step(x, y, z, tx, ty, tz, r1, r2, r3, 0.5 * duration)
        state[b, SPIN], state[b, SPIN + 1], state[b, SPIN + 2] = x, y, z
    else:
        add(b, SPIN, duration * tx, state, scratch.rest)
        add(b, SPIN + 1, duration * ty, state, scratch.rest)
        add(b, SPIN + 2, duration * tz, state, scratch.rest)


def strongly_stable_step(x, y, z, tx, ty, tz, r1, r2, r3, dt):
    """One step of dL/dt = τ - ω × L under a constant torque in body axes.

    Source: Gottlieb, Shu, Tadmor, SIAM Review 43:89, 2001, the optimal method of order three.

    >>> strongly_stable_step(1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 1.0, 1.0, 1.0, 0.5)
    (1.0, 1.0, 0.0)
    """
    ax, ay, az = angular_momentum_rate_body(x, y, z, r1 * x, r2 * y, r3 * z, tx, ty, tz)
    ux, uy, uz = x + dt * ax, y + dt * ay, z + dt * az
    bx, by, bz = angular_momentum_rate_body(ux, uy, uz, r1 * ux, r2 * uy, r3 * uz, tx, ty, tz)
    h = 0.25 * dt
    ux, uy, uz = x + h * (ax + bx), y + h * (ay + by), z + h * (az + bz)
    cx, cy, cz = angular_momentum_rate_body(ux, uy, uz, r1 * ux, r2 * uy, r3 * uz, tx, ty, tz)
    h = dt / 6.0
    return x + h * (ax + bx + 4.0 * cx), y + h * (ay + by + 4.0 * cy), z + h * (az + bz + 4.0 * cz)


def add_impulse(b, duration, fx, fy, fz, tx, ty, tz, x, y, z, ledger):
    """Force and torque over a time into the ledger; the torque about the world's origin if the force is not zero."""
    cx, cy, cz = cross(x, y, z, fx, fy, fz)
    ledger[b, IMPULSE] += duration * fx
    ledger[b, IMPULSE + 1] += duration * fy
    ledger[b, IMPULSE + 2] += duration * fz
    ledger[b, ANGULAR_IMPULSE] += duration * (tx + cx)
    ledger[b, ANGULAR_IMPULSE + 1] += duration * (ty + cy)
    ledger[b, ANGULAR_IMPULSE + 2] += duration * (tz + cz)


def find_midpoint(first, last, duration, state, bodies, loads, islands, scratch):
    """Put the velocities in the middle of a damped kick into scratch.stage and scratch.omega.

    The implicit midpoint rule M (V₁ - V₀) = h (F(V₀) - C (V̄ - V₀)), V̄ = (V₀ + V₁)/2, is the system
    (M + ½ h C) (V̄ - V₀) = ½ h F(V₀) with C symmetric and not negative: it is solved by conjugate gradients with M as
    preconditioner, in as many directions as C has eigenvalues at most. Velocities are those of the reference point in
    world axes and ω in body axes, in which M is diagonal; a direction that a body cannot move in has no velocity.
    """
    energy = begin_descent(first, last, duration, state, bodies, islands, scratch)
    target = CONVERGED * energy
    for _ in range(6 * (last - first) + 6):
        if energy <= target:
            break
        curvature = apply_damping(first, last, duration, state, bodies, loads, islands, scratch)
        if curvature <= 0.0:  # a backward kick so long that the rule has no solution
            break
        remaining = descend(first, last, energy / curvature, bodies, islands, scratch)
        for i in range(first, last):
            b = islands.member[i]
            for j in range(6):
                ahead = scratch.solver[b, RESIDUAL, j] * inverse_inertia(b, j, bodies)
                scratch.solver[b, DIRECTION, j] = ahead + remaining / energy * scratch.solver[b, DIRECTION, j]
        energy = remaining
    for i in range(first, last):
        set_velocities(islands.member[i], CHANGE, 1.0, state, bodies, scratch)


def begin_descent(first, last, duration, state, bodies, islands, scratch):
    """Residual ½ h F, direction M⁻¹ of it, no change yet; returns their product."""
    energy = 0.0
    for i in range(first, last):
        b = islands.member[i]
        q0, q1 = state[b, QUATERNION], state[b, QUATERNION + 1]
        q2, q3 = state[b, QUATERNION + 2], state[b, QUATERNION + 3]
        tx, ty, tz = rotate_back(q0, q1, q2, q3, scratch.wrench[b, 3], scratch.wrench[b, 4], scratch.wrench[b, 5])
        scratch.wrench[b, 3], scratch.wrench[b, 4], scratch.wrench[b, 5] = tx, ty, tz
        for j in range(6):
            residual = 0.5 * duration * scratch.wrench[b, j]
            scratch.solver[b, CHANGE, j] = 0.0
            scratch.solver[b, RESIDUAL, j] = residual
            scratch.solver[b, DIRECTION, j] = residual * inverse_inertia(b, j, bodies)
            energy += residual * scratch.solver[b, DIRECTION, j]
    return energy


def apply_damping(first, last, duration, state, bodies, loads, islands, scratch):
    """Image (M + ½ h C) p of the direction p, and their product."""
    for i in range(first, last):
        set_velocities(islands.member[i], DIRECTION, 0.0, state, bodies, scratch)
    curvature = 0.0
    for i in range(first, last):
        b = islands.member[i]
        for j in range(6):
            scratch.wrench[b, j] = 0.0
        add_damping(b, bodies, loads, scratch.stage, scratch.omega, scratch.wrench)
        q0, q1 = state[b, QUATERNION], state[b, QUATERNION + 1]
        q2, q3 = state[b, QUATERNION + 2], state[b, QUATERNION + 3]
        tx, ty, tz = rotate_back(q0, q1, q2, q3, scratch.wrench[b, 3], scratch.wrench[b, 4], scratch.wrench[b, 5])
        scratch.wrench[b, 3], scratch.wrench[b, 4], scratch.wrench[b, 5] = tx, ty, tz
        for j in range(6):
            inverse, direction = inverse_inertia(b, j, bodies), scratch.solver[b, DIRECTION, j]
            image = -0.5 * duration * scratch.wrench[b, j]
            if inverse > 0.0:
                image += direction / inverse
            scratch.solver[b, IMAGE, j] = image
            curvature += direction * image
    return curvature


def descend(first, last, length, bodies, islands, scratch):
    """Go along the direction; returns the squared norm of the residual that remains."""
    remaining = 0.0
    for i in range(first, last):
        b = islands.member[i]
        for j in range(6):
            scratch.solver[b, CHANGE, j] += length * scratch.solver[b, DIRECTION, j]
            scratch.solver[b, RESIDUAL, j] -= length * scratch.solver[b, IMAGE, j]
            residual = scratch.solver[b, RESIDUAL, j]
            remaining += residual * residual * inverse_inertia(b, j, bodies)
    return remaining


def inverse_inertia(b, j, bodies):
    """M⁻¹ in direction j: three of the mass, three of the moments; zero where body b cannot move."""
    if j < 3:
        return bodies.inverse_mass[b]
    return 0.0 if bodies.model[b] == TRANSLATING else bodies.inverse_moments[b, j - 3]


def set_velocities(b, row, share, state, bodies, scratch):
    """Velocities of the stage: `share` of those of the state, and a row of the solver's memory on top."""
    for j in range(3):
        scratch.stage[b, VELOCITY + j] = share * state[b, VELOCITY + j] + scratch.solver[b, row, j]
    if bodies.model[b] != TRANSLATING:
        x = share * state[b, SPIN] * bodies.inverse_moments[b, 0] + scratch.solver[b, row, 3]
        y = share * state[b, SPIN + 1] * bodies.inverse_moments[b, 1] + scratch.solver[b, row, 4]
        z = share * state[b, SPIN + 2] * bodies.inverse_moments[b, 2] + scratch.solver[b, row, 5]
        scratch.omega[b, 0], scratch.omega[b, 1], scratch.omega[b, 2] = to_world(b, x, y, z, state)
