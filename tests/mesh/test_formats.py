import meshio
import numpy as np
import pytest

from rbfem.errors import InputError
from rbfem.mesh.check import summarize
from rbfem.mesh.read import read_mesh


@pytest.mark.parametrize(
    "ending", ["vtu", "vtk", "xdmf", "inp", "med", "mesh", "msh", "su2", "h5m", "cgns", "mdpa", "vol"]
)
def test_what_meshio_writes_comes_back_with_its_volume(write, corner_tet, ending):
    mesh = read_mesh(write(*corner_tet, name=f"part.{ending}"))
    assert summarize(mesh).volume == pytest.approx(1 / 6, rel=1e-15)
    assert mesh.repairs == () and mesh.warnings == ()


@pytest.mark.parametrize("version", ["2.2", "4.1"])
@pytest.mark.parametrize("binary", [False, True])
def test_both_gmsh_formats_as_text_and_binary(tmp_path, corner_tet, version, binary):
    path = tmp_path / "part.msh"
    meshio.gmsh.write(str(path), meshio.Mesh(*corner_tet), fmt_version=version, binary=binary)
    assert summarize(read_mesh(path)).volume == pytest.approx(1 / 6, rel=1e-15)


@pytest.fixture(scope="module")
def gmsh_files(gmsh, tmp_path_factory):
    """A box 1 x 2 x 3 of gmsh with the groups `steel` and `left`, in its own formats, first and second order."""
    folder = tmp_path_factory.mktemp("gmsh")
    for order in (1, 2):
        gmsh.initialize(readConfigFiles=False, interruptible=False)
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.model.occ.addBox(0, 0, 0, 1, 2, 3)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [1], name="steel")
        gmsh.model.addPhysicalGroup(2, [1], name="left")
        gmsh.option.setNumber("Mesh.MeshSizeMax", 2)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(order)
        for ending in ("msh", "med", "inp", "vtk", "mesh", "su2"):
            gmsh.write(str(folder / f"order{order}.{ending}"))
        gmsh.option.setNumber("Mesh.Binary", 1)
        gmsh.write(str(folder / f"order{order}_binary.msh"))
        gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
        gmsh.write(str(folder / f"order{order}_binary22.msh"))
        gmsh.finalize()
    return folder


NAMED = ["order1.msh", "order1_binary.msh", "order1_binary22.msh", "order1.med", "order1.inp"]
NAMED_CURVED = ["order2.msh", "order2_binary.msh", "order2_binary22.msh", "order2.med"]


@pytest.mark.parametrize("name", NAMED + NAMED_CURVED)
def test_gmsh_groups_keep_their_names(gmsh_files, name):
    mesh = read_mesh(gmsh_files / name)
    assert len(mesh.groups["steel"]) == mesh.n_tets
    assert mesh.is_second_order == name.startswith("order2")
    left = mesh.surfaces["left"]
    assert (mesh.nodes[left][:, :, 0] == 0.0).all()
    edges = mesh.nodes[left[:, 1:3]] - mesh.nodes[left[:, :1]]
    areas = np.cross(edges[:, 0], edges[:, 1]) / 2
    assert areas.sum(axis=0) == pytest.approx([-6.0, 0.0, 0.0], abs=1e-12)  # outward: towards smaller x
    assert summarize(mesh).volume == pytest.approx(6.0, rel=1e-14)


@pytest.mark.parametrize(("name", "group"), [("order1.mesh", "ref_1"), ("order1.vtk", None), ("order1.su2", None)])
def test_gmsh_formats_without_names(gmsh_files, name, group):
    mesh = read_mesh(gmsh_files / name)
    assert summarize(mesh).volume == pytest.approx(6.0, rel=1e-14)
    assert group is None or group in mesh.groups


@pytest.mark.parametrize("order", [1, 2])
def test_med_of_gmsh_is_inside_out_and_is_turned(gmsh_files, order):
    """Second-order nodes must follow the corners: the same volume with straight edges, and no fold."""
    mesh = read_mesh(gmsh_files / f"order{order}.med")
    assert mesh.repairs == (f"{mesh.n_tets} of {mesh.n_tets} tets were inside out: flipped",)
    assert mesh.warnings == ()


def test_millimetres_become_metres(write, corner_tet):
    points, cells = corner_tet
    mesh = read_mesh(write(10 * points, cells), unit="mm")
    assert mesh.nodes.max() == 0.01


def test_an_unknown_unit_lists_the_known_ones(write, corner_tet):
    with pytest.raises(InputError, match=r"read 'furlong'.*one of m, cm, mm, um, nm, km, in, ft"):
        read_mesh(write(*corner_tet), unit="furlong")


def test_scalar_fields_are_carried_and_bookkeeping_is_not(write, corner_tet):
    data = {"density": [np.array([7.0])], "gmsh:physical": [np.array([3])], "vector": [np.ones((1, 3))]}
    points = {"temperature": np.arange(4.0), "vector": np.ones((4, 3))}
    mesh = read_mesh(write(*corner_tet, cell_data=data, point_data=points))
    assert {name: values.tolist() for name, values in mesh.cell_fields.items()} == {"density": [7.0]}
    assert {name: values.tolist() for name, values in mesh.point_fields.items()} == {"temperature": [0, 1, 2, 3]}
    assert mesh.groups["physical_3"].tolist() == [0]


ABAQUS = """*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 0, 1, 0
4, 0, 0, 1
5, 1, 1, 1
*ELEMENT, TYPE=T3D2
1, 1, 2
2, 1, 3
*ELEMENT, type=C3D4, ELSET=steel
3, 1, 2, 3, 4
*ELEMENT, type=C3D4, ELSET=rubber
4, 2, 3, 4, 5
*ELEMENT, type=S3, ELSET=floor
5, 1, 2, 3
*ELSET, ELSET=both
steel, rubber
*ELSET, ELSET=listed
4,
*ELSET, ELSET=nothing
"""


def test_abaqus_sets_land_on_their_own_elements(tmp_path):
    """meshio alone puts `steel` on the trusses and `both` nowhere."""
    path = tmp_path / "part.inp"
    path.write_text(ABAQUS)
    mesh = read_mesh(path)
    assert {name: tets.tolist() for name, tets in mesh.groups.items()} == {
        "steel": [0],
        "rubber": [1],
        "both": [0, 1],
        "listed": [1],
    }
    assert mesh.surfaces["floor"].tolist() == [[0, 2, 1]]


def test_med_families_with_two_names_make_two_groups(tmp_path, corner_tet):
    mesh = meshio.Mesh(*corner_tet, cell_data={"cell_tags": [np.array([-1])]})
    mesh.cell_tags = {-1: ["steel", "left half"]}
    meshio.med.write(str(tmp_path / "part.med"), mesh)
    assert set(read_mesh(tmp_path / "part.med").groups) == {"steel", "left half"}


def test_an_empty_physical_group_is_said(write, corner_tet):
    data = {"gmsh:physical": [np.array([1])], "gmsh:geometrical": [np.array([1])]}
    names = {"steel": np.array([1, 3]), "ghost": np.array([2, 3])}
    path = write(*corner_tet, name="part.msh", cell_data=data, field_data=names)
    mesh = read_mesh(path)
    assert "ghost" not in mesh.groups
    assert any("group 'ghost' has no cells" in warning for warning in mesh.warnings)
