"""One function of components, over few rows and over many."""

import numpy as np
import pytest

from rbfem.compute.rows import BLOCK, FEW, each_row


def mix(point, rate, mass, count):
    x, y, z = point
    return mass * (x * y - 0.3 * z) + rate[1], (z > 0.0) * mass - rate[0] * x, x * z, (count != 2) * y + count


def tables(n):
    rng = np.random.default_rng(n)
    return rng.normal(size=(n, 3)), rng.normal(size=(2, n)).T, rng.uniform(1, 2, n), rng.integers(0, 4, n)


@pytest.mark.parametrize("n", [1, FEW, FEW + 1, BLOCK, BLOCK + 1, 3 * BLOCK - 1])
def test_every_row_is_that_of_the_function_to_the_last_bit(n):
    rows = zip(*[table.tolist() for table in tables(n)], strict=True)
    expected = np.array([mix(*row) for row in rows])
    assert (each_row(mix, *tables(n)) == expected).all()


def test_no_rows_have_their_columns():
    assert each_row(mix, *tables(0)).shape == (0, 4)


@pytest.mark.parametrize("n", [FEW, FEW + 1])
def test_what_is_no_number_stays_in_its_row(n):
    points, *others = tables(n)
    points[1] = np.nan, np.inf, -np.inf
    with np.errstate(invalid="ignore"):
        result = each_row(mix, points, *others)
    assert np.isnan(result[1, 0]) and np.isfinite(np.delete(result, 1, axis=0)).all()
