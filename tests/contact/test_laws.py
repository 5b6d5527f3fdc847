"""The laws of one contact: springs, the limit of friction, and a memory that goes with the bodies."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rbfem.contact.laws import (
    damping_coefficient,
    elastic_energy,
    elastic_force,
    normal_stiffness,
    tangential_stiffness,
    touch,
)
from rbfem.contact.model import HERTZ, LAST_STIFFNESS, LAW_WIDTH, LINEAR, MEMORY_WIDTH

E_STAR, G_STAR, MASS, RADIUS = 7e6, 2e6, 0.3, 0.04
LAWS = {"linear": LINEAR, "hertz": HERTZ}


class Contact:
    """One contact with its row of laws and its memory."""

    def __init__(self, law=LINEAR, damping=0.2, friction=0.5):
        self.laws = np.zeros((1, LAW_WIDTH))
        self.laws[0] = law, E_STAR, G_STAR, damping, friction
        self.touches, self.memory = np.zeros(1, np.int8), np.zeros((1, MEMORY_WIDTH))

    def step(self, dt, overlap, normal=(0, 0, 1), velocity=(0, 0, 0), turning=(0, 0, 0), spin=0.0, curvature=0.0):
        """Normal force, tangential force, and energy that the dashpot and friction take."""
        f, *rest = touch(
            *map(float, normal), curvature, overlap, *map(float, velocity), *map(float, turning), spin,
            MASS, RADIUS, dt, 0, self.laws, 0, self.touches, self.memory,
        )  # fmt: skip
        return f, np.array(rest[:3]), *rest[3:]


def test_hertz_s_spring_is_the_textbook_s_force_stiffness_and_energy():
    overlap, h = 1e-4, 1e-10
    force = 4 / 3 * E_STAR * math.sqrt(RADIUS) * overlap**1.5
    stiffness = normal_stiffness(HERTZ, E_STAR, overlap, RADIUS)
    assert stiffness * overlap == pytest.approx(force, rel=1e-14)
    assert elastic_energy(HERTZ, stiffness, overlap) == pytest.approx(
        8 / 15 * E_STAR * math.sqrt(RADIUS) * overlap**2.5, rel=1e-14
    )
    ahead, behind = (
        elastic_energy(HERTZ, normal_stiffness(HERTZ, E_STAR, d, RADIUS), d) for d in (overlap + h, overlap - h)
    )
    assert (ahead - behind) / (2 * h) == pytest.approx(force, rel=1e-6)


def test_mindlin_s_spring_is_eight_times_the_shear_modulus_times_the_radius_of_contact():
    assert tangential_stiffness(HERTZ, G_STAR, 1e-4, RADIUS) == pytest.approx(8 * G_STAR * math.sqrt(RADIUS * 1e-4))


def test_a_linear_spring_is_the_same_at_every_overlap():
    assert normal_stiffness(LINEAR, 5.0, 1e-9, RADIUS) == normal_stiffness(LINEAR, 5.0, 1.0, 3.0) == 5.0
    assert tangential_stiffness(LINEAR, 5.0, 1e-9, RADIUS) == 5.0
    assert elastic_energy(LINEAR, 10.0, 0.5) == 1.25


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_the_spring_is_whole_from_where_the_overlap_is_what_is_travelled_in_a_step(law):
    assert elastic_force(law, 2.0, 0.1 * (1 - 1e-12), 0.1) == pytest.approx(0.2, rel=1e-11)
    assert elastic_force(law, 2.0, 0.1, 0.1) == elastic_force(law, 2.0, 0.1, 0.0) == 0.2


def test_the_dashpot_of_a_whole_contact_takes_what_its_overlaps_tell():
    """Σ c |v| Δt over overlaps anywhere on the grid of steps is ∫ c dδ, but for the second order in the step."""
    travel, deepest = 1e-2, 1.0
    for law, power in ((LINEAR, 0.0), (HERTZ, 0.25)):
        at_one = damping_coefficient(law, 0.3, 2.0, MASS, 1.0, 0.0, 0.0)
        for phase in (0.05, 0.5, 0.95):
            overlaps = [(k + phase) * travel for k in range(100)]
            stiffness = [2.0 if law == LINEAR else 2.0 * d**0.5 for d in overlaps]
            total = sum(
                damping_coefficient(law, 0.3, k, MASS, d, travel, 0.0) * travel
                for d, k in zip(overlaps, stiffness, strict=True)
            )
            until = (deepest + (phase - 0.5) * travel) ** (1 + power) / (1 + power)
            assert total == pytest.approx(at_one * until, rel=3e-4)  # measured 1e-4 (Hertz), 1e-15 (linear)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@given(overlap=st.floats(1e-7, 1e-2), away=st.floats(-5.0, 50.0), dt=st.floats(1e-7, 1e-3), later=st.floats(1e-7, 1e-2))
def test_a_contact_never_pulls_and_its_friction_never_exceeds_its_share(law, overlap, away, dt, later):
    contact = Contact(law, damping=0.6)
    for depth in (overlap, later):
        normal, shear, *_ = contact.step(dt, depth, velocity=(3.0, -2.0, away))
        assert normal >= 0.0
        assert np.linalg.norm(shear) <= 0.5 * normal * (1 + 1e-12)
        assert shear[2] == 0.0


def test_the_force_at_rest_is_that_of_the_spring():
    contact = Contact()
    forces = [contact.step(1e-4, 1e-3)[0] for _ in range(20)]
    assert forces[-1] == pytest.approx(E_STAR * 1e-3, rel=1e-14)


def test_friction_is_capped_at_its_share_of_the_whole_normal_force_damping_included():
    contact = Contact()
    for _ in range(50):
        normal, shear, *_ = contact.step(1e-4, 1e-3, velocity=(5.0, 0, -1.0))
    assert normal > 1.05 * E_STAR * 1e-3
    np.testing.assert_allclose(shear, [-0.5 * normal, 0, 0], rtol=1e-12)


def test_without_friction_there_is_no_tangential_force_and_no_loss():
    contact = Contact(friction=0.0)
    for _ in range(3):
        _, shear, _, slipped = contact.step(1e-4, 1e-3, velocity=(5.0, 1.0, 0.0))
        assert not shear.any()
    assert slipped == pytest.approx(0.0, abs=1e-18)


def test_a_small_slide_is_held_by_the_spring_and_nothing_is_lost():
    contact = Contact()
    for _ in range(100):
        _, shear, _, slipped = contact.step(1e-4, 1e-3, velocity=(1e-2, 0, 0))
        assert slipped == 0.0
    np.testing.assert_allclose(shear, [-G_STAR * 1e-2 * 1e-2, 0, 0], rtol=1e-12)


def test_rolling_without_slip_builds_up_no_tangential_force():
    """u = ω arm e_x where ω turns about e_y: the points in contact stand still."""
    contact = Contact()
    for _ in range(10):
        _, shear, *_ = contact.step(1e-4, 1e-3, velocity=(RADIUS * 3.0, 0, 0), turning=(0, RADIUS * 3.0, 0))
    assert np.abs(shear).max() < 1e-9


def test_a_sliding_contact_loses_friction_times_the_way_it_slips():
    contact, dt, speed, total = Contact(damping=0.0), 1e-5, 1.75, 0.0  # the limit is reached at the end of a step
    limit = 0.5 * E_STAR * 1e-3
    n_steps = 1000
    for _ in range(n_steps):
        *_, slipped = contact.step(dt, 1e-3, velocity=(speed, 0, 0))
        total += slipped
    assert total == pytest.approx(limit * (speed * n_steps * dt - limit / G_STAR), rel=1e-12)


def test_the_dashpot_takes_what_its_force_does_on_the_approach():
    contact = Contact()
    contact.step(1e-5, 1e-3, velocity=(0, 0, -1.0))
    normal, _, damped, _ = contact.step(1e-5, 1.01e-3, velocity=(0, 0, -1.0))
    assert damped == pytest.approx((normal - E_STAR * 1.01e-3) * 1.0 * 1e-5, rel=0.2)
    assert damped > 0.0


def turned_pair(omega, n_steps, law, rolls):
    """How far the tangential force of a loaded pair has gone, after a rigid rotation, from that force turned with it.

    rolls : the turning of the spheres is that by which the points in contact stand still at the place at hand
    """
    omega, distance, overlap = np.array(omega), 0.1, 1e-3
    dt, contact = 1.0 / n_steps, Contact(law, damping=0.0, friction=1e9)
    contact.touches[0], contact.memory[0, LAST_STIFFNESS] = 1, tangential_stiffness(law, G_STAR, overlap, RADIUS)
    start, normal = np.array([3.0, 4.0, 0.0]), np.array([0.0, 0.0, 1.0])
    contact.memory[0, :3] = start
    for k in range(1, n_steps + 1):
        now, half = (Rotation.from_rotvec(omega * dt * t).apply(normal) for t in (k, k - 0.5))
        velocity = distance * np.cross(omega, half)
        velocity -= velocity @ now * now
        turning = np.cross(now, velocity) if rolls else distance * omega
        shear = contact.step(dt, overlap, now, velocity, turning, float(omega @ now), 1.0 / distance)[1]
    return np.linalg.norm(shear - Rotation.from_rotvec(omega).apply(start)) / 5.0


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@pytest.mark.parametrize("omega", [(0.0, 0.0, 2.0), (2.0, 0.0, 0.0), (0.7, -1.1, 1.6)], ids=["about", "over", "both"])
def test_the_force_of_a_pair_that_turns_as_one_turns_with_it(omega, law):
    coarse, fine = (turned_pair(omega, n_steps, law, True) for n_steps in (50, 100))
    assert fine < 4e-4  # measured 1.3e-4 about the normal, 1.3e-6 over it
    assert math.log2(coarse / fine) > 1.9


def test_the_points_in_contact_of_a_pair_that_turns_as_one_do_not_slide():
    """Its normal swings while it spins about it: with the normal of another instant than its rates it would slide."""
    coarse, fine = (turned_pair((0.7, -1.1, 1.6), n_steps, LINEAR, False) for n_steps in (2000, 4000))
    assert fine < 1.1e-3  # N of 5; measured 3.5e-4
    assert math.log2(coarse / fine) > 1.9
