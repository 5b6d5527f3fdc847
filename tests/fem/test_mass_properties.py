"""The integrals are exact: against sums without rounding, closed forms, and everything that must not matter."""

from dataclasses import replace

import numpy as np
import pytest
from exact_moments import exact_inertia, relative_error
from fem_meshes import ball_mesh, box_mesh, moved, second_order
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rbfem.errors import InputError
from rbfem.fem.mass_properties import composed, from_tensor, mass_properties, particle_sum, point_inertia
from rbfem.mesh.tet_mesh import TetMesh

quick = settings(max_examples=25, deadline=None)
seeds = st.integers(0, 2**32 - 1)
# Bricks a side whose six tets a brick make about so many.
BRICKS = {1e2: 3, 1e3: 6, 1e4: 12, 1e5: 26, 1e6: 55}
SIZES = [pytest.param(size, marks=pytest.mark.slow if size >= 1e5 else (), id=f"{size:.0e} tets") for size in BRICKS]


def far(one, other):
    """Relative distance of two mass properties: mass, centre against the gyration radius, tensor."""
    return max(
        abs(one.mass / other.mass - 1.0),
        np.linalg.norm(one.center_of_mass - other.center_of_mass) / other.radius_of_gyration,
        np.linalg.norm(one.inertia - other.inertia) / np.linalg.norm(other.inertia),
    )


def same_as(properties, exact):
    """Largest relative error of mass, centre and tensor against Fractions."""
    mass, center, tensor = exact
    gyration = properties.radius_of_gyration
    apart = [float(c) - x for c, x in zip(center, properties.center_of_mass, strict=True)]
    return max(
        abs(float(mass) / properties.mass - 1.0),
        np.abs(apart).max() / gyration,
        relative_error(properties.inertia, tensor),
    )


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("backend", ["numpy", "serial"])
def test_a_uniform_part_has_its_exact_tensor(size, backend):
    mesh = box_mesh(BRICKS[size], seed=int(size))
    properties = mass_properties(mesh, 1.0, backend)
    assert same_as(properties, exact_inertia(mesh)) <= 1e-14
    assert properties.volume == properties.mass


@pytest.mark.parametrize("size", [1e2, 1e3, 1e4])
@pytest.mark.parametrize("backend", ["numpy", "serial"])
def test_a_density_by_tet_has_its_exact_tensor(size, backend):
    mesh = box_mesh(BRICKS[size])
    density = np.random.default_rng(1).uniform(0.1, 10.0, mesh.n_tets)
    assert same_as(mass_properties(mesh, density, backend), exact_inertia(mesh, density)) <= 1e-14


@pytest.mark.parametrize("size", [1e2, 1e3])
def test_a_density_by_node_has_its_exact_tensor(size):
    mesh = box_mesh(BRICKS[size])
    density = np.random.default_rng(1).uniform(0.1, 10.0, mesh.n_nodes)
    assert same_as(mass_properties(mesh, density), exact_inertia(mesh, density, is_nodal=True)) <= 1e-14


def grouped(mesh):
    is_low = mesh.nodes[mesh.tets][:, :, 2].mean(axis=1) < 0.2
    return replace(mesh, groups={"low": np.flatnonzero(is_low), "high": np.flatnonzero(~is_low)})


def test_a_density_by_group_is_that_of_its_tets():
    mesh = grouped(box_mesh(4))
    density = np.full(mesh.n_tets, 3.0)
    density[mesh.groups["low"]] = 7.0
    assert far(mass_properties(mesh, {"low": 7.0, "high": 3.0}), mass_properties(mesh, density)) == 0.0
    assert same_as(mass_properties(mesh, {"high": 3.0, "low": 7.0}), exact_inertia(mesh, density)) <= 1e-14


def box_integral(size, powers):
    """∫ x^p y^q z^r over [0, a] × [0, b] × [0, c]."""
    return np.prod([length ** (p + 1) / (p + 1) for length, p in zip(size, powers, strict=True)])


@pytest.mark.parametrize("make", [lambda mesh: mesh, second_order], ids=["tet4", "tet10"])
def test_a_linear_density_is_integrated_as_the_polynomial_it_is(make):
    # ρ = a + b · x times two coordinates: degree 3, integrated in closed form over the box.
    size, a, slope = (1.0, 0.7, 0.4), 2.0, np.array([0.5, -1.0, 3.0])
    mesh = make(box_mesh(3, size))
    properties = mass_properties(mesh, a + mesh.nodes @ slope)

    def moment(*powers):
        unit = np.eye(3, dtype=int)
        rest = [slope[i] * box_integral(size, np.array(powers) + unit[i]) for i in range(3)]
        return a * box_integral(size, powers) + sum(rest)

    mass = moment(0, 0, 0)
    first = np.array([moment(1, 0, 0), moment(0, 1, 0), moment(0, 0, 1)])
    second = np.array(
        [[moment(*(np.eye(3, dtype=int)[i] + np.eye(3, dtype=int)[j])) for j in range(3)] for i in range(3)]
    )
    tensor = np.trace(second) * np.eye(3) - second - mass * point_inertia(first / mass)
    assert properties.mass == pytest.approx(mass, rel=1e-14)
    assert properties.center_of_mass == pytest.approx(first / mass, rel=1e-14)
    assert np.linalg.norm(properties.inertia - tensor) <= 1e-14 * np.linalg.norm(tensor)


def test_a_quadratic_density_on_second_order_tets_is_integrated_exactly():
    # ρ = 1 + x² over the unit cube: m = 4/3, ∫ρ x = 3/4, ∫ρ x² = 8/15, ∫ρ y² = 4/9.
    mesh = second_order(box_mesh(3, (1.0, 1.0, 1.0)))
    properties = mass_properties(mesh, 1.0 + mesh.nodes[:, 0] ** 2)
    assert properties.mass == pytest.approx(4 / 3, rel=1e-14)
    assert properties.center_of_mass == pytest.approx([9 / 16, 0.5, 0.5], rel=1e-14)
    xx, yy = 8 / 15 - 4 / 3 * (9 / 16) ** 2, 4 / 9 - 4 / 3 / 4
    assert np.diag(properties.inertia) == pytest.approx([2 * yy, xx + yy, xx + yy], rel=1e-13)


def test_the_corner_tet_is_the_known_one():
    # Any handbook; about the origin 1/30, off the diagonal -1/120; about its centre 1/80 and +1/480.
    corner = TetMesh(np.vstack([np.zeros(3), np.eye(3)]), np.array([[0, 1, 2, 3]]))
    body = mass_properties(corner)
    assert body.volume == pytest.approx(1 / 6, rel=1e-15)
    assert body.center_of_mass == pytest.approx([0.25] * 3, rel=1e-15)
    off = np.ones((3, 3)) - np.eye(3)
    assert body.inertia == pytest.approx(0.0125 * np.eye(3) + off / 480, rel=1e-14)
    assert body.inertia_about([0, 0, 0]) == pytest.approx(np.eye(3) / 30 - off / 120, rel=1e-14)


def test_straight_second_order_tets_are_first_order_ones():
    mesh = box_mesh(4)
    density = np.random.default_rng(0).uniform(1, 2, mesh.n_tets)
    assert far(mass_properties(second_order(mesh), density), mass_properties(mesh, density)) < 1e-15 * 4


@pytest.mark.parametrize("density", [2.0, "by tet"])
def test_the_compiled_loop_and_numpy_agree(density):
    mesh = box_mesh(14)
    rho = np.random.default_rng(0).uniform(1, 2, mesh.n_tets) if density == "by tet" else density
    one, other = (mass_properties(mesh, rho, backend) for backend in ("numpy", "serial"))
    assert far(one, other) < 1e-14
    assert one.rounding_error == pytest.approx(other.rounding_error, rel=1e-10)


@quick
@given(seeds)
def test_renumbering_nodes_and_tets_changes_nothing(seed):
    rng = np.random.default_rng(seed)
    mesh = box_mesh(3, seed=1)
    order, tets = rng.permutation(mesh.n_nodes), rng.permutation(mesh.n_tets)
    corners = np.argsort(order)[mesh.tets[tets]][:, [[0, 1, 2, 3], [1, 2, 0, 3], [3, 2, 1, 0]][seed % 3]]
    density = rng.uniform(1, 2, mesh.n_tets)
    one = mass_properties(mesh, density)
    other = mass_properties(TetMesh(mesh.nodes[order], corners), density[tets])
    assert far(one, other) < 1e-14


@quick
@given(seeds)
def test_turning_the_mesh_turns_the_tensor(seed):
    turn = Rotation.random(random_state=seed).as_matrix()
    mesh = box_mesh(3)
    here, there = mass_properties(mesh), mass_properties(moved(mesh, turn=turn))
    assert np.linalg.norm(there.inertia - turn @ here.inertia @ turn.T) < 1e-14 * np.linalg.norm(here.inertia)
    assert there.center_of_mass == pytest.approx(turn @ here.center_of_mass, abs=1e-15)
    assert there.principal_moments == pytest.approx(here.principal_moments, rel=1e-13)


@quick
@given(st.tuples(*[st.floats(-100, 100)] * 3))
def test_moving_the_mesh_moves_its_centre_and_nothing_else(shift):
    mesh = box_mesh(3)
    here, there = mass_properties(mesh), mass_properties(moved(mesh, shift))
    assert there.center_of_mass == pytest.approx(here.center_of_mass + shift, rel=1e-14, abs=1e-14)
    distance = np.linalg.norm(there.inertia - here.inertia) / np.linalg.norm(here.inertia)
    assert distance <= here.rounding_error + there.rounding_error


@quick
@given(st.floats(1e-6, 1e6), st.floats(1e-3, 1e3))
def test_units_of_length_enter_with_the_fifth_power_and_density_with_the_first(scale, density):
    mesh = box_mesh(3)
    one, other = mass_properties(mesh), mass_properties(moved(mesh, scale=scale), density)
    assert other.mass == pytest.approx(density * scale**3 * one.mass, rel=1e-14)
    assert np.linalg.norm(other.inertia / (density * scale**5) - one.inertia) < 2e-14 * np.linalg.norm(one.inertia)
    assert other.rounding_error == pytest.approx(one.rounding_error, rel=1.0)


@quick
@given(seeds, st.integers(2, 5))
def test_a_mesh_cut_in_parts_and_put_together_is_whole(seed, n_parts):
    mesh = box_mesh(4)
    rng = np.random.default_rng(seed)
    density = rng.uniform(1, 2, mesh.n_tets)
    owner = rng.permutation(np.arange(mesh.n_tets) % n_parts)
    parts = [
        mass_properties(TetMesh(mesh.nodes, mesh.tets[owner == part]), density[owner == part])
        for part in range(n_parts)
    ]
    whole = mass_properties(mesh, density)
    assert far(composed(parts), whole) < 1e-14
    assert composed(parts).volume == pytest.approx(whole.volume, rel=1e-14)


@quick
@given(st.tuples(*[st.floats(-5, 5)] * 3))
def test_the_tensor_about_another_point_is_the_integral_about_it(point):
    mesh = box_mesh(2)
    by_corner = mesh.nodes[mesh.tets] - np.array(point)  # degree 2: the four-point rule is exact
    a, b = (5 + 3 * 5**0.5) / 20, (5 - 5**0.5) / 20
    places = np.einsum("qk,mkc->mqc", np.full((4, 4), b) + (a - b) * np.eye(4), by_corner).reshape(-1, 3)
    volumes = np.linalg.det(by_corner[:, 1:] - by_corner[:, :1]) / 6.0
    direct = np.einsum("i,ijk->jk", np.repeat(volumes / 4, 4), point_inertia(places))
    assert mass_properties(mesh).inertia_about(point) == pytest.approx(direct, rel=1e-12, abs=1e-13)


def test_ever_finer_particles_tend_to_the_integral():
    size = np.array([1.0, 0.7, 0.4])
    exact = mass_properties(box_mesh(2))
    errors, counts = [], [4, 8, 16, 32]
    for n in counts:
        cells = (np.stack(np.meshgrid(*[np.arange(n) + 0.5] * 3), axis=-1).reshape(-1, 3) / n) * size
        errors.append(far(particle_sum(np.full(n**3, exact.mass / n**3), cells), exact))
    slope = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.02)


def test_particles_have_no_volume_and_their_own_centre():
    body = particle_sum([1.0, 3.0, 2.0, 2.0], [(0, 0, 0), (4, 0, 0), (0, 3, 0), (0, 0, 1)])
    assert body.volume == 0.0 and body.mass == 8.0
    assert body.center_of_mass == pytest.approx([1.5, 0.75, 0.25])
    by_hand = sum(m * point_inertia(np.array(r) - body.center_of_mass) for m, r in
                  [(1.0, (0.0, 0, 0)), (3.0, (4.0, 0, 0)), (2.0, (0, 3.0, 0)), (2.0, (0, 0, 1.0))])  # fmt: skip
    assert body.inertia == pytest.approx(by_hand)


@pytest.mark.parametrize(
    ("density", "words"),
    [
        (0.0, "density 0 read"),
        (-1.0, "density -1 read"),
        (np.nan, "density nan read"),
        (np.inf, "density inf read"),
        (np.ones(7), r"shape \(7,\) fits neither the 48 tets nor the 27 nodes"),
        (np.ones((48, 1)), "fits neither"),
        (np.r_[np.ones(47), -2.0], "density -2 read"),
        (np.r_[np.ones(26), np.nan], "density nan read"),
        ({"low": 1.0}, "24 of 48 tets are in none of the groups 'low'"),
        ({"low": 1.0, "high": 2.0, "left": 1.0}, "the mesh has no group 'left'"),
        ({"low": 1.0, "high": -3.0}, "density -3 read"),
    ],
)
def test_a_bad_density_is_refused_by_name(density, words):
    mesh = replace(grouped(box_mesh(2)), source="part.msh")
    with pytest.raises(InputError, match=words) as refused:
        mass_properties(mesh, density)
    assert str(refused.value).startswith("part.msh: ")


def test_groups_that_nobody_names_do_not_count():
    """Abaqus sets overlap by habit: those named have to hold each tet once, whatever others there are."""
    mesh = grouped(box_mesh(2))
    overlapping = replace(mesh, groups={**mesh.groups, "all": np.arange(mesh.n_tets)})
    assert mass_properties(overlapping, {"all": 2.0}).mass == pytest.approx(mass_properties(mesh, 2.0).mass, rel=1e-14)
    by_group = mass_properties(overlapping, {"low": 1.0, "high": 3.0}).mass
    assert by_group == pytest.approx(mass_properties(mesh, {"low": 1.0, "high": 3.0}).mass, rel=1e-14)


def test_points_on_a_line_have_one_moment_of_zero():
    pair = particle_sum([1, 1], [[0, 0, 1], [0, 0, -1]])
    assert pair.principal_moments.tolist() == [0.0, 2.0, 2.0]


def test_a_density_by_group_needs_each_tet_in_one_group():
    mesh = grouped(box_mesh(2))
    low, high = mesh.groups["low"], mesh.groups["high"]
    with pytest.raises(InputError, match=f"1 of {mesh.n_tets} tets are in none of the groups 'low', 'high'"):
        mass_properties(replace(mesh, groups={"low": low, "high": high[1:]}), {"low": 1.0, "high": 1.0})
    with pytest.raises(InputError, match="1 tets are in the group 'low' and in 'high'"):
        mass_properties(replace(mesh, groups={"low": low, "high": np.r_[high, low[:1]]}), {"low": 1.0, "high": 1.0})
    with pytest.raises(InputError, match="its groups are none"):
        mass_properties(box_mesh(2), {"steel": 1.0})


@pytest.mark.parametrize(
    "tensor",
    [
        np.diag([1.0, 1.0, 2.1]),
        np.diag([0.0, 1.0, 1.0]),
        np.diag([-1.0, 1.0, 1.0]),
        np.array([[1.0, 2.0, 0], [2.0, 1.0, 0], [0, 0, 1.0]]),
    ],
    ids=["triangle", "zero", "negative", "indefinite"],
)
def test_a_tensor_that_no_body_can_have_is_refused(tensor):
    with pytest.raises(InputError, match="principal moments"):
        from_tensor(1.0, 1.0, np.zeros(3), tensor)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_tensor_that_is_not_finite_is_refused(value):
    with pytest.raises(InputError, match="not finite"):
        from_tensor(1.0, 1.0, np.zeros(3), np.diag([value, 1.0, 1.0]))


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_mesh_whose_sums_overflow_is_refused_with_its_name():
    with pytest.raises(InputError, match=r"far\.msh: the inertia tensor is not finite"):
        mass_properties(replace(moved(box_mesh(2), scale=1e80), source="far.msh"))


def test_a_thin_plate_may_have_equal_sums():
    assert from_tensor(1.0, 1.0, np.zeros(3), np.diag([1.0, 1.0, 2.0])).principal_moments[2] == 2.0


def test_an_inverted_mesh_is_refused_with_its_name():
    mesh = box_mesh(2)
    inverted = TetMesh(mesh.nodes, mesh.tets[:, [0, 2, 1, 3]], source="inside_out.med")
    with pytest.raises(InputError, match=r"inside_out.med: .*principal moments"):
        mass_properties(inverted)


def test_every_tensor_is_that_of_a_body():
    for mesh in (box_mesh(3), ball_mesh(2), second_order(ball_mesh(2), (1, 1, 1))):
        body = mass_properties(mesh)
        assert (body.inertia == body.inertia.T).all()
        low, middle, high = body.principal_moments
        assert 0.0 < low <= middle <= high <= low + middle
        axes = body.principal_axes
        assert axes @ np.diag(body.principal_moments) @ axes.T == pytest.approx(
            body.inertia, rel=1e-13, abs=1e-13 * high
        )
