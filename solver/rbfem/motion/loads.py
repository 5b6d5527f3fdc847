"""Forces and torques on a body: the physics of each kind of load.

Kinds, and what a row of `Loads.values` holds. Points are levers from the reference point in principal axes.

    FORCE   f (N, world axes), at              a force that keeps its direction
    COUPLE  c (N m, world axes)                a torque that keeps its direction
    WRENCH  f (N), c (N m), both body axes     anything that follows the body: pressure, traction, thrust
    SPRING  at, end, k, d, L0                  end: a point of the world, or a lever of the body `other`
    DRAG    b (N s/m), b_r (N m s)             -b v at the centre of mass and -b_r ω
    GRADIENT  n (rad/s), normal, start         the torque of a central field on a free body whose orbit has the rate n
                                               about the normal, seen along `start` from the centre of attraction at
                                               t = 0 (unit vectors, world axes); the orbit itself is not computed
"""

import math

from rbfem.motion.model import (
    EXTERNAL,
    POSITION,
    QUATERNION,
    SPIN,
    TOTAL,
    TRANSLATING,
    VELOCITY,
    WITHOUT_POTENTIAL,
    WRENCH_WIDTH,
)
from rbfem.motion.rotation import cross, rotate, rotate_back

FORCE, COUPLE, WRENCH, SPRING, DRAG, GRADIENT = 0, 1, 2, 3, 4, 5


def ramp_factor(t, first, last, times, factors):
    """Piecewise linear factor of a load at time t, constant before the first and after the last breakpoint.

    >>> ramp_factor(0.25, 0, 2, [0.0, 1.0], [0.0, 8.0])
    2.0
    """
    if t <= times[first]:
        return factors[first]
    for i in range(first + 1, last):
        if t <= times[i]:
            share = (t - times[i - 1]) / (times[i] - times[i - 1])
            return factors[i - 1] + share * (factors[i] - factors[i - 1])
    return factors[last - 1]


def spring_damper(dx, dy, dz, ux, uy, uz, stiffness, damping, rest_length):
    """Force on the near end of a spring with a dashpot in line with it.

    F = (k (l - L0) + c l̇) e,  e = d/l, with d (m) from the near to the far end and u = ḋ (m/s). At l = 0 the line has
    no direction: the spring gives no force there and the dashpot acts on all of u.

    returns : fx, fy, fz (N), then the dashpot's share of it

    >>> spring_damper(2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 10.0, 1.0, 0.5)
    (15.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    """
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    if length == 0.0:
        return damping * ux, damping * uy, damping * uz, damping * ux, damping * uy, damping * uz
    viscous = damping * (ux * dx + uy * dy + uz * dz) / (length * length)
    pull = stiffness * (length - rest_length) / length + viscous
    return pull * dx, pull * dy, pull * dz, viscous * dx, viscous * dy, viscous * dz


def gradient_torque(rate, x, y, z, i1, i2, i3):
    """Torque of a central field on a body small beside its distance, on a circular orbit.

    τ = 3 n² r̂ × (I r̂)

    rate : n, rad/s      x, y, z : r̂, unit vector from the centre of attraction, principal axes
    i*   : kg m^2, principal moments about the centre of mass
    returns : three floats, N m, principal axes
    Not checked: the length of r̂.
    Source: Hughes, Spacecraft Attitude Dynamics, 1986, section 8.1.

    >>> gradient_torque(1.0, 0.0, 0.0, 1.0, 1.0, 2.0, 4.0) == (0.0, 0.0, 0.0)
    True
    >>> gradient_torque(1.0, 0.5, 0.5, 0.5, 1.0, 2.0, 4.0)
    (1.5, -2.25, 0.75)
    """
    strength = 3.0 * rate * rate
    return strength * (i3 - i2) * y * z, strength * (i1 - i3) * z * x, strength * (i2 - i1) * x * y


def find_wrench(b, t, bodies, loads, gravity, state, omega, wrench):
    """Everything that acts on body b but the uniform field on its centre of mass: wrench[b], as in `add_loads`.

    A body held at its reference point feels its weight as a torque, arm × m g.
    """
    for j in range(WRENCH_WIDTH):
        wrench[b, j] = 0.0
    add_loads(b, t, bodies, loads, state, omega, wrench)
    if bodies.inverse_mass[b] == 0.0:
        ax, ay, az = to_world(b, bodies.arm[b, 0], bodies.arm[b, 1], bodies.arm[b, 2], state)
        m = bodies.mass[b]
        tx, ty, tz = cross(ax, ay, az, m * gravity[0], m * gravity[1], m * gravity[2])
        add_wrench(b, TOTAL, 0.0, 0.0, 0.0, tx, ty, tz, wrench)
        add_wrench(b, EXTERNAL, 0.0, 0.0, 0.0, tx, ty, tz, wrench)


def add_loads(b, t, bodies, loads, state, omega, wrench):
    """Add up the loads of body b about its reference point, world axes, into wrench[b].

    t (s); state : (n, 13) and omega : (n, 3) rad/s, world axes, of every body at this stage
    wrench : (n, 18), force and torque of all loads, of those without a potential, and of those from outside
    """
    for k in range(bodies.first_load[b], bodies.first_load[b + 1]):
        fx, fy, fz, tx, ty, tz, gx, gy, gz, ux, uy, uz = load_wrench(k, b, t, bodies, loads, state, omega)
        add_wrench(b, TOTAL, fx, fy, fz, tx, ty, tz, wrench)
        add_wrench(b, WITHOUT_POTENTIAL, gx, gy, gz, ux, uy, uz, wrench)
        if loads.is_external[k]:
            add_wrench(b, EXTERNAL, fx, fy, fz, tx, ty, tz, wrench)


def add_damping(b, bodies, loads, state, omega, wrench):
    """Add up what the dampers and drags of body b do, which is linear in the velocities, into the first six columns."""
    for k in range(bodies.first_load[b], bodies.first_load[b + 1]):
        if loads.kind[k] == SPRING:
            _, _, _, _, _, _, fx, fy, fz, tx, ty, tz = spring_wrench(k, b, loads, state, omega)
            add_wrench(b, TOTAL, fx, fy, fz, tx, ty, tz, wrench)
        elif loads.kind[k] == DRAG:
            fx, fy, fz, tx, ty, tz = drag_wrench(k, b, bodies, loads, state, omega)
            add_wrench(b, TOTAL, fx, fy, fz, tx, ty, tz, wrench)


def add_wrench(b, first, fx, fy, fz, tx, ty, tz, wrench):
    """Add force and torque to six columns of wrench[b]."""
    wrench[b, first] += fx
    wrench[b, first + 1] += fy
    wrench[b, first + 2] += fz
    wrench[b, first + 3] += tx
    wrench[b, first + 4] += ty
    wrench[b, first + 5] += tz


def load_wrench(k, b, t, bodies, loads, state, omega):
    """Force and torque about the reference point of row k on body b, world axes, then the share without a potential."""
    kind = loads.kind[k]
    if kind == SPRING:
        return spring_wrench(k, b, loads, state, omega)
    if kind == DRAG:
        fx, fy, fz, tx, ty, tz = drag_wrench(k, b, bodies, loads, state, omega)
    elif kind == GRADIENT:
        fx, fy, fz = 0.0, 0.0, 0.0
        tx, ty, tz = field_torque(k, b, t, bodies, loads, state)
    else:
        factor = 1.0
        if loads.ramp[k] >= 0:
            ramp = loads.ramp[k]
            factor = ramp_factor(
                t, loads.ramp_first[ramp], loads.ramp_first[ramp + 1], loads.ramp_time, loads.ramp_factor
            )
        fx, fy, fz, tx, ty, tz = given_wrench(k, b, factor, loads, state)
    return fx, fy, fz, tx, ty, tz, fx, fy, fz, tx, ty, tz


def given_wrench(k, b, factor, loads, state):
    """FORCE, COUPLE and WRENCH: known beforehand but for the attitude."""
    kind = loads.kind[k]
    fx, fy, fz = factor * loads.values[k, 0], factor * loads.values[k, 1], factor * loads.values[k, 2]
    if kind == COUPLE:
        return 0.0, 0.0, 0.0, fx, fy, fz
    ax, ay, az = to_world(b, loads.values[k, 3], loads.values[k, 4], loads.values[k, 5], state)
    if kind == FORCE:
        tx, ty, tz = cross(ax, ay, az, fx, fy, fz)
    else:
        tx, ty, tz = factor * ax, factor * ay, factor * az
        fx, fy, fz = to_world(b, fx, fy, fz, state)
    return fx, fy, fz, tx, ty, tz


def spring_wrench(k, b, loads, state, omega):
    """SPRING: pulls the lever of body b towards a point of the world or the lever of another body."""
    other = loads.other[k]
    ax, ay, az = to_world(b, loads.values[k, 0], loads.values[k, 1], loads.values[k, 2], state)
    x, y, z, vx, vy, vz = point_motion(b, ax, ay, az, state, omega)
    ex, ey, ez = loads.values[k, 3], loads.values[k, 4], loads.values[k, 5]
    ux, uy, uz = 0.0, 0.0, 0.0
    if other >= 0:
        ex, ey, ez = to_world(other, ex, ey, ez, state)
        ex, ey, ez, ux, uy, uz = point_motion(other, ex, ey, ez, state, omega)
    stiffness, damping, rest_length = loads.values[k, 6], loads.values[k, 7], loads.values[k, 8]
    fx, fy, fz, dx, dy, dz = spring_damper(
        ex - x, ey - y, ez - z, ux - vx, uy - vy, uz - vz, stiffness, damping, rest_length
    )
    tx, ty, tz = cross(ax, ay, az, fx, fy, fz)
    sx, sy, sz = cross(ax, ay, az, dx, dy, dz)
    return fx, fy, fz, tx, ty, tz, dx, dy, dz, sx, sy, sz


def drag_wrench(k, b, bodies, loads, state, omega):
    """DRAG: against the velocity of the centre of mass and against the angular velocity."""
    ax, ay, az = to_world(b, bodies.arm[b, 0], bodies.arm[b, 1], bodies.arm[b, 2], state)
    _, _, _, vx, vy, vz = point_motion(b, ax, ay, az, state, omega)
    linear, angular = loads.values[k, 0], loads.values[k, 1]
    fx, fy, fz = -linear * vx, -linear * vy, -linear * vz
    tx, ty, tz = cross(ax, ay, az, fx, fy, fz)
    return fx, fy, fz, tx - angular * omega[b, 0], ty - angular * omega[b, 1], tz - angular * omega[b, 2]


def field_torque(k, b, t, bodies, loads, state):
    """GRADIENT: r̂ = start cos nt + normal × start sin nt, and the torque in world axes.

    A field that turns does work on a body that stands: it has no potential that could be counted as energy.
    """
    rate = loads.values[k, 0]
    sx, sy, sz = loads.values[k, 4], loads.values[k, 5], loads.values[k, 6]
    ax, ay, az = cross(loads.values[k, 1], loads.values[k, 2], loads.values[k, 3], sx, sy, sz)
    c, s = math.cos(rate * t), math.sin(rate * t)
    x, y, z = to_body(b, c * sx + s * ax, c * sy + s * ay, c * sz + s * az, state)
    i1, i2 = 1.0 / bodies.inverse_moments[b, 0], 1.0 / bodies.inverse_moments[b, 1]
    tx, ty, tz = gradient_torque(rate, x, y, z, i1, i2, 1.0 / bodies.inverse_moments[b, 2])
    return to_world(b, tx, ty, tz, state)


def find_omega(b, bodies, state, omega):
    """Angular velocity of body b in world axes, R I⁻¹ L, into omega[b]; a body that never turns has none."""
    if bodies.model[b] != TRANSLATING:
        x = bodies.inverse_moments[b, 0] * state[b, SPIN]
        y = bodies.inverse_moments[b, 1] * state[b, SPIN + 1]
        z = bodies.inverse_moments[b, 2] * state[b, SPIN + 2]
        omega[b, 0], omega[b, 1], omega[b, 2] = to_world(b, x, y, z, state)


def to_world(b, x, y, z, state):
    """A vector in the principal axes of body b, turned into world axes."""
    return rotate(
        state[b, QUATERNION],
        state[b, QUATERNION + 1],
        state[b, QUATERNION + 2],
        state[b, QUATERNION + 3],
        x,
        y,
        z,
    )


def to_body(b, x, y, z, state):
    """A vector in world axes, turned into the principal axes of body b."""
    return rotate_back(
        state[b, QUATERNION],
        state[b, QUATERNION + 1],
        state[b, QUATERNION + 2],
        state[b, QUATERNION + 3],
        x,
        y,
        z,
    )


def point_motion(b, ax, ay, az, state, omega):
    """Position and velocity of the point of body b at the world lever a: v = v_ref + ω × a."""
    cx, cy, cz = cross(omega[b, 0], omega[b, 1], omega[b, 2], ax, ay, az)
    return (
        state[b, POSITION] + ax,
        state[b, POSITION + 1] + ay,
        state[b, POSITION + 2] + az,
        state[b, VELOCITY] + cx,
        state[b, VELOCITY + 1] + cy,
        state[b, VELOCITY + 2] + cz,
    )
