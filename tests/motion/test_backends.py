"""One text of the physics: interpreted, compiled, on one thread or two, by the short path or the general one."""

from dataclasses import replace

import numpy as np
import pytest
from motion_scenes import GRAVITY, Body, Load, Setting, box_in_drag, build, heavy_top, spring_between, two_sprung_boxes

from rbfem.motion import loads as kinds
from rbfem.motion.methods import METHODS
from rbfem.motion.model import FIXED, RIGID, SPHERICAL, TRANSLATING
from rbfem.motion.state import move


def everything():
    """Each kind of load, each model, springs to the world, to a fixed body and between bodies, a pivot, ramps."""
    joined = two_sprung_boxes().bodies
    lone = box_in_drag().bodies[0]
    fixed = Body(model=FIXED, position=(0.0, 2.0, 0.0), attitude=(0.7, 0.1, 0.2, 0.6))
    tied, _ = spring_between(3, (0.1, 0.0, 0.0), 2, (0.2, 0.0, 0.1), 30.0, 0.4, 1.0)
    to_world = Load(kinds.SPRING, (0.0, 0.1, 0.0, 1.0, 3.0, 1.0, 20.0, 0.3, 0.5))
    ball = Body(1.5, (0.4, 0.4, 0.4), (0.0, 3.0, 0.0), omega=(1.0, 2.0, 3.0), model=SPHERICAL, loads=(tied, to_world))
    dot = Body(1.0, position=(5.0, 0.0, 0.0), model=TRANSLATING, loads=(Load(kinds.DRAG, (0.5, 0.0)),))
    thrown = Body(omega=(1.0, 5.0, 0.1), velocity=(1.0, 0.0, 2.0))
    return Setting((*joined, fixed, ball, lone, dot, thrown, *heavy_top().bodies), GRAVITY)


STEPPED = [name for name, row in METHODS.items() if not row.needs_free_bodies]


def numbers(state):
    return np.hstack([state.position, state.quaternion, state.velocity, state.angular_momentum, state.ledger])


@pytest.mark.parametrize("backend", ["serial", "parallel"])
@pytest.mark.parametrize("method", STEPPED)
def test_a_kernel_computes_what_python_computes(method, backend):
    system, state = build(everything())
    interpreted = numbers(move(state, 1e-3, 60, method, system, "python"))
    compiled = numbers(move(state, 1e-3, 60, method, system, backend))
    # Kernels may contract a * b + c to one rounding; the top turns with 150 rad/s.
    assert np.abs(compiled - interpreted).max() <= 1e-12 * np.abs(interpreted).max()
    assert np.abs(interpreted - numbers(state)).max() > 0.1


@pytest.fixture
def crowd():
    """Two hundred bodies, every other one pushed, so that both threads have work of both kinds."""
    rng = np.random.default_rng(3)
    loads = box_in_drag().bodies[0].loads
    bodies = [
        Body(position=tuple(rng.normal(size=3)), omega=tuple(rng.normal(size=3)), loads=loads if i % 2 else ())
        for i in range(200)
    ]
    return build(Setting(tuple(bodies), GRAVITY))


def test_two_threads_compute_bitwise_what_one_computes(crowd):
    import numba

    if numba.config.NUMBA_NUM_THREADS < 2:
        pytest.skip("this machine has one core")
    system, state = crowd
    ends = []
    before = numba.get_num_threads()
    try:
        for n_threads in (1, 2):
            numba.set_num_threads(n_threads)
            ends.append(numbers(move(state, 1e-2, 50, "rk4", system, "parallel")))
    finally:
        numba.set_num_threads(before)
    assert (ends[0] == ends[1]).all()
    assert (ends[0] == numbers(move(state, 1e-2, 50, "rk4", system, "serial"))).all()


@pytest.mark.parametrize("method", STEPPED)
@pytest.mark.parametrize("model", [TRANSLATING, SPHERICAL, RIGID])
def test_the_short_path_of_a_coasting_body_is_the_general_one(method, model):
    moments = (1.0, 2.0, 2.5) if model == RIGID else (0.8, 0.8, 0.8)
    omega = (0.0, 0.0, 0.0) if model == TRANSLATING else (0.3, -1.0, 0.5)
    body = Body(2.0, moments, (0.1, 0.2, 0.3), (0.5, 0.5, -0.1, 0.7), (0.3, 1.0, 2.0), omega, model=model)
    ends = []
    for is_pushed in (False, True):
        system, state = build(Setting((body,), GRAVITY), is_pushed)
        ends.append(move(state, 0.01, 100, method, system, "python"))
    short, general = ends
    for name in ("position", "quaternion", "velocity", "angular_momentum"):
        far = np.abs(getattr(general, name)).max()
        assert np.abs(getattr(short, name) - getattr(general, name)).max() <= 1e-13 * max(1.0, far), name
    assert (short.ledger == 0.0).all() and (general.ledger != 0.0).any()
    assert np.abs(short.position - body.position).max() > 0.1


@pytest.mark.parametrize("method", STEPPED)
def test_a_body_that_turns_as_a_ball_does_what_the_full_equations_say(method):
    load = (Load(kinds.COUPLE, (0.4, -0.3, 0.2)), Load(kinds.FORCE, (1.0, 2.0, 0.5, 0.1, 0.2, -0.1)))
    full = Body(2.0, (0.8, 0.8, 0.8), omega=(0.3, -1.0, 0.5), velocity=(1.0, 0.0, 0.0), loads=load)
    ends = []
    for model in (RIGID, SPHERICAL):
        system, state = build(Setting((replace(full, model=model),), GRAVITY))
        ends.append(numbers(move(state, 0.01, 100, method, system, "python")))
    # rk4_world lets the length of q into the turned tensor, as published; the ball has none. Measured: 3.4e-10.
    assert np.abs(ends[0] - ends[1]).max() < (1e-9 if method == "rk4_world" else 1e-12)


@pytest.mark.parametrize("method", STEPPED)
def test_a_body_that_only_translates_does_what_the_full_equations_say(method):
    load = (Load(kinds.FORCE, (1.0, 2.0, 0.5), ((0.0, 0.0), (2.0, 1.0))), Load(kinds.DRAG, (0.7, 0.3)))
    full = Body(2.0, velocity=(1.0, 0.0, 0.0), attitude=(0.5, 0.5, 0.5, 0.5), loads=load)
    ends = []
    for model in (RIGID, TRANSLATING):
        system, state = build(Setting((replace(full, model=model),), GRAVITY))
        ends.append(numbers(move(state, 0.01, 100, method, system, "python")))
    assert np.abs(ends[0] - ends[1]).max() < 1e-13


@pytest.mark.parametrize("method", STEPPED)
def test_a_run_in_two_calls_is_the_run_in_one(method):
    system, state = build(everything())
    whole = move(state, 1e-3, 60, method, system, "python")
    half = move(move(state, 1e-3, 30, method, system, "python"), 1e-3, 30, method, system, "python")
    assert half.time == pytest.approx(whole.time, rel=1e-15)
    # A call ends with half a kick; two halves of a damped kick are one whole kick to second order only. Measured: 2e-6.
    tolerance = 1e-5 if method in ("kdk", "dlm", "spiral") else 1e-12
    assert np.abs(numbers(half) - numbers(whole)).max() <= tolerance * np.abs(numbers(whole)).max()


def test_fixed_bodies_stay_and_the_given_state_is_not_touched():
    system, state = build(everything())
    before = numbers(state).copy()
    end = move(state, 1e-3, 10, "rk4", system, "python")
    assert (numbers(state) == before).all()
    assert (numbers(end)[2] == before[2]).all()
    assert (end.position[7] == state.position[7]).all()
