import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rbfem.errors import InputError
from rbfem.mesh.check import summarize
from rbfem.mesh.geometry import EDGES, signed_volumes
from rbfem.mesh.mesh_file import CellBlock, MeshFile
from rbfem.mesh.read import read_mesh, tet_mesh
from rbfem.mesh.repair import coincident_nodes, smallest_of_component

SQUARES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1.0]])
TWO_TETS = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])


def second_order(points, tets):
    """Points and tet10 with mid-nodes in the middle of the edges, none shared."""
    middles = (points[tets[:, EDGES[:, 0]]] + points[tets[:, EDGES[:, 1]]]) / 2
    numbers = len(points) + np.arange(6 * len(tets)).reshape(-1, 6)
    return np.vstack([points, middles.reshape(-1, 3)]), np.hstack([tets, numbers])


def test_an_inverted_tet_is_flipped(write):
    mesh = read_mesh(write(SQUARES, [("tetra", np.array([[0, 2, 1, 3], [1, 2, 3, 4]]))]))
    assert mesh.repairs == ("1 of 2 tets were inside out: flipped",)
    assert (signed_volumes(mesh.nodes, mesh.tets) > 0).all()


def test_an_inverted_curved_tet10_keeps_its_mid_nodes_on_their_edges(write):
    points, tets = second_order(SQUARES[:4], TWO_TETS[:1])
    points[8] += [0, 0.1, 0.1]  # the mid-node of edge 13, pulled outwards
    right = read_mesh(write(points, [("tetra10", tets)], name="right.vtu"))
    inverted = tets[:, [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]]
    mesh = read_mesh(write(points, [("tetra10", inverted)], name="inverted.vtu"))
    assert mesh.repairs == ("1 of 1 tets were inside out: flipped",) and mesh.warnings == ()
    assert summarize(mesh).volume == pytest.approx(summarize(right).volume, rel=1e-14)
    assert summarize(right).volume > 1 / 6 + 0.01


def test_flat_tets_are_dropped_with_their_groups_and_fields(write):
    points = np.vstack([SQUARES, [[1, 1, 0]]])
    tets = np.array([[0, 1, 2, 3], [0, 1, 2, 5], [1, 2, 3, 4]])
    data = {"a": [np.array([1.0, 2.0, 3.0])], "gmsh:physical": [np.array([7, 8, 7])]}
    mesh = read_mesh(write(points, [("tetra", tets)], cell_data=data))
    assert mesh.repairs == ("1 tets of zero volume dropped", "1 nodes that no tet has dropped")
    assert mesh.cell_fields["a"].tolist() == [1.0, 3.0]
    assert {name: group.tolist() for name, group in mesh.groups.items()} == {"physical_7": [0, 1]}


def test_a_thin_tet_is_not_a_flat_one(write):
    points = SQUARES[:4] * [1, 1, 1e-9]
    assert summarize(read_mesh(write(points, [("tetra", TWO_TETS[:1])]))).volume == pytest.approx(1e-9 / 6, rel=1e-14)


def test_the_second_of_two_equal_tets_is_dropped(write):
    tets = np.vstack([TWO_TETS, [[2, 0, 1, 3]]])
    mesh = read_mesh(write(SQUARES, [("tetra", tets)]))
    assert mesh.repairs == ("1 duplicate tets dropped",) and mesh.warnings == ()
    assert mesh.tets.tolist() == TWO_TETS.tolist()


def test_nodes_at_the_same_place_are_merged(write):
    """Exactly there, and 1e-13 of the box away; 1e-9 away is another node."""
    copies = SQUARES[1:4].copy()
    copies[1, 0] = 1e-13
    points = np.vstack([SQUARES, copies])
    tets = np.array([[0, 1, 2, 3], [5, 6, 7, 4]])
    mesh = read_mesh(write(points, [("tetra", tets)]))
    assert mesh.repairs == ("3 nodes merged with another at the same place", "3 nodes that no tet has dropped")
    assert mesh.warnings == ()
    apart = points + np.where(np.arange(8) == 6, 1e-9, 0.0)[:, None]
    assert "2 nodes merged" in read_mesh(write(apart, [("tetra", tets)])).repairs[0]


@pytest.mark.parametrize("jump", [0.0, 1.0])
def test_a_point_field_that_jumps_between_nodes_at_the_same_place_is_refused(write, jump):
    """Merged, the nodes could keep one of the two values only."""
    points = np.vstack([SQUARES, SQUARES[1:4]])
    density = np.array([9.0, 1, 2, 3, 9, 1, 2, 3 + jump])
    path = write(points, [("tetra", np.array([[0, 1, 2, 3], [5, 6, 7, 4]]))], point_data={"density": density})
    if jump:
        with pytest.raises(InputError, match=r"point field 'density' has two values.*give it as a cell field"):
            read_mesh(path)
    else:
        assert read_mesh(path).point_fields["density"].tolist() == [9, 1, 2, 3, 9]


def test_an_unused_node_is_dropped_even_if_it_is_not_a_number(write):
    points = np.vstack([[[np.nan] * 3], SQUARES, [[1e300] * 3]])
    mesh = read_mesh(write(points, [("tetra", TWO_TETS + 1)], point_data={"a": np.arange(7.0)}))
    assert mesh.repairs == ("2 nodes that no tet has dropped",)
    assert mesh.point_fields["a"].tolist() == [1, 2, 3, 4, 5] and mesh.tets.tolist() == TWO_TETS.tolist()


@given(points=st.lists(st.tuples(*[st.integers(0, 2)] * 3), min_size=1, max_size=40))
def test_coincident_nodes_agree_with_a_dictionary(points):
    first: dict = {}
    expected = [first.setdefault(point, k) for k, point in enumerate(points)]
    assert coincident_nodes(np.array(points, dtype=float)).tolist() == expected


@given(edges=st.lists(st.tuples(st.integers(0, 19), st.integers(0, 19)), max_size=30))
def test_components_agree_with_a_search(edges):
    label = list(range(20))
    for _ in range(20):
        for i, j in edges:
            label[i] = label[j] = min(label[i], label[j])
    cells = np.array(edges, dtype=np.int64).reshape(-1, 2)
    assert smallest_of_component(cells, 20).tolist() == label


@given(seed=st.integers(0, 10_000), is_curved=st.booleans())
@settings(max_examples=40, deadline=None)
def test_numbering_does_not_matter(seed, is_curved):
    """Nodes, tets and the corners in each tet in any order: the same volume, groups and quality."""
    generator = np.random.default_rng(seed)
    points, tets = second_order(SQUARES, TWO_TETS) if is_curved else (SQUARES, TWO_TETS)
    place, order = generator.permutation(len(points)), generator.permutation(2)
    turns = np.array([[0, 1, 2, 3, 4, 5, 6, 7, 8, 9], [1, 2, 0, 3, 5, 6, 4, 8, 9, 7], [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]])
    tets = np.take_along_axis(tets, turns[generator.integers(0, 3, 2)][:, : tets.shape[1]], axis=1)
    shuffled = np.empty_like(points)
    shuffled[place] = points
    block = CellBlock("tetra10" if is_curved else "tetra", place[tets][order])
    mesh = tet_mesh(MeshFile(shuffled, (block,), groups={"upper": [np.flatnonzero(order == 1)]}), "part")
    summary = summarize(mesh)
    assert summary.volume == pytest.approx(0.5, rel=1e-14) and summary.nodes == (14 if is_curved else 5)
    assert summary.quality_min == pytest.approx(0.839947, rel=1e-5)
    assert signed_volumes(mesh.nodes, mesh.tets[mesh.groups["upper"]]) == pytest.approx([1 / 3])
