"""What a run must keep: momentum between bodies that only pull each other, and energy up to the work done."""

import numpy as np
import pytest
from motion_scenes import (
    GRAVITY,
    Body,
    Load,
    Setting,
    box_in_drag,
    build,
    heavy_top,
    spring_between,
    sprung_box,
    two_sprung_boxes,
)

from rbfem.motion import loads as kinds
from rbfem.motion import quaternion
from rbfem.motion.loads import add_loads
from rbfem.motion.methods import METHODS
from rbfem.motion.model import ANGULAR_IMPULSE, EXTERNAL, IMPULSE, WORK, scratch_for
from rbfem.motion.state import angular_velocity_world, move


def triangle():
    """Three bodies, each joined to the next by a damped spring at some corner of theirs, far from the origin."""
    ends = [
        ((0.2, 0.1, 0.0), (0.0, -0.3, 0.1)),
        ((0.1, 0.2, 0.3), (0.3, 0.0, 0.0)),
        ((0.0, 0.1, 0.2), (-0.1, 0.2, 0.0)),
    ]
    pairs = [(0, 1), (1, 2), (2, 0)]
    springs = [spring_between(a, p, b, q, 30.0, 0.5, 0.6) for (a, b), (p, q) in zip(pairs, ends, strict=True)]
    rows = {0: (springs[0][0], springs[2][1]), 1: (springs[0][1], springs[1][0]), 2: (springs[1][1], springs[2][0])}
    places = [(5.0, 0.0, 0.0), (6.0, 0.3, 0.0), (5.5, 1.0, 0.4)]
    turns = [(1.0, -2.0, 0.5), (0.0, 1.0, 3.0), (-1.0, 0.2, 0.1)]
    bodies = [
        Body(1.0 + i, (1.0, 1.5 + 0.1 * i, 2.0), places[i], (1.0, 0.2 * i, 0.1, 0.0), (0.2, 0.1 * i, 0.0), turns[i],
             loads=rows[i])
        for i in range(3)
    ]  # fmt: skip
    return Setting(tuple(bodies), np.zeros(3), end=1.0)


def momentum(state, system):
    return state.velocity.T @ system.bodies.mass


def angular_momentum(state, system):
    """About the world's origin; of a held body about its pivot."""
    orbital = np.cross(state.position, system.bodies.mass[:, None] * state.velocity)
    return (orbital + quaternion.rotate(state.quaternion, state.angular_momentum)).sum(axis=0)


def energy(state, system, setting):
    """Kinetic energy, weight, and springs (each spring between bodies stands in two rows: half for each)."""
    omega = angular_velocity_world(state, system.bodies)
    spin = quaternion.rotate(state.quaternion, state.angular_momentum)
    total = 0.5 * (np.einsum("ij,ij", omega, spin) + system.bodies.mass @ (state.velocity**2).sum(axis=1))
    centers = state.position + quaternion.rotate(state.quaternion, system.bodies.arm)
    total -= system.bodies.mass @ centers @ system.gravity
    for i, body in enumerate(setting.bodies):
        for load in (load for load in body.loads if load.kind == kinds.SPRING):
            lever, end, (k, _, rest) = load.values[:3], np.array(load.values[3:6]), load.values[6:9]
            near = state.position[i] + quaternion.rotate(state.quaternion[i], lever)
            if load.other >= 0:
                end = state.position[load.other] + quaternion.rotate(state.quaternion[load.other], end)
            stretch = np.linalg.norm(end - near) - rest
            total += 0.5 * k * stretch**2 * (0.5 if load.other >= 0 else 1.0)
    return total


def test_springs_between_bodies_pull_both_ends_alike():
    system, state = build(triangle())
    scratch = scratch_for(3, 1)
    scratch.stage[:, :10] = np.hstack([state.position, state.quaternion, state.velocity])
    scratch.omega[:] = angular_velocity_world(state, system.bodies)
    for body in range(3):
        add_loads(body, 0.0, system.bodies, system.loads, scratch.stage, scratch.omega, scratch.wrench)
    force, torque = scratch.wrench[:, :3], scratch.wrench[:, 3:6]
    assert np.linalg.norm(force, axis=1).min() > 1.0
    assert np.abs(force.sum(axis=0)).max() < 1e-14 * np.abs(force).max()
    assert np.abs((np.cross(state.position, force) + torque).sum(axis=0)).max() < 1e-14 * 6 * np.abs(force).max()
    assert (scratch.wrench[:, EXTERNAL:] == 0.0).all()


@pytest.mark.parametrize("method", [name for name, row in METHODS.items() if not row.needs_free_bodies])
def test_springs_between_bodies_keep_the_momentum_of_all(method):
    system, state = build(triangle())
    end = move(state, 1e-3, 500, method, system, "serial")
    assert np.abs(momentum(end, system) - momentum(state, system)).max() < 1e-13
    assert np.abs(end.velocity - state.velocity).max() > 0.1


def test_springs_between_bodies_keep_the_angular_momentum_of_all():
    # rk4 keeps it to its own order, (1e-4)^4: below rounding of 5000 steps.
    system, state = build(triangle())
    end = move(state, 1e-4, 5000, "rk4", system, "serial")
    change = angular_momentum(end, system) - angular_momentum(state, system)
    assert np.abs(change).max() < 1e-12
    assert np.abs(end.angular_momentum - state.angular_momentum).max() > 0.1


@pytest.mark.parametrize("setting", [triangle, box_in_drag, sprung_box, two_sprung_boxes, heavy_top])
def test_the_energy_changes_by_the_work_done_to_the_order_of_the_method(setting):
    scene = setting()
    errors, steps = [], (200, 283, 400)
    for n in steps:
        system, state = build(scene)
        end = move(state, scene.end / n, n, "rk4", system, "serial")
        work = end.ledger[:, WORK].sum()
        errors.append(abs(energy(end, system, scene) - energy(state, system, scene) - work))
        assert (abs(work) > 0.05) == (setting is not heavy_top)
    slope = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert slope > 3.7


@pytest.mark.parametrize("method", ["rk4", "euler", "semi_implicit_euler", "rk4_world"])
def test_the_momentum_changes_by_the_impulse_to_rounding(method):
    system, state = build(box_in_drag())
    end = move(state, 1e-3, 500, method, system, "serial")
    change = momentum(end, system) - momentum(state, system)
    assert end.ledger[0, IMPULSE : IMPULSE + 3] == pytest.approx(change, abs=1e-12)
    assert np.abs(change).max() > 1.0


@pytest.mark.parametrize("setting", [box_in_drag, sprung_box, heavy_top])
def test_the_angular_momentum_changes_by_the_angular_impulse(setting):
    scene = setting()
    system, state = build(scene)
    end = move(state, scene.end / 5000, 5000, "rk4", system, "serial")
    change = angular_momentum(end, system) - angular_momentum(state, system)
    scale = np.abs(angular_momentum(state, system)).max() + np.abs(change).max()
    assert end.ledger[0, ANGULAR_IMPULSE : ANGULAR_IMPULSE + 3] == pytest.approx(change, abs=1e-11 * scale)
    assert np.abs(change).max() > 0.1


def test_a_spring_to_a_fixed_thing_counts_as_coming_from_outside():
    spring = Load(kinds.SPRING, (0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 10.0, 0.0, 1.0))
    system, state = build(Setting((Body(loads=(spring,)),)))
    end = move(state, 1e-3, 100, "rk4", system, "python")
    assert end.ledger[0, IMPULSE + 2] == pytest.approx(2.0 * end.velocity[0, 2], abs=1e-14)
    assert end.velocity[0, 2] > 0.1 and end.ledger[0, WORK] == 0.0


def test_gravity_on_a_pushed_body_is_in_its_impulse_and_not_in_its_work():
    system, state = build(Setting((Body(position=(1.0, 0.0, 0.0)),), GRAVITY), is_pushed=True)
    end = move(state, 1e-2, 100, "rk4", system, "python")
    assert end.ledger[0] == pytest.approx([0, 0, 0, -19.62, 0, 19.62, 0], abs=1e-12)
