"""What a case may say that only its meshes can refuse: file and line, what was read, what was expected."""

from pathlib import Path

import meshio
import numpy as np
import pytest

import rbfem
from rbfem.errors import InputError

CASE = """rbfem: 1
shapes:
  bracket: {mesh: MESHFILE}
  brick: {box: {size: [1, 1, 1]}}
materials:
  steel: {density: 7850}
  rubber: {density: 1100}
bodies:
  - name: part
    shape: bracket
    material: steel
    loads:
      - {force: [1, 0, 0]}
      - {pressure: 1, on: top}
time: {end: 1}
"""
CORNER = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
TET = [("tetra", np.array([[0, 1, 2, 3]]))]


@pytest.fixture
def message(tmp_path):
    """What the case says, with changes of its text, and how it is refused."""

    def refused(*changes, mesh=None):
        bracket = Path(__file__).parents[2] / "meshes/bracket.msh"
        text = CASE.replace("MESHFILE", mesh or str(bracket))
        for old, new in changes:
            assert text.count(old) == 1, old
            text = text.replace(old, new)
        (tmp_path / "case.yaml").write_text(text)
        with pytest.raises(InputError) as caught:
            rbfem.load(tmp_path)
        return str(caught.value)

    return refused


def test_an_unknown_surface_group_is_told_with_those_the_mesh_has(message):
    said = message()
    assert "case.yaml:14: bodies.part.loads.1: " in said
    assert "no surface group 'top'" in said and "bolted" in said and "loaded" in said


def test_a_pressure_on_a_primitive_is_refused(message):
    said = message(("shape: bracket", "shape: brick"))
    assert "case.yaml:14: bodies.part.loads.1: a box has no surface groups" in said


def test_a_missing_mesh_is_told_at_the_line_of_its_shape(message):
    said = message(mesh="nowhere.msh")
    assert "case.yaml:3: shapes.bracket: " in said and "nowhere.msh" in said


def test_a_mesh_that_is_no_mesh_is_told_at_the_line_of_its_shape(message, tmp_path):
    (tmp_path / "noise.msh").write_bytes(bytes(range(256)) * 4)
    assert "case.yaml:3: shapes.bracket: " in message(mesh="noise.msh")


def test_a_mesh_without_tets_is_refused(message, tmp_path):
    meshio.write(tmp_path / "skin.vtu", meshio.Mesh(CORNER, [("triangle", np.array([[0, 1, 2]]))]))
    said = message(mesh="skin.vtu")
    assert "case.yaml:3: shapes.bracket: " in said and "tet" in said


def test_a_mesh_with_a_nan_is_refused(message, tmp_path):
    points = CORNER.copy()
    points[2, 1] = np.nan
    meshio.write(tmp_path / "bad.vtu", meshio.Mesh(points, TET))
    assert "case.yaml:3: shapes.bracket: " in message(mesh="bad.vtu")


def test_a_mesh_of_no_volume_is_refused(message, tmp_path):
    flat = CORNER * [1, 1, 0]
    meshio.write(tmp_path / "flat.vtu", meshio.Mesh(flat, TET))
    assert "case.yaml:3: shapes.bracket: " in message(mesh="flat.vtu")


@pytest.mark.parametrize("values", [[0.0], [-2.0], [np.nan], [np.inf]])
def test_a_field_of_impossible_density_is_refused(message, tmp_path, values):
    meshio.write(tmp_path / "odd.vtu", meshio.Mesh(CORNER, TET, cell_data={"rho": [np.array(values)]}))
    said = message(("{density: 7850}", "{density: {field: rho}}"), mesh="odd.vtu")
    assert "case.yaml:3: shapes.bracket: " in said and "density" in said and "above zero" in said


def test_a_negative_density_at_one_node_of_a_tet_that_weighs_something_is_refused(message, tmp_path):
    """The mass would be positive, the inertia tensor not positive definite."""
    meshio.write(tmp_path / "odd.vtu", meshio.Mesh(CORNER, TET, point_data={"rho": np.array([-3.0, 2.0, 2.0, 2.0])}))
    said = message(("{density: 7850}", "{density: {field: rho}}"), mesh="odd.vtu")
    assert "case.yaml:3: shapes.bracket: " in said


def test_a_field_that_the_mesh_lacks_is_told_with_those_it_has(message, tmp_path):
    meshio.write(tmp_path / "odd.vtu", meshio.Mesh(CORNER, TET, cell_data={"density": [np.array([5.0])]}))
    said = message(("{density: 7850}", "{density: {field: rho}}"), mesh="odd.vtu")
    assert "'rho'" in said and "density" in said


def test_a_group_without_a_material_of_its_name_is_told_with_the_materials(message):
    said = message(("material: steel", "material: by-group"), ("rubber: {density", "gum: {density"))
    assert "case.yaml:3: shapes.bracket: " in said
    assert "no material is called 'rubber'" in said and "steel, gum" in said


def test_by_group_on_a_mesh_without_groups_is_refused(message, tmp_path):
    meshio.write(tmp_path / "plain.vtu", meshio.Mesh(CORNER, TET))
    said = message(("material: steel", "material: by-group"), mesh="plain.vtu")
    assert "case.yaml:3: shapes.bracket: " in said and "group" in said


def test_by_group_with_a_density_from_node_to_node_is_refused(message, tmp_path):
    """A node between two groups would have the densities of both."""
    fields = {"point_data": {"rho": np.ones(4)}, "cell_data": {"gmsh:physical": [np.array([7])]}}
    meshio.write(tmp_path / "nodal.vtu", meshio.Mesh(CORNER, TET, **fields))
    field = ("rubber: {density: 1100}", "physical_7: {density: {field: rho}}")
    said = message(("material: steel", "material: by-group"), field, mesh="nodal.vtu")
    assert "case.yaml:3: shapes.bracket: " in said and "varies from node to node" in said


def test_a_mesh_may_not_come_in_a_unit_of_another_dimension(message):
    assert "case.yaml:3: shapes.bracket.unit: " in message(("msh}", "msh, unit: kg}"))
