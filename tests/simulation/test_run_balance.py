"""Energy, momentum and angular momentum of a run balance with what its loads bring in, for every kind of load."""

import numpy as np
import pytest

import rbfem

G = [0.0, 1.0, -9.81]
MOVING = {"position": [0.5, 0.1, 0], "velocity": [1, 0.5, 2], "angular_velocity": [1, 2, 3]}
OTHER = {"name": "other", "position": [1, 1, 0], "material": "steel", "quaternion": [0.5, 0.5, -0.5, 0.5]}
AT, RAMP = [0.05, 0.02, 0.1], [[0, 0], [0.21, 1], [0.5, -0.5]]
TO_BODY = {"spring": {"at": AT, "to": {"body": "other", "at": [0, 0.1, 0]}, "stiffness": 90.0, "rest_length": 0.3}}
DAMPED = {"spring": TO_BODY["spring"] | {"damping": 2.0}}
TO_POINT = {"spring": {"at": AT, "to": [0, 0, 1], "stiffness": 90.0, "damping": 2.0, "rest_length": 0.3}}
HELD = {"pivot": [0.4, 0.1, 0.2], "position": [0.5, 0.1, 0], "angular_velocity": [1, 2, 3]}
BRACKET = {"shape": "bracket", "material": "by-group", "quaternion": [0.9, 0.1, -0.3, 0.2]}

SCENES = {
    "nothing": [MOVING],
    "force": [MOVING | {"loads": [{"force": [3, 1, 2], "at": AT}]}],
    "following_force": [MOVING | {"loads": [{"force": [3, 1, 2], "at": AT, "frame": "body"}]}],
    "ramped_force": [MOVING | {"loads": [{"force": [30, 1, 2], "at": AT, "ramp": RAMP}]}],
    "torque": [MOVING | {"loads": [{"torque": [0.3, 0.1, 0.2]}]}],
    "following_torque": [MOVING | {"loads": [{"torque": [0.3, 0.1, 0.2], "frame": "body", "ramp": RAMP}]}],
    "pressure": [MOVING | BRACKET | {"loads": [{"pressure": 800.0, "on": "loaded"}]}],
    "traction": [MOVING | BRACKET | {"loads": [{"traction": [300.0, 0, 200], "on": "loaded", "ramp": RAMP}]}],
    "drag": [MOVING | {"loads": [{"drag": {"linear": 2.0, "angular": 0.05}}]}],
    "spring": [MOVING | {"loads": [TO_POINT]}],
    "spring_between": [MOVING | {"loads": [TO_BODY]}, OTHER],
    "damper_between": [MOVING | {"loads": [DAMPED]}, OTHER],
    "spring_to_fixed": [MOVING | {"loads": [DAMPED]}, OTHER | {"fixed": True}],
    "spring_to_held": [MOVING | {"loads": [DAMPED]}, OTHER | {"pivot": [1, 1, 1]}],
    "held": [HELD],
    "held_and_pushed": [HELD | {"loads": [TO_POINT, {"force": [3, 1, 2]}, {"drag": {"linear": 2.0, "angular": 0.05}}]}],
    "held_bracket": [HELD | BRACKET | {"loads": [{"pressure": 800.0, "on": "loaded"}]}],
}


@pytest.mark.parametrize("name", SCENES)
def test_the_balance_closes_to_the_error_of_the_method(scene_of, run_of, name):
    scene = scene_of(*SCENES[name], gravity=G, time={"end": 0.8, "step": 2e-3, "method": "rk4"}, output={"every": 0.1})
    run, frames = run_of(scene)
    energy = max(abs(frame.balance.kinetic) + abs(frame.balance.rotational) for frame in frames)
    momentum = scene.mass.sum() * max(np.abs(frame.velocity).max() for frame in frames)
    assert energy > 0.01
    assert run.largest_drift["energy"] < 1e-6 * energy
    assert run.largest_drift["momentum"] < 1e-12 * momentum
    assert run.largest_drift["angular_momentum"] < 1e-6 * momentum
    assert run.largest_drift.keys() == {"energy", "momentum", "angular_momentum"}


@pytest.mark.parametrize("name", ["force", "drag", "spring", "damper_between", "held_and_pushed"])
def test_the_drift_falls_with_the_step(scene_of, run_of, name):
    """A sign or a lever wrong in the books would not fall."""

    def drift(step):
        time = {"end": 0.8, "step": step, "method": "rk4"}
        return run_of(scene_of(*SCENES[name], gravity=G, time=time, output={"every": 0.1}))[0].largest_drift["energy"]

    assert drift(0.01) > 6 * drift(0.005) or drift(0.005) < 1e-12


def test_the_work_of_a_constant_force_is_force_times_way(scene_of, run_of):
    _, frames = run_of(scene_of(MOVING | {"loads": [{"force": [3, 1, 2]}]}, gravity=G))
    way = frames[-1].position[0] - frames[0].position[0]
    assert frames[-1].balance.work == pytest.approx(np.dot([3, 1, 2], way), rel=1e-12)


def test_a_spring_stores_half_k_elongation_squared_once_also_between_bodies(scene_of):
    spring = {"stiffness": 90.0, "rest_length": 0.3}
    for to in ([1, 0, 0], {"body": "other"}):
        bodies = [{"loads": [{"spring": spring | {"to": to}}]}, {"name": "other", "position": [1, 0, 0]}]
        scene = scene_of(*bodies)
        first = next(iter(rbfem.simulate(scene, rbfem.plan(scene))))
        assert first.balance.elastic == pytest.approx(0.5 * 90 * 0.7**2, rel=1e-13)


def test_momentum_of_bodies_that_only_fall_is_booked_without_being_integrated(scene_of, run_of):
    place = {"in_box": [[-1, -1, 0], [1, 1, 3]], "orientation": "random"}
    scene = scene_of({"count": 20, "place": place, "velocity": [1, 2, 3]}, gravity=G)
    run, frames = run_of(scene)
    np.testing.assert_allclose(frames[-1].balance.impulse, scene.mass.sum() * np.array(G), rtol=1e-13)
    assert run.largest_drift["angular_momentum"] < 1e-11


def test_a_fixed_body_has_neither_energy_nor_momentum(scene_of, run_of):
    _, frames = run_of(scene_of({"fixed": True, "position": [0, 0, 5]}, gravity=G))
    balance = frames[-1].balance
    assert balance.energy == 0.0 and not balance.momentum.any() and not balance.angular_momentum.any()
