"""The Newton-Euler equations of one body: rates of its attitude and of its rotational variable.

Body axes are the principal axes about the reference point, where the inertia tensor is diagonal.
"""

from rbfem.motion.rotation import cross, multiply


def rotation_rates(is_world, q0, q1, q2, q3, x, y, z, r1, r2, r3, tx, ty, tz, is_spherical):
    """Rates of the quaternion and of the rotational variable (x, y, z): ω in world axes, or L in body axes.

    r* : 1/(kg m^2), reciprocals of the principal moments    t* : N m, in the axes of the variable
    returns : seven floats    A spherical body, r1 = r2 = r3, has no gyroscopic term and needs no turned tensor.
    """
    if is_world:
        p0, p1, p2, p3 = quaternion_rate_world(q0, q1, q2, q3, x, y, z)
        if is_spherical:
            return p0, p1, p2, p3, tx * r1, ty * r1, tz * r1
        ax, ay, az = angular_acceleration_world(q0, q1, q2, q3, x, y, z, tx, ty, tz, r1, r2, r3)
        return p0, p1, p2, p3, ax, ay, az
    w1, w2, w3 = x * r1, y * r2, z * r3
    p0, p1, p2, p3 = quaternion_rate_body(q0, q1, q2, q3, w1, w2, w3)
    if is_spherical:
        return p0, p1, p2, p3, tx, ty, tz
    ax, ay, az = angular_momentum_rate_body(x, y, z, w1, w2, w3, tx, ty, tz)
    return p0, p1, p2, p3, ax, ay, az


def angular_momentum_rate_body(l1, l2, l3, w1, w2, w3, t1, t2, t3):
    """dL/dt = τ - ω × L, all in body axes: Euler's equations with the gyroscopic term, written for L = I ω.

    l* : kg m^2/s    w* : rad/s, I⁻¹ L    t* : N m    returns : three floats, N m
    Source: Goldstein, Classical Mechanics, 3rd ed., eq. 5.39.

    >>> angular_momentum_rate_body(1.0, 4.0, 9.0, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0)
    (-6.0, 6.0, -2.0)
    """
    return t1 + l2 * w3 - l3 * w2, t2 + l3 * w1 - l1 * w3, t3 + l1 * w2 - l2 * w1


def quaternion_rate_body(q0, q1, q2, q3, w1, w2, w3):
    """dq/dt = ½ q ω with ω (rad/s) in body axes.

    >>> quaternion_rate_body(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0)
    (0.0, 0.0, 0.0, 1.0)
    """
    return multiply(q0, q1, q2, q3, 0.0, 0.5 * w1, 0.5 * w2, 0.5 * w3)


def quaternion_rate_world(q0, q1, q2, q3, wx, wy, wz):
    """dq/dt = ½ ω q with ω (rad/s) in world axes.

    >>> quaternion_rate_world(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0)
    (0.0, 0.0, 0.0, 1.0)
    """
    return multiply(0.0, 0.5 * wx, 0.5 * wy, 0.5 * wz, q0, q1, q2, q3)


def angular_acceleration_world(q0, q1, q2, q3, wx, wy, wz, tx, ty, tz, r1, r2, r3):
    """dω/dt = I⁻¹ (τ - ω × I ω) in world axes, I = R(q) I0 R(q)ᵀ, for a quaternion of any length.

    R(q) v = q v q̄ as the 2019 article writes it: with |q|² = s it is s times a rotation, so that I carries s² and its
    inverse 1/s². For a unit quaternion this is the textbook equation.

    w* : rad/s    t* : N m, world axes    r* : 1/(kg m^2), reciprocals of the principal moments

    >>> angular_acceleration_world(1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.25)
    (-12.0, 4.5, -0.5)
    """
    hx, hy, hz = apply_tensor(q0, q1, q2, q3, wx, wy, wz, 1.0 / r1, 1.0 / r2, 1.0 / r3)
    gx, gy, gz = cross(wx, wy, wz, hx, hy, hz)
    s = q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3
    s4 = (s * s) * (s * s)
    ax, ay, az = apply_tensor(q0, q1, q2, q3, tx - gx, ty - gy, tz - gz, r1, r2, r3)
    return ax / s4, ay / s4, az / s4


def apply_tensor(q0, q1, q2, q3, x, y, z, i1, i2, i3):
    """R diag(i1, i2, i3) Rᵀ v with R v = q v q̄, for a quaternion of any length.

    >>> apply_tensor(1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 3.0, 4.0)
    (2.0, 3.0, 4.0)
    """
    bx, by, bz = sandwich(q0, -q1, -q2, -q3, x, y, z)
    return sandwich(q0, q1, q2, q3, i1 * bx, i2 * by, i3 * bz)


def sandwich(q0, q1, q2, q3, x, y, z):
    """Vector part of q v q̄, which is |q|² times a rotation of v.

    >>> sandwich(2.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0)
    (4.0, 8.0, 12.0)
    """
    p0, p1, p2, p3 = multiply(q0, q1, q2, q3, 0.0, x, y, z)
    _, x, y, z = multiply(p0, p1, p2, p3, q0, -q1, -q2, -q3)
    return x, y, z
