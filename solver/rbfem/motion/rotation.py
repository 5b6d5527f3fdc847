"""Quaternion arithmetic on plain components: the one text that kernels compile and arrays share.

A quaternion is q0 + q1 i + q2 j + q3 k, scalar first; a unit one turns body axes into world axes. Every function takes
and gives components, so it works on floats, inside a compiled loop, and on whole NumPy arrays of components alike.
"""

import math


def multiply(a0, a1, a2, a3, b0, b1, b2, b3):
    """Hamilton product a b: turning by b first, then by a.

    >>> multiply(0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    (0.0, 0.0, 0.0, 1.0)
    """
    return (
        a0 * b0 - a1 * b1 - a2 * b2 - a3 * b3,
        a0 * b1 + a1 * b0 + a2 * b3 - a3 * b2,
        a0 * b2 - a1 * b3 + a2 * b0 + a3 * b1,
        a0 * b3 + a1 * b2 - a2 * b1 + a3 * b0,
    )


def rotate(q0, q1, q2, q3, x, y, z):
    """Turn a vector from body to world axes: v + 2 q0 (u × v) + 2 u × (u × v) with u = (q1, q2, q3).

    Equal to q v q̄ for a unit quaternion; not checked that it is one.

    >>> rotate(0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 3.0)
    (-1.0, -2.0, 3.0)
    """
    dx, dy, dz = rotation_change(q0, q1, q2, q3, x, y, z)
    return x + dx, y + dy, z + dz


def rotation_change(q0, q1, q2, q3, x, y, z):
    """What `rotate` adds to a vector: it shrinks with the turn, and no digits of it cancel.

    >>> rotation_change(0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 3.0)
    (-2.0, -4.0, 0.0)
    """
    tx = 2.0 * (q2 * z - q3 * y)
    ty = 2.0 * (q3 * x - q1 * z)
    tz = 2.0 * (q1 * y - q2 * x)
    return q0 * tx + q2 * tz - q3 * ty, q0 * ty + q3 * tx - q1 * tz, q0 * tz + q1 * ty - q2 * tx


def rotate_back(q0, q1, q2, q3, x, y, z):
    """Turn a vector from world to body axes: `rotate` with the conjugate.

    >>> rotate_back(0.5, 0.5, 0.5, 0.5, *rotate(0.5, 0.5, 0.5, 0.5, 1.0, 2.0, 3.0))
    (1.0, 2.0, 3.0)
    """
    return rotate(q0, -q1, -q2, -q3, x, y, z)


def cross(ax, ay, az, bx, by, bz):
    """Cross product a × b.

    >>> cross(1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    (0.0, 0.0, 1.0)
    """
    return (ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx)


def exp(x, y, z):
    """Unit quaternion of a turn by the rotation vector (x, y, z), rad: floats only, unlike the others.

    Below 1e-4 rad the sine is its series, to rounding.

    >>> exp(0.0, 0.0, math.pi)[3]
    1.0
    """
    square = x * x + y * y + z * z
    if square < 1e-8:
        scale = 0.5 - square * (1.0 / 48.0 - square / 3840.0)
    else:
        angle = math.sqrt(square)
        scale = math.sin(0.5 * angle) / angle
    return math.cos(0.5 * math.sqrt(square)), scale * x, scale * y, scale * z
