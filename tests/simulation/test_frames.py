"""What a frame says of few bodies and of many, against sums over them by NumPy from their parts' own tensors."""

import numpy as np
import pytest

import rbfem
from rbfem.compute.rows import FEW
from rbfem.motion import quaternion

G = np.array([0.3, 1.0, -9.81])
BOX = [[-1, -1, -1], [1, 2, 3]]
THROWN = {"place": {"in_box": BOX, "orientation": "random"}, "velocity": [1, 0.5, 2], "angular_velocity": [1, 2, 3]}
AT, TO, STIFFNESS, LENGTH = [0.05, 0.02, 0.1], [0.2, 0.1, 1.0], 90.0, 0.3
SPRING = {"spring": {"at": AT, "to": TO, "stiffness": STIFFNESS, "rest_length": LENGTH}}
HELD = {"pivot": [0.4, 0.1, 0.2], "position": [0.5, 0.1, 0], "angular_velocity": [1, 2, 3], "shape": "bracket"}
FIXED = {"fixed": True, "position": [0, 0, 5]}
TIME = {"end": 0.4, "step": 0.01, "method": "rk4"}
COUNTS = [1, FEW + 30]

# Of the sum of the sizes of its terms; measured: 8e-16.
ROUNDING = 1e-14


@pytest.fixture(params=COUNTS, ids=["few", "many"])
def mixed(request, scene_of, run_of):
    """Free, sprung, held and fixed bodies: scene and last frame."""
    free, sprung = THROWN | {"count": request.param}, THROWN | {"count": request.param, "loads": [SPRING]}
    scene = scene_of(FIXED, free, HELD, FIXED, sprung, FIXED, gravity=G.tolist(), time=TIME, output={"every": 0.2})
    return scene, run_of(scene)[1][-1]


def spins(scene, frame):
    """(n, 3) angular momentum of each body about its centre of mass, world axes."""
    turned = quaternion.to_matrix(frame.quaternion)
    inertia = scene.of_parts([part.inertia for part in scene.parts])
    return np.einsum("nij,njk,nlk,nl->ni", turned, inertia, turned, frame.angular_velocity)


def test_energies_are_those_of_the_bodies(mixed):
    scene, frame = mixed
    kinetic = 0.5 * scene.mass * (frame.velocity**2).sum(axis=1)
    rotational = 0.5 * (frame.angular_velocity * spins(scene, frame)).sum(axis=1)
    moves = ~scene.is_fixed
    weight = -(scene.mass * (frame.position @ G))[moves]
    assert frame.balance.kinetic == pytest.approx(kinetic.sum(), rel=ROUNDING)
    assert frame.balance.rotational == pytest.approx(rotational.sum(), rel=ROUNDING)
    assert frame.balance.gravity == pytest.approx(weight.sum(), abs=ROUNDING * np.abs(weight).sum())
    np.testing.assert_allclose(frame.kinetic_energy, kinetic + rotational, rtol=ROUNDING)
    assert kinetic[moves].min() > 0.0 and rotational[moves].min() > 0.0
    assert not frame.kinetic_energy[scene.is_fixed].any()


def test_the_elastic_energy_is_that_of_the_springs(mixed):
    scene, frame = mixed
    sprung = np.array([bool(kinds) for kinds in scene.load_kinds])
    ends = frame.position[sprung] + quaternion.to_matrix(frame.quaternion[sprung]) @ AT
    elongation = np.linalg.norm(ends - TO, axis=1) - LENGTH
    assert sprung.any()
    assert frame.balance.elastic == pytest.approx(0.5 * STIFFNESS * (elongation**2).sum(), rel=ROUNDING)


def test_momenta_are_those_of_the_free_bodies_and_of_the_held_about_their_pivots(mixed):
    scene, frame = mixed
    momentum = scene.mass[:, None] * frame.velocity
    about = np.where(scene.is_held[:, None], scene.pivot, 0.0)
    angular = spins(scene, frame) + np.cross(frame.position - about, momentum)
    free = ~scene.is_held & ~scene.is_fixed
    for found, terms in ((frame.balance.momentum, momentum[free]), (frame.balance.angular_momentum, angular)):
        np.testing.assert_allclose(found, terms.sum(axis=0), rtol=0, atol=ROUNDING * np.abs(terms).sum())


@pytest.mark.parametrize("count", COUNTS)
def test_what_gravity_brings_in_is_what_falling_bodies_gain(scene_of, run_of, count):
    scene = scene_of(THROWN | {"count": count}, FIXED, gravity=G.tolist())
    frames = run_of(scene)[1]
    first, last = frames[0].balance, frames[-1].balance
    np.testing.assert_allclose(last.impulse, scene.mass[:-1].sum() * G * scene.end_time, rtol=1e-14)
    for sum_of, brought in (("momentum", "impulse"), ("angular_momentum", "angular_impulse")):
        gain = getattr(last, sum_of) - getattr(first, sum_of)
        np.testing.assert_allclose(getattr(last, brought), gain, rtol=0, atol=1e-13 * np.abs(gain).sum())
    assert last.work == 0.0


def test_a_body_among_many_has_the_numbers_it_has_alone(scene_of):
    """The two ways of going through bodies agree to the last bit; a fixed body changes nothing."""
    frames = []
    for others in (1, 2 * FEW):
        bystanders = {"fixed": True, "count": others, "place": {"in_box": BOX}}
        scene = scene_of(THROWN, HELD, bystanders, gravity=G.tolist())
        frames.append(next(iter(rbfem.simulate(scene, rbfem.plan(scene)))))
    for name in ("position", "quaternion", "velocity", "angular_velocity", "kinetic_energy"):
        alone, among = (getattr(frame, name) for frame in frames)
        assert (alone[:2] == among[:2]).all() and among.flags.c_contiguous
