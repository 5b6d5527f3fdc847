import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rbfem.motion import quaternion

quick = settings(max_examples=60, deadline=None)

number = st.floats(-3, 3, allow_subnormal=False)
quaternions = st.tuples(number, number, number, number).map(np.array)
vectors = st.tuples(number, number, number).map(np.array)


def to_unit(q):
    return q / np.linalg.norm(q)


attitudes = quaternions.filter(lambda q: np.linalg.norm(q) > 0.1).map(to_unit)
axes = vectors.filter(lambda v: np.linalg.norm(v) > 0.1).map(to_unit)


def close(a, b, tolerance=1e-14):
    return np.abs(np.asarray(a) - b).max() <= tolerance


def same_attitude(a, b, tolerance=1e-14):
    return min(np.abs(a - b).max(), np.abs(a + b).max()) <= tolerance


@quick
@given(quaternions, quaternions, quaternions)
def test_the_product_is_associative(a, b, c):
    one, other = quaternion.product(quaternion.product(a, b), c), quaternion.product(a, quaternion.product(b, c))
    assert close(one, other, 1e-15 * 16 * (1 + np.linalg.norm(a) * np.linalg.norm(b) * np.linalg.norm(c)))


@quick
@given(quaternions, quaternions)
def test_the_length_of_a_product_is_the_product_of_lengths(a, b):
    length = np.linalg.norm(quaternion.product(a, b))
    assert length == pytest.approx(np.linalg.norm(a) * np.linalg.norm(b), rel=1e-14, abs=1e-14)


@quick
@given(quaternions, quaternions)
def test_the_conjugate_of_a_product_is_the_product_of_conjugates_turned_round(a, b):
    turned = quaternion.product(quaternion.conjugate(b), quaternion.conjugate(a))
    assert close(quaternion.conjugate(quaternion.product(a, b)), turned, 1e-13)


def test_the_units_multiply_as_hamilton_carved_them():
    one, i, j, k = np.eye(4)
    assert (quaternion.product(i, j) == k).all() and (quaternion.product(j, i) == -k).all()
    for unit in (i, j, k):
        assert (quaternion.product(unit, unit) == -one).all()


@quick
@given(attitudes, vectors)
def test_rotation_is_the_sandwich_product_and_the_matrix(q, v):
    sandwich = quaternion.product(quaternion.product(q, np.r_[0.0, v]), quaternion.conjugate(q))
    turned = quaternion.rotate(q, v)
    assert close(sandwich, np.r_[0.0, turned])
    assert close(quaternion.to_matrix(q) @ v, turned)
    assert close(quaternion.rotate_back(q, turned), v)


@quick
@given(attitudes)
def test_all_nine_entries_are_scipys_and_lead_back(q):
    matrix = quaternion.to_matrix(q)
    assert close(matrix, Rotation.from_quat(q, scalar_first=True).as_matrix())
    back = quaternion.from_matrix(matrix)
    assert back[0] >= 0.0 and same_attitude(back, q)


@quick
@given(axes, st.sampled_from([0.0, 1e-12, 1e-8, 1e-5]))
def test_half_turns_about_any_axis_survive_the_matrix(axis, short_of):
    q = quaternion.from_axis_angle(axis, np.pi - short_of)
    assert same_attitude(quaternion.from_matrix(quaternion.to_matrix(q)), q)


@pytest.mark.parametrize("axis", [*np.eye(3), *-np.eye(3), (1, 1, 0), (0, 1, -1), (1, 1, 1), (-1, 1e-9, 1)])
def test_half_turns_about_coordinate_axes_and_diagonals_survive_the_matrix(axis):
    unit = to_unit(np.array(axis, dtype=float))
    matrix = 2.0 * np.outer(unit, unit) - np.eye(3)
    assert close(quaternion.to_matrix(quaternion.from_matrix(matrix)), matrix)


def test_many_matrices_at_once_are_read_row_by_row():
    q = quaternion.normalize(np.random.default_rng(1).normal(size=(4, 5, 4)))
    back = quaternion.from_matrix(quaternion.to_matrix(q))
    assert back.shape == (4, 5, 4)
    assert np.abs(np.abs(np.einsum("...i,...i", q, back)) - 1.0).max() < 1e-14


@quick
@given(axes, st.floats(0, np.pi - 1e-6))
def test_log_undoes_exp(axis, angle):
    assert close(quaternion.log(quaternion.exp(angle * axis)), angle * axis)


@quick
@given(attitudes)
def test_exp_undoes_log(q):
    assert np.linalg.norm(quaternion.log(q)) <= np.pi + 1e-15
    assert same_attitude(quaternion.exp(quaternion.log(q)), q)


@quick
@given(axes, st.floats(1e-300, 1e-8))
def test_tiny_turns_keep_their_digits(axis, angle):
    back = quaternion.log(quaternion.exp(angle * axis))
    assert np.abs(back - angle * axis).max() <= 1e-15 * angle


@quick
@given(axes, st.floats(1e-3, np.pi - 1e-3))
def test_axis_and_angle_lead_back(axis, angle):
    q = quaternion.from_axis_angle(7.0 * axis, angle)
    back_axis, back_angle = quaternion.to_axis_angle(q)
    assert close(back_axis, axis, 1e-12) and close(back_angle, angle)
    assert close(quaternion.to_matrix(q), Rotation.from_rotvec(angle * axis).as_matrix())


def test_no_turn_has_a_unit_axis():
    axis, angle = quaternion.to_axis_angle([1.0, 0.0, 0.0, 0.0])
    assert angle == 0.0 and np.linalg.norm(axis) == 1.0


@quick
@given(attitudes, vectors)
def test_the_derivative_is_that_of_a_turn_in_world_axes(q, omega):
    h = 1e-5
    ahead = quaternion.product(quaternion.exp(h * omega), q)
    behind = quaternion.product(quaternion.exp(-h * omega), q)
    # h²/6 |ω/2|³ ≤ 3e-10 with |ω| ≤ 5.2, and rounding of 1e-16/h.
    assert close(quaternion.derivative(q, omega), (ahead - behind) / (2 * h), 4e-10)


@quick
@given(attitudes, attitudes)
def test_slerp_begins_and_ends_where_it_should(start, end):
    assert same_attitude(quaternion.slerp(start, end, 0.0), start)
    assert same_attitude(quaternion.slerp(start, end, 1.0), end)


@quick
@given(attitudes, attitudes, st.floats(0, 1))
def test_slerp_turns_at_constant_rate_the_shorter_way(start, end, share):
    whole = quaternion.angle_between(start, end)
    assume(whole < np.pi - 1e-6)
    between = quaternion.slerp(start, end, share)
    assert whole <= np.pi
    assert quaternion.angle_between(start, between) == pytest.approx(share * whole, abs=1e-13)
    assert quaternion.angle_between(between, end) == pytest.approx((1 - share) * whole, abs=1e-13)
    assert same_attitude(between, quaternion.slerp(start, -end, share), 1e-13)


@quick
@given(attitudes, vectors)
def test_a_constant_spin_is_slerped_exactly(start, omega):
    end = quaternion.product(quaternion.exp(0.5 * omega), start)
    assume(np.linalg.norm(0.5 * omega) < np.pi - 1e-6)
    half_way = quaternion.product(quaternion.exp(0.25 * omega), start)
    assert same_attitude(quaternion.slerp(start, end, 0.5), half_way, 1e-13)


def test_one_turn_is_shared_by_many_times():
    quarter = quaternion.from_axis_angle([0, 0, 1], np.pi / 2)
    times = quaternion.slerp([1.0, 0, 0, 0], quarter, np.linspace(0, 1, 5))
    assert times.shape == (5, 4)
    assert np.allclose(quaternion.to_axis_angle(times)[1], np.linspace(0, np.pi / 2, 5), atol=1e-15)


@quick
@given(quaternions.filter(lambda q: np.linalg.norm(q) > 0.1))
def test_normalizing_keeps_the_direction(q):
    unit = quaternion.normalize(q)
    assert np.linalg.norm(unit) == pytest.approx(1.0, abs=4e-16)
    assert close(unit * np.linalg.norm(q), q)
