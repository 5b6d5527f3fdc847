"""From shapes and materials to parts."""

from pathlib import Path

import meshio
import numpy as np
import pytest

import rbfem

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1.0]])
TETS = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])  # volumes 1/6 and 1/3


@pytest.fixture
def two_tets(tmp_path):
    """A mesh with a cell field and a point field of density."""
    fields = {
        "point_data": {"at_nodes": np.array([1.0, 2, 3, 4, 5])},
        "cell_data": {"in_cells": [np.array([6.0, 3.0])]},
    }
    meshio.write(tmp_path / "two.vtu", meshio.Mesh(CORNERS, [("tetra", TETS)], **fields))
    return {"shapes": {"two": {"mesh": "two.vtu"}}}


def test_bodies_of_one_shape_and_material_share_a_part(scene_of):
    scene = scene_of({}, {"material": "steel"}, {"shape": "ball"}, {})
    assert scene.part_of.tolist() == [0, 1, 2, 0]
    assert [part.kind for part in scene.parts] == ["box", "box", "sphere"]


@pytest.mark.parametrize(
    ("shape", "moments"),
    [
        ({"sphere": {"radius": 0.3}}, 0.4 * np.array([0.09, 0.09, 0.09])),
        ({"box": {"size": [1, 2, 3]}}, np.array([1 + 4, 1 + 9, 4 + 9]) / 12),
        ({"cylinder": {"radius": 0.2, "height": 2}}, [0.02, 0.04 / 4 + 4 / 12, 0.04 / 4 + 4 / 12]),
        ({"ellipsoid": {"radii": [1, 2, 3]}}, np.array([1 + 4, 1 + 9, 4 + 9]) / 5),
    ],
)
def test_a_primitive_has_the_moments_of_its_formula(scene_of, shape, moments):
    part = scene_of({"shape": "it"}, shapes={"it": shape}).parts[0]
    np.testing.assert_allclose(part.principal_moments, part.mass * np.array(moments), rtol=1e-14)


def test_the_unit_of_a_mesh_scales_lengths(scene_of, two_tets):
    two_tets["shapes"]["two"]["unit"] = "mm"
    part = scene_of({"shape": "two"}, **two_tets).parts[0]
    assert part.volume == pytest.approx(0.5e-9, rel=1e-14)
    assert part.mass == pytest.approx(0.5e-6, rel=1e-14)


def test_each_volume_group_takes_the_material_of_its_name(scene_of):
    scene = scene_of({"shape": "bracket", "material": "by-group"})
    part = scene.parts[0]
    names = np.array(scene.materials)[part.tet_material]
    np.testing.assert_array_equal(part.tet_density, np.where(names == "steel", 7850.0, 1100.0))
    for group, tets in part.mesh.groups.items():
        assert set(names[tets]) == {group}
    both = {"steel": 7850.0, "rubber": 1100.0}
    assert part.mass == pytest.approx(rbfem.mass_properties(part.mesh, both).mass, rel=1e-15)
    assert set(np.array(scene.materials)[part.triangle_material]) == {"steel", "rubber"}


def test_a_material_may_take_its_density_from_a_cell_field(scene_of, two_tets):
    part = scene_of(
        {"shape": "two", "material": "odd"}, materials={"odd": {"density": {"field": "in_cells"}}}, **two_tets
    ).parts[0]
    np.testing.assert_array_equal(part.tet_density, [6, 3])
    assert part.mass == pytest.approx(2.0, rel=1e-14)


def test_a_material_may_take_its_density_from_a_point_field(scene_of, two_tets):
    part = scene_of(
        {"shape": "two", "material": "odd"}, materials={"odd": {"density": {"field": "at_nodes"}}}, **two_tets
    ).parts[0]
    np.testing.assert_allclose(part.tet_density, [2.5, 3.5], rtol=1e-14)
    assert part.mass == pytest.approx(2.5 / 6 + 3.5 / 3, rel=1e-14)
    np.testing.assert_allclose(-part.mass * part.origin, first_moment(CORNERS, TETS, [1.0, 2, 3, 4, 5]), rtol=1e-13)


def first_moment(nodes, tets, density):
    """∫ ρ x dV of linear density: Σ_ij V (1 + δ_ij)/20 ρ_i x_j."""
    total = np.zeros(3)
    for tet in tets:
        volume = abs(np.linalg.det(nodes[tet[1:]] - nodes[tet[0]])) / 6
        total += volume / 20 * np.asarray(density)[tet] @ (1 + np.eye(4)) @ nodes[tet]
    return total


def test_the_drawn_surface_is_closed_and_centred_on_the_mass(scene_of):
    part = scene_of({"shape": "bracket", "material": "steel"}).parts[0]
    a, b, c = (part.points[part.triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    assert np.abs(normals.sum(axis=0)).max() < 1e-12
    centroid = (np.einsum("ij,ij->i", a, normals)[:, None] * (a + b + c)).sum(axis=0)
    assert np.abs(centroid).max() / 24 < 1e-12  # ∫ x dV, about the centre of mass of one material
    assert np.einsum("ij,ij", a, normals) / 6 == pytest.approx(part.volume, rel=1e-12)


def test_a_second_order_surface_is_drawn_with_its_midside_nodes(scene_of):
    mesh = Path(__file__).parents[2] / "meshes/sphere_tet10.msh"
    part = scene_of({"shape": "it"}, shapes={"it": {"mesh": str(mesh)}}).parts[0]
    assert len(part.triangle_material) == len(part.triangles)
    assert len(part.triangles) % 4 == 0
    radii = np.linalg.norm(part.points, axis=1)
    assert radii.min() / radii.max() > 1 - 1e-3
