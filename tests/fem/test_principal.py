import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rbfem.fem.mass_properties import from_tensor
from rbfem.fem.principal import principal_axes
from rbfem.motion import quaternion

quick = settings(max_examples=60, deadline=None)
turns = st.integers(0, 2**32 - 1).map(lambda seed: Rotation.random(random_state=seed).as_matrix())
shares = st.tuples(*[st.floats(0.1, 5.0)] * 3)


def tensor_of(turn, x2, y2, z2):
    """A body's tensor from its mean squares along turned axes."""
    return turn @ np.diag([y2 + z2, x2 + z2, x2 + y2]) @ turn.T


def leads_back(tensor, moments, axes):
    return np.abs(axes @ np.diag(moments) @ axes.T - tensor).max() < 1e-13 * moments[2]


@quick
@given(turns, shares)
def test_axes_are_right_handed_and_give_the_tensor_back(turn, squares):
    tensor = tensor_of(turn, *squares)
    moments, axes = principal_axes(tensor)
    assert (np.diff(moments) >= 0.0).all()
    assert np.abs(axes.T @ axes - np.eye(3)).max() < 1e-14
    assert np.linalg.det(axes) == pytest.approx(1.0, abs=1e-14)
    assert leads_back(tensor, moments, axes)


@quick
@given(turns, shares, st.integers(0, 2**32 - 1))
def test_a_rounding_error_does_not_turn_the_axes_round(turn, squares, seed):
    assume(np.diff(np.sort(squares)).min() > 0.05)
    noise = np.random.default_rng(seed).uniform(-1, 1, (3, 3))
    tensor = tensor_of(turn, *squares)
    one, other = (principal_axes(t)[1] for t in (tensor, tensor + 1e-14 * (noise + noise.T)))
    largest = np.sort(np.abs(one), axis=0)
    assume((largest[2] - largest[1] > 1e-6).all())
    assert np.abs(one - other).max() < 1e-11


@quick
@given(turns, shares)
def test_the_first_two_axes_point_up(turn, squares):
    _, axes = principal_axes(tensor_of(turn, *squares))
    for axis in axes.T[:2]:
        assert axis[np.argmax(np.abs(axis).round(9))] > 0.0


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_equally_large_components_leave_the_first_positive(sign):
    across = Rotation.from_euler("z", 45, degrees=True).as_matrix()
    tensor = across @ np.diag([1.0, 1.5, 2.0]) @ across.T + sign * 1e-15 * np.array([[1, 1, 0], [1, -1, 0], [0, 0, 0]])
    axes = principal_axes(tensor)[1]
    half = np.sqrt(0.5)
    assert axes == pytest.approx(np.array([[half, half, 0], [half, -half, 0], [0, 0, -1]]), abs=1e-12)


@quick
@given(turns, st.booleans(), st.integers(0, 2**32 - 1))
def test_two_equal_moments_have_axes_that_rounding_cannot_spin(turn, is_long, seed):
    squares = (1.0, 1.0, 3.0) if is_long else (1.0, 1.0, 0.2)
    tensor = tensor_of(turn, *squares)
    noise = np.random.default_rng(seed).uniform(-1, 1, (3, 3))
    tolerance = 1e-12
    moments, axes = principal_axes(tensor, tolerance)
    _, other = principal_axes(tensor + 1e-14 * (noise + noise.T), tolerance)
    own = axes[:, 0 if is_long else 2]
    assert abs(own @ turn[:, 2]) == pytest.approx(1.0, abs=1e-13)
    assert np.abs(axes.T @ axes - np.eye(3)).max() < 1e-14 and np.linalg.det(axes) > 0.0
    assert leads_back(tensor, moments, axes)
    size = np.sort(np.abs(own))
    largest = np.sort(np.abs(axes), axis=0)
    assume(size[1] - size[0] > 1e-6 and (largest[2] - largest[1] > 1e-6).all())
    assert np.abs(axes - other).max() < 1e-11


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("own", [1.0, 3.0])
def test_a_body_round_about_a_coordinate_axis_has_the_coordinate_axes(axis, own):
    moments = np.full(3, 2.0)
    moments[axis] = own
    axes = principal_axes(np.diag(moments))[1]
    assert (np.sort(np.abs(axes), axis=0) == [[0] * 3, [0] * 3, [1] * 3]).all()
    assert np.abs(axes[axis, 0 if own < 2.0 else 2]) == 1.0


@quick
@given(turns)
def test_three_equal_moments_have_the_coordinate_axes(turn):
    assert (principal_axes(turn @ (2.0 * np.eye(3)) @ turn.T, 1e-13)[1] == np.eye(3)).all()


@quick
@given(turns, shares)
def test_the_quaternion_turns_principal_axes_into_the_meshs(turn, squares):
    body = from_tensor(1.0, 1.0, np.zeros(3), tensor_of(turn, *squares))
    assert quaternion.to_matrix(body.principal_quaternion) == pytest.approx(body.principal_axes, abs=1e-14)
