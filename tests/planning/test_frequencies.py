"""The fastest swing, decay and spin of a scene against closed forms, and the step limit against real runs."""

import dataclasses

import numpy as np
import pytest

import rbfem
from rbfem.errors import RunError
from rbfem.motion.methods import METHODS
from rbfem.planning import frequencies as room
from rbfem.planning.frequencies import Frequencies, StepLimit, step_limit
from rbfem.planning.models import choose_models
from rbfem.planning.system import find_islands

K, R = 250.0, 0.1
M = 1000.0 * 4 / 3 * np.pi * R**3  # a ball of water
I = 0.4 * M * R**2
BALL = {"shape": "ball"}
AWAY = {"position": [0.5, 0, 0]}


def spring(to=(0, 0, 0), **keys):
    return {"spring": {"to": to if isinstance(to, dict) else list(to), "stiffness": K} | keys}


def fastest(scene):
    models = choose_models(scene)
    return room.frequencies(scene, models, find_islands(scene, models))


# ---------------------------------------------------------------------------------------------------- closed forms


def test_a_point_on_a_spring_swings_at_the_root_of_k_over_m(scene_of):
    found = fastest(scene_of(BALL | AWAY | {"loads": [spring()]}))
    assert found.oscillation == pytest.approx(np.sqrt(K / M), rel=1e-12)
    assert (found.decay, found.spin) == (0.0, 0.0)
    assert found.step_limit == pytest.approx(2 / np.sqrt(K / M), rel=1e-12)


def test_a_lever_makes_a_spring_faster(scene_of):
    slack = spring(at=[0, 0.07, 0], rest_length=float(np.hypot(0.5, 0.07)))
    found = fastest(scene_of(BALL | AWAY | {"loads": [slack]}))
    assert found.oscillation == pytest.approx(np.sqrt(K * (1 / M + 0.07**2 / I)), rel=1e-8)


def test_the_pull_of_a_taut_spring_swings_its_lever_like_a_weight(scene_of):
    """Far away the stiffness is nothing beside the pull: ω² = k l a / I, as of a pendulum in a field k l / m."""
    far = {"position": [3000.0, 0, 0], "loads": [spring(at=[-0.07, 0, 0])]}
    found = fastest(scene_of(BALL | far))
    assert found.oscillation == pytest.approx(np.sqrt(K * (2999.93 + 0.07) * 0.07 / I), rel=1e-4)


def test_a_lever_of_a_turned_mesh_counts_with_the_whole_tensor(scene_of):
    """The fastest direction n of k (1/m + (r × n)·I⁻¹(r × n)), in the axes of the mesh."""
    point = [0.01, 0.05, 0.03]
    slack = spring(at=point, rest_length=float(np.linalg.norm(point)))  # the mesh's origin stays where the anchor is
    body = {"shape": "bracket", "material": "steel", "quaternion": [0.9, 0.1, -0.3, 0.2], "loads": [slack]}
    scene = scene_of(body)
    part = scene.parts[0]
    cross = np.cross(np.eye(3), np.array(point) + part.origin)
    compliance = np.eye(3) / part.mass + cross @ np.linalg.inv(part.inertia) @ cross.T
    expected = np.sqrt(K * np.linalg.eigvalsh(compliance)[-1])
    assert fastest(scene).oscillation == pytest.approx(expected, rel=1e-8)


def test_the_gradient_of_a_field_counts_with_its_stiffness_and_with_its_turning(scene_of):
    field = {"gravity_gradient": {"rate": 0.1, "normal": [0, 0, 1], "start": [1, 0, 0]}}
    scene = scene_of({"loads": [field]})
    small, middle, large = scene.reference.moments[0]
    shares = [(large - middle) / small, (large - small) / middle, (middle - small) / large]
    assert fastest(scene).oscillation == pytest.approx(0.1 * np.sqrt(3 * max(shares) + 1), rel=1e-12)
    assert fastest(scene_of(BALL | {"loads": [field]})).oscillation == 0.0


def test_two_springs_add_up(scene_of):
    found = fastest(scene_of(BALL | {"loads": [spring((1, 0, 0)), spring((-1, 0, 0))]}))
    assert found.oscillation == pytest.approx(np.sqrt(2 * K / M), rel=1e-12)


def test_two_bodies_on_a_spring_swing_with_their_reduced_mass(scene_of):
    light, heavy = BALL | {"loads": [spring({"body": "body1"})]}, BALL | AWAY | {"material": "steel"}
    found = fastest(scene_of(light, heavy))
    assert found.oscillation == pytest.approx(np.sqrt(K * (1 / M + 1 / (7.85 * M))), rel=1e-12)


def test_a_body_sprung_to_a_fixed_one_swings_alone(scene_of):
    found = fastest(scene_of(BALL | {"loads": [spring({"body": "body1"})]}, BALL | AWAY | {"fixed": True}))
    assert found.oscillation == pytest.approx(np.sqrt(K / M), rel=1e-12)


def chain(n_bodies):
    """Balls in a row, each sprung to the next, the first to the wall."""
    bodies = [BALL | {"position": [i, 0, 0], "loads": [spring({"body": f"body{i + 1}"})]} for i in range(n_bodies)]
    bodies[-1]["loads"] = []
    bodies[0]["loads"] = [*bodies[0]["loads"], spring((-1, 0, 0))]
    return bodies


def test_a_chain_of_masses_swings_at_the_largest_eigenvalue_of_its_matrix(scene_of):
    matrix = 2 * np.eye(7) - np.eye(7, k=1) - np.eye(7, k=-1)
    matrix[-1, -1] = 1
    expected = np.sqrt(K / M * np.linalg.eigvalsh(matrix)[-1])
    assert fastest(scene_of(*chain(7))).oscillation == pytest.approx(expected, rel=1e-12)


def test_a_long_chain_swings_at_the_closed_form(scene_of):
    """Fixed at one end, free at the other: ω = 2 √(k/m) cos(π/(4n + 2)), here from Lanczos, which is asked for 1e-4."""
    expected = 2 * np.sqrt(K / M) * np.cos(np.pi / (4 * 230 + 2))
    found = fastest(scene_of(*chain(230))).oscillation
    assert expected <= found <= expected * (1 + 1e-4)


def test_a_large_island_gets_the_same_frequency_from_both_solvers(scene_of, monkeypatch):
    bodies = chain(60)
    for body in bodies[::3]:
        body["loads"] = [*body["loads"], {"drag": {"linear": 3.0}}]
    bodies[40]["loads"].append(spring((3, 1, 0), at=[0.05, 0.02, 0], damping=2.0))
    scene = scene_of(*bodies)
    sparse = fastest(scene)
    monkeypatch.setattr(room, "DENSE_BODIES", 10**6)
    dense = fastest(scene)
    assert sparse.oscillation != dense.oscillation  # it did take the other road
    assert dense.oscillation <= sparse.oscillation <= dense.oscillation * (1 + 2e-4)
    assert dense.decay <= sparse.decay * (1 + 1e-12) and sparse.decay <= dense.decay * (1 + 2e-4)


def test_the_sparse_solver_gives_the_same_digits_every_time(scene_of):
    scene = scene_of(*chain(230))
    assert fastest(scene).oscillation == fastest(scene).oscillation


def test_a_damper_decays_at_half_its_damping_over_the_mass(scene_of):
    found = fastest(scene_of(BALL | AWAY | {"loads": [spring(damping=6.0)]}))
    beta, omega = 6.0 / (2 * M), np.sqrt(K / M)
    assert found.decay == pytest.approx(beta, rel=1e-12)
    assert found.step_limit == pytest.approx(2 / (np.hypot(omega, beta) + beta), rel=1e-12)
    zeta = beta / omega
    assert found.step_limit == pytest.approx(2 * (np.sqrt(1 + zeta**2) - zeta) / omega, rel=1e-12)


def test_drag_decays_in_translation_and_in_rotation(scene_of):
    spun = BALL | {"angular_velocity": [1, 0, 0]}
    slow = fastest(scene_of(spun | {"loads": [{"drag": {"linear": 6.0, "angular": 1e-6}}]}))
    assert slow.decay == pytest.approx(6.0 / (2 * M), rel=1e-12)
    fast = fastest(scene_of(spun | {"loads": [{"drag": {"linear": 6.0, "angular": 0.3}}]}))
    assert fast.decay == pytest.approx(0.3 / (2 * I), rel=1e-12)


def test_a_pendulum_swings_at_the_root_of_its_weight_on_the_arm_over_its_moment(scene_of):
    found = fastest(scene_of(BALL | {"pivot": [0, 0, 0.7]}, gravity=[0, 0, -9.81]))
    assert found.oscillation == pytest.approx(np.sqrt(M * 9.81 * 0.7 / (I + M * 0.7**2)), rel=1e-12)


def test_a_force_on_an_arm_swings_like_a_weight_and_with_its_largest_ramp_factor(scene_of):
    load = {"force": [0, 0, -5.0], "at": [0.07, 0, 0], "ramp": [[0, 0], [0.5, -3], [1, 1]]}
    found = fastest(scene_of(BALL | {"loads": [load]}))
    assert found.oscillation == pytest.approx(np.sqrt(3 * 5.0 * 0.07 / I), rel=1e-12)


def test_equal_bodies_with_loads_that_differ_only_in_their_ramp_are_not_taken_for_copies(scene_of):
    def pushed(factor):
        return BALL | {"loads": [{"force": [0, 0, -5.0], "at": [0.07, 0, 0], "ramp": [[0, factor]]}]}

    one, both = scene_of(pushed(1), pushed(9)), scene_of(pushed(9))
    assert fastest(one).oscillation == pytest.approx(fastest(both).oscillation, rel=1e-12)


def test_spin_counts_the_start_and_what_constant_torques_add_until_the_end(scene_of):
    brick = {"angular_velocity": [3, 0, 4], "loads": [{"torque": [0, 2, 0], "ramp": [[0, 0], [1, 0.5]]}]}
    scene = scene_of(brick, time={"end": 4})
    smallest = 6.0 * (0.1**2 + 0.2**2) / 12
    lasting = 0.25 + 0.5 * 3  # ∫ factor dt
    assert fastest(scene).spin == pytest.approx(5 + 2 * lasting / smallest, rel=1e-12)
    assert fastest(scene_of({"angular_velocity": [3, 0, 4]})).step_limit == pytest.approx(2 / 5, rel=1e-12)


def test_where_nothing_swings_or_spins_there_is_no_limit(scene_of):
    scene = scene_of({"velocity": [1, 2, 3], "loads": [{"force": [1, 2, 3]}]}, gravity=[0, 0, -9.81])
    assert fastest(scene).step_limit == np.inf
    assert rbfem.plan(scene).step_limit.value is None


def test_the_limit_of_a_method_is_that_of_what_it_does_not_do_exactly():
    spinning, damped = Frequencies(3.0, 0.0, 20.0), Frequencies(3.0, 4.0, 1.0)
    assert step_limit(spinning, METHODS["rk4"]) == StepLimit(2 / 20, "2/spin")
    assert step_limit(spinning, METHODS["rkn4"]) == StepLimit(2 / 3, "2/ω")
    assert step_limit(damped, METHODS["rk4"]) == StepLimit(2 / 9, "2/(√(ω² + β²) + β)")
    assert step_limit(damped, METHODS["kdk"]) == StepLimit(2 / 4, "2/β")
    assert step_limit(Frequencies(0.0, 0.0, 20.0), METHODS["kdk"]).seconds == np.inf


def test_the_limit_of_a_method_is_shorter_where_it_stands_less_than_two_and_never_longer():
    swinging = Frequencies(4.0, 0.0, 0.0)
    short = dataclasses.replace(METHODS["kdk"], oscillation_limit=1.0)
    assert step_limit(swinging, short) == StepLimit(1 / 4, "1/ω")
    assert {step_limit(swinging, row).seconds for row in METHODS.values()} == {2 / 4}


def test_a_fixed_body_swings_with_nothing(scene_of):
    assert fastest(scene_of(BALL | AWAY | {"fixed": True, "loads": [spring()]})).step_limit == np.inf


def test_the_frequency_does_not_depend_on_the_attitude(scene_of):
    """The bracket turns about its own origin, and the pulls stay: one spring starts there, the other ends there."""
    loads = [spring((0.2, 0, 0), at=[0, 0, 0]), spring((0, 0, 0), at=[-0.02, 0.01, 0.03])]
    body = {"shape": "bracket", "material": "steel", "loads": loads}
    turned = fastest(scene_of(body | {"quaternion": [0.3, 0.5, -0.7, 0.1]})).oscillation
    assert turned == pytest.approx(fastest(scene_of(body)).oscillation, rel=1e-10)


# ------------------------------------------------------------------------------------- against what really happens

KICK = {"velocity": [1e-3, 0, 0]}


def undamped(scene_of):
    return scene_of(BALL | KICK | {"loads": [spring()]}, **TIME)


def damped(scene_of):
    return scene_of(BALL | KICK | {"loads": [spring(damping=20.0)]}, **TIME)


def dragged(scene_of):
    return scene_of(BALL | KICK | {"loads": [{"drag": {"linear": 40.0}}]}, **TIME)


def on_a_lever(scene_of):
    """The body's end sits on the anchor; a kick across the lever swings the fastest mode."""
    kick = {"velocity": [0, 0, 1e-9], "angular_velocity": [0, 5e-8, 0]}
    return scene_of(BALL | kick | {"position": [-0.05, 0, 0], "loads": [spring(at=[0.05, 0, 0])]}, **TIME)


def three_in_a_row(scene_of):
    """All in one spot: springs without rest length are then linear."""
    bodies = [body | {"position": [0, 0, 0]} for body in chain(3)]
    bodies[0]["loads"][1]["spring"]["to"] = [0, 0, 0]
    bodies[1] |= KICK
    return scene_of(*bodies, **TIME)


def spun_down(scene_of):
    return scene_of(BALL | {"angular_velocity": [0, 0, 1e-3], "loads": [{"drag": {"angular": 0.3}}]}, **TIME)


def pendulum(scene_of):
    return scene_of(BALL | {"pivot": [0, 0, 0.7], "angular_velocity": [1e-9, 0, 0]}, gravity=[0, 0, -9.81], **TIME)


TIME = {"time": {"end": 1, "method": "semi_implicit_euler"}}
SCENES = [undamped, damped, dragged, on_a_lever, three_in_a_row, spun_down, pendulum]


def growth(scene, step, n_steps=400):
    """Largest speed after n_steps over the largest of the first steps; infinite for a run that blew up."""
    scene = dataclasses.replace(scene, step=step, end_time=n_steps * step, output_interval=10 * step)
    plan = rbfem.plan(scene, beyond_limit=True)
    plan = dataclasses.replace(plan, verify=dataclasses.replace(plan.verify, value=False))
    speeds = []
    try:
        for frame in rbfem.simulate(scene, plan):
            speeds.append(max(np.abs(frame.velocity).max(), np.abs(frame.angular_velocity).max()))
    except RunError:
        return np.inf
    return max(speeds[len(speeds) // 2 :]) / max(speeds[:2])


@pytest.mark.parametrize("make", SCENES, ids=lambda make: make.__name__)
def test_semi_implicit_euler_stays_bounded_just_below_the_limit_and_grows_just_above(scene_of, make):
    scene = make(scene_of)
    limit = fastest(scene).step_limit
    assert growth(scene, 0.98 * limit) < 20  # at dt ω = 1.96 the orbit in phase space is 10 times as long as wide
    assert growth(scene, 1.02 * limit) > 1e3
