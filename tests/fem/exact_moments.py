"""Mass, static moment and inertia of straight tets without any rounding: the float64 data are integers over 2^k."""

from fractions import Fraction
from math import factorial

import numpy as np


def to_integers(values):
    """Python integers (object array) and the power k with values = integers / 2^k, exactly."""
    flat = [float(value).as_integer_ratio() for value in np.ravel(values)]
    power = max(bottom.bit_length() - 1 for _, bottom in flat)
    whole = [top << (power - (bottom.bit_length() - 1)) for top, bottom in flat]
    out = np.empty(len(whole), dtype=object)
    out[:] = whole
    return out.reshape(np.shape(values)), power


def exact_inertia(mesh, density=None, is_nodal=False):
    """Mass, centre (3,) and tensor about it (3, 3) as Fractions, of a density a tet or a node (None: one).

    ∫ L1^a L2^b L3^c L4^d dV = 6V a! b! c! d!/(a+b+c+d+3)! summed term by term: not the formulas under test.
    """
    nodes, k = to_integers(mesh.nodes)
    corners = nodes[mesh.tets[:, :4]]  # (m, 4, 3)
    u, v, w = (corners[:, i] - corners[:, 0] for i in (1, 2, 3))
    six_volumes = (
        u[:, 0] * (v[:, 1] * w[:, 2] - v[:, 2] * w[:, 1])
        + u[:, 1] * (v[:, 2] * w[:, 0] - v[:, 0] * w[:, 2])
        + u[:, 2] * (v[:, 0] * w[:, 1] - v[:, 1] * w[:, 0])
    )
    rho, r = to_integers(np.ones(mesh.n_tets) if density is None else density)
    if is_nodal:
        rho = rho[mesh.tets[:, :4]]
    else:
        six_volumes = six_volumes * rho
        rho = None
    volume_unit = 2 ** (3 * k + r)
    mass = Fraction(int(_integral(six_volumes, rho, [])), volume_unit * _whole(rho, 0))
    first = [
        Fraction(int(_integral(six_volumes, rho, [corners[:, :, a]])), volume_unit * 2**k * _whole(rho, 1))
        for a in range(3)
    ]
    center = [value / mass for value in first]
    second = np.empty((3, 3), dtype=object)
    for a in range(3):
        for b in range(a, 3):
            total = _integral(six_volumes, rho, [corners[:, :, a], corners[:, :, b]])
            value = Fraction(int(total), volume_unit * 4**k * _whole(rho, 2))
            second[a, b] = second[b, a] = value - mass * center[a] * center[b]
    trace = second[0, 0] + second[1, 1] + second[2, 2]
    tensor = np.array([[(trace if a == b else 0) - second[a, b] for b in range(3)] for a in range(3)], dtype=object)
    return mass, center, tensor


def _whole(rho, n_factors):
    """(degree + 3)! of the integrand, the number that `_integral` leaves out."""
    return factorial(n_factors + (rho is not None) + 3)


def _integral(six_volumes, rho, factors):
    """Σ over tets of 6V Σ over corners of the product of fields × a! b! c! d!, without the factorial below."""
    fields = ([] if rho is None else [rho]) + factors
    total = 0
    for choice in np.ndindex(*(4,) * len(fields)):
        weight = int(np.prod([factorial(choice.count(i)) for i in range(4)]))
        term = six_volumes * weight
        for field, corner in zip(fields, choice, strict=True):
            term = term * field[:, corner]
        total += term.sum()
    return total


def relative_error(tensor, exact):
    """|tensor - exact| / |exact| in the Frobenius norm; the difference is taken exactly, too."""
    apart = [Fraction(float(one)) - other for one, other in zip(np.ravel(tensor), exact.ravel(), strict=True)]
    return float(np.linalg.norm([float(value) for value in apart]) / np.linalg.norm(exact.astype(float)))
