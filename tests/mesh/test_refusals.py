import sys

import meshio
import numpy as np
import pytest

from rbfem.errors import InputError
from rbfem.mesh.containment import contained
from rbfem.mesh.read import read_mesh

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
TET = [("tetra", np.array([[0, 1, 2, 3]]))]


def refusal(path):
    with pytest.raises(InputError) as caught:
        read_mesh(path)
    assert str(caught.value).startswith(f"{path}: ") and "\n" not in str(caught.value)
    return str(caught.value)


def test_a_file_that_is_not_there(tmp_path):
    assert "no such file" in refusal(tmp_path / "part.msh")


def test_a_directory(tmp_path):
    assert "is a directory, expected a mesh file" in refusal(tmp_path)


def test_an_empty_file(tmp_path):
    (tmp_path / "part.msh").touch()
    assert "is empty" in refusal(tmp_path / "part.msh")


def test_a_kind_that_is_not_known_lists_those_that_are(tmp_path):
    path = tmp_path / "part.docx"
    path.write_text("words")
    assert "unknown kind of file '.docx'; expected one of .avs" in refusal(path)


@pytest.mark.parametrize("ending", ["stl", "step", "geo"])
def test_a_shape_without_tets_names_the_command_that_makes_them(tmp_path, ending):
    path = tmp_path / f"part.{ending}"
    path.write_text("solid")
    assert f"make them first: rbfem mesh {path} -o {path.with_suffix('.msh')}, with the --unit" in refusal(path)


def test_a_surface_mesh(write):
    assert "no tetrahedra (nor hexahedra, wedges, pyramids) in it, only triangle" in refusal(
        write(POINTS, [("triangle", np.array([[0, 1, 2]]))])
    )


@pytest.mark.parametrize("number", [np.nan, np.inf, 1e200])
def test_a_coordinate_that_is_no_number(write, number):
    points = POINTS.copy()
    points[2, 1] = number
    assert "a coordinate that is not a finite number" in refusal(write(points, TET))


def test_a_node_that_does_not_exist(write):
    path = write(POINTS, [("tetra", np.array([[0, 1, 2, 7]]))])
    assert "name nodes 0 to 7, but the file has nodes 0 to 3" in refusal(path)


def test_a_mesh_without_volume(write):
    words = refusal(write(np.vstack([POINTS[:3], [[1, 1, 0]]]), TET))
    assert "the volume of the mesh is zero (1 tets of zero volume dropped)" in words


def test_all_nodes_at_one_place(write):
    assert "the volume of the mesh is zero" in refusal(write(np.ones((4, 3)), TET))


def test_a_text_that_is_no_mesh(tmp_path, capfd):
    """meshio prints and calls sys.exit here; neither gets through."""
    path = tmp_path / "part.vtk"
    path.write_text("dear reader\n" * 5)
    assert "not readable as a mesh" in refusal(path)
    assert capfd.readouterr() == ("", "")


def test_entities_without_a_group_are_explained(tmp_path, gmsh):
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [1], name="steel")
    gmsh.option.setNumber("Mesh.SaveAll", 1)
    gmsh.model.mesh.generate(3)
    gmsh.write(str(tmp_path / "part.msh"))
    gmsh.finalize()
    assert "switch 'Save all elements' (Mesh.SaveAll) off" in refusal(tmp_path / "part.msh")


def test_a_warning_of_the_reader_is_kept(tmp_path, capfd):
    """VTK's voxels (type 11) are skipped by meshio with no more than a line on stderr."""
    path = tmp_path / "part.vtk"
    meshio.write(
        path, meshio.Mesh(np.vstack([POINTS, POINTS + 2]), [("tetra", np.arange(8).reshape(2, 4))]), binary=False
    )
    text = path.read_text()
    assert "\n10\n10\n" in text
    capfd.readouterr()
    path.write_text(text.replace("\n10\n10\n", "\n10\n11\n"))
    mesh = read_mesh(path)
    assert "File contains cells that meshio cannot handle (type 11)" in mesh.warnings[0]
    assert capfd.readouterr() == ("", "")


def test_a_reader_that_leaves_is_contained():
    assert contained(lambda: sys.exit(3), 10) == (None, "the reader gave up", "")


def test_a_reader_that_never_ends_is_stopped(monkeypatch):
    from rbfem.mesh import containment

    def forever():
        while True:
            pass

    with pytest.raises(containment.OutOfTimeError, match="more than 0 s"), containment.time_limit(0.05):
        forever()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the memory limit needs Linux")
def test_a_reader_that_wants_all_memory_is_refused():
    _, failure, _ = contained(lambda: [None] * 10**10, 1000)
    assert failure == "MemoryError"


def test_ctrl_c_passes_through():
    def interrupted():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        contained(interrupted, 10)
