"""Shape functions of the tetrahedron and the integrals that everything else is built from.

Linear: N_i = L_i, the barycentric coordinates, ΣL_i = 1. Quadratic, nodes in VTK's order: corners L_i (2 L_i - 1),
edges 4 L_i L_j on the edges 01, 12, 02, 03, 13, 23.
Source: Zienkiewicz, Taylor, Zhu, The Finite Element Method, 7th ed., section 6.2.
"""

import functools
from math import factorial

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

EDGES = np.array([(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)])
TRIANGLE_EDGES = np.array([(0, 1), (1, 2), (0, 2)])


def monomial_integral(a: int, b: int, c: int, d: int, volume: float) -> float:
    """∫ L1^a L2^b L3^c L4^d dV = 6V a! b! c! d! / (a+b+c+d+3)! over a straight tetrahedron.

    Source: Eisenberg & Malvern, Int. J. Numer. Meth. Eng. 7:574, 1973.

    >>> monomial_integral(0, 0, 0, 0, 1.0), monomial_integral(1, 1, 0, 0, 1.0), monomial_integral(2, 0, 0, 0, 1.0)
    (1.0, 0.05, 0.1)
    """
    powers = factorial(a) * factorial(b) * factorial(c) * factorial(d)
    return 6.0 * volume * powers / factorial(a + b + c + d + 3)


def quadratic(barycentric: Array) -> Array:
    """Values (k, 10) of the quadratic shape functions of the tetrahedron at barycentric points (k, 4).

    >>> quadratic(np.array([[0.5, 0.5, 0.0, 0.0]]))[0] + 0.0
    array([0., 0., 0., 0., 1., 0., 0., 0., 0., 0.])
    """
    corners = barycentric * (2.0 * barycentric - 1.0)
    return np.hstack([corners, 4.0 * barycentric[:, EDGES[:, 0]] * barycentric[:, EDGES[:, 1]]])


def quadratic_gradients(barycentric: Array) -> Array:
    """Derivatives (k, 10, 3) of the quadratic shape functions by L2, L3, L4, with L1 = 1 - L2 - L3 - L4."""
    by_coordinate = np.zeros((len(barycentric), 10, 4))
    for i in range(4):
        by_coordinate[:, i, i] = 4.0 * barycentric[:, i] - 1.0
    for edge, (i, j) in enumerate(EDGES):
        by_coordinate[:, 4 + edge, i] = 4.0 * barycentric[:, j]
        by_coordinate[:, 4 + edge, j] = 4.0 * barycentric[:, i]
    return by_coordinate[:, :, 1:] - by_coordinate[:, :, :1]


@functools.cache
def tet_quadrature(degree: int) -> tuple[Array, Array]:
    """Barycentric points (k, 4) and weights (k,), Σ weights = 1/6, exact for polynomials up to `degree`.

    A Gauss product on the cube, folded onto the tetrahedron; the fold's Jacobian (1-u)² (1-v) adds two to the degree.
    Source: Stroud, Approximate Calculation of Multiple Integrals, 1971, section 2.4.

    >>> float(tet_quadrature(7)[1].sum().round(15))
    0.166666666666667
    """
    u, v, w, weight = _gauss_cube(degree + 2)
    points = np.stack([u, (1 - u) * v, (1 - u) * (1 - v) * w], axis=1)
    barycentric = np.hstack([1.0 - points.sum(axis=1, keepdims=True), points])
    return barycentric, weight * (1 - u) ** 2 * (1 - v)


@functools.cache
def triangle_quadrature(degree: int) -> tuple[Array, Array]:
    """Barycentric points (k, 3) and weights (k,), Σ weights = 1/2, exact for polynomials up to `degree`.

    >>> float(triangle_quadrature(4)[1].sum().round(15))
    0.5
    """
    x, w = _gauss_interval(degree + 1)
    u, v = (grid.ravel() for grid in np.meshgrid(x, x, indexing="ij"))
    weight = np.outer(w, w).ravel()
    points = np.stack([u, (1 - u) * v], axis=1)
    return np.hstack([1.0 - points.sum(axis=1, keepdims=True), points]), weight * (1 - u)


def triangle_quadratic(barycentric: Array) -> Array:
    """Values (k, 6) of the quadratic shape functions of the triangle, edges 01, 12, 20, at barycentric (k, 3)."""
    i, j = TRIANGLE_EDGES.T
    return np.hstack([barycentric * (2.0 * barycentric - 1.0), 4.0 * barycentric[:, i] * barycentric[:, j]])


def triangle_quadratic_gradients(barycentric: Array) -> Array:
    """Derivatives (k, 6, 2) of the quadratic shape functions of the triangle by L2 and L3, with L1 = 1 - L2 - L3."""
    by_coordinate = np.zeros((len(barycentric), 6, 3))
    for i in range(3):
        by_coordinate[:, i, i] = 4.0 * barycentric[:, i] - 1.0
    for edge, (i, j) in enumerate(TRIANGLE_EDGES):
        by_coordinate[:, 3 + edge, i] = 4.0 * barycentric[:, j]
        by_coordinate[:, 3 + edge, j] = 4.0 * barycentric[:, i]
    return by_coordinate[:, :, 1:] - by_coordinate[:, :, :1]


def _gauss_interval(degree: int) -> tuple[Array, Array]:
    x, w = np.polynomial.legendre.leggauss(degree // 2 + 1)
    return 0.5 * (x + 1.0), 0.5 * w


def _gauss_cube(degree: int) -> tuple[Array, Array, Array, Array]:
    x, w = _gauss_interval(degree)
    u, v, t = (grid.ravel() for grid in np.meshgrid(x, x, x, indexing="ij"))
    return u, v, t, np.einsum("i,j,k->ijk", w, w, w).ravel()
