"""Quaternion algebra on arrays, scalar first, shape (…, 4); vectors have shape (…, 3). Leading axes broadcast.

A unit quaternion q turns body axes into world axes, v_world = q v_body q̄, and q12 = q2 q1 turns by q1 first.
Source: Sola, Quaternion kinematics for the error-state Kalman filter, arXiv 1711.02508, sections 1 and 2.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbfem.compute.rows import each_row
from rbfem.motion import rotation

Array = NDArray[np.float64]


def product(a: ArrayLike, b: ArrayLike) -> Array:
    """Hamilton product a b.

    >>> product([0, 1, 0, 0], [0, 0, 1, 0])
    array([0., 0., 0., 1.])
    """
    return _componentwise(rotation.multiply, a, b)


def conjugate(q: ArrayLike) -> Array:
    """q̄ = (q0, -q1, -q2, -q3), the inverse of a unit quaternion.

    >>> conjugate([1, 2, 3, 4])
    array([ 1., -2., -3., -4.])
    """
    return np.asarray(q, dtype=float) * [1.0, -1.0, -1.0, -1.0]


def normalize(q: ArrayLike) -> Array:
    """q / |q|. The one place outside the steps where a quaternion gets its unit length.

    >>> normalize([0, 0, 0, 2])
    array([0., 0., 0., 1.])
    """
    q = np.asarray(q, dtype=float)
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def rotate(q: ArrayLike, v: ArrayLike) -> Array:
    """v_world = q v_body q̄ for unit q.

    >>> rotate([0, 0, 0, 1], [1, 2, 3])
    array([-1., -2.,  3.])
    """
    return _componentwise(rotation.rotate, q, v)


def rotate_back(q: ArrayLike, v: ArrayLike) -> Array:
    """v_body = q̄ v_world q for unit q.

    >>> rotate_back([0, 0, 0, 1], [-1, -2, 3])
    array([1., 2., 3.])
    """
    return _componentwise(rotation.rotate_back, q, v)


def exp(rotation_vector: ArrayLike) -> Array:
    """Unit quaternion of a rotation by |v| radians about v: (cos |v|/2, v/|v| sin |v|/2).

    >>> exp([0, 0, np.pi]).round(15)
    array([0., 0., 0., 1.])
    """
    v = np.asarray(rotation_vector, dtype=float)
    half = 0.5 * np.linalg.norm(v, axis=-1, keepdims=True)
    return np.concatenate([np.cos(half), 0.5 * np.sinc(half / np.pi) * v], axis=-1)


def log(q: ArrayLike) -> Array:
    """Rotation vector of a unit quaternion, of length in [0, π]: the inverse of `exp` on the shorter way round.

    >>> log(exp([0.1, -0.2, 0.3])).round(15)
    array([ 0.1, -0.2,  0.3])
    """
    q = np.asarray(q, dtype=float)
    q = np.where(q[..., :1] < 0.0, -q, q)
    sine = np.linalg.norm(q[..., 1:], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, q[..., :1])
    return q[..., 1:] * np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 0.0)


def from_axis_angle(axis: ArrayLike, angle: ArrayLike) -> Array:
    """Unit quaternion of a turn by `angle` [rad] about `axis` (any length but zero).

    >>> from_axis_angle([0, 0, 5], np.pi).round(15)
    array([0., 0., 0., 1.])
    """
    axis = np.asarray(axis, dtype=float)
    unit = axis / np.linalg.norm(axis, axis=-1, keepdims=True)
    return exp(unit * np.asarray(angle, dtype=float)[..., None])


def to_axis_angle(q: ArrayLike) -> tuple[Array, Array]:
    """Unit axis (…, 3) and angle (…) in [0, π]; the axis of no turn at all is x.

    >>> axis, angle = to_axis_angle([0, 0, 0, 1])
    >>> axis, float(angle)
    (array([0., 0., 1.]), 3.14159...)
    """
    v = log(q)
    angle = np.linalg.norm(v, axis=-1, keepdims=True)
    axis = np.divide(v, angle, out=np.broadcast_to([1.0, 0.0, 0.0], v.shape).copy(), where=angle > 0.0)
    return axis, angle[..., 0]


def to_matrix(q: ArrayLike) -> Array:
    """Rotation matrix R(q), shape (…, 3, 3), whose columns are the body axes in the world, for unit q.

    >>> to_matrix([0, 0, 0, 1])
    array([[-1.,  0.,  0.],
           [ 0., -1.,  0.],
           [ 0.,  0.,  1.]])
    """
    q = np.asarray(q, dtype=float)
    return np.stack([rotate(q, axis) for axis in np.eye(3)], axis=-1)


def from_matrix(matrix: ArrayLike) -> Array:
    """Unit quaternion, q0 ≥ 0, of a rotation matrix (…, 3, 3), from all nine entries.

    The four products 4 q_i q_j of one row of q qᵀ are read off the matrix; the row with the largest diagonal is taken,
    so nothing is divided by a small number. Not checked: that the matrix is orthogonal with determinant one.
    Source: Shepperd, J. Guidance and Control 1:223, 1978.

    >>> from_matrix([[-1, 0, 0], [0, -1, 0], [0, 0, 1]])
    array([0., 0., 0., 1.])
    """
    m = np.moveaxis(np.asarray(matrix, dtype=float), (-2, -1), (0, 1))
    xx, yy, zz = m[0, 0], m[1, 1], m[2, 2]
    ox, oy, oz = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    xy, xz, yz = m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1]
    rows = np.array(
        [
            [1 + xx + yy + zz, ox, oy, oz],
            [ox, 1 + xx - yy - zz, xy, xz],
            [oy, xy, 1 - xx + yy - zz, yz],
            [oz, xz, yz, 1 - xx - yy + zz],
        ]
    )
    best = np.argmax([rows[i, i] for i in range(4)], axis=0)
    q = np.take_along_axis(np.moveaxis(rows, (0, 1), (-2, -1)), best[..., None, None], axis=-2)[..., 0, :]
    return normalize(np.where(q[..., :1] < 0.0, -q, q))


def derivative(q: ArrayLike, angular_velocity: ArrayLike) -> Array:
    """dq/dt = ½ ω q, with ω (rad/s) in world axes.

    >>> derivative([1, 0, 0, 0], [0, 0, 2])
    array([0., 0., 0., 1.])
    """
    omega = np.asarray(angular_velocity, dtype=float)
    pure = np.concatenate([np.zeros_like(omega[..., :1]), omega], axis=-1)
    return 0.5 * product(pure, q)


def slerp(start: ArrayLike, end: ArrayLike, share: ArrayLike) -> Array:
    """Turn at constant rate from `start` to `end` on the shorter way: q0 (q0⁻¹ q1)^share, share 0…1.

    >>> slerp([1, 0, 0, 0], [0, 0, 0, 1], 0.5).round(6)
    array([0.707107, 0.      , 0.      , 0.707107])
    """
    turn = log(product(conjugate(start), end))
    return product(start, exp(np.asarray(share, dtype=float)[..., None] * turn))


def angle_between(a: ArrayLike, b: ArrayLike) -> Array:
    """Angle (rad, 0…π) of the turn that takes attitude a to attitude b.

    >>> float(angle_between([1, 0, 0, 0], [0, 0, 0, -1]))
    3.14159...
    """
    return np.linalg.norm(log(product(conjugate(a), b)), axis=-1)


def _componentwise(function: Callable, a: ArrayLike, b: ArrayLike) -> Array:
    """A function of the components of a, then those of b; the results along the last axis."""
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    if a.ndim == b.ndim == 2 and len(a) == len(b):
        return np.ascontiguousarray(each_row(lambda p, q: function(*p, *q), a, b))
    return _join(function(*_components(a), *_components(b)))


def _components(values: Array) -> list[Array]:
    """Views by hand: NumPy's moveaxis and stack take longer than the algebra of a few quaternions."""
    return [values[..., i] for i in range(values.shape[-1])]


def _join(components) -> Array:
    joined = np.empty((*np.broadcast_shapes(*map(np.shape, components)), len(components)))
    for i, component in enumerate(components):
        joined[..., i] = component
    return joined
