"""Principal moments and axes, in an order and with signs that do not depend on chance."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def principal_axes(inertia: Array, tolerance: float = 1e-14) -> tuple[Array, Array]:
    """Moments (3,), ascending, and axes (3, 3), right-handed unit columns, with I = A diag(moments) Aᵀ.

    Axis one and two point so that their largest component is positive; the third follows by the right hand. Where two
    moments are equal to within `tolerance` of the largest, any axis across is principal: the one nearest to a
    coordinate axis is taken; three equal moments have the coordinate axes.

    >>> moments, axes = principal_axes(np.diag([3.0, 1.0, 2.0]))
    >>> moments, axes[:, 0]
    (array([1., 2., 3.]), array([0., 1., 0.]))
    """
    moments, axes = np.linalg.eigh(inertia)
    near = np.diff(moments) <= tolerance * moments[2]
    if near.all():
        return moments, np.eye(3)
    if near[0]:
        axes = _with_free_plane(axes[:, 2], own_column=2)
    elif near[1]:
        axes = _with_free_plane(axes[:, 0], own_column=0)
    first, second = _pointing_up(axes[:, 0]), _pointing_up(axes[:, 1])
    return moments, np.stack([first, second, np.cross(first, second)], axis=1)


def _with_free_plane(axis: Array, own_column: int) -> Array:
    """Axes with `axis` in its column and, across it, the coordinate axis that lies nearest to the plane."""
    nearest = np.eye(3)[np.argmin(np.abs(axis).round(12))]
    across = nearest - (nearest @ axis) * axis
    across /= np.linalg.norm(across)
    third = np.cross(axis, across)
    columns = [axis, across, third] if own_column == 0 else [across, third, axis]
    return np.stack(columns, axis=1)


def _pointing_up(axis: Array) -> Array:
    """The axis or its opposite, so that its largest component, the first of equal ones, is positive."""
    size = np.abs(axis)
    largest = np.flatnonzero(size >= size.max() - 1e-9)[0]
    return axis if axis[largest] > 0.0 else -axis
