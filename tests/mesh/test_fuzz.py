import time

import meshio
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rbfem.errors import InputError
from rbfem.mesh.read import read_mesh
from rbfem.mesh.tet_mesh import TetMesh

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1.0]])
CELLS = [("tetra", np.array([[0, 1, 2, 3], [1, 2, 3, 4]])), ("triangle", np.array([[0, 1, 2]]))]
TAGS = {"gmsh:physical": [np.array([1, 1]), np.array([2])], "gmsh:geometrical": [np.array([1, 1]), np.array([1])]}
NAMES = {"steel": np.array([1, 3]), "left": np.array([2, 2])}
ENTITIES = np.array([[2, 1], [2, 1], [2, 1], [3, 1], [3, 1]])
WRITERS = {
    "text.msh": {"file_format": "gmsh", "binary": False},
    "binary.msh": {"file_format": "gmsh", "binary": True},
    "old.msh": {"file_format": "gmsh22", "binary": True},
    "part.vtu": {},
    "part.vtk": {},
    "part.inp": {},
    "part.med": {},
    "part.mesh": {},
    "part.xdmf": {"data_format": "XML"},
}


@pytest.fixture(scope="module")
def originals(tmp_path_factory):
    folder = tmp_path_factory.mktemp("originals")
    for name, options in WRITERS.items():
        entities = {"gmsh:dim_tags": ENTITIES} if options.get("file_format") == "gmsh" else {}
        tags = {key: list(values) for key, values in TAGS.items()}
        mesh = meshio.Mesh(POINTS, CELLS, cell_data=tags, field_data=NAMES, point_data=entities)
        meshio.write(folder / name, mesh, **options)
    return folder


def mesh_or_reason(path):
    try:
        return read_mesh(path)
    except InputError as error:
        return str(error)


@pytest.mark.parametrize("name", WRITERS)
@given(data=st.data())
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_damaged_file_gives_a_mesh_or_a_reason(tmp_path, originals, name, data):
    """Cut short, or with some bits flipped. In the first 400 bytes are the counts, which do the most harm."""
    content = bytearray((originals / name).read_bytes())
    keep = data.draw(st.one_of(st.just(len(content)), st.integers(0, len(content))), "kept bytes")
    content = content[:keep]
    for place in data.draw(
        st.lists(st.integers(0, max(keep - 1, 0)) | st.integers(0, 400), max_size=6), "flipped bytes"
    ):
        if place < len(content):
            content[place] ^= 1 << data.draw(st.integers(0, 7))
    path = tmp_path / name
    path.write_bytes(content)
    start = time.monotonic()
    outcome = mesh_or_reason(path)
    if isinstance(outcome, TetMesh):
        assert outcome.n_tets > 0 and np.isfinite(outcome.nodes).all()
    else:
        assert str(path) in outcome
    assert time.monotonic() - start < 15.0


def test_a_file_cut_short_in_its_last_block_is_refused(tmp_path, originals):
    """meshio makes cells without nodes of it."""
    content = (originals / "binary.msh").read_bytes()
    path = tmp_path / "part.msh"
    path.write_bytes(content[: content.index(b"$EndElements") - 33])
    with pytest.raises(InputError, match="cells of kind triangle have 0 nodes each"):
        read_mesh(path)


def test_a_count_beyond_all_memory_is_a_damaged_file(tmp_path, originals):
    """meshio makes lists as long as the number of element blocks says, before it reads one."""
    content = (originals / "binary.msh").read_bytes()
    place = content.index(b"$Elements\n") + len(b"$Elements\n")
    path = tmp_path / "part.msh"
    path.write_bytes(content[:place] + (2**33).to_bytes(8, "little") + content[place + 8 :])
    with pytest.raises(InputError, match=r"not readable as a mesh \(MemoryError"):
        read_mesh(path)
