"""`rbfem inertia`: the table, the JSON, the snippets and the refusals."""

import json
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import meshio
import numpy as np
import pytest
from click.testing import CliRunner

import rbfem as library
from rbfem.cli import commands, main

MESHES = Path(__file__).parents[2] / "meshes"
BRACKET = MESHES / "bracket.msh"
NAMES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def say(*words):
    done = CliRunner().invoke(commands, ["inertia", *map(str, words)], catch_exceptions=False)
    assert done.exit_code == 0
    return done.output


def refusal(capsys, *words):
    with pytest.raises(SystemExit) as ended:
        main(["inertia", *map(str, words)])
    assert ended.value.code == 2
    said = capsys.readouterr()
    assert said.out == ""
    return said.err


@pytest.fixture(scope="module")
def properties():
    return library.mass_properties(library.read_mesh(BRACKET), 7850.0)


def tensor_of(values):
    xx, xy, xz, yy, yz, zz = values
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def test_json_has_all_that_the_design_promises_to_the_last_digit(properties):
    told = json.loads(say(BRACKET, "--density", 7850, "--json"))
    assert told["mass"] == properties.mass and told["volume"] == properties.volume
    np.testing.assert_array_equal(told["center_of_mass"], properties.center_of_mass)
    np.testing.assert_array_equal(told["inertia"], properties.inertia)
    np.testing.assert_array_equal(told["principal_moments"], properties.principal_moments)
    np.testing.assert_array_equal(told["principal_axes"], properties.principal_quaternion)
    assert 0 < told["error"] < 1e-10
    assert told["mesh"].keys() >= {"nodes", "tets", "groups", "quality", "repairs", "warnings"}
    assert told["mesh"]["groups"].keys() == {"steel", "rubber"}


def test_the_table_holds_the_numbers_a_person_looks_for(properties):
    told = say(BRACKET, "--density", "7.85 g/cm^3")
    for number in (properties.mass, properties.volume):
        assert f"{number:.12g}" in told
    for word in ("steel", "center of mass", "principal moments", "error of tensor", "quality"):
        assert word in told


def test_without_a_density_the_numbers_are_those_of_one_kilogram_a_cubic_metre(properties):
    assert json.loads(say(BRACKET, "--json"))["mass"] == pytest.approx(properties.volume, rel=1e-15)


def test_a_density_for_each_group(properties):
    told = json.loads(say(BRACKET, "--density", "steel=7850", "--density", "rubber=1.1 g/cm^3", "--json"))
    by_group = library.mass_properties(library.read_mesh(BRACKET), {"steel": 7850.0, "rubber": 1100.0})
    assert told["mass"] == pytest.approx(by_group.mass, rel=1e-14)
    assert told["mass"] < properties.mass


def test_a_density_from_a_field_of_the_mesh(tmp_path):
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    mesh = meshio.Mesh(corners, [("tetra", np.array([[0, 1, 2, 3]]))], cell_data={"rho": [np.array([12.0])]})
    meshio.write(tmp_path / "one.vtu", mesh)
    assert json.loads(say(tmp_path / "one.vtu", "--density", "field:rho", "--json"))["mass"] == pytest.approx(2.0)


def test_the_tensor_about_another_point_follows_the_parallel_axis_theorem(properties):
    told = json.loads(say(BRACKET, "--density", 7850, "--about", "0.1,0,-0.2", "--json"))["inertia_about"]
    arm = properties.center_of_mass - [0.1, 0, -0.2]
    expected = properties.inertia + properties.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    np.testing.assert_allclose(told["inertia"], expected, rtol=1e-12)
    assert "inertia about 0.1, 0, -0.2" in say(BRACKET, "--about", "0.1,0,-0.2")


def test_the_exact_shape_tells_the_discretisation_error():
    ball = MESHES / "sphere_tet10.msh"
    plain = json.loads(say(ball, "--json"))
    assert plain["error_parts"]["discretisation"] is None
    radius = (3 * plain["volume"] / (4 * np.pi)) ** (1 / 3)
    exact = json.loads(say(ball, "--exact", f"sphere:radius={radius}", "--json"))
    assert 0 < exact["error_parts"]["discretisation"] < 0.01


def test_a_second_mesh_tells_the_discretisation_error(tmp_path):
    """One tet, and the same one cut into eight and three percent longer, as if it filled a curved part better."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    middles = np.array([(corners[i] + corners[j]) / 2 for i, j in ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))])
    eight = [
        [0, 4, 5, 6],
        [4, 1, 7, 8],
        [5, 7, 2, 9],
        [6, 8, 9, 3],
        [4, 9, 5, 6],
        [4, 9, 6, 8],
        [4, 9, 8, 7],
        [4, 9, 7, 5],
    ]
    meshio.write(tmp_path / "one.vtu", meshio.Mesh(corners, [("tetra", np.array([[0, 1, 2, 3]]))]))
    meshio.write(
        tmp_path / "eight.vtu", meshio.Mesh(1.03 * np.vstack([corners, middles]), [("tetra", np.array(eight))])
    )
    told = json.loads(say(tmp_path / "one.vtu", "--second", tmp_path / "eight.vtu", "--json"))
    difference = 1.03**5 - 1  # of the two tensors; Richardson for order 2: 4/3 of it
    assert told["error_parts"]["discretisation"] == pytest.approx(4 / 3 * difference, rel=0.2)
    assert told["error"] >= told["error_parts"]["discretisation"]


def test_urdf_parses_and_holds_the_numbers(properties):
    root = ElementTree.fromstring(say(BRACKET, "--density", 7850, "--urdf"))
    assert float(root.find("mass").get("value")) == properties.mass
    assert [float(x) for x in root.find("origin").get("xyz").split()] == properties.center_of_mass.tolist()
    assert root.find("origin").get("rpy") == "0 0 0"
    inertia = root.find("inertia")
    np.testing.assert_array_equal(tensor_of([float(inertia.get(name)) for name in NAMES]), properties.inertia)


def test_sdf_parses_and_holds_the_numbers(properties):
    root = ElementTree.fromstring(say(BRACKET, "--density", 7850, "--sdf"))
    assert float(root.findtext("mass")) == properties.mass
    assert [float(x) for x in root.findtext("pose").split()] == [*properties.center_of_mass.tolist(), 0, 0, 0]
    tensor = tensor_of([float(root.findtext(f"inertia/{name}")) for name in NAMES])
    np.testing.assert_array_equal(tensor, properties.inertia)


def test_mjcf_parses_and_holds_the_numbers(properties):
    root = ElementTree.fromstring(say(BRACKET, "--density", 7850, "--mjcf"))
    assert float(root.get("mass")) == properties.mass
    xx, yy, zz, xy, xz, yz = (float(x) for x in root.get("fullinertia").split())
    np.testing.assert_array_equal(tensor_of([xx, xy, xz, yy, yz, zz]), properties.inertia)


def test_mujoco_reads_the_snippet_as_the_same_body(properties):
    mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed")
    inertial = say(BRACKET, "--density", 7850, "--mjcf")
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco><worldbody><body>{inertial}<freejoint/></body></worldbody></mujoco>"
    )
    assert model.body_mass[1] == pytest.approx(properties.mass, rel=1e-12)
    np.testing.assert_allclose(model.body_ipos[1], properties.center_of_mass, rtol=1e-12)
    np.testing.assert_allclose(sorted(model.body_inertia[1]), properties.principal_moments, rtol=1e-9)


@pytest.mark.parametrize("density", ["0", "-5", "nan", "inf", "heavy", "5 m", "steel=-1", "steel=5 m"])
def test_an_impossible_density_is_refused(capsys, density):
    said = refusal(capsys, BRACKET, "--density", density)
    assert "density" in said and density.rpartition("=")[2].split()[0] in said


def test_two_densities_without_groups_are_refused(capsys):
    assert "expected one" in refusal(capsys, BRACKET, "--density", "1", "--density", "2")
    assert "GROUP=DENSITY" in refusal(capsys, BRACKET, "--density", "1", "--density", "steel=2")


def test_a_group_that_the_mesh_lacks_or_that_was_forgotten_is_refused(capsys):
    assert "stel" in refusal(capsys, BRACKET, "--density", "stel=1", "--density", "rubber=1")
    assert "rubber" in refusal(capsys, BRACKET, "--density", "steel=1")


@pytest.mark.parametrize("point", ["1,2", "1,2,x", "", "1 2 3", "nan,0,0", "0,inf,0"])
def test_a_point_that_is_none_is_refused(capsys, point):
    said = refusal(capsys, BRACKET, "--about", point)
    assert "--about" in said and "three numbers" in said and repr(point) in said


def test_an_exact_shape_that_nobody_knows_is_refused(capsys):
    assert "cone:radius=1" in refusal(capsys, BRACKET, "--exact", "cone:radius=1")


@pytest.mark.parametrize("unit", ["kg", "parsnip", "0 mm", ""])
def test_a_unit_that_is_no_length_is_refused(capsys, unit):
    assert "unit" in refusal(capsys, BRACKET, "--unit", unit)


def test_a_mesh_that_is_missing_or_unreadable_is_refused(capsys, tmp_path):
    assert "nowhere.msh" in refusal(capsys, tmp_path / "nowhere.msh")
    (tmp_path / "noise.vtu").write_bytes(bytes(range(256)))
    assert "noise.vtu" in refusal(capsys, tmp_path / "noise.vtu")
    assert str(tmp_path) in refusal(capsys, tmp_path)
