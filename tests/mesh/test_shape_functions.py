from fractions import Fraction
from itertools import product
from math import factorial

import numpy as np
import pytest

from rbfem.mesh.shape_functions import (
    EDGES,
    TRIANGLE_EDGES,
    monomial_integral,
    quadratic,
    quadratic_gradients,
    tet_quadrature,
    triangle_quadratic,
    triangle_quadratic_gradients,
    triangle_quadrature,
)

POWERS = [powers for powers in product(range(5), repeat=4) if sum(powers) <= 6]


def exact_monomial(powers):
    """∫ over the corner tet of x^b y^c z^d (1-x-y-z)^a, expanded and integrated power by power."""
    a, b, c, d = powers
    total = Fraction(0)
    for i, j, k in product(range(a + 1), repeat=3):
        if i + j + k <= a:
            coefficient = Fraction(factorial(a), factorial(i) * factorial(j) * factorial(k) * factorial(a - i - j - k))
            total += (-1) ** (i + j + k) * coefficient * simplex_power(b + i, c + j, d + k)
    return total


def simplex_power(p, q, r):
    """∫ x^p y^q z^r over the corner tet: first z up to 1-x-y, then y up to 1-x by beta functions."""
    over_z = Fraction(1, r + 1)
    over_y = Fraction(factorial(q) * factorial(r + 1), factorial(q + r + 2))
    over_x = Fraction(factorial(p) * factorial(q + r + 2), factorial(p + q + r + 3))
    return over_z * over_y * over_x


@pytest.mark.parametrize("volume", [1.0 / 6.0, 2.5])
def test_the_factorial_formula_is_the_exact_integral(volume):
    for powers in POWERS:
        exact = float(6 * exact_monomial(powers)) * volume
        assert monomial_integral(*powers, volume) == pytest.approx(exact, rel=4e-16)


@pytest.mark.parametrize("degree", [1, 2, 4, 6, 7, 9])
def test_tet_quadrature_is_exact_up_to_its_degree(degree):
    points, weights = tet_quadrature(degree)
    assert (points > 0).all() and (weights > 0).all()
    assert points.sum(axis=1) == pytest.approx(np.ones(len(points)), abs=1e-15)
    for powers in product(range(degree + 1), repeat=4):
        if sum(powers) == degree:
            value = weights @ np.prod(points ** np.array(powers), axis=1)
            assert value == pytest.approx(monomial_integral(*powers, 1 / 6), rel=1e-13)


@pytest.mark.parametrize("degree", [1, 2, 4, 6])
def test_tet_quadrature_is_not_exact_far_beyond_its_degree(degree):
    points, weights = tet_quadrature(degree)
    beyond = degree + 6
    exact = monomial_integral(0, beyond, 0, 0, 1 / 6)
    assert abs(weights @ points[:, 1] ** beyond / exact - 1.0) > 1e-9


@pytest.mark.parametrize("degree", [1, 2, 4, 8])
def test_triangle_quadrature_is_exact_up_to_its_degree(degree):
    points, weights = triangle_quadrature(degree)
    for a, b, c in product(range(degree + 1), repeat=3):
        if a + b + c == degree:
            value = weights @ np.prod(points ** np.array([a, b, c]), axis=1)
            exact = factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 2)
            assert value == pytest.approx(exact, rel=1e-13)


def inside(n_corners, n=20):
    return np.random.default_rng(2).dirichlet(np.ones(n_corners), size=n)


@pytest.mark.parametrize(
    ("values", "gradients", "edges"),
    [(quadratic, quadratic_gradients, EDGES), (triangle_quadratic, triangle_quadratic_gradients, TRIANGLE_EDGES)],
    ids=["tetrahedron", "triangle"],
)
class TestQuadraticFunctions:
    def test_each_is_one_at_its_node_and_zero_at_the_others(self, values, gradients, edges):
        corners = np.eye(edges.max() + 1)
        nodes = np.vstack([corners, corners[edges].mean(axis=1)])
        assert values(nodes) == pytest.approx(np.eye(len(nodes)), abs=1e-15)

    def test_they_add_up_to_one_and_give_back_the_point(self, values, gradients, edges):
        points = inside(edges.max() + 1)
        corners = np.eye(edges.max() + 1)
        nodes = np.vstack([corners, corners[edges].mean(axis=1)])
        assert values(points).sum(axis=1) == pytest.approx(np.ones(len(points)), abs=1e-15)
        assert values(points) @ nodes == pytest.approx(points, abs=1e-15)

    def test_gradients_are_the_slopes_of_the_values(self, values, gradients, edges):
        points, h = inside(edges.max() + 1), 1e-5
        for axis in range(edges.max()):
            step = np.zeros(edges.max() + 1)
            step[axis + 1], step[0] = h, -h
            slope = (values(points + step) - values(points - step)) / (2 * h)
            assert gradients(points)[:, :, axis] == pytest.approx(slope, abs=1e-10)
        assert gradients(points).sum(axis=1) == pytest.approx(np.zeros((len(points), edges.max())), abs=1e-14)
