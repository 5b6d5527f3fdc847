"""A field of the mesh file keeps its kind, whatever the numbers of nodes and tets."""

import numpy as np
import pytest

from rbfem.fem.density import field_of_file
from rbfem.fem.mass_properties import mass_properties
from rbfem.mesh.tet_mesh import TetMesh


def test_a_point_field_stays_one_where_there_are_as_many_nodes_as_tets():
    nodes = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    values = np.array([1.0, 2, 3, 10])
    mesh = TetMesh(nodes, np.tile([0, 1, 2, 3], (4, 1)), point_fields={"rho": values})
    field = field_of_file(mesh, "rho")
    assert field.is_nodal
    body = mass_properties(mesh, field)
    assert body.mass == pytest.approx(4 * values.mean() / 6, rel=1e-14)
    expected = (
        0.05 * (values @ nodes + values.sum() * nodes.sum(axis=0)) / values.mean()
    )  # (Σρx + ΣρΣx)/20 over the mean
    np.testing.assert_allclose(body.center_of_mass, expected, rtol=1e-14)
