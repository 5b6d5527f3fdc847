"""Small meshes whose volumes are known by hand, and a writer for them."""

import meshio
import numpy as np
import pytest

CORNER_TET = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])


@pytest.fixture
def write(tmp_path):
    """Write points and cells to a file in a temporary folder; returns its path."""

    def to_file(points, cells, name="part.vtu", **data):
        path = tmp_path / name
        mesh = meshio.Mesh(np.asarray(points, dtype=float), cells, **data)
        meshio.write(path, mesh, file_format="gmsh" if name.endswith(".msh") else None)
        return path

    return to_file


@pytest.fixture
def corner_tet():
    """Points and cells of one tet of volume 1/6."""
    return CORNER_TET.copy(), [("tetra", np.array([[0, 1, 2, 3]]))]


@pytest.fixture
def grid():
    """Hexahedra that fill the unit cube, n to a side: points, (n^3, 8) cells."""

    def make(n=2):
        index = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
        points = np.stack(np.meshgrid(*[np.linspace(0, 1, n + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
        i, j, k = (axis.ravel() for axis in np.meshgrid(*[np.arange(n)] * 3, indexing="ij"))
        low = [index[i, j, k], index[i + 1, j, k], index[i + 1, j + 1, k], index[i, j + 1, k]]
        high = [index[i, j, k + 1], index[i + 1, j, k + 1], index[i + 1, j + 1, k + 1], index[i, j + 1, k + 1]]
        return points, np.column_stack(low + high)

    return make


@pytest.fixture(scope="session")
def gmsh():
    return pytest.importorskip("gmsh", reason="gmsh or one of its system libraries is missing", exc_type=Exception)
