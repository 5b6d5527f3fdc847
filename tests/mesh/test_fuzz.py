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
        mesh = meshio.Mesh(POINTS, CELLS, cell_data={k: list(v) for k, v in TAGS.items()}, field_data=NAMES)
        meshio.write(folder / name, mesh, **options)
    return {name: (folder / name).read_bytes() for name in WRITERS}


@pytest.mark.parametrize("name", WRITERS)
@given(data=st.data())
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_damaged_file_gives_a_mesh_or_a_reason(tmp_path, originals, name, data):
    """Cut short, or with some bits flipped. In the first 400 bytes are the counts, which do the most harm."""
    content = bytearray(originals[name])
    keep = data.draw(st.one_of(st.just(len(content)), st.integers(0, len(content))), "kept bytes")
    content = content[:keep]
    for place in data.draw(st.lists(st.integers(0, max(keep - 1, 0)) | st.integers(0, 400), max_size=6), "flipped bytes"):
        if place < len(content):
            content[place] ^= 1 << data.draw(st.integers(0, 7))
    path = tmp_path / name
    path.write_bytes(content)
    start = time.monotonic()
    try:
        mesh = read_mesh(path)
    except InputError as error:
        assert str(path) in str(error)
    else:
        assert isinstance(mesh, TetMesh) and mesh.n_tets > 0 and np.isfinite(mesh.nodes).all()
    assert time.monotonic() - start < 15.0


def test_a_count_beyond_all_memory_is_a_damaged_file(tmp_path, originals):
    """meshio makes lists as long as the number of element blocks says, before it reads one."""
    content = originals["binary.msh"]
    place = content.index(b"$Elements\n") + len(b"$Elements\n")
    path = tmp_path / "part.msh"
    path.write_bytes(content[:place] + (2**33).to_bytes(8, "little") + content[place + 8 :])
    with pytest.raises(InputError, match=r"not readable as a mesh \(MemoryError"):
        read_mesh(path)
