"""Forces and torques on a body: the physics of each kind of load.

Kinds, and what a row of `Loads.values` holds. Points are levers from the reference point in principal axes.

    FORCE   f (N, world axes), at              a force that keeps its direction
    COUPLE  c (N m, world axes)                a torque that keeps its direction
    WRENCH  f (N), c (N m), both body axes     anything that follows the body: pressure, traction, thrust
    SPRING  at, end, k, d, L0                  end: a point of the world, or a lever of the body `other`
    DRAG    b (N s/m), b_r (N m s)             -b v at the centre of mass and -b_r ω
"""

import math

from rbfem.motion.model import POSITION, QUATERNION, VELOCITY
from rbfem.motion.rotation import cross, rotate

FORCE, COUPLE, WRENCH, SPRING, DRAG = 0, 1, 2, 3, 4


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


def add_loads(b, t, bodies, loads, state, omega, wrench):
    """Add up the loads of body b about its reference point, world axes, into wrench[b].

    t (s); state : (n, 13) and omega : (n, 3) rad/s, world axes, of every body at this stage
    wrench : (n, 13), in columns force, torque, power of what has no potential, external force, external torque
    """
    for k in range(bodies.first_load[b], bodies.first_load[b + 1]):
        fx, fy, fz, tx, ty, tz, power = load_wrench(k, b, t, bodies, loads, state, omega)
        wrench[b, 0] += fx
        wrench[b, 1] += fy
        wrench[b, 2] += fz
        wrench[b, 3] += tx
        wrench[b, 4] += ty
        wrench[b, 5] += tz
        wrench[b, 6] += power
        if loads.is_external[k]:
            wrench[b, 7] += fx
            wrench[b, 8] += fy
            wrench[b, 9] += fz
            wrench[b, 10] += tx
            wrench[b, 11] += ty
            wrench[b, 12] += tz


def load_wrench(k, b, t, bodies, loads, state, omega):
    """Force, torque about the reference point (world axes) of row k on body b, and its power if it has no potential."""
    kind = loads.kind[k]
    if kind == SPRING:
        return spring_wrench(k, b, loads, state, omega)
    if kind == DRAG:
        return drag_wrench(k, b, bodies, loads, state, omega)
    factor = 1.0
    if loads.ramp[k] >= 0:
        ramp = loads.ramp[k]
        factor = ramp_factor(t, loads.ramp_first[ramp], loads.ramp_first[ramp + 1], loads.ramp_time, loads.ramp_factor)
    return given_wrench(k, b, factor, loads, state, omega)


def given_wrench(k, b, factor, loads, state, omega):
    """FORCE, COUPLE and WRENCH: known beforehand but for the attitude."""
    kind = loads.kind[k]
    wx, wy, wz = omega[b, 0], omega[b, 1], omega[b, 2]
    fx, fy, fz = factor * loads.values[k, 0], factor * loads.values[k, 1], factor * loads.values[k, 2]
    if kind == COUPLE:
        return 0.0, 0.0, 0.0, fx, fy, fz, fx * wx + fy * wy + fz * wz
    ax, ay, az = to_world(b, loads.values[k, 3], loads.values[k, 4], loads.values[k, 5], state)
    if kind == FORCE:
        tx, ty, tz = cross(ax, ay, az, fx, fy, fz)
    else:
        tx, ty, tz = factor * ax, factor * ay, factor * az
        fx, fy, fz = to_world(b, fx, fy, fz, state)
    vx, vy, vz = state[b, VELOCITY], state[b, VELOCITY + 1], state[b, VELOCITY + 2]
    return fx, fy, fz, tx, ty, tz, fx * vx + fy * vy + fz * vz + tx * wx + ty * wy + tz * wz


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
    return fx, fy, fz, tx, ty, tz, dx * vx + dy * vy + dz * vz


def drag_wrench(k, b, bodies, loads, state, omega):
    """DRAG: against the velocity of the centre of mass and against the angular velocity."""
    ax, ay, az = to_world(b, bodies.arm[b, 0], bodies.arm[b, 1], bodies.arm[b, 2], state)
    _, _, _, vx, vy, vz = point_motion(b, ax, ay, az, state, omega)
    linear, angular = loads.values[k, 0], loads.values[k, 1]
    fx, fy, fz = -linear * vx, -linear * vy, -linear * vz
    wx, wy, wz = omega[b, 0], omega[b, 1], omega[b, 2]
    tx, ty, tz = cross(ax, ay, az, fx, fy, fz)
    power = fx * vx + fy * vy + fz * vz - angular * (wx * wx + wy * wy + wz * wz)
    return fx, fy, fz, tx - angular * wx, ty - angular * wy, tz - angular * wz, power


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
