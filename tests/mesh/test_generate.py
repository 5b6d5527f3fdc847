import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from rbfem.cli.mesh import command
from rbfem.errors import InputError, MissingLibraryError, RunError
from rbfem.mesh import generate as generating
from rbfem.mesh.check import summarize
from rbfem.mesh.generate import generate
from rbfem.mesh.read import read_mesh

MESHES = Path(__file__).parents[2] / "meshes"

TRIANGLES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]


def stl(path, shells):
    """Tetrahedral shells as STL: (offset, edge, whether the normals point out)."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    lines = ["solid part"]
    for offset, edge, is_outward, triangles in shells:
        for triangle in triangles if is_outward else [t[::-1] for t in triangles]:
            points = "\n".join(f"vertex {x} {y} {z}" for x, y, z in offset + edge * corners[triangle])
            lines.append(f"facet normal 0 0 0\nouter loop\n{points}\nendloop\nendfacet")
    path.write_text("\n".join([*lines, "endsolid part"]))
    return path


BOX_FACES = {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"}


@pytest.mark.parametrize(
    ("words", "volume", "surfaces"),
    [
        ("sphere:radius=0.05", 4 / 3 * math.pi * 0.05**3, {"surface"}),
        ("box:size=0.1,0.1,0.2", 0.002, BOX_FACES),
        ("cylinder:radius=1e-4,height=2e-4", 2e-12 * math.pi, {"side", "z_min", "z_max"}),
        ("ellipsoid:radii=1,2,3", 8 * math.pi, {"surface"}),
    ],
)
def test_primitives_have_their_volume_and_named_groups(gmsh, tmp_path, words, volume, surfaces):
    made = generate(words, tmp_path / "part.msh", order=2)
    mesh = read_mesh(made.path)
    assert mesh.repairs == () and mesh.warnings == () and mesh.is_second_order
    assert made.exact_volume == pytest.approx(volume, rel=1e-14)
    # Ten-node tets of a twentieth of the diagonal: measured 2e-5 on the ellipsoid, less on the others.
    assert summarize(mesh).volume == pytest.approx(volume, rel=6e-5)
    assert made.volume == pytest.approx(summarize(mesh).volume, rel=1e-13)
    assert set(mesh.surfaces) == surfaces == set(made.surfaces)
    assert (made.nodes, made.tets) == (mesh.n_nodes, mesh.n_tets)
    assert mesh.nodes[np.unique(mesh.tets[:, :4])].mean(axis=0) == pytest.approx(
        [0, 0, 0], abs=0.05 * np.ptp(mesh.nodes)
    )


def test_the_size_is_in_the_unit_of_the_output(gmsh, tmp_path):
    coarse = generate("box:size=1,1,1", tmp_path / "coarse.msh", size=0.5)
    fine = generate("box:size=1,1,1", tmp_path / "fine.msh", size=0.25)
    assert coarse.size == 0.5 and 3 < fine.tets / coarse.tets < 16


@pytest.mark.parametrize(("unit", "metre"), [("m", 1.0), ("mm", 1e3), ("in", 1 / 0.0254)])
def test_a_step_file_comes_out_right_in_every_unit(gmsh, tmp_path, unit, metre):
    """The drawing is in mm, 80 long; read with the unit it was written in, it is 0.08 m long."""
    made = generate(MESHES / "t_handle.step", tmp_path / "part.msh", size=4e-3 * metre, unit=unit)
    mesh = read_mesh(made.path, unit=unit)
    assert np.ptp(mesh.nodes, axis=0)[0] == pytest.approx(0.08, rel=1e-9)
    assert made.exact_volume == pytest.approx(t_handle_volume() * metre**3, rel=3e-6)  # measured: 1.05e-6
    # Chords of 4 mm on cylinders of 10 and 12 mm lose some 6 %.
    assert made.volume == pytest.approx(made.exact_volume, rel=0.1) and made.volume < made.exact_volume
    assert made.groups == ("t_handle",)


def t_handle_volume():
    """Bar with two chamfers and stem, less what of the stem is inside the bar, m^3."""
    y = np.linspace(-5, 5, 20_001)
    inside = np.trapezoid(2 * np.sqrt(25 - y**2) * np.sqrt(36 - y**2), y)
    ends = 2 * math.pi / 3 * (36 + 30 + 25)
    return (36 * math.pi * 78 + ends + 25 * math.pi * 50 - inside) * 1e-9


def test_touching_solids_share_their_nodes(gmsh, tmp_path):
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.occ.addBox(0, 0, 0, 10, 10, 10)
    gmsh.model.occ.addBox(10, 2, 2, 10, 5, 5)
    gmsh.model.occ.synchronize()
    gmsh.write(str(tmp_path / "two.step"))
    gmsh.finalize()
    made = generate(tmp_path / "two.step", tmp_path / "two.msh", unit="mm")
    mesh = read_mesh(made.path, unit="mm")
    assert summarize(mesh).components == 1 and len(made.groups) == 2 and mesh.warnings == ()
    assert made.exact_volume == pytest.approx(1250, rel=1e-12) == made.volume


def test_a_geo_file_keeps_its_names_and_sizes(gmsh, tmp_path):
    script = tmp_path / "part.geo"
    script.write_text(
        'SetFactory("OpenCASCADE"); Box(1) = {0, 0, 0, 1, 1, 1};\n'
        'MeshSize{:} = 0.4; Physical Volume("core") = {1}; Physical Surface("left") = {1};\n'
    )
    made = generate(script, tmp_path / "part.msh")
    assert (made.groups, made.surfaces, made.size) == (("core",), ("left",), None)
    assert made.volume == pytest.approx(1.0, rel=1e-12) == made.exact_volume


def test_a_geo_file_with_an_error_says_where(gmsh, tmp_path):
    script = tmp_path / "part.geo"
    script.write_text("Point(1) = {0, 0, 0;\n")
    with pytest.raises(InputError, match=r"gmsh cannot read it.*line 1"):
        generate(script, tmp_path / "part.msh")


def test_a_closed_stl_is_filled(gmsh, tmp_path):
    made = generate(stl(tmp_path / "part.stl", [(0, 1.0, True, TRIANGLES)]), tmp_path / "part.msh", size=0.3)
    mesh = read_mesh(made.path)
    assert summarize(mesh).volume == pytest.approx(1 / 6, rel=1e-12)
    assert set(mesh.surfaces) == {f"surface_{k}" for k in range(1, 5)} and made.exact_volume is None


def test_a_shell_with_normals_inwards_is_a_cavity(gmsh, tmp_path):
    shells = [(0.0, 1.0, True, TRIANGLES), (0.1, 0.3, False, TRIANGLES)]
    made = generate(stl(tmp_path / "part.stl", shells), tmp_path / "part.msh", size=0.2)
    mesh = read_mesh(made.path)
    assert mesh.warnings == () and made.volume == pytest.approx((1 - 0.3**3) / 6, rel=1e-12)


def test_two_shells_are_two_solids(gmsh, tmp_path):
    shells = [(0.0, 1.0, True, TRIANGLES), (2.0, 1.0, True, TRIANGLES)]
    made = generate(stl(tmp_path / "part.stl", shells), tmp_path / "part.msh", size=0.3)
    assert made.volume == pytest.approx(2 / 6, rel=1e-12) and made.groups == ("volume_1", "volume_2")


@pytest.mark.parametrize("shape", ["Sphere(1) = {0, 0, 0, 1};", "Torus(1) = {0, 0, 0, 1, 0.3};"])
def test_round_stl_without_sharp_edges_is_filled(gmsh, tmp_path, shape):
    script = tmp_path / "shape.geo"
    script.write_text(f'SetFactory("OpenCASCADE"); {shape}')
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(str(script))
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.12)
    exact = gmsh.model.occ.getMass(3, 1)
    gmsh.model.mesh.generate(2)
    gmsh.write(str(tmp_path / "shape.stl"))
    gmsh.finalize()
    made = generate(tmp_path / "shape.stl", tmp_path / "part.msh", size=0.12)
    assert read_mesh(made.path).warnings == ()
    assert made.volume == pytest.approx(exact, rel=0.07)  # chords of 0.12 on a tube of radius 0.3, twice


def test_an_open_stl_is_refused_and_nothing_is_left(gmsh, tmp_path):
    with pytest.raises(InputError, match="not closed: 3 of its edges"):
        generate(stl(tmp_path / "part.stl", [(0, 1.0, True, TRIANGLES[:3])]), tmp_path / "part.msh")
    assert [path.name for path in tmp_path.iterdir()] == ["part.stl"]


@pytest.mark.parametrize("ending", ["stl", "step", "brep", "iges"])
def test_rubbish_is_refused(gmsh, tmp_path, ending):
    path = tmp_path / f"part.{ending}"
    path.write_text("dear reader\n")
    with pytest.raises(InputError, match="part"):
        generate(path, tmp_path / "part.msh")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("box:size=1", "expected box:size=1,1,1"),
        ("box", "expected box:size=1,1,1"),
        ("sphere:radius=-1", "read '-1', expected a length above zero"),
        ("sphere:radius=big", "read 'big' where a number was expected"),
        ("sphere:diameter=1", "unexpected 'diameter'; expected sphere:radius=1"),
        ("cylinder:radius=1", "expected cylinder:radius=1,height=1"),
        ("part.docx", "expected a file ending in .stl"),
        ("part.step", "no such file"),
    ],
)
def test_a_wrong_source_says_what_was_expected(tmp_path, words, said):
    with pytest.raises(InputError) as caught:
        generate(words, tmp_path / "part.msh")
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("output", "said"),
    [("none/part.msh", "there is no directory"), ("part.vtu", "name the output part.msh"), ("", "written as .msh")],
)
def test_what_cannot_be_written_is_refused_before_meshing(tmp_path, monkeypatch, output, said):
    monkeypatch.setattr(generating, "ask_gmsh", lambda request: pytest.fail("meshed first"))
    with pytest.raises(InputError, match=said):
        generate("sphere:radius=1", tmp_path / output)


@pytest.mark.parametrize(("option", "said"), [({"size": -1.0}, "size: read -1"), ({"order": 3}, "order: read 3")])
def test_a_wrong_option_is_refused(tmp_path, option, said):
    with pytest.raises(InputError, match=said):
        generate("sphere:radius=1", tmp_path / "part.msh", **option)


def test_a_missing_system_library_names_the_command_that_installs_it(tmp_path, monkeypatch):
    """A stand-in for the gmsh module fails as the real one does without libGLU."""
    (tmp_path / "gmsh.py").write_text("raise OSError('libGLU.so.1: cannot open shared object file')")
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    with pytest.raises(
        MissingLibraryError, match=r"libGLU.so.1(.|\n)*apt-get install -y --no-install-recommends libglu1"
    ):
        generate("sphere:radius=1", tmp_path / "part.msh")


def test_a_gmsh_that_dies_is_an_error_and_not_the_end(tmp_path, monkeypatch):
    (tmp_path / "gmsh.py").write_text("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    with pytest.raises(RunError, match="gmsh was ended by signal 11"):
        generate("sphere:radius=1", tmp_path / "part.msh")


def test_ctrl_c_ends_it_and_leaves_nothing(tmp_path):
    """A stand-in for gmsh that says it has started and never ends."""
    (tmp_path / "out").mkdir()
    (tmp_path / "gmsh.py").write_text(f"open({str(tmp_path / 'started')!r}, 'w').close()\nwhile True: pass")
    code = "import sys; from rbfem.mesh.generate import generate; generate('sphere:radius=1', sys.argv[1])"
    solver = str(Path(generating.__file__).parents[2])
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), solver])}
    arguments = [sys.executable, "-c", code, str(tmp_path / "out" / "part.msh")]
    child = subprocess.Popen(arguments, stderr=subprocess.PIPE, env=environment)
    deadline = time.monotonic() + 20
    while not (tmp_path / "started").exists() and time.monotonic() < deadline:
        time.sleep(0.01)
    child.send_signal(signal.SIGINT)
    _, said = child.communicate(timeout=10)
    assert b"KeyboardInterrupt" in said and list((tmp_path / "out").iterdir()) == []


def test_the_command_prints_the_unit_and_both_volumes(gmsh, tmp_path):
    result = CliRunner().invoke(command, ["box:size=10,10,20", "-o", str(tmp_path / "part.msh"), "--unit", "mm"])
    assert result.exit_code == 0
    assert "numbers in mm" in result.output and "volume of mesh  2000 mm^3" in result.output
    assert "exact volume    2000 mm^3 (the mesh differs by" in result.output
    assert "--density 1000 --unit mm" in result.output and "x_min" in result.output
