"""How a plain function of components is applied to every row of some arrays, without a kernel."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FEW = 20  # rows that take as long one by one, as floats, as NumPy takes to begin with their columns (measured)
BLOCK = 4096  # rows whose columns stay in the cache


def each_row(function: Callable, *tables: NDArray) -> Array:
    """What a function makes of every row: its components as the columns of an array, (n, k), in either memory order.

    function : of a row of each table, in their order: a sequence of components for a table (n, j), a number for (n,);
               returns k components
    Few rows are handed over one by one, as floats; many block by block, as columns. So the function may add, multiply
    and compare; a branch or a division is not for it. The numbers come out the same, to the last bit.

    >>> each_row(lambda point, mass: (mass * point[0], mass * point[1]), np.ones((2, 3)), np.array([2.0, 3.0]))
    array([[2., 2.],
           [3., 3.]])
    """
    n = len(tables[0])
    if 0 < n <= FEW:
        rows = zip(*[table.tolist() for table in tables], strict=True)
        return np.array([function(*row) for row in rows])
    blocks = [slice(first, first + BLOCK) for first in range(0, max(n, 1), BLOCK)]
    columns = function(*[table[blocks[0]].T for table in tables])
    joined = np.empty((len(columns), n))
    joined[:, blocks[0]] = columns
    for block in blocks[1:]:
        joined[:, block] = function(*[table[block].T for table in tables])
    return joined.T
